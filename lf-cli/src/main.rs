//! `lfslab`: capture, compress, inspect and render environment light fields.
//!
//! Each sub-command is a short list of calls into the crates; no algorithm lives here.

#![forbid(unsafe_code)]

mod args;
mod capture;
mod capture_args;
mod crop;
mod cubemap;
mod demo;
mod device;
mod exchange;
mod exchange_args;
mod frames;
mod holdout;
mod info;
mod input;
mod output;
mod pictures;
mod plan;
mod plan_args;
mod progress;
mod refocus;
mod refocus_args;
mod render;
mod report;
mod scene_args;
mod sources;
mod validate;
mod view;

use std::process::ExitCode;

use anyhow::Result;
use clap::Parser;

use crate::args::{Cli, Command};

fn main() -> ExitCode {
    match run(&Cli::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            // What shells give for Ctrl-C.
            if error.is::<capture::Stopped>() { ExitCode::from(130) } else { ExitCode::FAILURE }
        }
    }
}

fn run(command: &Command) -> Result<()> {
    match command {
        Command::Demo(args) => demo::run(args),
        Command::Capture(args) => capture::run(args),
        Command::View(args) => view::run(args),
        Command::Merge(args) => capture::run_merge(args),
        Command::Cubemap(args) => cubemap::run(args),
        Command::Plan(args) => plan::run(args),
        Command::Report(args) => report::run(args),
        Command::Render(args) => render::run(args),
        Command::Info(args) => info::run(args),
        Command::Validate(args) => validate::run(args),
        Command::Crop(args) => crop::run(args),
        Command::Refocus(args) => refocus::run(args),
        Command::Holdout(args) => holdout::run(args),
        Command::Export(args) => exchange::run_export(args),
        Command::Import(args) => exchange::run_import(args),
    }
}

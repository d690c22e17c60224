//! `lf-bench`: BC1 encoders and decoders side by side.

#![forbid(unsafe_code)]

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
use lf_bench::{BenchError, Options, compare_decoders, compare_encoders};

/// Measures BC1 encoders and decoders of several crates side by side, on one thread.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Encoders: speed and PSNR, which of them no other beats, as table, CSV and plots.
    Front {
        #[command(flatten)]
        common: Common,
        /// Distance in blocks of nearly equal pictures side by side (32 for the 128-texel cameras of an atlas): adds the
        /// encoders that start from the picture to the left.
        #[arg(long, value_name = "N", default_value_t = 0)]
        repeat_blocks: u32,
    },
    /// Decoders: speed against copying and against texture2ddecoder, as table and CSV.
    Decoders(Common),
}

#[derive(Args)]
struct Common {
    /// Folder of photographs (PNG, JPEG, HDR) for the class "photo"; without it those of shared/data, if there.
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,
    /// Folder for the results.
    #[arg(long, value_name = "DIR", default_value = "target/lf-bench")]
    out: PathBuf,
    /// Measure only codecs whose names hold one of these words.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    only: Vec<String>,
    /// CPU seconds for each codec on each class; slow codecs take as long as three rounds need.
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = seconds)]
    seconds: f64,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("expected a number of seconds, zero or more".to_owned()),
    }
}

impl Common {
    fn options(self, repeat_blocks: u32) -> Options {
        let words: Vec<String> = std::env::args().skip(1).collect();
        let command = format!("cargo run --release -p lf-bench -- {}", words.join(" "));
        Options { images: self.images, out: self.out, only: self.only, seconds: self.seconds, repeat_blocks, command }
    }
}

fn main() -> ExitCode {
    match run(Cli::parse().command) {
        Ok(table) => {
            println!("{table}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(command: Command) -> Result<String, BenchError> {
    match command {
        Command::Front { common, repeat_blocks } => compare_encoders(&common.options(repeat_blocks)),
        Command::Decoders(common) => compare_decoders(&common.options(0)),
    }
}

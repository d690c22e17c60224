//! Error against run time: how each method that draws a reflection is measured, compared and reported.
//!
//! [`measure`] times frames and keeps every sample, so that a [`Timing`] gives the median *and* the spread. A
//! [`MethodResult`] joins that time to the error of each eye and to the bytes the method needs; a [`Report`] holds the
//! results of one run with everything a reader needs to judge and to repeat it: machine, scene, command line. It is
//! written as JSON ([`Report::to_json`], described field by field in `report.schema.json`), as CSV, as one self-contained HTML
//! page ([`Report::to_html`]), as plots ([`Report::plot`]) and as Markdown. A [`Baseline`] is an earlier report's JSON, and tells what got
//! worse since.
//!
//! A report compares methods on *the same frames* ([`Frames`]): errors of different reflectors are never set against each other,
//! and [`pareto_front`] is taken for all frames by themselves. Whoever fills the report in sees to it that the frames
//! are the same; this crate renders nothing and reads no files but `/proc/cpuinfo` (in [`cpu_name`]).

#![forbid(unsafe_code)]

mod axis;
mod check;
mod csv;
mod error;
mod html;
mod labels;
mod machine;
mod markdown;
mod pareto;
mod plot;
mod report;
mod result;
mod timing;
mod units;

#[cfg(test)]
mod sample;

pub use axis::Plot;
pub use check::{Baseline, Change};
pub use error::ReportError;
pub use labels::{LabelPlacer, Placed, Rect};
pub use machine::{Machine, cpu_name};
pub use pareto::pareto_front;
pub use report::{Figure, Report, Table};
pub use result::{BASELINE_METHOD, EyeError, Frames, MethodResult};
pub use timing::{Timing, measure};

/// Compiles the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

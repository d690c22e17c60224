//! The command line of `lfslab methods`.

use std::path::PathBuf;

use clap::Args;

use crate::scene_args::LightArgs;

#[derive(Debug, Args)]
pub(crate) struct MethodsArgs {
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "lfslab-methods")]
    pub(crate) out: PathBuf,
    /// Scenes to compare in, one after the other: embedded ones (museum, corridor, mirror-box, forest, beside) or glTF files
    #[arg(value_name = "NAME|FILE", default_values = ["museum", "mirror-box", "corridor"])]
    pub(crate) scenes: Vec<String>,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    /// Only methods that need at most this much of the device, in MB
    #[arg(long, value_name = "MB", default_value_t = 60.0, value_parser = budget)]
    pub(crate) budget: f64,
    /// Width and height of the pictures in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=4096))]
    pub(crate) size: u32,
    /// Samples of each ray of the traced pictures, which the others are measured against [default: 16 times --samples, 1 where nothing
    /// is random]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) reference_samples: Option<u32>,
    /// Do not use a GPU even if there is one
    #[arg(long)]
    pub(crate) cpu: bool,
}

fn budget(text: &str) -> Result<f64, String> {
    let parsed = text.trim().parse().ok().filter(|megabytes| (0.5..=4000.0).contains(megabytes));
    parsed.ok_or_else(|| "expected a number from 0.5 to 4000".to_owned())
}

//! The command line of `lfslab refocus` and `lfslab holdout`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use lf_math::Face;

use crate::args::{FileArgs, numbers};
use crate::capture_args::counts;
use crate::exchange_args::face;

#[derive(Debug, Args)]
pub(crate) struct RefocusArgs {
    #[command(flatten)]
    pub(crate) input: FileArgs,
    /// The file to write; without it, what was found is only told
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Where the focal planes are to stand: `auto` (where left-out cameras are predicted best by those beside them, a least-squares
    /// sweep), `none` (at infinity), or how many texels they move from one camera to the next
    #[arg(long, value_name = "auto|none|TEXELS", default_value = "auto")]
    pub(crate) disparity: DisparityArg,
}

#[derive(Debug, Args)]
pub(crate) struct HoldoutArgs {
    #[command(flatten)]
    pub(crate) input: FileArgs,
    /// Which slab: +x, -x, +y, -y, +z or -z; needed if there are several
    #[arg(long, value_name = "FACE", value_parser = face, allow_hyphen_values = true)]
    pub(crate) face: Option<Face>,
    /// Keep every N-th camera along s and t: N, or SxT
    #[arg(long, value_name = "N|SxT", value_parser = counts::<256>, default_value = "2")]
    pub(crate) every: [u32; 2],
    /// How many planes to choose from, texel by texel, where the cameras agree best; several numbers set apart by commas, 0 for none
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_value = "2,4,8", value_parser = clap::value_parser!(u16).range(0..=256))]
    pub(crate) planes: Vec<u16>,
    /// Measure at most so many of the left-out views, evenly spread [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) views: Option<u32>,
    /// A picture to write (.png): a left-out view, what each method makes of it, and the differences
    #[arg(long, value_name = "PNG")]
    pub(crate) sheet: Option<PathBuf>,
}

/// Where focal planes are to stand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum DisparityArg {
    /// Where the images say.
    Auto,
    /// So many texels from one camera to the next, at least 0: infinity.
    Texels(f32),
}

impl FromStr for DisparityArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self::Auto),
            "none" => Ok(Self::Texels(0.0)),
            texels => match numbers(texels) {
                Ok([texels]) if texels >= 0.0 => Ok(Self::Texels(texels as f32)),
                _ => Err("expected auto, none or a number of texels, not less than 0".to_owned()),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disparities_are_named_or_counted() {
        assert_eq!("auto".parse(), Ok(DisparityArg::Auto));
        assert_eq!("none".parse(), Ok(DisparityArg::Texels(0.0)));
        assert_eq!("1.5".parse(), Ok(DisparityArg::Texels(1.5)));
        for bad in ["", "-1", "1,2", "nan", "some"] {
            assert!(bad.parse::<DisparityArg>().is_err(), "{bad}");
        }
    }
}

//! The arguments of commands that trace scenes.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use lf_capture::Shard;
use lf_math::PlanePlacement;
use lf_scene::FocusRule;

use crate::args::{EncodingArgs, Preset, numbers};
use crate::scene_args::SceneArgs;

#[derive(Debug, Args)]
pub(crate) struct CaptureArgs {
    /// The file to write
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// How many cameras and texels
    #[arg(long, value_enum, default_value_t = Preset::Small)]
    pub(crate) preset: Preset,
    /// Cameras along s and t, instead of the preset's: N for N×N, or SxT
    #[arg(long, value_name = "N|SxT", value_parser = counts::<256>)]
    pub(crate) cameras: Option<[u32; 2]>,
    /// Texels along u and v of each camera's image, instead of the preset's: N for N×N, or UxV
    #[arg(long, value_name = "N|UxV", value_parser = counts::<1024>)]
    pub(crate) resolution: Option<[u32; 2]>,
    /// Where the camera planes stand, instead of the preset's choice: `faces` (on the cell's, as in the paper: slabs of
    /// three edge lengths), `center` (through the cell's centre: two edge lengths), or metres from the centre towards each
    /// face
    #[arg(long, value_name = "PLACE", allow_hyphen_values = true)]
    pub(crate) planes: Option<PlanesArg>,
    /// Rays per texel and axis, instead of the preset's: N×N rays a texel
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) supersample: Option<u32>,
    /// Where the focal planes stand: at a middle of the inverse depths that a survey finds: `median`, the default, as it does best
    /// in the museum (docs/light-fields.md); `least-squares`, the mean; `minimax`, between the nearest and the farthest (the harmonic mean of both depths); or `none` (at infinity), or metres from the
    /// camera planes
    #[arg(long, value_name = "RULE|METRES", default_value = "median")]
    pub(crate) focus: FocusArg,
    #[command(flatten)]
    pub(crate) encoding: EncodingArgs,
    /// Trace and store the texels that no ray through the cell asks for, too
    #[arg(long)]
    pub(crate) whole: bool,
    /// Write inverse depths, too: a light field of the same windows whose texels, linear half floats, are 1/m along the
    /// face's axis from the camera plane; negative behind the plane, 0 where nothing is met
    #[arg(long, value_name = "FILE")]
    pub(crate) depth: Option<PathBuf>,
    /// Go on with the capture that was stopped or killed; begin it if there is none
    #[arg(long, conflicts_with = "restart")]
    pub(crate) resume: bool,
    /// Throw away what a stopped capture left, and begin anew
    #[arg(long)]
    pub(crate) restart: bool,
    /// Capture only the K-th of N parts of the file, and leave it in a journal beside FILE for `lfslab merge`
    #[arg(long, value_name = "K/N")]
    pub(crate) shard: Option<Shard>,
    /// How many threads work [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

#[derive(Debug, Args)]
pub(crate) struct MergeArgs {
    /// The journals that `lfslab capture --shard` left, one of each shard; they are kept
    #[arg(value_name = "JOURNAL", required = true)]
    pub(crate) journals: Vec<PathBuf>,
    /// The file to write
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// The file of inverse depths to write, if they were captured
    #[arg(long, value_name = "FILE")]
    pub(crate) depth: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct CubemapArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Where to stand, metres, world space, as x,y,z; may be given several times [default: the cell's centre]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(crate) at: Vec<PointArg>,
    /// Texels along the edge of a face
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=8192))]
    pub(crate) size: u32,
    /// Rays per texel and axis, for the radiance
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) supersample: u32,
    /// Folder for the faces, made if it is not there: NUMBER-FACE.exr with R, G, B (linear radiance) and Z (metres from the
    /// point along the middle ray of each texel; infinite where nothing is met), 32-bit floats
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

/// Where camera planes stand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlanesArg(pub(crate) PlanePlacement);

/// Where focal planes stand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FocusArg(pub(crate) FocusRule);

/// A point in world space, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PointArg(pub(crate) [f64; 3]);

/// Two counts from 1 to `MAX`: one number for both, or two with an x between.
pub(crate) fn counts<const MAX: u32>(text: &str) -> Result<[u32; 2], String> {
    let (first, second) = text.split_once(['x', '×']).unwrap_or((text, text));
    let count = |text: &str| text.trim().parse().ok().filter(|count| (1..=MAX).contains(count));
    let both = count(first).zip(count(second)).map(|(first, second)| [first, second]);
    both.ok_or_else(|| format!("expected a number from 1 to {MAX}, or two such as 32x16"))
}

impl FromStr for PlanesArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let placement = match text {
            "faces" => PlanePlacement::CellFaces,
            "center" => PlanePlacement::CellCenter,
            metres => match numbers(metres) {
                Ok([offset]) => PlanePlacement::Offset(offset as f32),
                Err(_) => return Err("expected faces, center or a distance in metres".to_owned()),
            },
        };
        Ok(Self(placement))
    }
}

impl FromStr for FocusArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let rule = match text {
            "median" => FocusRule::Median,
            "least-squares" => FocusRule::LeastSquares,
            "minimax" => FocusRule::Minimax,
            "none" => FocusRule::Infinity,
            metres => match numbers(metres) {
                Ok([depth]) if depth > 0.0 => FocusRule::At(depth as f32),
                _ => return Err("expected median, least-squares, minimax, none or a distance in metres".to_owned()),
            },
        };
        Ok(Self(rule))
    }
}

impl FromStr for PointArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        numbers(text).map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_one_number_or_two() {
        assert_eq!(counts::<256>("32"), Ok([32; 2]));
        assert_eq!(counts::<256>("32x16"), Ok([32, 16]));
        for bad in ["", "0", "257", "1x", "x", "1x0", "1x2x3", "-1"] {
            assert!(counts::<256>(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn focal_planes_are_named_or_measured() {
        assert_eq!("minimax".parse(), Ok(FocusArg(FocusRule::Minimax)));
        assert_eq!("2.5".parse(), Ok(FocusArg(FocusRule::At(2.5))));
        for bad in ["", "0", "-1", "auto", "1,2", "nan"] {
            assert!(bad.parse::<FocusArg>().is_err(), "{bad}");
        }
    }

    #[test]
    fn planes_are_named_or_measured() {
        assert_eq!("faces".parse(), Ok(PlanesArg(PlanePlacement::CellFaces)));
        assert_eq!("-0.25".parse(), Ok(PlanesArg(PlanePlacement::Offset(-0.25))));
        for bad in ["", "face", "1,2", "nan", "inf", "1e30"] {
            assert!(bad.parse::<PlanesArg>().is_err(), "{bad}");
        }
    }
}

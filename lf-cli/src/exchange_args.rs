//! The command line of `lfslab export` and `lfslab import`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use lf_exchange::QuiltLayout;
use lf_math::Face;

use crate::args::{CellArg, EncodingArgs, FileArgs};
use crate::plan_args::PlanImportArgs;

#[derive(Debug, Args)]
pub(crate) struct ExportArgs {
    #[command(flatten)]
    pub(crate) input: FileArgs,
    /// What to write
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) to: ExportFormat,
    /// The file to write, or the folder for formats of many files; made if it is not there
    #[arg(long, value_name = "PATH")]
    pub(crate) out: PathBuf,
    /// Which slab, for `hci` and `quilt`: +x, -x, +y, -y, +z or -z; needed if there are several
    #[arg(long, value_name = "FACE", value_parser = face, allow_hyphen_values = true)]
    pub(crate) face: Option<Face>,
    /// Which row of cameras makes a quilt, counted from the highest [default: the middle one]
    #[arg(long, value_name = "N")]
    pub(crate) row: Option<u32>,
    /// Columns and rows of the quilt's tiles [default: nearest to a square]
    #[arg(long, value_name = "CxR")]
    pub(crate) quilt: Option<QuiltArg>,
    /// Nearest and farthest depth of the scene in metres, for `hci`
    #[arg(long, value_name = "NEAR,FAR", value_parser = depth_range)]
    pub(crate) depth_range: Option<[f64; 2]>,
}

/// What a light field can be written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ExportFormat {
    /// KTX 2.0, a 3D texture, packed by zstd
    Ktx2,
    /// DDS with the DX10 header, a volume texture
    Dds,
    /// DDS with the DX10 header, a 2D array
    DdsArray,
    /// A folder of PNG or OpenEXR pictures for each slab, named as in the Stanford archive: out_RR_CC_Y_X
    Grid,
    /// The same, named RR_CC
    PlainGrid,
    /// A scene of the 4D Light Field Benchmark, of one slab
    Hci,
    /// A Looking Glass quilt of one row of cameras
    Quilt,
    /// `transforms.json` of NeRF tools, with pictures
    Transforms,
}

#[derive(Debug, Args)]
pub(crate) struct ImportArgs {
    /// A folder of pictures (of `lfslab plan`, out_RR_CC_Y_X, RR_CC or a benchmark scene), or a quilt
    #[arg(value_name = "PATH")]
    pub(crate) path: PathBuf,
    /// The file to write
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// Where the cameras look: +x, -x, +y, -y, +z or -z [default: what the files say, else -z]
    #[arg(long, value_name = "FACE", value_parser = face, allow_hyphen_values = true)]
    pub(crate) face: Option<Face>,
    /// Field of view from the left edge to the right one, degrees [default: what the files say, else 60]
    #[arg(long, value_name = "DEGREES", conflicts_with = "focal_length")]
    pub(crate) fov: Option<f64>,
    /// Focal length in pixels
    #[arg(long, value_name = "PIXELS")]
    pub(crate) focal_length: Option<f64>,
    /// Width by height of a view as it is shown, if not that of its pixels
    #[arg(long, value_name = "RATIO")]
    pub(crate) aspect: Option<f64>,
    /// Distance between neighbouring cameras, metres [default: what the files say, else 0.01]
    #[arg(long, value_name = "METRES")]
    pub(crate) spacing: Option<f64>,
    /// Distance of the plane on which all pictures agree, metres, for rectified pictures; with a plan, of the slabs' focal planes
    /// from the camera planes [default: what the files say, else infinite]
    #[arg(long, value_name = "METRES")]
    pub(crate) focal_plane: Option<f64>,
    /// The camera plane's coordinate along the face's axis, world space, metres
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    pub(crate) plane: Option<f64>,
    /// The cell: centre and edge length in metres, as x,y,z,size [default: around the middle of the grid]
    #[arg(long, value_name = "X,Y,Z,SIZE", allow_hyphen_values = true)]
    pub(crate) cell: Option<CellArg>,
    /// Columns and rows of a quilt's tiles [default: what its name says]
    #[arg(long, value_name = "CxR")]
    pub(crate) quilt: Option<QuiltArg>,
    /// What names begin with, where a folder holds pictures of several kinds
    #[arg(long, value_name = "PREFIX")]
    pub(crate) series: Option<String>,
    /// Without positions in the names: row 0 is the lowest
    #[arg(long)]
    pub(crate) rows_upwards: bool,
    /// Without positions in the names: column 0 is the rightmost
    #[arg(long)]
    pub(crate) columns_leftwards: bool,
    /// The content's licence, for the metadata, as an SPDX expression
    #[arg(long, value_name = "TEXT")]
    pub(crate) license: Option<String>,
    /// Who is to be credited, for the metadata
    #[arg(long, value_name = "TEXT")]
    pub(crate) attribution: Option<String>,
    #[command(flatten)]
    pub(crate) from_plan: PlanImportArgs,
    #[command(flatten)]
    pub(crate) encoding: EncodingArgs,
    /// How much memory the pictures may take, in MiB
    #[arg(long, value_name = "MIB", default_value_t = 4096)]
    pub(crate) max_memory: u64,
}

/// Tiles of a quilt, as `8x4`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct QuiltArg(pub(crate) QuiltLayout);

impl FromStr for QuiltArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('x').and_then(|(c, r)| Some((c.parse().ok()?, r.parse().ok()?)));
        match numbers {
            Some((columns @ 1.., rows @ 1..)) => Ok(Self(QuiltLayout { columns, rows })),
            _ => Err("expected columns and rows, as in 8x4".to_owned()),
        }
    }
}

pub(crate) fn face(text: &str) -> Result<Face, String> {
    let found = Face::ALL.into_iter().find(|face| face.name().eq_ignore_ascii_case(text));
    found.ok_or_else(|| "expected +x, -x, +y, -y, +z or -z".to_owned())
}

/// The far end may be infinite.
fn depth_range(text: &str) -> Result<[f64; 2], String> {
    let numbers = text.split_once(',').and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    numbers
        .filter(|&[near, far]: &[f64; 2]| near > 0.0 && far > near)
        .ok_or_else(|| "expected two depths, as in 1,20".to_owned())
}

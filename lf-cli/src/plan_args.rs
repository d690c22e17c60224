//! The command line of `lfslab plan`, and what `lfslab import` asks about a plan's pictures.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use lf_exchange::World;
use lf_math::Face;

use crate::args::CellArg;
use crate::capture_args::PlanesArg;
use crate::exchange_args::face;

#[derive(Debug, Args)]
pub(crate) struct PlanArgs {
    /// The cell in which reflectors will move: centre and edge length, as x,y,z,size
    #[arg(long, value_name = "X,Y,Z,SIZE", allow_hyphen_values = true)]
    pub(crate) cell: CellArg,
    /// Whose coordinates the cell and the faces are in: `gltf` (right-handed; also Mitsuba's), `povray` (left-handed) or
    /// `blender` (+Z up)
    #[arg(long, value_name = "PROGRAM", default_value = "gltf", value_parser = world())]
    pub(crate) world: World,
    /// Cameras per axis of each slab
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub(crate) cameras: u32,
    /// Width and height of each picture in pixels
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) resolution: u32,
    /// Where the camera planes stand: `center`, `faces`, or a distance in metres from the cell's centre towards each face. Cameras
    /// stand up to one edge length from the centre with `center`, up to one and a half with `faces`; none should stand in an object
    #[arg(long, value_name = "PLACE", default_value = "center", allow_hyphen_values = true)]
    pub(crate) planes: PlanesArg,
    /// Only the slabs of some faces, such as +x,-z [default: all six]
    #[arg(long, value_name = "FACES", value_delimiter = ',', value_parser = face, allow_hyphen_values = true)]
    pub(crate) faces: Vec<Face>,
    /// The folder to write; made if it is not there
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

/// How the pictures of a plan become slabs.
#[derive(Debug, Args)]
pub(crate) struct PlanImportArgs {
    /// The plan of the pictures [default: `plan.json` in the folder, if it is there]
    #[arg(long, value_name = "JSON")]
    pub(crate) plan: Option<PathBuf>,
    /// Make 8-bit sRGB of the linear pictures of a plan, so that `--encoding` applies; brighter than 1 is cut off
    #[arg(long)]
    pub(crate) srgb: bool,
    /// Brighten by so many stops first
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, requires = "srgb", allow_hyphen_values = true, value_parser = exposure)]
    pub(crate) exposure: f32,
}

fn world() -> impl TypedValueParser<Value = World> {
    PossibleValuesParser::new(World::ALL.map(World::name)).map(|name| World::from_name(&name).unwrap_or_default())
}

fn exposure(text: &str) -> Result<f32, String> {
    let parsed = text.trim().parse().ok().filter(|stops| (-64.0..=64.0).contains(stops));
    parsed.ok_or_else(|| "expected a number from -64 to 64".to_owned())
}

//! The command line of `lfslab report`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;

use super::spec::Preset;
use crate::args::CellArg;
use crate::scene_args::{LightArgs, SceneArgs};

#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// What to measure (.toml, laid out like what --print writes), or a finished report (.json) to hold to --check
    #[arg(value_name = "SPEC", conflicts_with = "preset")]
    pub(crate) spec: Option<PathBuf>,
    /// A report that comes with the program [default: quick]
    #[arg(long, value_enum)]
    pub(crate) preset: Option<Preset>,
    /// Write the preset's TOML and measure nothing
    #[arg(long)]
    pub(crate) print: bool,
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "lfslab-report")]
    pub(crate) out: PathBuf,
    /// An earlier report.json: say what got worse by more than the noise, and fail if anything did
    #[arg(long, value_name = "JSON")]
    pub(crate) check: Option<PathBuf>,
    /// Other scenes than the report's: embedded ones (museum, corridor, mirror-box, forest, beside) or glTF files, each with the centre and
    /// edge length of its cell in metres if another than its own is wanted. May be given several times
    #[arg(long = "scene", value_name = "NAME|FILE[@X,Y,Z,SIZE]")]
    pub(crate) scenes: Vec<ScenePlace>,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    /// Only methods that need at most this much of the device, in MB, instead of the report's budget
    #[arg(long, value_name = "MB")]
    pub(crate) budget: Option<f64>,
    /// Another number of eyes that look at each reflector, evenly around it
    #[arg(long, value_name = "N")]
    pub(crate) eyes: Option<u32>,
    /// One other width and height of the pictures, in pixels
    #[arg(long, value_name = "PIXELS")]
    pub(crate) size: Option<u32>,
    /// Samples of each ray of the traced pictures, which the others are measured against [default: 8 times --samples, 1 where nothing
    /// is random]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) reference_samples: Option<u32>,
    /// Do not use a GPU even if there is one
    #[arg(long)]
    pub(crate) cpu: bool,
}

/// A scene, and where in it the cell is.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ScenePlace {
    scene: String,
    cell: Option<CellArg>,
}

impl ScenePlace {
    pub(crate) fn in_light(&self, light: &LightArgs) -> SceneArgs {
        SceneArgs { scene: self.scene.clone(), light: light.clone(), camera: None, cell: self.cell }
    }
}

impl FromStr for ScenePlace {
    type Err = String;

    /// File names may hold an @, too: a cell has commas.
    fn from_str(text: &str) -> Result<Self, String> {
        let (scene, cell) = match text.rsplit_once('@') {
            Some((scene, cell)) if cell.contains(',') => (scene, Some(cell.parse()?)),
            _ => (text, None),
        };
        Ok(Self { scene: scene.to_owned(), cell })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_may_follow_a_scene() {
        let place = |scene: &str, cell: Option<&str>| {
            Ok(ScenePlace { scene: scene.to_owned(), cell: cell.map(|cell| cell.parse().unwrap()) })
        };
        assert_eq!("museum".parse(), place("museum", None));
        assert_eq!("a/b@c.glb".parse(), place("a/b@c.glb", None));
        assert_eq!("a@b.glb@0,1.5,-2,0.8".parse(), place("a@b.glb", Some("0,1.5,-2,0.8")));
        for bad in ["room.glb@1,2,3", "room.glb@1,2,3,0", "room.glb@a,b,c,d"] {
            assert!(bad.parse::<ScenePlace>().is_err(), "{bad}");
        }
    }
}

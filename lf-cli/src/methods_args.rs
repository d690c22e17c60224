//! The command line of `lfslab methods`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;

use crate::args::CellArg;
use crate::scene_args::{LightArgs, SceneArgs};

#[derive(Debug, Args)]
pub(crate) struct MethodsArgs {
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "lfslab-methods")]
    pub(crate) out: PathBuf,
    /// Scenes to compare in, one after the other: embedded ones (museum, corridor, mirror-box, forest, beside) or glTF files, each with the
    /// centre and edge length of its cell in metres if another than its own is wanted
    #[arg(value_name = "NAME|FILE[@X,Y,Z,SIZE]", default_values = ["museum", "mirror-box", "corridor"])]
    pub(crate) scenes: Vec<ScenePlace>,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    /// Only methods that need at most this much of the device, in MB
    #[arg(long, value_name = "MB", default_value_t = 60.0, value_parser = budget)]
    pub(crate) budget: f64,
    /// How many eyes look at the sphere, evenly around it
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) eyes: u32,
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

fn budget(text: &str) -> Result<f64, String> {
    let parsed = text.trim().parse().ok().filter(|megabytes| (0.5..=4000.0).contains(megabytes));
    parsed.ok_or_else(|| "expected a number from 0.5 to 4000".to_owned())
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

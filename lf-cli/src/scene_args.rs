//! The part of the command line that says what is captured, and in which light.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use lf_scene::{Illumination, Quality, Scene, Tracer};

use crate::args::{CellArg, EyeArg};

/// Where the light comes from, and where it is caught.
#[derive(Debug, Args)]
pub(crate) struct SceneArgs {
    /// An embedded scene (museum, corridor, mirror-box, forest, beside) or a glTF file (.glb, .gltf)
    #[arg(long, value_name = "NAME|FILE", default_value = "museum")]
    pub(crate) scene: String,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    /// Which of the scene's cameras shows where the cell may be: its number from 0, or its name
    #[arg(long, value_name = "N|NAME")]
    pub(crate) camera: Option<String>,
    /// The cell: centre and edge length in metres, as x,y,z,size [default: the embedded scene's, or free space near the scene's
    /// camera]
    #[arg(long, value_name = "X,Y,Z,SIZE", allow_hyphen_values = true)]
    pub(crate) cell: Option<CellArg>,
}

/// Which light is traced, and light from outside the scene.
#[derive(Debug, Clone, Args)]
pub(crate) struct LightArgs {
    /// Which light is traced
    #[arg(long, value_enum, default_value_t = LightKind::Direct)]
    pub(crate) light: LightKind,
    /// Samples of each ray; the noise falls with their root, in soft light faster [default: 1, where light has an
    /// extent 8, with global light 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub(crate) samples: Option<u32>,
    /// How often light may be scattered on its way; global light only
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub(crate) bounces: u32,
    /// Another number gives another noise
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u64,
    /// A panorama around the scene (.hdr, .exr), equirectangular
    #[arg(long, value_name = "FILE")]
    pub(crate) environment: Option<PathBuf>,
    /// What the panorama's values are multiplied by
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, requires = "environment")]
    pub(crate) environment_scale: f32,
    /// Turns the panorama about the vertical: its middle moves from -Z towards +X
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, requires = "environment", allow_hyphen_values = true)]
    pub(crate) environment_turn: f32,
}

/// Which light is traced.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum LightKind {
    /// Straight from its source, and an ambient term for the rest
    Direct,
    /// All of it, by path tracing
    Global,
}

/// Samples of rays in direct light that has an extent: their error is 41 dB below white in the box of mirror spheres, that of one sample 26.
const SOFT_SAMPLES: u32 = 8;

impl LightArgs {
    /// The scene, to be traced as is asked for.
    pub(crate) fn tracer(&self, scene: Scene) -> Tracer {
        let (illumination, samples) = match self.light {
            LightKind::Direct => (Illumination::Direct, 1),
            LightKind::Global => (Illumination::Global { max_bounces: self.bounces }, 64),
        };
        let quality = Quality { illumination, samples: self.samples.unwrap_or(samples), seed: self.seed };
        let tracer = Tracer::new(scene).with_quality(quality);
        let is_soft = illumination == Illumination::Direct && tracer.is_random() && self.samples.is_none();
        if is_soft { tracer.with_quality(Quality { samples: SOFT_SAMPLES, ..quality }) } else { tracer }
    }
}

#[derive(Debug, Args)]
pub(crate) struct ViewArgs {
    /// An embedded scene (museum, corridor, mirror-box, forest, beside) or a glTF file (.glb, .gltf)
    #[arg(value_name = "NAME|FILE")]
    pub(crate) scene: String,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    /// A picture to write: .png, or .exr for the radiance itself, its standard error (`error`, an upper bound) and distance (`Z`)
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Which of the scene's cameras takes the picture: its number from 0, or its name
    #[arg(long, value_name = "N|NAME", conflicts_with_all = ["eye", "target"])]
    pub(crate) camera: Option<String>,
    /// Where the eye stands instead, world space, metres
    #[arg(long, value_name = "X,Y,Z", requires = "target", allow_hyphen_values = true)]
    pub(crate) eye: Option<EyeArg>,
    /// What the eye looks at
    #[arg(long, value_name = "X,Y,Z", requires = "eye", allow_hyphen_values = true)]
    pub(crate) target: Option<EyeArg>,
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "960x540")]
    pub(crate) size: SizeArg,
}

/// The size of a picture on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SizeArg {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl FromStr for SizeArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const MAX: u32 = 16_384;
        let number = |text: &str| text.trim().parse().ok().filter(|n| (1..=MAX).contains(n));
        let parsed = text.split_once(['x', '×']).and_then(|(w, h)| Some((number(w)?, number(h)?)));
        let (width, height) = parsed.ok_or_else(|| format!("expected two numbers from 1 to {MAX}, as 960x540"))?;
        Ok(Self { width, height })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_parsed() {
        assert_eq!("960x540".parse(), Ok(SizeArg { width: 960, height: 540 }));
        for bad in ["", "960", "0x5", "5x0", "20000x5", "-5x5", "4x4x4", "axb"] {
            assert!(bad.parse::<SizeArg>().is_err(), "{bad}");
        }
    }
}

//! The command line.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::{DVec3, Vec3};
use lf_compress::PackOptions;
use lf_compress::bc1::Quality;
use lf_compress::tile::RdoOptions;
use lf_format::{Limits, TexelEncoding};
use lf_math::PlanePlacement;

use crate::capture_args::{CaptureArgs, CubemapArgs, MergeArgs};
use crate::exchange_args::{ExportArgs, ImportArgs};
use crate::plan_args::PlanArgs;
use crate::refocus_args::{HoldoutArgs, RefocusArgs};
use crate::report::args::ReportArgs;
use crate::scene_args::{LightArgs, SceneArgs, ViewArgs};
use crate::sources::REFLECTOR_RADIUS;

/// Reflections with parallax from light field slabs: capture, compress, inspect and render them.
#[derive(Debug, Parser)]
#[command(name = "lfslab", version, propagate_version = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run everything once: scene, capture, encoding, file, pictures and a report of error against run time
    Demo(DemoArgs),
    /// Capture a scene into a .lfslab file
    Capture(CaptureArgs),
    /// Show what a scene holds, and a picture of it
    View(ViewArgs),
    /// Put the shards of a capture together
    Merge(MergeArgs),
    /// Trace cube maps of radiance and distance (OpenEXR)
    Cubemap(CubemapArgs),
    /// List the pictures that any other renderer has to render, with ready scripts; `import` makes a .lfslab file of them
    Plan(PlanArgs),
    /// Draw a mirror that reflects a .lfslab file
    Render(RenderArgs),
    /// Measure error against time and bytes: ways to reflect a scene, ours and those that people use today, on the same frames
    Report(ReportArgs),
    /// Show what a .lfslab file holds
    Info(InfoArgs),
    /// Check every byte of a .lfslab file
    Validate(ValidateArgs),
    /// Leave out what no ray through the cell asks for, without encoding anything again
    Crop(CropArgs),
    /// Find the focal planes of a light field from its images alone, and set them; the images stay as they are
    Refocus(RefocusArgs),
    /// Leave cameras out, make their pictures from the others, and measure the error
    Holdout(HoldoutArgs),
    /// Write a light field in another program's format
    Export(ExportArgs),
    /// Make a .lfslab file of pictures from a camera grid, or of those of a plan
    Import(ImportArgs),
}

#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "lfslab-demo")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// How many cameras and texels
    #[arg(long, value_enum, default_value_t = Preset::Small)]
    pub(crate) preset: Preset,
    /// An OBJ mesh to reflect in, instead of the teapot; the sphere is always drawn
    #[arg(long, value_name = "FILE")]
    pub(crate) reflector: Option<PathBuf>,
    /// Width and height of the pictures in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=4096))]
    pub(crate) size: u32,
    /// Samples of each ray of the ray-traced pictures, which the others are measured against [default: as many as by
    /// --samples, with global light four times as many]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) reference_samples: Option<u32>,
    /// Draw on the CPU even if there is a GPU
    #[arg(long)]
    pub(crate) cpu: bool,
}

/// How texels become bytes.
#[derive(Debug, Args)]
pub(crate) struct EncodingArgs {
    /// How texels are stored
    #[arg(long, value_enum, default_value_t = Encoding::Bc1)]
    pub(crate) encoding: Encoding,
    /// How hard the block encoder searches; each step is slower and better. BC1 only
    #[arg(long, default_value = "standard", value_parser = quality())]
    pub(crate) quality: Quality,
    /// Trade error for a smaller file: the squared error per block (48 values) that a bit is worth. 10 is hard to see and
    /// saves a fifth to two fifths, 100 is rough. BC1 only
    #[arg(long, value_name = "LAMBDA", default_value_t = 0.0, value_parser = lambda)]
    pub(crate) rdo: f32,
}

#[derive(Debug, Args)]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    pub(crate) input: FileArgs,
    /// The picture to write (.png)
    #[arg(long, value_name = "PNG")]
    pub(crate) out: PathBuf,
    /// What mirrors: `sphere`, `teapot` (or `sphere:N` of 20·4ᴺ, `teapot:N` of 64·N² triangles) or an OBJ file. Behind an `@` its place and radius, seen from the cell's centre, in edge
    /// lengths of the cell: x,y,z or x,y,z,radius. May be given several times
    #[arg(long, value_name = "MESH[@X,Y,Z[,R]]", default_value = "teapot")]
    pub(crate) reflector: Vec<ReflectorArg>,
    /// Shares of red, green and blue that are reflected, of linear light
    #[arg(long, value_name = "R,G,B", default_value = "1,1,1", conflicts_with = "against")]
    pub(crate) tint: TintArg,
    /// Reflect this share at perpendicular sight (glass: 0.04), more towards grazing sight, by Schlick's approximation
    #[arg(long, value_name = "F0", value_parser = share, conflicts_with = "against")]
    pub(crate) fresnel: Option<f32>,
    /// Bend the reflectors' normals by a tangent-space normal map (PNG or JPEG), laid on from all three axes
    #[arg(long, value_name = "PICTURE", conflicts_with = "against")]
    pub(crate) normal_map: Option<PathBuf>,
    /// How often the normal map fits into an edge of the cell
    #[arg(long, value_name = "N", default_value_t = 4.0, value_parser = repeats, requires = "normal_map")]
    pub(crate) normal_repeats: f32,
    /// What is behind the reflectors
    #[arg(long, value_enum, default_value_t = BackgroundArg::None, conflicts_with = "against", requires_if("scene", "scene"))]
    pub(crate) background: BackgroundArg,
    /// The scene for `--background scene`: an embedded one or a glTF file, the one that the light field was captured in
    #[arg(long, value_name = "NAME|FILE", conflicts_with = "against")]
    pub(crate) scene: Option<String>,
    /// How long edges of the scene's triangles may be, in edge lengths of the cell: the light is right at their ends. A
    /// scene is cut into two million triangles at most
    #[arg(long, value_name = "LENGTH", default_value_t = 0.1, value_parser = length, requires = "scene")]
    pub(crate) scene_edge: f32,
    /// What is painted
    #[arg(long, value_enum, default_value_t = ViewArg::Color, conflicts_with = "against")]
    pub(crate) view: ViewArg,
    /// Where the eye stands, seen from the cell's centre, in edge lengths of the cell, as x,y,z
    #[arg(long, value_name = "X,Y,Z", default_value = "1.4,0.5,0.6", allow_hyphen_values = true)]
    pub(crate) eye: EyeArg,
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=4096))]
    pub(crate) size: u32,
    /// Draw on the CPU even if there is a GPU
    #[arg(long)]
    pub(crate) cpu: bool,
    /// Trace the same mirror in this scene, an embedded one or a glTF file, put the pictures and their difference side by side,
    /// and print the error
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) against: Option<String>,
    #[command(flatten)]
    pub(crate) light: LightArgs,
}

/// What is behind the reflectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum BackgroundArg {
    /// Grey
    None,
    /// The scene, from the same slabs; they hold all of it if the eye is inside the cell
    Slabs,
    /// The triangles of `--scene`, which also hide the reflectors; from any eye. Patterns and shadows finer than `--scene-edge` blur
    Scene,
}

/// What a frame paints where it asks the slabs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ViewArg {
    /// The light
    Color,
    /// Half the light, half a colour for the slab that answers
    Slabs,
    /// The light, and magenta where a ray lies outside the slabs
    Range,
    /// The rays' indices: s in red, t in green, the mean of u and v in blue
    Stuv,
}

/// Memory that reading a file may take, MiB.
const MAX_MEMORY_MIB: u64 = 4096;

/// A file to read, and what reading it may cost.
#[derive(Debug, Args)]
pub(crate) struct FileArgs {
    /// The light field
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// How much memory reading the file may take, in MiB
    #[arg(long, value_name = "MIB", default_value_t = MAX_MEMORY_MIB)]
    pub(crate) max_memory: u64,
}

#[derive(Debug, Args)]
pub(crate) struct InfoArgs {
    #[command(flatten)]
    pub(crate) input: FileArgs,
    /// Write JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ValidateArgs {
    #[command(flatten)]
    pub(crate) input: FileArgs,
    /// How findings are written
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
}

#[derive(Debug, Args)]
pub(crate) struct CropArgs {
    #[command(flatten)]
    pub(crate) input: FileArgs,
    /// Keep only what rays from this cube ask for: its centre and edge length in metres, world space, as x,y,z,size [default: the
    /// whole cell]
    #[arg(long = "box", value_name = "X,Y,Z,SIZE", allow_hyphen_values = true)]
    pub(crate) cube: Option<CellArg>,
    /// The file to write
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
}

/// How findings are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Lines for people
    Text,
    /// JSON, as spec/validate.schema.json describes it
    Json,
}

/// Numbers of cameras and texels.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Preset {
    /// 16×16 cameras of 64×64 texels per slab
    Small,
    /// 32×32 cameras of 128×128 texels per slab, as in the paper
    Paper,
}

/// How texels are stored.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Encoding {
    /// BC1 (DXT1) blocks, 4 bits a texel
    Bc1,
    /// Plain RGBA, 32 bits a texel
    Rgba8,
}

/// A cell given on the command line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CellArg {
    pub(crate) center: DVec3,
    pub(crate) size: f32,
}

/// A point given on the command line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EyeArg(pub(crate) Vec3);

/// A reflector given on the command line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ReflectorArg {
    /// A built-in mesh or a file.
    pub(crate) mesh: String,
    /// Edge lengths of the cell.
    pub(crate) place: Vec3,
    pub(crate) radius: f32,
}

/// A tint given on the command line, each share within 0 … 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TintArg(pub(crate) Vec3);

/// What a preset stands for.
#[derive(PartialEq)]
pub(crate) struct Sampling {
    /// Per axis.
    pub(crate) cameras: [u32; 2],
    pub(crate) resolution: [u32; 2],
    pub(crate) placement: PlanePlacement,
    /// Rays per texel and axis.
    pub(crate) grid: u32,
}

impl EncodingArgs {
    /// The encoding, and the options of the block encoder.
    pub(crate) fn options(&self) -> (TexelEncoding, PackOptions) {
        let encoding = match self.encoding {
            Encoding::Bc1 => TexelEncoding::Bc1,
            Encoding::Rgba8 => TexelEncoding::Rgba8,
        };
        let rdo = RdoOptions { lambda: self.rdo, ..RdoOptions::default() };
        (encoding, PackOptions { quality: self.quality, rdo })
    }
}

impl FileArgs {
    /// A file to read with the usual limit.
    pub(crate) fn new(file: &Path) -> Self {
        Self { file: file.to_owned(), max_memory: MAX_MEMORY_MIB }
    }

    /// What reading the file may cost.
    pub(crate) fn limits(&self) -> Limits {
        Limits { memory_bytes: self.max_memory.saturating_mul(1 << 20) }
    }
}

impl Preset {
    pub(crate) fn sampling(self) -> Sampling {
        match self {
            Self::Small => {
                Sampling { cameras: [16; 2], resolution: [64; 2], placement: PlanePlacement::CellCenter, grid: 2 }
            }
            Self::Paper => {
                Sampling { cameras: [32; 2], resolution: [128; 2], placement: PlanePlacement::CellFaces, grid: 1 }
            }
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Small => "small",
            Self::Paper => "paper",
        }
    }
}

/// The encoder's qualities by name.
fn quality() -> impl TypedValueParser<Value = Quality> {
    let names = Quality::ALL.map(Quality::name);
    let find = |text: String| Quality::ALL.into_iter().find(|quality| quality.name() == text).unwrap_or_default();
    PossibleValuesParser::new(names).map(find)
}

/// A trade-off between error and bits: a number from 0 on.
fn lambda(text: &str) -> Result<f32, String> {
    let parsed = text.trim().parse().ok().filter(|lambda| (0.0..=1e6).contains(lambda));
    parsed.ok_or_else(|| "expected a number from 0 to 1e6".to_owned())
}

/// A share of light.
fn share(text: &str) -> Result<f32, String> {
    let parsed = text.trim().parse().ok().filter(|share| (0.0..=1.0).contains(share));
    parsed.ok_or_else(|| "expected a number from 0 to 1".to_owned())
}

/// A length.
fn length(text: &str) -> Result<f32, String> {
    let parsed = text.trim().parse().ok().filter(|length| (1e-6..=1e6).contains(length));
    parsed.ok_or_else(|| "expected a number from 1e-6 to 1e6".to_owned())
}

/// How often something repeats.
fn repeats(text: &str) -> Result<f32, String> {
    let parsed = text.trim().parse().ok().filter(|repeats| (1e-3..=1e3).contains(repeats));
    parsed.ok_or_else(|| "expected a number from 0.001 to 1000".to_owned())
}

/// Exactly `N` numbers set apart by commas, within ±1e12: beyond that the tracer's products leave `f32`.
pub(crate) fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let parsed: Result<Vec<f64>, _> = text.split(',').map(|n| n.trim().parse::<f64>()).collect();
    let finite = parsed.ok().filter(|all| all.iter().all(|n| n.abs() <= 1e12));
    let list = finite.and_then(|all| <[f64; N]>::try_from(all).ok());
    list.ok_or_else(|| format!("expected {N} numbers within ±1e12, set apart by commas"))
}

impl FromStr for CellArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let [x, y, z, size] = numbers(text)?;
        if size <= 0.0 {
            return Err("the size must be greater than 0".to_owned());
        }
        Ok(Self { center: DVec3::new(x, y, z), size: size as f32 })
    }
}

impl FromStr for ReflectorArg {
    type Err = String;

    /// What follows the last `@` is a place if it is three or four numbers, else part of a file's name.
    fn from_str(text: &str) -> Result<Self, String> {
        let placed = text.rsplit_once('@').and_then(|(mesh, place)| {
            let [x, y, z, radius] = numbers(place).or_else(|_| numbers(&format!("{place},{REFLECTOR_RADIUS}"))).ok()?;
            Some((mesh, Vec3::new(x as f32, y as f32, z as f32), radius as f32))
        });
        let (mesh, place, radius) = placed.unwrap_or((text, Vec3::ZERO, REFLECTOR_RADIUS));
        if radius <= 0.0 {
            return Err("the radius must be greater than 0".to_owned());
        }
        Ok(Self { mesh: mesh.to_owned(), place, radius })
    }
}

impl FromStr for TintArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let shares: [f64; 3] = numbers(text)?;
        let tint = Vec3::from(shares.map(|share| share as f32));
        if tint.cmpge(Vec3::ZERO).all() && tint.cmple(Vec3::ONE).all() {
            Ok(Self(tint))
        } else {
            Err("expected three numbers from 0 to 1".to_owned())
        }
    }
}

impl FromStr for EyeArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        numbers(text).map(|[x, y, z]: [f64; 3]| Self(DVec3::new(x, y, z).as_vec3()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn cells_and_eyes_are_parsed() {
        let cell: CellArg = "1, -2,3.5,0.25".parse().unwrap();
        assert_eq!((cell.center, cell.size), (DVec3::new(1.0, -2.0, 3.5), 0.25));
        for bad in ["", "1,2,3", "1,2,3,0", "1,2,3,nan", "1,2,3,4,5", "1,2,3,-1", "0,0,0,1e29", "inf,0,0,1"] {
            assert!(bad.parse::<CellArg>().is_err(), "{bad}");
        }
        let reflector = |mesh: &str, place, radius| Ok(ReflectorArg { mesh: mesh.to_owned(), place, radius });
        assert_eq!("a@b.obj".parse(), reflector("a@b.obj", Vec3::ZERO, REFLECTOR_RADIUS));
        assert_eq!("sphere@0,1,-2".parse(), reflector("sphere", Vec3::new(0.0, 1.0, -2.0), REFLECTOR_RADIUS));
        assert_eq!("a@b.obj@0,0,0,0.2".parse(), reflector("a@b.obj", Vec3::ZERO, 0.2));
        assert!("sphere@0,0,0,-1".parse::<ReflectorArg>().is_err());
        assert!("1,1,1.5".parse::<TintArg>().is_err() && "0,0.5,1".parse::<TintArg>().is_ok());
        assert_eq!("-1,0,2".parse::<EyeArg>(), Ok(EyeArg(Vec3::new(-1.0, 0.0, 2.0))));
    }
}

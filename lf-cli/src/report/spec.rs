//! What a report measures: scenes, reflectors, sizes of pictures and methods with their parameters, read from TOML.
//!
//! Wherever a list of parameters stands, all combinations are measured.

use std::fmt::Display;
use std::path::Path;
use std::str::FromStr;

use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use lf_capture::Options;
use lf_compress::PackOptions;
use lf_compress::bc1::Quality;
use lf_format::TexelEncoding;
use lf_math::PlanePlacement;
use lf_scene::FocusRule;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::args::ScenePlace;
use crate::args::{ReflectorArg, Sampling};
use crate::capture_args::{FocusArg, PlanesArg};

/// A report that comes with the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Preset {
    /// The museum in a sphere, small pictures and little memory: a minute
    Quick,
    /// The paper's Table 1, its comparison of methods, and reflectors of more and more triangles
    Paper,
    /// Ours beside what people use today, in three scenes
    Methods,
    /// Every parameter, one after the other, in the museum
    Full,
}

/// A whole report.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Spec {
    pub(crate) title: String,
    #[serde(deserialize_with = "parsed")]
    pub(crate) scenes: Vec<ScenePlace>,
    #[serde(deserialize_with = "named")]
    pub(crate) reflectors: Vec<(String, ReflectorArg)>,
    /// Width and height of the pictures.
    pub(crate) sizes: Vec<u32>,
    pub(crate) eyes: u32,
    /// Frames of each eye that are timed, after one that is not.
    pub(crate) repeats: usize,
    /// Methods that need more of the device are left out, MB.
    pub(crate) budget: f64,
    pub(crate) methods: Vec<Method>,
}

/// A method, or several that share their data.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub(crate) enum Method {
    Cube(CubeSpec),
    Probes(ProbesSpec),
    Guided(GuidedSpec),
    Slabs(SlabsSpec),
}

/// Everything that one cube map in the cell's middle can do.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CubeSpec {
    pub(crate) texels: Vec<u32>,
    pub(crate) answers: Vec<Answer>,
}

/// How a cube map is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Answer {
    /// By direction alone.
    Direction,
    Sphere,
    Box,
    FixedPoint,
    Steps,
}

/// Eight distance cubes.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ProbesSpec {
    pub(crate) megabytes: Vec<f64>,
    pub(crate) steps: Vec<u32>,
}

/// Guided cubes.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct GuidedSpec {
    pub(crate) megabytes: Vec<f64>,
}

/// Six slabs.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SlabsSpec {
    /// Per axis.
    pub(crate) cameras: Vec<u32>,
    pub(crate) texels: Vec<u32>,
    #[serde(deserialize_with = "named")]
    pub(crate) planes: Vec<(String, PlanesArg)>,
    #[serde(deserialize_with = "named")]
    pub(crate) focus: Vec<(String, FocusArg)>,
    pub(crate) crop: Vec<bool>,
    #[serde(deserialize_with = "named")]
    pub(crate) codec: Vec<(String, Codec)>,
    /// Per texel and axis.
    pub(crate) rays: u32,
}

/// How texels are stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Codec {
    pub(crate) encoding: TexelEncoding,
    pub(crate) quality: Quality,
}

/// One of the slabs that a [`SlabsSpec`] asks for.
#[derive(PartialEq)]
pub(crate) struct SlabsCase {
    /// For people: cameras, texels and where planes are.
    pub(crate) layout: String,
    pub(crate) codec: String,
    pub(crate) sampling: Sampling,
    pub(crate) focus: FocusRule,
    pub(crate) options: Options,
}

impl Preset {
    pub(crate) fn toml(self) -> &'static str {
        match self {
            Self::Quick => include_str!("../../presets/quick.toml"),
            Self::Paper => include_str!("../../presets/paper.toml"),
            Self::Methods => include_str!("../../presets/methods.toml"),
            Self::Full => include_str!("../../presets/full.toml"),
        }
    }
}

impl Spec {
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        Self::parse(&text).with_context(|| format!("{} is no report to measure", path.display()))
    }

    /// Refuses what cannot be measured.
    pub(crate) fn parse(text: &str) -> Result<Self> {
        let spec: Self = toml::from_str(text)?;
        spec.check()?;
        Ok(spec)
    }

    pub(crate) fn check(&self) -> Result<()> {
        let within = |name: &str, numbers: &[u32], range: std::ops::RangeInclusive<u32>| {
            if numbers.is_empty() {
                bail!("{name}: nothing to measure");
            }
            match numbers.iter().find(|number| !range.contains(number)) {
                Some(number) => bail!("{name}: {number} is not within {}…{}", range.start(), range.end()),
                None => Ok(()),
            }
        };
        within("scenes", &[self.scenes.len() as u32], 1..=100)?;
        within("reflectors", &[self.reflectors.len() as u32], 1..=100)?;
        within("methods", &[self.methods.len() as u32], 1..=1000)?;
        within("sizes", &self.sizes, 16..=4096)?;
        within("eyes", &[self.eyes], 1..=64)?;
        within("repeats", &[self.repeats.try_into().unwrap_or(u32::MAX)], 1..=1000)?;
        if !(0.5..=4000.0).contains(&self.budget) {
            bail!("budget: {} is not within 0.5…4000 MB", self.budget);
        }
        let all_differ = |name: &str, mut texts: Vec<String>| {
            texts.sort();
            match texts.windows(2).find(|pair| pair[0] == pair[1]) {
                Some(pair) => bail!("{name}: {} is there twice", pair[0]),
                None => Ok(()),
            }
        };
        all_differ("reflectors", self.reflectors.iter().map(|(name, _)| name.clone()).collect())?;
        all_differ("sizes", self.sizes.iter().map(ToString::to_string).collect())?;
        for method in &self.methods {
            match method {
                Method::Cube(CubeSpec { texels, answers }) => {
                    within("cube: texels", texels, 8..=4096)?;
                    within("cube: answers", &[answers.len() as u32], 1..=100)?;
                }
                Method::Probes(ProbesSpec { megabytes, steps }) => {
                    check_megabytes("probes", megabytes)?;
                    within("probes: steps", steps, 1..=10_000)?;
                }
                Method::Guided(GuidedSpec { megabytes }) => check_megabytes("guided", megabytes)?,
                Method::Slabs(slabs) => {
                    within("slabs: cameras", &slabs.cameras, 1..=256)?;
                    within("slabs: texels", &slabs.texels, 4..=2048)?;
                    within("slabs: rays", &[slabs.rays], 1..=16)?;
                    let lists = [slabs.planes.len(), slabs.focus.len(), slabs.crop.len(), slabs.codec.len()];
                    within("slabs: planes, focus, crop, codec", &lists.map(|len| len as u32), 1..=100)?;
                }
            }
        }
        Ok(())
    }
}

fn check_megabytes(kind: &str, sizes: &[f64]) -> Result<()> {
    match sizes.iter().find(|size| !(0.1..=4000.0).contains(*size)) {
        Some(size) => bail!("{kind}: {size} MB is not within 0.1…4000"),
        None if sizes.is_empty() => bail!("{kind}: no size is given"),
        None => Ok(()),
    }
}

impl SlabsSpec {
    /// All combinations.
    pub(crate) fn cases(&self) -> Vec<SlabsCase> {
        let mut cases = vec![];
        for &cameras in &self.cameras {
            for &texels in &self.texels {
                for (planes, placement) in &self.planes {
                    for (focus, rule) in &self.focus {
                        for &crop in &self.crop {
                            for (codec, how) in &self.codec {
                                cases.push(SlabsCase {
                                    layout: format!("6 × {cameras}² × {texels}²; planes: {planes}; focus: {focus}"),
                                    codec: codec.clone(),
                                    sampling: self.sampling(cameras, texels, placement.0),
                                    focus: rule.0,
                                    options: self.options(crop, *how),
                                });
                            }
                        }
                    }
                }
            }
        }
        cases
    }

    fn sampling(&self, cameras: u32, texels: u32, placement: PlanePlacement) -> Sampling {
        Sampling { cameras: [cameras; 2], resolution: [texels; 2], placement, grid: self.rays }
    }

    fn options(&self, crop: bool, Codec { encoding, quality }: Codec) -> Options {
        let pack = PackOptions { quality, ..PackOptions::default() };
        Options { grid: self.rays, encoding, pack, whole: !crop, depth: false }
    }
}

impl FromStr for Codec {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bc1 = |quality| Self { encoding: TexelEncoding::Bc1, quality };
        match text {
            "rgba8" => Ok(Self { encoding: TexelEncoding::Rgba8, quality: Quality::default() }),
            "bc1" => Ok(bc1(Quality::default())),
            _ => {
                let named = Quality::ALL.into_iter().find(|quality| text.strip_prefix("bc1-") == Some(quality.name()));
                let names = Quality::ALL.map(|quality| format!("bc1-{}", quality.name())).join(", ");
                named.map(bc1).ok_or_else(|| format!("{text:?} is none of rgba8, bc1, {names}"))
            }
        }
    }
}

/// A list of texts that say what they are.
fn parsed<'de, D, T>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    D: Deserializer<'de>,
    T: FromStr<Err: Display>,
{
    Ok(named(deserializer)?.into_iter().map(|(_, value)| value).collect())
}

/// The same, with the texts.
fn named<'de, D, T>(deserializer: D) -> Result<Vec<(String, T)>, D::Error>
where
    D: Deserializer<'de>,
    T: FromStr<Err: Display>,
{
    let texts = Vec::<String>::deserialize(deserializer)?;
    let parse = |text: String| match text.parse() {
        Ok(value) => Ok((text, value)),
        Err(error) => Err(D::Error::custom(format!("{text:?}: {error}"))),
    };
    texts.into_iter().map(parse).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_can_be_measured() {
        for preset in Preset::value_variants() {
            let spec = Spec::parse(preset.toml()).unwrap_or_else(|error| panic!("{preset:?}: {error:#}"));
            assert!(!spec.title.is_empty(), "{preset:?}");
        }
    }

    #[test]
    fn lists_are_multiplied() {
        let text = "kind = 'slabs'\ncameras = [8, 16]\ntexels = [32]\nplanes = ['center', 'faces']\nfocus = ['none', '2.5', 'median']\n\
                    crop = [true, false]\ncodec = ['rgba8', 'bc1-best']\nrays = 1\n";
        let Method::Slabs(slabs) = toml::from_str(text).unwrap() else { panic!("not slabs") };
        let cases = slabs.cases();
        assert_eq!(cases.len(), 2 * 2 * 3 * 2 * 2);
        assert_eq!(cases[0].layout, "6 × 8² × 32²; planes: center; focus: none");
        let last = &cases[47];
        assert_eq!((last.sampling.cameras, last.options.whole), ([16; 2], true));
        assert_eq!((last.options.encoding, last.options.pack.quality.name()), (TexelEncoding::Bc1, "best"));
    }

    #[test]
    fn mistakes_are_named() {
        let quick = Preset::Quick.toml();
        for (from, to, part) in [
            ("eyes = ", "eyes = 0 #", "eyes: 0 is not within 1…64"),
            ("sizes = ", "sizes = [] #", "sizes: nothing to measure"),
            ("sizes = ", "sizes = [64, 32, 64] #", "sizes: 64 is there twice"),
            ("scenes = ", "scenes = ['a@1,2,3'] #", "a@1,2,3"),
            ("title = ", "colour = 1\ntitle = ", "colour"),
            ("kind = \"slabs\"", "kind = \"slab\"", "slab"),
            ("codec = ", "codec = ['bc7'] #", "bc1-fast"),
            ("megabytes = ", "megabytes = [-1.0] #", "-1 MB"),
        ] {
            let text = quick.replacen(from, to, 1);
            assert_ne!(text, quick, "{from}");
            let message = format!("{:#}", Spec::parse(&text).unwrap_err());
            assert!(message.contains(part), "{to}: {message}");
        }
    }
}

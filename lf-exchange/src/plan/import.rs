//! From the pictures of a plan to slabs.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::Vec3;
use half::f16;
use lf_math::{Coverage, Image, LightFieldGeometry, Slab, SlabTexels, srgb8_from_linear};

use crate::import::decode::{self, Decode};
use crate::import::folder::scan;
use crate::plan::{Grid, Plan, basis};
use crate::{ExchangeError, PictureBasis};

/// Edge of the blocks that windows are rounded out to, texels.
const BLOCK: u32 = 4;

/// What the plan and its pictures do not say. To change one, set the field.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PlanImportOptions {
    /// Distance from the camera planes to the focal planes, metres, for all slabs; `None` is infinity. The pictures stay as
    /// they are.
    pub focal_depth: Option<f32>,
    /// Linear pictures become sRGB-encoded texels: multiplied by 2 to the power of this, and cut off at 1. `None`: they
    /// stay linear. Of no effect for pictures that are sRGB-encoded already.
    pub srgb_exposure: Option<f32>,
    /// The most memory that texels, and one picture in the making, may take. Default 4 GiB.
    pub max_bytes: u64,
}

impl Default for PlanImportOptions {
    fn default() -> Self {
        Self { focal_depth: None, srgb_exposure: None, max_bytes: 4 << 30 }
    }
}

/// The texels of all slabs of an import, in their order.
#[derive(Debug, Clone, PartialEq)]
pub enum PlanTexels {
    /// RGBA, 8 bits a channel, sRGB-encoded; alpha is 255.
    Srgb8(Vec<SlabTexels>),
    /// RGB in linear Rec. 709, 16-bit floating point, as the pictures have it.
    Linear16(Vec<SlabTexels<[f16; 3]>>),
}

/// A light field of a plan's pictures.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ImportedPlan {
    /// The cell, and those slabs that there are pictures of.
    pub geometry: LightFieldGeometry,
    /// What rays through the cell ask for of each slab's pictures.
    pub texels: PlanTexels,
    /// How many of the plan's cameras have no picture.
    pub missing: u32,
    /// What was found to be amiss; sentences for people.
    pub notes: Vec<String>,
}

/// Imports the pictures of a plan: the files of a folder whose names end in the number of a frame, such as `lfslab0001.png`, with
/// one beginning for all. PNG and JPEG become sRGB texels, OpenEXR linear ones. Other files are ignored.
///
/// A pixel is a texel, and windows of images are cut to what rays through the cell ask for. Cameras without a picture are
/// left out, and so are slabs without any.
///
/// # Errors
/// [`ExchangeError::Malformed`] if a picture has no frame's number in its name, or that of no camera, or that of another picture,
/// or not the plan's size, or if there is none; [`ExchangeError::LimitExceeded`] before anything is decoded; others as their names
/// say.
pub fn import_plan(plan: &Plan, folder: &Path, options: &PlanImportOptions) -> Result<ImportedPlan, ExchangeError> {
    let pictures = Pictures::find(plan, folder)?;
    let mut notes = Vec::new();
    if let Some(first) = pictures.by_frame.values().next().filter(|_| pictures.linear)
        && decode::has_other_primaries(first)?
    {
        notes.push("the pictures have other primaries than Rec. 709; their values are kept as they are".into());
    }
    let slabs = pictured_slabs(plan, &pictures, options, &mut notes)?;
    check_budget(plan, &slabs, pictures.linear && options.srgb_exposure.is_none(), options.max_bytes)?;
    let size = [plan.slopes().count(); 2];
    let texels = match (pictures.linear, options.srgb_exposure) {
        (true, None) => PlanTexels::Linear16(load(&slabs, &pictures, |path| <[f16; 3]>::decode(path, size))?),
        (true, Some(exposure)) => {
            PlanTexels::Srgb8(load(&slabs, &pictures, |path| Ok(toned(&<[f16; 3]>::decode(path, size)?, exposure)))?)
        }
        (false, _) => PlanTexels::Srgb8(load(&slabs, &pictures, |path| <[u8; 4]>::decode(path, size))?),
    };
    let missing = plan.camera_count() - pictures.by_frame.len() as u32;
    let geometry = LightFieldGeometry::new(*plan.geometry().cell(), slabs.iter().map(|slab| slab.slab).collect())?;
    Ok(ImportedPlan { geometry, texels, missing, notes })
}

/// The picture files of a plan.
struct Pictures {
    by_frame: BTreeMap<u32, PathBuf>,
    linear: bool,
}

impl Pictures {
    fn find(plan: &Plan, folder: &Path) -> Result<Self, ExchangeError> {
        let expected =
            format!("expected {} to {}", plan.picture_name(1, "png"), plan.picture_name(plan.camera_count(), "png"));
        let names = scan(folder)?;
        let mut by_frame = BTreeMap::new();
        let first = names.first().ok_or_else(|| {
            ExchangeError::malformed(folder, format!("it holds no picture; {expected}, or the same as .exr"))
        })?;
        let (prefix, linear) = (frame_of(&first.0).0, decode::is_exr(&first.1));
        for (stem, path) in &names {
            let refuse =
                |what: &str| Err(ExchangeError::malformed(path, format!("{what}; {expected}, or the same as .exr")));
            let (before, frame) = frame_of(stem);
            let Some(frame) = frame else { return refuse("its name does not end in the number of a frame") };
            if before != prefix {
                return refuse(&format!("its name does not begin as that of {}", first.1.display()));
            }
            if !(1..=plan.camera_count()).contains(&frame) {
                return refuse(&format!("the plan has no frame {frame}"));
            }
            if decode::is_exr(path) != linear {
                return refuse(&format!("it is not of the kind of {}", first.1.display()));
            }
            if let Some(other) = by_frame.insert(frame, path.clone()) {
                return refuse(&format!("{} is of the same frame", other.display()));
            }
        }
        Ok(Self { by_frame, linear })
    }
}

/// What comes before the number at a name's end, and the number.
fn frame_of(stem: &str) -> (&str, Option<u32>) {
    let before = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    (before, stem[before.len()..].parse().ok())
}

/// A slab of which there are pictures.
struct PicturedSlab<'a> {
    slab: Slab,
    basis: PictureBasis,
    grid: &'a Grid,
    coverage: Coverage,
}

/// The slabs that there are pictures of, with what is kept of each.
fn pictured_slabs<'a>(
    plan: &'a Plan,
    pictures: &Pictures,
    options: &PlanImportOptions,
    notes: &mut Vec<String>,
) -> Result<Vec<PicturedSlab<'a>>, ExchangeError> {
    let mut slabs = Vec::new();
    for (slab, grid) in plan.geometry().slabs().iter().zip(&plan.grids) {
        let slab = slab.with_focal_depth(options.focal_depth)?;
        let columns = slab.cameras()[0] as usize;
        let mut kept = vec![false; columns * slab.cameras()[1] as usize];
        for (frame, [s, t]) in grid.frames() {
            if let Some(kept) = kept.get_mut(t as usize * columns + s as usize) {
                *kept = pictures.by_frame.contains_key(&frame);
            }
        }
        let coverage = Coverage::of_cell(&slab, plan.geometry().cell()).aligned(BLOCK).with_cameras(kept)?;
        if coverage.keeps_any() {
            slabs.push(PicturedSlab { slab, basis: basis(&slab), grid, coverage });
        } else {
            notes.push(format!("slab {} has no picture and is left out", slab.face().name()));
        }
    }
    Ok(slabs)
}

/// Holds the memory for all texels, and for the picture that is being decoded, to the limit.
fn check_budget(plan: &Plan, slabs: &[PicturedSlab<'_>], linear: bool, limit: u64) -> Result<(), ExchangeError> {
    let texel = if linear { size_of::<[f16; 3]>() } else { size_of::<[u8; 4]>() } as u64;
    let texels = slabs.iter().map(|slab| slab.coverage.texels()).fold(0, u64::saturating_add);
    // 16-bit RGBA or 32-bit RGB, and what it is converted to.
    let picture = u64::from(plan.slopes().count()).pow(2).saturating_mul(16 + texel);
    let bytes = texels.saturating_mul(texel).saturating_add(picture);
    if bytes <= limit {
        return Ok(());
    }
    Err(ExchangeError::LimitExceeded { what: format!("{} pictures", plan.camera_count()), bytes, limit })
}

fn load<T: Copy>(
    slabs: &[PicturedSlab<'_>],
    pictures: &Pictures,
    decode: impl Fn(&Path) -> Result<Image<T>, ExchangeError>,
) -> Result<Vec<SlabTexels<T>>, ExchangeError> {
    slabs.iter().map(|slab| slab.load(pictures, &decode)).collect()
}

impl PicturedSlab<'_> {
    fn load<T: Copy>(
        &self,
        pictures: &Pictures,
        decode: impl Fn(&Path) -> Result<Image<T>, ExchangeError>,
    ) -> Result<SlabTexels<T>, ExchangeError> {
        let frames: BTreeMap<[u32; 2], u32> = self.grid.frames().map(|(frame, camera)| (camera, frame)).collect();
        // The caller's limit has let this pass.
        let mut texels = Vec::with_capacity(usize::try_from(self.coverage.texels()).unwrap_or(0));
        for (camera, window) in self.coverage.stored() {
            let path = frames.get(&camera).and_then(|frame| pictures.by_frame.get(frame));
            let path = path.ok_or_else(|| ExchangeError::argument(format!("camera {camera:?} has no picture")))?;
            self.append(&decode(path)?, window, &mut texels);
        }
        Ok(SlabTexels::covering(self.coverage.clone(), texels)?)
    }

    /// The part of a picture in a window, in the slab's order.
    fn append<T: Copy>(&self, picture: &Image<T>, [u, v]: [Range<u32>; 2], texels: &mut Vec<T>) {
        let samples = v.flat_map(|v| u.clone().map(move |u| [u, v]));
        texels.extend(samples.map(|sample| {
            let [x, y] = self.basis.pixel(sample, self.slab.resolution());
            picture.get(x, y)
        }));
    }
}

fn toned(picture: &Image<[f16; 3]>, exposure: f32) -> Image<[u8; 4]> {
    let gain = exposure.exp2();
    picture.map(|color| {
        let [r, g, b] = srgb8_from_linear(Vec3::from(color.map(f16::to_f32)) * gain);
        [r, g, b, 255]
    })
}

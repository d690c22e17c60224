//! What a scene and a frame do not need, and what leaving it out saves: measured with and without.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use anyhow::Result;
use glam::Vec3;
use lf_capture::Options;
use lf_compress::PackedLightField;
use lf_format::TexelEncoding;
use lf_gpu::{Behind, Frame, Gpu, MirrorMesh, ReflectionPass, Reflector, SlabRenderer, SlabTexture, Target};
use lf_ibr::{BlockField, Environment};
use lf_math::{Image, LightFieldGeometry, Placement, Ray, Reflectance, View};
use lf_report::{Table, Timing};

use super::contenders::{Drawn, captured, stored};
use super::shots::Shot;
use super::spec::{Method, SlabsCase};
use crate::device::Method as Draws;
use crate::frames::{merged, timed};
use crate::sources::Source;

/// Whole slabs of more bytes than this are not captured only to be cropped.
const MOST: u64 = 100_000_000;

/// What draws, for how many bytes, how long, and what came out.
#[derive(Clone)]
struct Case {
    bytes: u64,
    timing: Timing,
    pictures: Vec<Image<[u8; 4]>>,
}

/// Of the first slabs that are asked for, in the first frames; none without slabs, or where they are too large.
pub(crate) fn table(
    source: &Source,
    shot: &Shot,
    methods: &[Method],
    gpu: Option<&Gpu>,
    repeats: usize,
    folder: &Path,
) -> Result<Option<Table>> {
    let cases = methods.iter().find_map(|method| match method {
        Method::Slabs(slabs) => slabs.cases().into_iter().next(),
        _ => None,
    });
    let Some(case) = cases.filter(|case| whole_bytes(source, case).is_ok_and(|bytes| bytes <= MOST)) else {
        return Ok(None);
    };
    eprintln!("left out {}", case.layout);
    let options = Options { whole: true, encoding: TexelEncoding::Bc1, ..case.options };
    let (_, whole) = captured(source, &case, options, folder)?;
    let cropped = whole.cropped()?;
    let (least, most) = shot.mesh.bounds();
    let tight = whole.cropped_to([least, most])?;
    let in_whole = measured(&whole, shot, gpu, repeats)?;
    // Where nothing was left out, there is nothing to measure again.
    let after = |before: &PackedLightField, with: &Case, field: &PackedLightField| {
        if stored(field) == stored(before) { Ok(with.clone()) } else { measured(field, shot, gpu, repeats) }
    };
    let in_cropped = after(&whole, &in_whole, &cropped)?;
    let in_tight = after(&cropped, &in_cropped, &tight)?;
    let mut rows = vec![
        row("texels that no ray through the cell asks for", &in_whole, &in_cropped),
        row("of the rest, texels that no ray from the reflector's box asks for", &in_cropped, &in_tight),
        unasked(&tight, shot, repeats)?,
        empty_slots(&whole),
        mip_levels(&in_cropped),
    ];
    if let Some(gpu) = gpu {
        rows.push(shader(&cropped, shot, gpu, repeats)?);
    }
    let columns = ["what", "bytes with", "bytes without", "ms with", "ms without", "largest difference, of 255"];
    Ok(Some(Table {
        title: format!("Left out in {}", source.name()),
        caption: format!(
            "Slabs ({}) with and without what {} does not need; medians of milliseconds a frame. A dash: nothing to draw, as no ray could \
             reach it.",
            case.layout, shot.frames.reflector
        ),
        columns: columns.map(str::to_owned).to_vec(),
        rows,
    }))
}

fn whole_bytes(source: &Source, case: &SlabsCase) -> Result<u64> {
    let sampling = &case.sampling;
    let geometry =
        LightFieldGeometry::around_with(source.cell, sampling.placement, sampling.cameras, sampling.resolution)?;
    let count =
        |slab: &lf_math::Slab| slab.cameras().iter().chain(&slab.resolution()).map(|&n| u64::from(n)).product::<u64>();
    Ok(geometry.slabs().iter().map(count).sum::<u64>() / 2)
}

/// Draws the frames from a light field, on the GPU if there is one.
fn measured(field: &PackedLightField, shot: &Shot, gpu: Option<&Gpu>, repeats: usize) -> Result<Case> {
    let (bytes, frames) = match gpu {
        Some(gpu) => {
            let texture = SlabTexture::new(gpu, field)?;
            let pass = ReflectionPass::slabs(gpu, &texture)?;
            (texture.bytes(), shot.draw(&Drawn::OnGpu(gpu, &pass), repeats)?)
        }
        None => (stored(field), shot.draw(&Drawn::OnCpu(&BlockField::new(field)?), repeats)?),
    };
    let (timings, pictures): (Vec<_>, Vec<_>) = frames.into_iter().unzip();
    Ok(Case { bytes, timing: merged(&timings)?, pictures })
}

fn row(what: &str, with: &Case, without: &Case) -> Vec<String> {
    let ms = |case: &Case| format!("{:.1}", 1e3 * case.timing.median());
    [
        what.to_owned(),
        with.bytes.to_string(),
        without.bytes.to_string(),
        ms(with),
        ms(without),
        largest(&with.pictures, &without.pictures).to_string(),
    ]
    .to_vec()
}

fn largest(a: &[Image<[u8; 4]>], b: &[Image<[u8; 4]>]) -> u8 {
    let texels =
        |pictures: &[Image<[u8; 4]>]| pictures.iter().flat_map(|p| p.texels().to_vec()).flatten().collect::<Vec<u8>>();
    texels(a).into_iter().zip(texels(b)).map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0)
}

fn arithmetic(what: String, with: u64, without: u64) -> Vec<String> {
    let dash = || "–".to_owned();
    [what, with.to_string(), without.to_string(), dash(), dash(), "0".to_owned()].to_vec()
}

/// Counts which slab each ray asks.
struct Counting<'a> {
    geometry: &'a LightFieldGeometry,
    asked: Vec<AtomicU64>,
}

impl Environment for Counting<'_> {
    fn look_up(&self, ray: &Ray) -> Option<Vec3> {
        let slab = self.geometry.index_ray(ray)?.slab;
        self.asked[slab].fetch_add(1, Ordering::Relaxed);
        Some(Vec3::ONE)
    }
}

/// Slabs that no ray of these frames asks.
fn unasked(field: &PackedLightField, shot: &Shot, repeats: usize) -> Result<Vec<String>> {
    let geometry = field.geometry();
    let asked = geometry.slabs().iter().map(|_| AtomicU64::new(0)).collect();
    let counting = Counting { geometry, asked };
    shot.draw(&Drawn::OnCpu(&counting), repeats.min(1))?;
    let bytes = |slab: usize| field.tiles(slab).iter().map(|tile| tile.len() as u64).sum::<u64>();
    let idle: Vec<usize> =
        (0..geometry.slabs().len()).filter(|&i| counting.asked[i].load(Ordering::Relaxed) == 0).collect();
    let names: Vec<String> = idle.iter().map(|&i| geometry.slabs()[i].face().name().to_owned()).collect();
    let what = format!(
        "slabs that no ray of these frames asks: {}",
        if names.is_empty() { "none".to_owned() } else { names.join(", ") }
    );
    let (all, unused) = (stored(field), idle.into_iter().map(bytes).sum::<u64>());
    Ok(arithmetic(what, all, all - unused))
}

/// What rounds whole slabs up to a volume of powers of two, as in the paper: two slots of eight. An array texture has none.
fn empty_slots(whole: &PackedLightField) -> Vec<String> {
    let [width, height, depth] = whole.layout().size().map(u64::from);
    let slice = width * height / 2;
    let what = "empty slots of the power-of-two volume, which an array texture has not".to_owned();
    arithmetic(what, slice * depth, slice * u64::from(whole.layout().slices()))
}

/// Smaller copies of the images, a quarter and a sixteenth and so on, which no fetch asks for.
fn mip_levels(case: &Case) -> Vec<String> {
    arithmetic("mip levels".to_owned(), case.bytes + case.bytes / 3, case.bytes)
}

/// A shader with a tint of one and Fresnel's effect of none, beside one that has neither.
fn shader(field: &PackedLightField, shot: &Shot, gpu: &Gpu, repeats: usize) -> Result<Vec<String>> {
    let texture = SlabTexture::new(gpu, field)?;
    let mesh = MirrorMesh::new(gpu, &shot.mesh)?;
    let target = Target::new(gpu, shot.frames.size[0], shot.frames.size[1])?;
    let mut renderer = SlabRenderer::new(gpu, &texture)?;
    let mut case = |reflectance| -> Result<Case> {
        let reflectors = [Reflector { mesh: &mesh, placement: Placement::IDENTITY, reflectance, normal_map: None }];
        let mut frames = vec![];
        for camera in shot.cameras() {
            let frame = Frame { camera, reflectors: &reflectors, behind: Behind::Nothing, view: View::Color };
            frames.push(timed(Rendered { gpu, renderer: &mut renderer, target: &target, frame }, repeats)?);
        }
        let (timings, pictures): (Vec<_>, Vec<_>) = frames.into_iter().unzip();
        Ok(Case { bytes: texture.bytes(), timing: merged(&timings)?, pictures })
    };
    let (with, without) = (case(Reflectance::new(Vec3::ONE, Some(1.0))?)?, case(Reflectance::MIRROR)?);
    Ok(row("the shader's tint and Fresnel effect, for a perfect mirror", &with, &without))
}

/// A frame by the renderer of whole frames.
struct Rendered<'r, 'g> {
    gpu: &'g Gpu,
    renderer: &'r mut SlabRenderer<'g>,
    target: &'r Target,
    frame: Frame<'r>,
}

impl Draws for Rendered<'_, '_> {
    fn draw(&mut self) -> Result<()> {
        self.renderer.draw(self.target, &self.frame)?;
        Ok(self.gpu.wait()?)
    }

    fn picture(&mut self) -> Result<Image<[u8; 4]>> {
        Ok(self.target.read(self.gpu)?)
    }
}

//! The demo's frames: every method on the same eyes, timed and compared with the traced reference.

use std::f32::consts::TAU;

use anyhow::{Context, Result};
use glam::Vec3;
use lf_gpu::MirrorMesh;
use lf_math::{GeometryError, Image, Pinhole, TriangleMesh};
use lf_report::{EyeError, Timing, measure};
use lf_scene::reference::{self, Mirror, Reference};
use rayon::prelude::*;

use crate::device::{CpuMethod, CpuSide, GpuMethod, GpuSide, Method};
use crate::pictures::{display, masked, over};
use crate::sources::{EYE_DISTANCE, Source};

/// Vertical field of view, radians: a reflector that fills the cell fills nine tenths of the picture.
pub(crate) const FOV_Y: f32 = 0.67;
/// Frames that are counted of each eye, after one that is not; of the slower reference fewer.
const REPEATS: usize = 5;
const REFERENCE_REPEATS: usize = 2;
/// If the first frame takes longer than so many seconds, it is the only one.
const SLOW: f64 = 1.0;
/// How far above the cell's centre the eyes look down from, radians.
const ELEVATION: f32 = 0.26;

/// The environments and what they hang in.
pub(crate) struct Stage<'a> {
    pub(crate) source: &'a Source,
    pub(crate) cpu: &'a CpuSide,
    pub(crate) gpu: Option<&'a GpuSide>,
}

/// Which environment a method asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Asked {
    Slabs,
    Cube,
}

/// One method on one device over all eyes.
pub(crate) struct MethodFrames {
    pub(crate) asked: Asked,
    pub(crate) on_gpu: bool,
    pub(crate) timing: Timing,
    pub(crate) errors: Vec<EyeError>,
    /// Composed over the background, one for each eye.
    pub(crate) pictures: Vec<Image<[u8; 4]>>,
}

/// All frames of one reflector.
pub(crate) struct ReflectorFrames {
    pub(crate) references: Vec<Reference>,
    pub(crate) reference_timing: Timing,
    /// The references composed over the background.
    pub(crate) truth: Vec<Image<[u8; 4]>>,
    pub(crate) methods: Vec<MethodFrames>,
}

/// `count` cameras around the cell's centre, `step` radians apart, the first at azimuth `from`; `edge` is the cell's.
pub(crate) fn orbit(edge: f32, size: u32, from: f32, step: f32, count: u32) -> Result<Vec<Pinhole>, GeometryError> {
    let eye = |i: u32| {
        let azimuth = from + step * i as f32;
        let (sin, cos) = ELEVATION.sin_cos();
        Vec3::new(cos * azimuth.cos(), sin, cos * azimuth.sin()) * EYE_DISTANCE * edge
    };
    (0..count).map(|i| Pinhole::look_at(eye(i), Vec3::ZERO, FOV_Y, size, size)).collect()
}

/// `count` cameras evenly on a full circle.
pub(crate) fn full_orbit(edge: f32, size: u32, count: u32) -> Result<Vec<Pinhole>, GeometryError> {
    orbit(edge, size, 0.0, TAU / count as f32, count)
}

impl Stage<'_> {
    /// The scene without a reflector, as each camera sees it.
    pub(crate) fn backgrounds(&self, cameras: &[Pinhole]) -> Vec<Image<[u8; 4]>> {
        let trace = |camera| display(&reference::background(&self.source.tracer, &self.source.cell, camera));
        cameras.iter().map(trace).collect()
    }

    /// Draws, times and compares every method; `done` is called after each picture.
    pub(crate) fn frames(
        &self,
        mesh: &TriangleMesh,
        cameras: &[Pinhole],
        backgrounds: &[Image<[u8; 4]>],
        done: impl Fn(),
    ) -> Result<ReflectorFrames> {
        let mirror = Mirror::new(mesh.clone());
        let mut references = Vec::new();
        let timings = cameras.iter().map(|camera| {
            let mut frame = None;
            let mut render =
                || frame = Some(reference::render(&self.source.tracer, &self.source.cell, &mirror, camera));
            let timing = paced(REFERENCE_REPEATS, &mut render);
            references.extend(frame);
            done();
            timing
        });
        let reference_timing = merged(&timings.collect::<Vec<_>>())?;
        let composed = references.iter().zip(backgrounds);
        let truth: Vec<_> = composed.map(|(r, back)| masked(&display(&r.radiance), &r.mask, back)).collect();
        let mut methods = Vec::new();
        let devices: &[bool] = if self.gpu.is_some() { &[true, false] } else { &[false] };
        for (&on_gpu, asked) in devices.iter().flat_map(|gpu| [(gpu, Asked::Slabs), (gpu, Asked::Cube)]) {
            let mut frames = self.method(asked, on_gpu, mesh, cameras, backgrounds, &done)?;
            frames.errors = compared(&references, &truth, &frames.pictures)?;
            methods.push(frames);
        }
        Ok(ReflectorFrames { references, reference_timing, truth, methods })
    }

    fn method(
        &self,
        asked: Asked,
        on_gpu: bool,
        mesh: &TriangleMesh,
        cameras: &[Pinhole],
        backgrounds: &[Image<[u8; 4]>],
        done: &impl Fn(),
    ) -> Result<MethodFrames> {
        let side = self.gpu.filter(|_| on_gpu);
        let device_mesh = side.map(|side| MirrorMesh::new(&side.gpu, mesh)).transpose()?;
        let (mut timings, mut pictures) = (Vec::new(), Vec::new());
        for (camera, background) in cameras.iter().zip(backgrounds) {
            let (timing, picture) = match (side, &device_mesh, asked) {
                (Some(side), Some(mesh), _) => {
                    let pass = if asked == Asked::Slabs { &side.slabs } else { &side.cube };
                    timed(GpuMethod { gpu: &side.gpu, pass, target: &side.target, mesh, camera }, REPEATS)?
                }
                (_, _, Asked::Slabs) => timed(CpuMethod::new(&self.cpu.slabs, mesh, camera), REPEATS)?,
                (_, _, Asked::Cube) => timed(CpuMethod::new(&self.cpu.cube, mesh, camera), REPEATS)?,
            };
            timings.push(timing);
            pictures.push(over(&picture, background));
            done();
        }
        Ok(MethodFrames { asked, on_gpu, timing: merged(&timings)?, errors: vec![], pictures })
    }
}

/// The error of each eye's picture over the reflector's pixels; of several eyes at once, as what is seen takes longer to find out than a frame.
pub(crate) fn compared(
    references: &[Reference],
    truth: &[Image<[u8; 4]>],
    pictures: &[Image<[u8; 4]>],
) -> Result<Vec<EyeError>> {
    let eyes = (references, truth, pictures).into_par_iter().enumerate();
    let errors = eyes.map(|(eye, (reference, truth, picture))| {
        EyeError::compare(eye, truth, picture, &reference.mask).context("the reflector is out of sight")
    });
    errors.collect()
}

/// Times a frame several times. The first does not count, unless it takes so long that a cold start does not disturb it: then it is the
/// only one.
fn paced(repeats: usize, mut draw: impl FnMut()) -> Timing {
    let first = measure(0, 1, &mut draw);
    if first.median() > SLOW { first } else { measure(0, repeats, draw) }
}

/// Draws a frame several times; the timing and the picture.
pub(crate) fn timed(mut method: impl Method, repeats: usize) -> Result<(Timing, Image<[u8; 4]>)> {
    let mut outcome = Ok(());
    let timing = paced(repeats, || {
        if let Err(error) = method.draw() {
            outcome = Err(error);
        }
    });
    outcome?;
    Ok((timing, method.picture()?))
}

/// The frames of several timings as one.
pub(crate) fn merged(timings: &[Timing]) -> Result<Timing> {
    let samples = timings.iter().flat_map(|timing| timing.samples().to_vec()).collect();
    Timing::from_seconds(samples).context("no frames were timed")
}

/// The share of the reflector's pixels at which two sets of pictures agree within 2/255 in every channel, and the largest
/// difference.
pub(crate) fn agreement(references: &[Reference], a: &[Image<[u8; 4]>], b: &[Image<[u8; 4]>]) -> (f64, u8) {
    let (mut all, mut close, mut largest) = (0u64, 0u64, 0);
    for (reference, (a, b)) in references.iter().zip(a.iter().zip(b)) {
        let pixels = reference.mask.texels().iter().zip(a.texels().iter().zip(b.texels()));
        for (_, (a, b)) in pixels.filter(|(inside, _)| **inside) {
            let difference = (0..3).map(|c| a[c].abs_diff(b[c])).max().unwrap_or(0);
            all += 1;
            close += u64::from(difference <= 2);
            largest = largest.max(difference);
        }
    }
    (close as f64 / all.max(1) as f64, largest)
}

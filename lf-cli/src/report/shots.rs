//! The frames that all methods draw: each reflector in each size, as ray tracing draws it.

use anyhow::{Context, Result};
use lf_gpu::{MirrorMesh, Target};
use lf_math::{Image, Pinhole, TriangleMesh};
use lf_report::{Frames, MethodResult, Timing, measure};
use lf_scene::Quality;
use lf_scene::reference::{self, Mirror, Reference};

use super::args::ReportArgs;
use super::contenders::{Contender, Drawn};
use super::spec::Spec;
use crate::device::{CpuMethod, GpuMethod};
use crate::frames::{compared, full_orbit, merged, timed};
use crate::output::progress_bar;
use crate::pictures::{display, noise};
use crate::sources::{Source, placed};

/// Times as many samples as texels have, where there is noise.
const REFERENCE_SAMPLES: u32 = 8;

/// What came of one method.
pub(crate) struct Measured {
    pub(crate) result: MethodResult,
    /// The first eye's.
    pub(crate) picture: Image<[u8; 4]>,
}

/// One reflector in one size, from all eyes.
pub(crate) struct Shot {
    pub(crate) frames: Frames,
    pub(crate) mesh: TriangleMesh,
    cameras: Vec<Pinhole>,
    pub(crate) references: Vec<Reference>,
    pub(crate) truth: Vec<Image<[u8; 4]>>,
    /// Of each traced ray.
    pub(crate) samples: u32,
    timing: Timing,
}

/// Traces all reflectors in all sizes.
pub(crate) fn shots(args: &ReportArgs, spec: &Spec, source: &mut Source) -> Result<Vec<Shot>> {
    let quality = *source.tracer.quality();
    let times = if source.tracer.is_random() { REFERENCE_SAMPLES } else { 1 };
    let samples = args.reference_samples.unwrap_or(times.saturating_mul(quality.samples));
    source.tracer.set_quality(Quality { samples, ..quality });
    let mut shots = vec![];
    for (name, reflector) in &spec.reflectors {
        let (mesh, placement) = placed(reflector, &source.cell)?;
        let mesh = mesh.placed(&placement)?;
        for &size in &spec.sizes {
            let frames = Frames { scene: source.name().to_owned(), reflector: name.clone(), size: [size; 2] };
            shots.push(Shot::trace(source, frames, mesh.clone(), spec.eyes)?);
        }
    }
    source.tracer.set_quality(quality);
    Ok(shots)
}

impl Shot {
    fn trace(source: &Source, frames: Frames, mesh: TriangleMesh, eyes: u32) -> Result<Self> {
        let cameras = full_orbit(2.0 * source.cell.half_extent().min_element(), frames.size[0], eyes)?;
        let mirror = Mirror::new(mesh.clone());
        let bar = progress_bar(cameras.len() as u64, "trace", "pictures");
        let (mut references, mut timings) = (vec![], vec![]);
        for camera in &cameras {
            let render = || references.push(reference::render(&source.tracer, &source.cell, &mirror, camera));
            timings.push(measure(0, 1, render));
            bar.inc(1);
        }
        bar.finish_and_clear();
        let truth = references.iter().map(|reference| display(&reference.radiance)).collect();
        let samples = source.tracer.quality().samples;
        Ok(Self { frames, mesh, cameras, references, truth, samples, timing: merged(&timings)? })
    }

    /// Draws, times and compares one method.
    pub(crate) fn measured(&self, contender: &Contender<'_>, repeats: usize) -> Result<Measured> {
        let (timings, pictures): (Vec<_>, Vec<_>) = self.draw(&contender.drawn, repeats)?.into_iter().unzip();
        let result = MethodResult {
            frames: self.frames.clone(),
            method: contender.name.to_owned(),
            parameters: contender.parameters.clone(),
            device: match contender.drawn {
                Drawn::OnCpu(_) => "CPU".to_owned(),
                Drawn::OnGpu(gpu, _) => gpu.name(),
            },
            eyes: compared(&self.references, &self.truth, &pictures).with_context(|| self.frames.reflector.clone())?,
            timing: merged(&timings)?,
            bytes_on_device: contender.bytes,
            bytes_on_disk: contender.on_disk,
            preparation_s: contender.preparation_s,
            rays: Some(contender.rays),
        };
        let picture = pictures.into_iter().next().context("there are no eyes")?;
        Ok(Measured { result, picture })
    }

    /// Every eye's time and picture.
    pub(crate) fn draw(&self, drawn: &Drawn<'_>, repeats: usize) -> Result<Vec<(Timing, Image<[u8; 4]>)>> {
        let (mesh, cameras) = (&self.mesh, self.cameras.iter());
        match *drawn {
            Drawn::OnCpu(environment) => {
                cameras.map(|camera| timed(CpuMethod::new(environment, mesh, camera), repeats)).collect()
            }
            Drawn::OnGpu(gpu, pass) => {
                let mesh = MirrorMesh::new(gpu, mesh)?;
                let target = Target::new(gpu, self.frames.size[0], self.frames.size[1])?;
                let method = |camera| GpuMethod { gpu, pass, target: &target, mesh: &mesh, camera };
                cameras.map(|camera| timed(method(camera), repeats)).collect()
            }
        }
    }

    /// The eyes.
    pub(crate) fn cameras(&self) -> &[Pinhole] {
        &self.cameras
    }

    /// The reference as a result.
    pub(crate) fn traced(&self, source: &Source) -> MethodResult {
        MethodResult {
            frames: self.frames.clone(),
            method: "ray tracing".to_owned(),
            parameters: format!("reference; samples of each ray: {}; scene and hierarchy", self.samples),
            device: "CPU".to_owned(),
            eyes: vec![],
            timing: self.timing.clone(),
            bytes_on_device: source.tracer.memory_bytes() as u64,
            bytes_on_disk: None,
            preparation_s: source.build_time.as_secs_f64(),
            rays: None,
        }
    }

    /// How well the traced pictures are known, if they are noisy: the upper bound of their standard error as a share of the radiance.
    pub(crate) fn noise(&self) -> Option<f64> {
        let pairs = self.references.iter().flat_map(|r| r.radiance.texels().iter().zip(r.standard_error.texels()));
        noise(pairs).filter(|share| *share > 0.0)
    }
}

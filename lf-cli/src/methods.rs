//! `lfslab methods`: what people use today and our own methods, side by side on the same frames.

use std::time::Instant;

use anyhow::{Context, Result};
use lf_gpu::{Gpu, MirrorMesh, Target};
use lf_math::{Image, Pinhole, TriangleMesh};
use lf_report::{Machine, MethodResult, Report, Timing, measure};
use lf_scene::Quality;
use lf_scene::reference::{self, Mirror, Reference};

use crate::contenders::{Budget, Contender, Drawn, contenders};
use crate::demo::command_line;
use crate::device::{CpuMethod, GpuMethod, open_gpu};
use crate::frames::{compared, full_orbit, merged, timed};
use crate::methods_args::{MethodsArgs, ScenePlace};
use crate::methods_table::table;
use crate::output::{jpeg, print, progress_bar, write};
use crate::pictures::{Tile, difference, display, masked, mosaic, noise, over, shrunk};
use crate::sources::{Source, builtin};

/// Frames of each eye that are timed, after one that is not.
const REPEATS: usize = 2;
/// Times as many samples as texels have, where there is noise.
const REFERENCE_SAMPLES: u32 = 16;
/// Pixels of a method's picture on the sheet, at most, and methods beside each other on it: both fit a page of documentation.
const TILE: u32 = 256;
const COLUMNS: usize = 4;

/// What came of one method.
struct Measured {
    result: MethodResult,
    /// The first eye's.
    picture: Image<[u8; 4]>,
}

/// What all methods are measured on.
struct Frames {
    mesh: TriangleMesh,
    cameras: Vec<Pinhole>,
    references: Vec<Reference>,
    truth: Vec<Image<[u8; 4]>>,
    /// Of each traced ray.
    samples: u32,
    timing: Timing,
}

pub(crate) fn run(args: &MethodsArgs) -> Result<()> {
    std::fs::create_dir_all(&args.out).with_context(|| format!("cannot make the folder {}", args.out.display()))?;
    let mut text = String::new();
    for scene in &args.scenes {
        text += &compare(args, scene)?;
    }
    write(&args.out.join("methods.md"), text.as_bytes())?;
    print(&text)
}

/// All methods in one scene: pictures, plots and report to the folder, the table as Markdown.
fn compare(args: &MethodsArgs, scene: &ScenePlace) -> Result<String> {
    let start = Instant::now();
    let mut source = Source::load(&scene.in_light(&args.light))?;
    let frames = frames(args, &mut source)?;
    let gpu = open_gpu(args.cpu);
    let budget = Budget { bytes: (args.budget * 1e6) as u64, folder: &args.out };
    let mut methods = vec![];
    contenders(&source, &budget, gpu.as_ref(), &mut |contender| {
        eprintln!("method   {}, {}", contender.name, contender.parameters);
        methods.push(measured(&frames, contender)?);
        Ok(())
    })?;
    let report = report(&source, &frames, &methods, gpu.as_ref().map(Gpu::description));
    let file = |end: &str| args.out.join(format!("{}{end}", source.name()));
    write(&file(".jpg"), &jpeg(&pictures(&frames, &methods))?)?;
    write(&file(".json"), report.to_json()?.as_bytes())?;
    write(&file("-time.svg"), report.error_time_svg()?.as_bytes())?;
    write(&file("-bytes.svg"), report.error_bytes_svg()?.as_bytes())?;
    eprintln!("{}: {:.0} s", source.name(), start.elapsed().as_secs_f64());
    Ok(table(&report) + &conditions(&frames, &report.machine))
}

/// Traces the sphere from all eyes.
fn frames(args: &MethodsArgs, source: &mut Source) -> Result<Frames> {
    let (_, mesh) = builtin("sphere", &source.cell)?;
    let cameras = full_orbit(2.0 * source.cell.half_extent().min_element(), args.size, args.eyes)?;
    let quality = *source.tracer.quality();
    let times = if source.tracer.is_random() { REFERENCE_SAMPLES } else { 1 };
    let samples = args.reference_samples.unwrap_or(times.saturating_mul(quality.samples));
    source.tracer.set_quality(Quality { samples, ..quality });
    let mirror = Mirror::new(mesh.clone());
    let bar = progress_bar(cameras.len() as u64, "trace", "pictures");
    let (mut references, mut timings) = (vec![], vec![]);
    for camera in &cameras {
        let render = || references.push(reference::render(&source.tracer, &source.cell, &mirror, camera));
        timings.push(measure(0, 1, render));
        bar.inc(1);
    }
    bar.finish_and_clear();
    source.tracer.set_quality(quality);
    let truth = references.iter().map(|reference| display(&reference.radiance)).collect();
    Ok(Frames { mesh, cameras, references, truth, samples, timing: merged(&timings)? })
}

/// Draws, times and compares one method.
fn measured(frames: &Frames, contender: &Contender<'_>) -> Result<Measured> {
    let (timings, pictures): (Vec<_>, Vec<_>) = draw(frames, contender)?.into_iter().unzip();
    let result = MethodResult {
        reflector: "sphere".to_owned(),
        method: contender.name.to_owned(),
        parameters: contender.parameters.clone(),
        device: match contender.drawn {
            Drawn::OnCpu(_) => "CPU".to_owned(),
            Drawn::OnGpu(gpu, _) => gpu.name(),
        },
        eyes: compared(&frames.references, &frames.truth, &pictures)?,
        timing: merged(&timings)?,
        bytes_on_device: contender.bytes,
        bytes_on_disk: contender.on_disk,
        preparation_s: contender.preparation_s,
    };
    let picture = pictures.into_iter().next().context("there are no eyes")?;
    Ok(Measured { result, picture })
}

/// Every eye's time and picture.
fn draw(frames: &Frames, contender: &Contender<'_>) -> Result<Vec<(Timing, Image<[u8; 4]>)>> {
    let (mesh, cameras) = (&frames.mesh, frames.cameras.iter());
    match contender.drawn {
        Drawn::OnCpu(environment) => {
            cameras.map(|camera| timed(CpuMethod::new(environment, mesh, camera), REPEATS)).collect()
        }
        Drawn::OnGpu(gpu, pass) => {
            let (mesh, truth) = (MirrorMesh::new(gpu, mesh)?, &frames.truth[0]);
            let target = Target::new(gpu, truth.width(), truth.height())?;
            let method = |camera| GpuMethod { gpu, pass, target: &target, mesh: &mesh, camera };
            cameras.map(|camera| timed(method(camera), REPEATS)).collect()
        }
    }
}

fn report(source: &Source, frames: &Frames, methods: &[Measured], adapter: Option<String>) -> Report {
    let traced = MethodResult {
        reflector: "sphere".to_owned(),
        method: "ray tracing".to_owned(),
        parameters: format!("reference; samples of each ray: {}; scene and hierarchy", frames.samples),
        device: "CPU".to_owned(),
        eyes: vec![],
        timing: frames.timing.clone(),
        bytes_on_device: source.tracer.memory_bytes() as u64,
        bytes_on_disk: None,
        preparation_s: source.build_time.as_secs_f64(),
    };
    Report {
        title: format!("Ways to reflect {}", source.name()),
        generator: concat!("lfslab ", env!("CARGO_PKG_VERSION")).to_owned(),
        machine: Machine::detect(adapter),
        scene: source.name().to_owned(),
        reproduce: command_line(),
        facts: vec![],
        results: methods.iter().map(|method| method.result.clone()).chain([traced]).collect(),
        notes: vec![],
    }
}

/// The first eye's pictures, and below each what is wrong with it. Of methods with as many bytes the best stands for all; a GPU draws the
/// same picture.
fn pictures(frames: &Frames, methods: &[Measured]) -> Image<[u8; 4]> {
    let size = frames.truth[0].width();
    let (black, factor) = (Image::filled(size, size, [0, 0, 0, 255]), size.div_ceil(TILE));
    let truth = masked(&frames.truth[0], &frames.references[0].mask, &black);
    let mut tiles =
        vec![Tile { title: "ray traced".to_owned(), note: String::new(), pictures: vec![shrunk(&truth, factor)] }];
    for Measured { result, picture } in methods.iter().filter(|method| stands_for_all(&method.result, methods)) {
        let drawn = over(picture, &black);
        let apart = difference(&truth, &drawn);
        let [megabytes, psnr] = [result.bytes_on_device as f64 / 1e6, result.mean_psnr_db().unwrap_or(f64::NAN)];
        tiles.push(Tile {
            title: result.method.clone(),
            note: format!("{megabytes:.1} MB, {psnr:.1} dB"),
            pictures: vec![shrunk(&drawn, factor), shrunk(&apart, factor)],
        });
    }
    mosaic(&tiles, COLUMNS)
}

/// Whether a result is the best of its method, on the CPU, in its bytes.
fn stands_for_all(this: &MethodResult, methods: &[Measured]) -> bool {
    let like = |other: &&MethodResult| {
        (&other.method, &other.device, other.bytes_on_device) == (&this.method, &this.device, this.bytes_on_device)
    };
    let mut twins = methods.iter().map(|method| &method.result).filter(like);
    this.device == "CPU" && twins.all(|other| other.mean_psnr_db() <= this.mean_psnr_db())
}

/// What the table was measured on.
fn conditions(frames: &Frames, machine: &Machine) -> String {
    let adapter = machine.adapter.as_deref().unwrap_or("none");
    format!(
        "\nMirror sphere, {} eyes, {}×{} pixels; samples of each traced ray: {}{}. {}, {} threads; GPU: {adapter}.\n\n",
        frames.cameras.len(),
        frames.truth[0].width(),
        frames.truth[0].height(),
        frames.samples,
        noise_note(frames),
        machine.cpu,
        machine.threads,
    )
}

fn noise_note(frames: &Frames) -> String {
    let pairs = frames.references.iter().flat_map(|r| r.radiance.texels().iter().zip(r.standard_error.texels()));
    match noise(pairs).filter(|share| *share > 0.0) {
        Some(share) => format!(", their standard error {:.2} % of the radiance", 100.0 * share),
        None => String::new(),
    }
}

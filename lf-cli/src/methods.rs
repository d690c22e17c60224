//! `lfslab methods`: what people use today and our own methods, side by side on the same frames.

use std::fmt::Write as _;
use std::time::Instant;

use anyhow::{Context, Result};
use lf_gpu::{Gpu, MirrorMesh, Target};
use lf_math::{Image, ImageError, Pinhole, TriangleMesh, image_error};
use lf_report::{EyeError, Machine, MethodResult, Report, Timing, measure};
use lf_scene::Quality;
use lf_scene::reference::{self, Mirror, Reference};

use crate::contenders::{Budget, Contender, Drawn, contenders};
use crate::demo::command_line;
use crate::device::{CpuMethod, GpuMethod, open_gpu};
use crate::frames::{full_orbit, merged, timed};
use crate::methods_args::MethodsArgs;
use crate::output::{png, print, progress_bar, write};
use crate::pictures::{difference, display, masked, noise, over, sheet, shrunk};
use crate::scene_args::SceneArgs;
use crate::sources::{Source, builtin};

/// Frames of each eye that are timed, after one that is not.
const REPEATS: usize = 2;
/// Times as many samples as texels have, where there is noise.
const REFERENCE_SAMPLES: u32 = 16;

/// One row of the table.
struct Row {
    result: MethodResult,
    errors: Vec<ImageError>,
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

/// All methods in one scene: pictures and report to the folder, the table as Markdown.
fn compare(args: &MethodsArgs, scene: &str) -> Result<String> {
    let start = Instant::now();
    let mut source = Source::load(&SceneArgs::of(scene, &args.light))?;
    let frames = frames(args, &mut source)?;
    let gpu = open_gpu(args.cpu);
    let budget = Budget { bytes: (args.budget * 1e6) as u64, folder: &args.out };
    let mut rows = vec![];
    contenders(&source, &budget, gpu.as_ref(), &mut |contender| {
        eprintln!("method   {}, {}", contender.name, contender.parameters);
        rows.push(row(&frames, contender)?);
        Ok(())
    })?;
    let report = report(&source, &frames, &rows, gpu.as_ref().map(Gpu::description));
    let base = source.name().to_owned();
    write(&args.out.join(format!("{base}.png")), &png(&pictures(&frames, &rows))?)?;
    write(&args.out.join(format!("{base}.json")), report.to_json()?.as_bytes())?;
    write(&args.out.join(format!("{base}.svg")), report.error_time_svg()?.as_bytes())?;
    eprintln!("{base}: {:.0} s", start.elapsed().as_secs_f64());
    Ok(table(&source, &frames, &rows, &report.machine))
}

/// Traces the sphere from eight eyes.
fn frames(args: &MethodsArgs, source: &mut Source) -> Result<Frames> {
    let (_, mesh) = builtin("sphere", &source.cell)?;
    let cameras = full_orbit(2.0 * source.cell.half_extent().min_element(), args.size)?;
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
fn row(frames: &Frames, contender: &Contender<'_>) -> Result<Row> {
    let (mut timings, mut errors, mut first) = (vec![], vec![], None);
    for (eye, camera) in frames.cameras.iter().enumerate() {
        let (timing, picture) = draw(frames, contender, camera)?;
        timings.push(timing);
        let error = image_error(&frames.truth[eye], &picture, &frames.references[eye].mask);
        errors.push(error.context("the reflector is out of sight")?);
        first.get_or_insert(picture);
    }
    let result = MethodResult {
        reflector: "sphere".to_owned(),
        method: contender.name.to_owned(),
        parameters: contender.parameters.clone(),
        device: match contender.drawn {
            Drawn::OnCpu(_) => "CPU".to_owned(),
            Drawn::OnGpu(gpu, _) => gpu.name(),
        },
        eyes: (0..).zip(&errors).map(|(eye, error)| EyeError::new(eye, *error)).collect(),
        timing: merged(&timings)?,
        bytes_on_device: contender.bytes,
        bytes_on_disk: contender.on_disk,
        preparation_s: contender.preparation_s,
    };
    let picture = first.context("there are no eyes")?;
    Ok(Row { result, errors, picture })
}

fn draw(frames: &Frames, contender: &Contender<'_>, camera: &Pinhole) -> Result<(Timing, Image<[u8; 4]>)> {
    match contender.drawn {
        Drawn::OnCpu(environment) => timed(CpuMethod::new(environment, &frames.mesh, camera), REPEATS),
        Drawn::OnGpu(gpu, pass) => {
            let (mesh, target) =
                (MirrorMesh::new(gpu, &frames.mesh)?, Target::new(gpu, camera.width(), camera.height())?);
            timed(GpuMethod { gpu, pass, target: &target, mesh: &mesh, camera }, REPEATS)
        }
    }
}

fn report(source: &Source, frames: &Frames, rows: &[Row], adapter: Option<String>) -> Report {
    let traced = MethodResult {
        reflector: "sphere".to_owned(),
        method: "ray tracing".to_owned(),
        parameters: format!("reference; samples of each ray: {}", frames.samples),
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
        results: rows.iter().map(|row| row.result.clone()).chain([traced]).collect(),
        notes: vec![],
    }
}

/// The first eye's pictures and errors of all methods.
fn pictures(frames: &Frames, rows: &[Row]) -> Image<[u8; 4]> {
    let black = Image::filled(frames.truth[0].width(), frames.truth[0].height(), [0, 0, 0, 255]);
    let truth = masked(&frames.truth[0], &frames.references[0].mask, &black);
    let mut sheets = vec![("ray traced".to_owned(), vec![shrunk(&truth, 2)])];
    // A GPU draws the same picture.
    for row in rows.iter().filter(|row| row.result.device == "CPU") {
        let drawn = over(&row.picture, &black);
        let apart = difference(&truth, &drawn);
        let title = format!("{}, {:.1} MB", row.result.method, row.result.bytes_on_device as f64 / 1e6);
        sheets.push((title, vec![shrunk(&drawn, 2), shrunk(&apart, 2)]));
    }
    sheet(&sheets)
}

/// The table of one scene. The best of each device at its time or less, and at its bytes or less, are marked.
fn table(source: &Source, frames: &Frames, rows: &[Row], machine: &Machine) -> String {
    let mut text = format!("## {}\n\n", source.name());
    text += "| method | parameters | device | MB | ms | PSNR, dB | relMSE | off > 0.1 | front |\n|---|---|---|--:|--:|--:|--:|--:|---|\n";
    for (number, row) in rows.iter().enumerate() {
        let result = &row.result;
        let mean = |f: &dyn Fn(&ImageError) -> f64| row.errors.iter().map(f).sum::<f64>() / row.errors.len() as f64;
        let (q1, q3) = result.timing.quartiles();
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.1} | {:.1} [{:.1}–{:.1}] | {:.2} | {:.4} | {:.2} % | {} |",
            result.method,
            result.parameters,
            result.device,
            result.bytes_on_device as f64 / 1e6,
            1e3 * result.timing.median(),
            1e3 * q1,
            1e3 * q3,
            psnr(row),
            mean(&|error| error.rel_mse),
            100.0 * mean(&ImageError::share_over_tenth),
            front(rows, number)
        );
    }
    let adapter = machine.adapter.as_deref().unwrap_or("none");
    let _ = writeln!(
        text,
        "\nMirror sphere, {} eyes, {}×{} pixels; the traced pictures take {:.0} ms each, samples of each ray: {}{}. {}, {} threads; GPU: {adapter}.\n",
        frames.cameras.len(),
        frames.truth[0].width(),
        frames.truth[0].height(),
        1e3 * frames.timing.median(),
        frames.samples,
        noise_note(frames),
        machine.cpu,
        machine.threads,
    );
    text
}

fn noise_note(frames: &Frames) -> String {
    let pairs = frames.references.iter().flat_map(|r| r.radiance.texels().iter().zip(r.standard_error.texels()));
    match noise(pairs).filter(|share| *share > 0.0) {
        Some(share) => format!(", their standard error {:.2} % of the radiance", 100.0 * share),
        None => String::new(),
    }
}

/// Mean of the eyes'.
fn psnr(row: &Row) -> f64 {
    row.result.mean_psnr_db().unwrap_or(f64::INFINITY)
}

/// On which fronts a method is among those of its device: no other is better at its time or less, or at its bytes or less.
fn front(rows: &[Row], number: usize) -> &'static str {
    let this = &rows[number];
    let others = || rows.iter().filter(|row| row.result.device == this.result.device && psnr(row) > psnr(this));
    let time = others().all(|row| row.result.timing.median() > this.result.timing.median());
    let bytes = others().all(|row| row.result.bytes_on_device > this.result.bytes_on_device);
    match (time, bytes) {
        (true, true) => "time, bytes",
        (true, false) => "time",
        (false, true) => "bytes",
        (false, false) => "",
    }
}

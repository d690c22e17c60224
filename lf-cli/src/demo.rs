//! `lfslab demo`: the whole way from scene to report.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use lf_capture::Options;
use lf_compress::{PackOptions, PackedLightField};
use lf_math::{CubeMap, Image, Pinhole, PlanePlacement, TriangleMesh};
use lf_report::{Figure, Frames, Machine, MethodResult, Plot, Report};
use lf_scene::{FocusRule, Illumination, Quality, capture_cube};

use crate::args::{DemoArgs, FileArgs, Sampling};
use crate::capture::{Captured, capture_to};
use crate::device::{CpuSide, GpuSide, open_gpu, or_cpu};
use crate::frames::{Asked, MethodFrames, ReflectorFrames, Stage, agreement, full_orbit, orbit};
use crate::input::load;
use crate::output::{megabytes, png, print, progress_bar, write, write_exr};
use crate::pictures::{ERROR_GAIN, difference, middle, noise, sheet, shrunk, strip};
use crate::sources::{Source, builtin, from_file};

/// Texels along the edge of the environment map's faces, and rays per texel and axis.
const CUBE_SIZE: u32 = 512;
const CUBE_GRID: u32 = 2;
/// Eyes around each reflector.
const EYES: u32 = 8;
/// Eyes of the parallax sheet, and the angle between them, radians (7°).
const ARC_EYES: u32 = 6;
const ARC_STEP: f32 = 0.122_173_05;

/// What was made before the frames, with what it cost.
struct Prepared {
    source: Source,
    captured: Captured,
    /// Of what is read from the file.
    texels: u64,
    focal_depths: Vec<Option<f32>>,
    cube: CubeMap,
    cube_time: Duration,
}

pub(crate) fn run(args: &DemoArgs) -> Result<()> {
    let start = Instant::now();
    let source = Source::load(&args.scene)?;
    // Read before the long work, so that a bad file is known at once.
    let other = match &args.reflector {
        Some(path) => from_file(path, &source.cell)?,
        None => builtin("teapot", &source.cell)?,
    };
    let reflectors = [builtin("sphere", &source.cell)?, other];
    std::fs::create_dir_all(&args.out).with_context(|| format!("cannot make the folder {}", args.out.display()))?;

    let file = args.out.join(format!("{}.lfslab", source.name()));
    let captured = capture(args, &source, &file)?;
    // From here on everything comes from the file.
    let field = load(&FileArgs::new(&file))?;
    let mut prepared = prepare(source, captured, &field)?;
    let quality = reference_quality(args, *prepared.source.tracer.quality());
    prepared.source.tracer = prepared.source.tracer.with_quality(quality);
    let cpu = CpuSide::new(&field, &prepared.cube)?;
    let gpu = or_cpu(open_gpu(args.cpu).map(|gpu| GpuSide::new(gpu, &field, &prepared.cube, args.size)));
    let stage = Stage { source: &prepared.source, cpu: &cpu, gpu: gpu.as_ref() };
    let frames = draw(args, &stage, &reflectors)?;
    let parallax = parallax(args, &stage, &reflectors[0].1)?;

    let report = report(args, &prepared, &frames, gpu.as_ref())?;
    let mut figures = vec![save_figure(&args.out, "parallax", "Parallax on the sphere", PARALLAX_CAPTION, &parallax)?];
    for (name, frames) in &frames {
        figures.extend(save_pictures(&args.out, name, frames)?);
    }
    write(&args.out.join("report.json"), report.to_json()?.as_bytes())?;
    for frames in report.frames() {
        if let Some(svg) = report.plot(frames, Plot::Time)? {
            write(&args.out.join(format!("{}-error-time.svg", frames.reflector)), svg.as_bytes())?;
        }
    }
    write(&args.out.join("report.html"), report.to_html(&figures)?.as_bytes())?;
    let open = format!("\n{:.0} s; open {}", start.elapsed().as_secs_f64(), args.out.join("report.html").display());
    let lines = [vec![report.to_markdown()], report.headlines(), vec![open]].concat();
    print(&lines.join("\n"))
}

/// How well the ray-traced pictures are traced: better than texels, several of which make a pixel.
fn reference_quality(args: &DemoArgs, quality: Quality) -> Quality {
    let times = match quality.illumination {
        Illumination::Direct => 1,
        Illumination::Global { .. } => 4,
    };
    Quality { samples: args.reference_samples.unwrap_or(quality.samples.saturating_mul(times)), ..quality }
}

const PARALLAX_CAPTION: &str = "The middle of the sphere from six eyes 7° apart. In the traced and in the slab pictures \
    near things move against what is behind them; in the environment map they stay glued to it.";

/// Captures the slabs into the file.
fn capture(args: &DemoArgs, source: &Source, file: &Path) -> Result<Captured> {
    let sampling = args.preset.sampling();
    let (encoding, pack) = (lf_format::TexelEncoding::Bc1, PackOptions::default());
    let options = Options { grid: sampling.grid, encoding, pack, whole: false, depth: false };
    capture_to(source, &sampling, FocusRule::default(), options, file)
}

/// Takes the environment map, and notes what the report tells of the slabs.
fn prepare(source: Source, captured: Captured, field: &PackedLightField) -> Result<Prepared> {
    let start = Instant::now();
    let cube = capture_cube(&source.tracer, &source.cell, CUBE_SIZE, CUBE_GRID)?;
    let cube_time = start.elapsed();
    eprintln!("cube map {:.1} s, 6 faces of {CUBE_SIZE}×{CUBE_SIZE} texels", cube_time.as_secs_f64());
    let texels = field.tilings().iter().map(|tiling| tiling.coverage().texels()).sum();
    let focal_depths = field.geometry().slabs().iter().map(lf_math::Slab::focal_depth).collect();
    Ok(Prepared { source, captured, texels, focal_depths, cube, cube_time })
}

/// All methods on all reflectors, seen from the orbit.
fn draw(
    args: &DemoArgs,
    stage: &Stage<'_>,
    reflectors: &[(String, TriangleMesh)],
) -> Result<Vec<(String, ReflectorFrames)>> {
    let cameras = full_orbit(edge(stage), args.size, EYES)?;
    let backgrounds = stage.backgrounds(&cameras);
    let methods = if stage.gpu.is_some() { 5 } else { 3 };
    let bar = progress_bar((reflectors.len() * cameras.len() * methods) as u64, "frames", "pictures");
    let draw = |(name, mesh): &(String, TriangleMesh)| {
        Ok((name.clone(), stage.frames(mesh, &cameras, &backgrounds, || bar.inc(1))?))
    };
    let frames = reflectors.iter().map(draw).collect();
    bar.finish_and_clear();
    frames
}

fn edge(stage: &Stage<'_>) -> f32 {
    2.0 * stage.source.cell.half_extent().min_element()
}

/// The sphere's middle from a few close eyes: what moves against what.
fn parallax(args: &DemoArgs, stage: &Stage<'_>, sphere: &TriangleMesh) -> Result<Image<[u8; 4]>> {
    let cameras: Vec<Pinhole> = orbit(edge(stage), args.size, 0.3, ARC_STEP, ARC_EYES)?;
    let frames = stage.frames(sphere, &cameras, &stage.backgrounds(&cameras), || ())?;
    let row = |title: &str, pictures: &[Image<[u8; 4]>]| (title.to_owned(), pictures.iter().map(middle).collect());
    Ok(sheet(&[
        row("ray traced; eyes 7 degrees apart", &frames.truth),
        row("slabs", &shown(&frames, Asked::Slabs).pictures),
        row("environment map", &shown(&frames, Asked::Cube).pictures),
    ]))
}

/// The frames to show of a method: the first device's, which is the GPU if there is one.
fn shown(frames: &ReflectorFrames, asked: Asked) -> &MethodFrames {
    let found = frames.methods.iter().find(|method| method.asked == asked);
    found.unwrap_or_else(|| unreachable!("every method is drawn on every device"))
}

/// One strip for each eye, the contact sheet, and the first reference as OpenEXR.
fn save_pictures(out: &Path, name: &str, frames: &ReflectorFrames) -> Result<Vec<Figure>> {
    let (slabs, cube) = (&shown(frames, Asked::Slabs).pictures, &shown(frames, Asked::Cube).pictures);
    let mut figures = Vec::new();
    let gained = format!("x{ERROR_GAIN}");
    for (eye, truth) in frames.truth.iter().enumerate() {
        let picture = strip(&[
            ("ray traced", truth.clone()),
            ("slabs", slabs[eye].clone()),
            ("environment map", cube[eye].clone()),
            (&format!("slab error {gained}"), difference(truth, &slabs[eye])),
            (&format!("map error {gained}"), difference(truth, &cube[eye])),
        ]);
        let file = format!("{name}-eye-{eye}");
        let caption = "Reference, both methods, and their absolute errors, brightened.";
        let figure = save_figure(out, &file, &format!("{name}, eye {eye}"), caption, &picture)?;
        if eye == 0 {
            figures.push(figure);
        }
    }
    let row = |title: &str, pictures: &[Image<[u8; 4]>]| {
        (title.to_owned(), pictures.iter().map(|picture| shrunk(picture, 2)).collect())
    };
    let contact = sheet(&[row("ray traced", &frames.truth), row("slabs", slabs), row("environment map", cube)]);
    let caption = "The orbit: eight eyes, 45° apart.";
    figures.push(save_figure(out, &format!("{name}-orbit"), &format!("{name}, all eyes"), caption, &contact)?);
    write_exr(&out.join(format!("{name}-eye-0-reference.exr")), &frames.references[0].radiance)?;
    Ok(figures)
}

fn save_figure(out: &Path, file: &str, title: &str, caption: &str, picture: &Image<[u8; 4]>) -> Result<Figure> {
    let png = png(picture)?;
    write(&out.join(format!("{file}.png")), &png)?;
    Ok(Figure { title: title.to_owned(), caption: caption.to_owned(), picture: png })
}

fn report(
    args: &DemoArgs,
    prepared: &Prepared,
    frames: &[(String, ReflectorFrames)],
    gpu: Option<&GpuSide>,
) -> Result<Report> {
    let adapter = gpu.map(|side| side.gpu.description());
    let mut results = Vec::new();
    for (name, frames) in frames {
        results.extend(frames.methods.iter().map(|method| method_result(args, prepared, name, method, gpu)));
        results.push(MethodResult {
            frames: drawn(args, prepared, name),
            method: "ray tracing".into(),
            parameters: format!(
                "reference, 1 ray a pixel, samples of it: {}; scene, hierarchy and textures in memory",
                prepared.source.tracer.quality().samples
            ),
            device: "CPU".into(),
            eyes: vec![],
            timing: frames.reference_timing.clone(),
            bytes_on_device: prepared.source.tracer.memory_bytes() as u64,
            bytes_on_disk: None,
            preparation_s: prepared.source.build_time.as_secs_f64(),
            rays: None,
        });
    }
    let mut notes = vec![
        "PSNR is over the reflector's pixels of 8-bit sRGB pictures, against one traced ray per pixel.".to_owned(),
        "The reference reflects the surroundings once; the reflector's image in itself is left out in all methods."
            .to_owned(),
    ];
    notes.extend(frames.iter().filter_map(|(name, frames)| noise_note(name, frames)));
    notes.extend(frames.iter().filter_map(|(name, frames)| parity_note(name, frames)));
    Ok(Report {
        title: format!("Reflections in {}", prepared.source.name()),
        generator: concat!("lfslab ", env!("CARGO_PKG_VERSION")).into(),
        machine: Machine::detect(adapter),
        reproduce: command_line(),
        facts: facts(args, prepared),
        results,
        tables: vec![],
        notes,
    })
}

fn method_result(
    args: &DemoArgs,
    prepared: &Prepared,
    reflector: &str,
    frames: &MethodFrames,
    gpu: Option<&GpuSide>,
) -> MethodResult {
    let side = gpu.filter(|_| frames.on_gpu);
    let sampling = args.preset.sampling();
    let cube_bytes = 4 * 6 * u64::from(CUBE_SIZE).pow(2);
    let seconds = |time: Duration| time.as_secs_f64();
    let (method, parameters, bytes_on_device, bytes_on_disk, preparation_s, rays) = match frames.asked {
        Asked::Slabs => (
            "slabs",
            format!(
                "6 × {0}×{0} cameras × {1}×{1} texels, planes {2}, {3}",
                sampling.cameras[0],
                sampling.resolution[0],
                placement(&sampling),
                side.map_or("decoded RGBA8", |side| side.storage.as_str())
            ),
            side.map_or(4 * prepared.texels, |side| side.slab_bytes),
            Some(prepared.captured.file_bytes),
            seconds(prepared.captured.time),
            prepared.captured.rays,
        ),
        Asked::Cube => (
            lf_report::BASELINE_METHOD,
            format!("6 × {CUBE_SIZE}×{CUBE_SIZE} texels, RGBA8"),
            cube_bytes,
            None,
            seconds(prepared.cube_time),
            6 * u64::from(CUBE_SIZE * CUBE_GRID).pow(2),
        ),
    };
    MethodResult {
        frames: drawn(args, prepared, reflector),
        method: method.to_owned(),
        parameters,
        device: side.map_or("CPU".to_owned(), |side| side.gpu.name()),
        eyes: frames.errors.clone(),
        timing: frames.timing.clone(),
        bytes_on_device,
        bytes_on_disk,
        preparation_s,
        rays: Some(rays),
    }
}

fn drawn(args: &DemoArgs, prepared: &Prepared, reflector: &str) -> Frames {
    Frames { scene: prepared.source.name().to_owned(), reflector: reflector.to_owned(), size: [args.size; 2] }
}

/// Where the camera planes stand, for people.
fn placement(sampling: &Sampling) -> String {
    match sampling.placement {
        PlanePlacement::CellFaces => "on the cell's faces".to_owned(),
        PlanePlacement::CellCenter => "through the cell's centre".to_owned(),
        PlanePlacement::Offset(offset) => format!("{offset} m from the cell's centre"),
    }
}

/// How well the references of a reflector are known, if they are noisy.
fn noise_note(name: &str, frames: &ReflectorFrames) -> Option<String> {
    let radiance = frames.references.iter().flat_map(|reference| reference.radiance.texels());
    let error = frames.references.iter().flat_map(|reference| reference.standard_error.texels());
    let share = noise(radiance.zip(error)).filter(|share| *share > 0.0)?;
    Some(format!("{name}: the standard error of the references is at most {:.2} % of their radiance.", 100.0 * share))
}

/// How far the GPU's slab pictures are from the CPU's, if both were drawn.
fn parity_note(name: &str, frames: &ReflectorFrames) -> Option<String> {
    let on = |gpu: bool| frames.methods.iter().find(|method| method.asked == Asked::Slabs && method.on_gpu == gpu);
    let (share, worst) = agreement(&frames.references, &on(true)?.pictures, &on(false)?.pictures);
    Some(format!(
        "{name}: the slab pictures of GPU and CPU agree within 2/255 at {:.3} % of the reflector's pixels (largest difference {worst}).",
        100.0 * share
    ))
}

fn facts(args: &DemoArgs, prepared: &Prepared) -> Vec<(String, String)> {
    let captured = &prepared.captured;
    let (center, edges) = (prepared.source.cell.center(), 2.0 * prepared.source.cell.half_extent());
    let depth = |depth: &Option<f32>| depth.map_or("∞".to_owned(), |d| format!("{d:.2}"));
    let depths: Vec<_> = prepared.focal_depths.iter().map(depth).collect();
    let bits = 8.0 * captured.file_bytes as f64 / prepared.texels as f64;
    [
        ("Triangles", prepared.source.tracer.scene().triangles().len().to_string()),
        ("Cell", format!("{:.3} m around ({:.3}, {:.3}, {:.3})", edges.x, center.x, center.y, center.z)),
        ("Preset", format!("{}, camera planes {}", args.preset.name(), placement(&args.preset.sampling()))),
        ("Focal depths +X −X +Y −Y +Z −Z", format!("{} m", depths.join(", "))),
        (
            "Capture",
            format!(
                "{:.1} million rays, traced and encoded in {:.1} s, {2}×{2} a texel",
                captured.rays as f64 / 1e6,
                captured.time.as_secs_f64(),
                args.preset.sampling().grid
            ),
        ),
        ("Stored texels", format!("{:.2} dB", captured.psnr)),
        ("File", format!("{}, {bits:.2} bits a texel", megabytes(captured.file_bytes))),
        ("Pictures", format!("{0}×{0} pixels", args.size)),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// The command that was typed, for the report; words that a shell would change are quoted.
pub(crate) fn command_line() -> String {
    let quoted = |word: std::ffi::OsString| {
        let word = word.to_string_lossy().into_owned();
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
        if !word.is_empty() && word.chars().all(plain) { word } else { format!("'{}'", word.replace('\'', "'\\''")) }
    };
    let words = std::env::args_os().skip(1).map(quoted);
    std::iter::once("lfslab".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

//! What a frame of slabs costs beside one of an environment map, on this machine's GPU: `docs/cost.md`.
//!
//! `cargo run --release -p lf-tests --example cost`, or with a light field of your own, `… --example cost -- room.lfslab`. Every round
//! draws one frame of each method; ratios are of the same round, so that what slows the machine down for a while slows both. Where the
//! adapter is a program, `--processor-time` counts what this process takes on all cores, whatever else the machine does.

#![forbid(unsafe_code)]

use std::error::Error;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Parser;
use cpu_time::ProcessTime;
use glam::{DVec3, Vec3};
use lf_compress::bc1::Quality;
use lf_compress::format::{Container, Limits, TexelEncoding};
use lf_compress::{PackedCube, PackedLightField};
use lf_gpu::{
    Behind, CubePicture, Frame, Gpu, GpuError, MirrorMesh, ReflectionPass, Reflector, SlabRenderer, SlabTexture,
    Storage, StuvBuffer, Target,
};
use lf_math::{
    Cell, CubeMap, DistanceCube, Image, LightFieldGeometry, Pinhole, Placement, PlanePlacement, Reflectance,
    SlabTexels, TriangleMesh, View,
};
use lf_scene::reflectors;

#[derive(Parser)]
struct Arguments {
    /// A light field in BC1; without it one of noise, of the paper's size
    field: Option<PathBuf>,
    /// Pixels along a picture's edge
    #[arg(long, default_value_t = 512)]
    size: u32,
    /// Frames of each method
    #[arg(long, default_value_t = 31)]
    rounds: usize,
    /// Counts processor time, not time: for software adapters
    #[arg(long)]
    processor_time: bool,
}

/// Texels along the edge of the environment maps' faces.
const CUBE: u32 = 512;
/// Subdivisions of an icosahedron: some thousand, ten thousand, hundred thousand and a million triangles.
const SPHERES: [u32; 4] = [3, 5, 6, 8];

/// A method and the milliseconds of its frames.
struct Method {
    name: String,
    bytes: u64,
    pass: ReflectionPass,
    times: Vec<f64>,
}

/// What all frames share.
struct Stage<'a> {
    gpu: &'a Gpu,
    target: Target,
    camera: Pinhole,
    rounds: usize,
    processor_time: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let gpu = Gpu::new()?;
    let fields = fields(&arguments)?;
    let half = fields[0].1.geometry().cell().half_extent().min_element();
    let eye = Vec3::new(1.1, 0.6, 1.6).normalize() * 3.2 * half;
    let camera = Pinhole::look_at(eye, Vec3::ZERO, 0.67, arguments.size, arguments.size)?;
    let target = Target::new(&gpu, arguments.size, arguments.size)?;
    let Arguments { rounds, processor_time, .. } = arguments;
    let stage = Stage { gpu: &gpu, target, camera, rounds, processor_time };
    println!("{}, {2}×{2} pixels, {} frames of each\n", gpu.description(), stage.rounds, arguments.size);

    let mut methods = maps(&gpu)?;
    for (name, field) in &fields {
        methods.extend(slabs(&gpu, name, field)?);
    }
    for (name, mesh) in [("sphere", reflectors::sphere(5)), ("teapot", reflectors::teapot(10))] {
        stage.draw(&mesh.fitted(Vec3::ZERO, 0.96 * half)?, &mut methods)?;
        ratios(name, &methods);
    }
    triangles(&stage, half, &fields[0].1)?;
    Ok(())
}

/// The light field named, or noise: whole and cropped.
fn fields(arguments: &Arguments) -> Result<Vec<(&'static str, PackedLightField)>, Box<dyn Error>> {
    if let Some(path) = &arguments.field {
        let bytes = std::fs::read(path)?;
        return Ok(vec![("slabs", PackedLightField::read(&Container::parse(&bytes, &Limits::default())?)?)]);
    }
    let cell = Cell::cube(DVec3::ZERO, 1.0)?;
    let geometry = LightFieldGeometry::around(cell, PlanePlacement::CellFaces, 32, 128)?;
    let texels = |slab| SlabTexels::new(slab, noise(32 * 32 * 128 * 128));
    let texels = geometry.slabs().iter().map(texels).collect::<Result<Vec<_>, _>>()?;
    let whole = PackedLightField::encode(geometry, &texels, TexelEncoding::Bc1, Quality::Realtime)?;
    let cropped = whole.cropped()?;
    Ok(vec![("whole slabs", whole), ("cropped slabs", cropped)])
}

/// Numbers that look random: a hash of the index.
fn noise(count: u32) -> Vec<[u8; 4]> {
    (0..count)
        .map(|i| (i.wrapping_mul(0x9E37_79B1).rotate_left(15).wrapping_mul(0x85EB_CA77) | 0xff).to_be_bytes())
        .collect()
}

/// Environment maps of texels and of blocks.
fn maps(gpu: &Gpu) -> Result<Vec<Method>, Box<dyn Error>> {
    let face = Image::new(CUBE, CUBE, noise(CUBE * CUBE))?;
    let cube = CubeMap::new([(); 6].map(|()| face.clone()))?;
    let distances = [(); 6].map(|()| Image::filled(8, 8, 1.0));
    let packed = PackedCube::encode(&DistanceCube::new(Vec3::ZERO, cube.clone(), distances)?, Quality::Realtime)?;
    let map = |name: &str, picture: CubePicture<'_>| {
        let pass = ReflectionPass::environment(gpu, picture)?;
        Ok::<_, GpuError>(Method { name: name.to_owned(), bytes: picture.bytes(gpu), pass, times: vec![] })
    };
    Ok(vec![map("environment map, RGBA8", (&cube).into())?, map("environment map, BC1", (&packed).into())?])
}

/// A light field in every form that the device holds.
fn slabs(gpu: &Gpu, name: &str, field: &PackedLightField) -> Result<Vec<Method>, GpuError> {
    let mut methods = Vec::new();
    for storage in [Storage::Bc1Volume, Storage::Bc1Array, Storage::Rgba8Array] {
        match SlabTexture::with_storage(gpu, field, storage) {
            Ok(texture) => methods.push(Method {
                name: format!("{name}, {storage}"),
                bytes: texture.bytes(),
                pass: ReflectionPass::slabs(gpu, &texture)?,
                times: vec![],
            }),
            Err(error) => eprintln!("left out: {error}"),
        }
    }
    Ok(methods)
}

impl Stage<'_> {
    /// Draws a frame of each method in turns, after one that is not counted.
    fn draw(&self, mesh: &TriangleMesh, methods: &mut [Method]) -> Result<(), GpuError> {
        let mesh = MirrorMesh::new(self.gpu, mesh)?;
        for method in methods.iter_mut() {
            method.times.clear();
        }
        for round in 0..=self.rounds {
            for method in methods.iter_mut() {
                let taken = self.frame(method, &mesh)?;
                if round > 0 {
                    method.times.push(1e3 * taken.as_secs_f64());
                }
            }
        }
        Ok(())
    }

    /// Draws a frame, waits for it and says how long that took.
    fn frame(&self, method: &Method, mesh: &MirrorMesh) -> Result<Duration, GpuError> {
        self.timed(|| method.pass.draw(self.gpu, &self.target, mesh, &self.camera))
    }

    /// Runs what submits work, waits for it and says how long that took.
    fn timed(&self, submit: impl FnOnce() -> Result<(), GpuError>) -> Result<Duration, GpuError> {
        let (start, busy) = (Instant::now(), ProcessTime::now());
        submit()?;
        self.gpu.wait()?;
        Ok(if self.processor_time { busy.elapsed() } else { start.elapsed() })
    }
}

/// First quartile, median and third quartile.
fn quartiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_unstable_by(f64::total_cmp);
    [1, 2, 3].map(|quarter| values[(values.len() - 1) * quarter / 4])
}

fn ratios(reflector: &str, methods: &[Method]) {
    println!("| {reflector} | MiB | ms: median [quartiles] | × RGBA8 map | × BC1 map |\n|---|--:|--:|--:|--:|");
    for method in methods {
        let [low, middle, high] = quartiles(method.times.clone());
        let over = |map: &Method| {
            let [low, middle, high] = quartiles(method.times.iter().zip(&map.times).map(|(a, b)| a / b).collect());
            format!("{middle:.2} [{low:.2}–{high:.2}]")
        };
        let mebibytes = method.bytes as f64 / f64::from(1 << 20);
        let (plain, blocks) = (over(&methods[0]), over(&methods[1]));
        println!("| {} | {mebibytes:.1} | {middle:.1} [{low:.1}–{high:.1}] | {plain} | {blocks} |", method.name);
    }
    println!();
}

/// What reflections take on spheres of more and more triangles: in one pass, less what a white mirror takes; and in the second of two.
fn triangles(stage: &Stage<'_>, half: f32, field: &PackedLightField) -> Result<(), Box<dyn Error>> {
    let texture = SlabTexture::new(stage.gpu, field)?;
    println!(
        "| triangles | white, ms | {}, ms | difference, ms: median [quartiles] | second of two passes, ms |\n|--:|--:|--:|--:|--:|",
        texture.storage()
    );
    let method = |name: &str, pass| Method { name: name.to_owned(), bytes: 0, pass, times: vec![] };
    let mut methods = [
        method("white", ReflectionPass::flat(stage.gpu)?),
        method("slabs", ReflectionPass::slabs(stage.gpu, &texture)?),
    ];
    let mut renderer = SlabRenderer::new(stage.gpu, &texture)?;
    for subdivisions in SPHERES {
        let mesh = reflectors::sphere(subdivisions).fitted(Vec3::ZERO, 0.96 * half)?;
        stage.draw(&mesh, &mut methods)?;
        let [white, slabs] = &methods;
        let [low, middle, high] = quartiles(slabs.times.iter().zip(&white.times).map(|(a, b)| a - b).collect());
        let [white, slabs] = [white, slabs].map(|method| quartiles(method.times.clone())[1]);
        let second = second_passes(stage, &mut renderer, &MirrorMesh::new(stage.gpu, &mesh)?)?;
        let count = mesh.triangles().len();
        println!("| {count} | {white:.1} | {slabs:.1} | {middle:.1} [{low:.1}–{high:.1}] | {} |", spread(second));
    }
    Ok(())
}

/// Milliseconds of the paper's second pass, which answers each pixel once.
fn second_passes(stage: &Stage<'_>, renderer: &mut SlabRenderer<'_>, mesh: &MirrorMesh) -> Result<Vec<f64>, GpuError> {
    let stuv = StuvBuffer::new(stage.gpu, stage.camera.width(), stage.camera.height())?;
    let reflector =
        Reflector { mesh, placement: Placement::IDENTITY, reflectance: Reflectance::MIRROR, normal_map: None };
    let frame = Frame { camera: &stage.camera, reflectors: &[reflector], behind: Behind::Nothing, view: View::Color };
    renderer.ask(&stuv, &frame)?;
    renderer.answer(&stuv, &stage.target, View::Color)?;
    stage.gpu.wait()?;
    let mut round = || stage.timed(|| renderer.answer(&stuv, &stage.target, View::Color));
    (0..stage.rounds).map(|_| Ok(1e3 * round()?.as_secs_f64())).collect()
}

/// Median and quartiles, for people.
fn spread(times: Vec<f64>) -> String {
    let [low, middle, high] = quartiles(times);
    format!("{middle:.1} [{low:.1}–{high:.1}]")
}

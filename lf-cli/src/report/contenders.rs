//! The methods that a report compares, each ready to draw.
//!
//! Data is made as a device would hold it, and drawn as decoded from that: BC1 blocks for colours, blocks of two planes for depths,
//! for other people's methods as for ours.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use glam::Vec3;
use lf_capture::Options;
use lf_compress::bc1::Quality;
use lf_compress::{DepthGuide, GuidedCubes, PackedCube, PackedLightField};
use lf_format::TexelEncoding;
use lf_gpu::{CubePicture, Gpu, Proxy, ReflectionPass, SlabTexture, Storage};
use lf_ibr::{
    BlockField, BoxCube, CubeField, DistanceField, Environment, GuidedField, ProbeField, SlabField, SphereCube,
};
use lf_math::{Coverage, DistanceCube, LightFieldGeometry, PlanePlacement, Search, Slab};
use lf_scene::{capture_distance_cube, capture_inverse_depths, capture_mirror_cube, focus};

use super::spec::{Answer, CubeSpec, GuidedSpec, Method, ProbesSpec, SlabsCase};
use crate::args::FileArgs;
use crate::capture::{Captured, capture_to};
use crate::input::{MAX_DECODED_BYTES, load};
use crate::sources::Source;

/// Steps of the searches in distance cubes. In the museum more of the fixed point gain a few hundredths of a decibel.
const FIXED_POINT: (Search, &str) = (Search::FixedPoint(4), "fixed point, 4 steps");
const STEPS: (Search, &str) = (Search::March { steps: 64, halvings: 6 }, "64 steps, 6 halvings");
/// Halvings of the step in which a ray through eight cubes ends.
const PROBE_HALVINGS: u32 = 6;
/// Eight probes stand at the corners of a cube this large, of the cell's size.
const PROBES_AT: f32 = 0.7;
/// One of the guided cubes stands in the middle, four at corners of a cube this large.
const GUIDED_AT: f32 = 0.9;
/// Cameras and texels of the guide, per axis. More of them gain nothing in the museum; the bytes serve the cubes better.
const GUIDE: [u32; 2] = [6, 20];
/// One ray a texel: several cubes make up for each other's gaps, and means of four would be blurred twice (a decibel in the museum).
const GUIDED_GRID: u32 = 1;

/// How much of the device a method may take, and where files may be put on the way.
pub(crate) struct Budget<'a> {
    pub(crate) bytes: u64,
    pub(crate) folder: &'a Path,
}

/// A method ready to draw.
pub(crate) struct Contender<'a> {
    pub(crate) name: &'static str,
    pub(crate) parameters: String,
    /// On the device.
    pub(crate) bytes: u64,
    pub(crate) on_disk: Option<u64>,
    pub(crate) preparation_s: f64,
    /// Rays traced for it.
    pub(crate) rays: u64,
    pub(crate) drawn: Drawn<'a>,
}

/// What draws.
pub(crate) enum Drawn<'a> {
    OnCpu(&'a dyn Environment),
    OnGpu(&'a Gpu, &'a ReflectionPass),
}

impl Budget<'_> {
    /// Those sizes that it allows, MB; itself if it allows none.
    fn fitting(&self, sizes: &[f64]) -> Vec<f64> {
        let most = self.bytes as f64 / 1e6;
        let fitting: Vec<f64> = sizes.iter().copied().filter(|size| *size <= most).collect();
        if fitting.is_empty() { vec![most] } else { fitting }
    }
}

type Each<'a> = dyn FnMut(&Contender<'_>) -> Result<()> + 'a;

/// Makes one method after another and hands it on, if it keeps to the budget.
pub(crate) fn contenders(
    source: &Source,
    methods: &[Method],
    budget: &Budget<'_>,
    gpu: Option<&Gpu>,
    each: &mut Each<'_>,
) -> Result<()> {
    let mut within = |contender: &Contender<'_>| if contender.bytes <= budget.bytes { each(contender) } else { Ok(()) };
    let mut captured: Vec<SlabsCase> = vec![];
    for method in methods {
        match method {
            Method::Cube(spec) => one_cube(source, spec, budget, gpu, &mut within)?,
            Method::Probes(spec) => probes(source, spec, budget, gpu, &mut within)?,
            Method::Guided(spec) => guided(source, spec, budget, gpu, &mut within)?,
            Method::Slabs(spec) => {
                // Sweeps along several axes meet in one case.
                for case in spec.cases() {
                    if !captured.contains(&case) {
                        slabs(source, &case, budget, gpu, &mut within)?;
                        captured.push(case);
                    }
                }
            }
        }
    }
    Ok(())
}

/// Everything that one cube map at the cell's centre can do, with and without its depths. Where the budget is small, so is the cube.
fn one_cube(
    source: &Source,
    spec: &CubeSpec,
    budget: &Budget<'_>,
    gpu: Option<&Gpu>,
    each: &mut Each<'_>,
) -> Result<()> {
    let most = cube_size(budget.bytes as f64);
    let mut edges: Vec<u32> = spec.texels.iter().map(|&edge| edge.min(most)).collect();
    edges.dedup();
    edges.into_iter().try_for_each(|edge| cube_of(source, edge, &spec.answers, gpu, each))
}

fn cube_of(source: &Source, edge: u32, answers: &[Answer], gpu: Option<&Gpu>, each: &mut Each<'_>) -> Result<()> {
    let start = Instant::now();
    let packed = capture(source, Vec3::ZERO, edge, 2)?;
    let cube = packed.decode()?;
    let preparation_s = start.elapsed().as_secs_f64();
    let picture: usize = packed.radiance().iter().map(Vec::len).sum();
    let map = CubeField::new(cube.radiance());
    let rays = 6 * u64::from(2 * edge).pow(2);
    let size = format!("{edge}², BC1");
    let searched = |steps: &str| format!("{size}, depth blocks; {steps}");
    let mut hand = |(name, parameters, bytes): (_, String, usize), environment: &dyn Environment| {
        let drawn = Drawn::OnCpu(environment);
        each(&Contender { name, parameters, bytes: bytes as u64, on_disk: None, preparation_s, rays, drawn })
    };
    let search = |(search, steps): (Search, &str), hand: &mut dyn FnMut(_, &dyn Environment) -> Result<()>| {
        hand(("distance cube", searched(steps), packed.bytes()), &DistanceField::new(cube.clone(), search))
    };
    for answer in answers {
        match answer {
            Answer::Direction => hand((lf_report::BASELINE_METHOD, size.clone(), picture), &map)?,
            Answer::Sphere => {
                let field = SphereCube::new(map.clone(), Vec3::ZERO, cube.median_distance());
                hand(("sphere-projected map", size.clone(), picture), &field)?;
            }
            Answer::Box => {
                let field = BoxCube::new(map.clone(), Vec3::ZERO, cube.median_box());
                hand(("box-projected map", size.clone(), picture), &field)?;
            }
            Answer::FixedPoint => search(FIXED_POINT, &mut hand)?,
            Answer::Steps => search(STEPS, &mut hand)?,
        }
    }
    let Some(gpu) = gpu else { return Ok(()) };
    let map = CubePicture::from(&packed);
    let size = format!("{edge}², {}", texels_on(gpu, &packed));
    let proxy = |proxy| ReflectionPass::proxy(gpu, map, Vec3::ZERO, proxy);
    for answer in answers {
        let searched = |(search, steps): (Search, &str)| {
            let pass = ReflectionPass::packed_distance_cube(gpu, &packed, search);
            ("distance cube", format!("{size}, depth blocks; {steps}"), pass)
        };
        let (name, parameters, pass) = match answer {
            Answer::Direction => (lf_report::BASELINE_METHOD, size.clone(), ReflectionPass::environment(gpu, map)),
            Answer::Sphere => ("sphere-projected map", size.clone(), proxy(Proxy::Sphere(cube.median_distance()))),
            Answer::Box => ("box-projected map", size.clone(), proxy(Proxy::Box(cube.median_box()))),
            Answer::FixedPoint => searched(FIXED_POINT),
            Answer::Steps => searched(STEPS),
        };
        let pass = pass?;
        let (bytes, drawn) = (pass.bytes(), Drawn::OnGpu(gpu, &pass));
        each(&Contender { name, parameters, bytes, on_disk: None, preparation_s, rays, drawn })?;
    }
    Ok(())
}

/// How a device holds the colours of a cube.
fn texels_on(gpu: &Gpu, cube: &PackedCube) -> &'static str {
    if CubePicture::from(cube).stays_blocks(gpu) { "BC1" } else { "RGBA8" }
}

/// Eight distance cubes, as many texels as fit.
fn probes(
    source: &Source,
    spec: &ProbesSpec,
    budget: &Budget<'_>,
    gpu: Option<&Gpu>,
    each: &mut Each<'_>,
) -> Result<()> {
    let mut of = |megabytes| probes_of(source, megabytes, &spec.steps, gpu, each);
    budget.fitting(&spec.megabytes).into_iter().try_for_each(&mut of)
}

fn probes_of(source: &Source, megabytes: f64, steps: &[u32], gpu: Option<&Gpu>, each: &mut Each<'_>) -> Result<()> {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    let places = (0..8).map(|i| PROBES_AT * corner(i) * source.cell.half_extent());
    // From this many bytes on one ray a texel is traced, not four: that would take minutes.
    let grid = if megabytes > 20.0 { 1 } else { 2 };
    let of = |place, size| capture(source, place, size, grid);
    let set = CubeSet::of(&places.collect::<Vec<_>>(), megabytes * 1e6, grid, of)?;
    let cubes = set.decode()?;
    let mut hand = |texels, steps, bytes, drawn: Drawn<'_>| {
        let (size, grid) = (set.size, set.rays);
        let parameters =
            format!("{size}², {texels}, depth blocks; {steps} steps, {PROBE_HALVINGS} halvings; rays a texel: {grid}");
        let (name, preparation_s, rays) = ("8 distance cubes", set.preparation_s, set.traced());
        each(&Contender { name, parameters, bytes, on_disk: None, preparation_s, rays, drawn })
    };
    for &steps in steps {
        let field = ProbeField::new(cubes.clone(), steps, PROBE_HALVINGS)?;
        hand("BC1", steps, set.bytes, Drawn::OnCpu(&field))?;
        if let Some(gpu) = gpu {
            let pass = ReflectionPass::probes(gpu, &set.cubes, steps, PROBE_HALVINGS)?;
            hand(texels_on(gpu, &set.cubes[0]), steps, pass.bytes(), Drawn::OnGpu(gpu, &pass))?;
        }
    }
    Ok(())
}

/// Five distance cubes and a guide.
fn guided(
    source: &Source,
    spec: &GuidedSpec,
    budget: &Budget<'_>,
    gpu: Option<&Gpu>,
    each: &mut Each<'_>,
) -> Result<()> {
    budget.fitting(&spec.megabytes).into_iter().try_for_each(|megabytes| guided_of(source, megabytes, gpu, each))
}

fn guided_of(source: &Source, megabytes: f64, gpu: Option<&Gpu>, each: &mut Each<'_>) -> Result<()> {
    let start = Instant::now();
    let [cameras, resolution] = GUIDE;
    let geometry = LightFieldGeometry::around(source.cell, PlanePlacement::CellCenter, cameras, resolution)?;
    let geometry = focus(&source.tracer, &geometry)?;
    let guide = DepthGuide::new(geometry.clone(), &capture_inverse_depths(&source.tracer, &geometry)?)?;
    let guide_s = start.elapsed().as_secs_f64();
    let corners = [[0.0; 3], [1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let places = corners.map(|corner| GUIDED_AT * Vec3::from(corner) * source.cell.half_extent());
    let guide_bytes = guide.bytes() as u64;
    let of = |place, size| {
        let cube = capture_mirror_cube(&source.tracer, &source.cell, place, size, GUIDED_GRID)?;
        Ok(PackedCube::encode(&cube, Quality::Best)?)
    };
    let set = CubeSet::of(&places, megabytes * 1e6 - guide_bytes as f64, GUIDED_GRID, of)?;
    let (size, grid, preparation_s) = (set.size, set.rays, guide_s + set.preparation_s);
    let rays = set.traced() + guide_bytes / 2;
    let data = GuidedCubes::new(set.cubes, guide)?;
    let mut hand = |texels, bytes, drawn: Drawn<'_>| {
        let parameters =
            format!("5 × {size}², {texels}, depth blocks; guide {cameras}²×{resolution}²; rays a texel: {grid}");
        each(&Contender { name: "guided cubes (ours)", parameters, bytes, on_disk: None, preparation_s, rays, drawn })
    };
    hand("BC1", data.bytes() as u64, Drawn::OnCpu(&GuidedField::new(&data)))?;
    let Some(gpu) = gpu else { return Ok(()) };
    let pass = ReflectionPass::guided(gpu, &data)?;
    hand(texels_on(gpu, &data.cubes()[0]), pass.bytes(), Drawn::OnGpu(gpu, &pass))
}

/// Slabs on the CPU and in every form that the device can hold.
fn slabs(source: &Source, case: &SlabsCase, budget: &Budget<'_>, gpu: Option<&Gpu>, each: &mut Each<'_>) -> Result<()> {
    let sampling = &case.sampling;
    let geometry =
        LightFieldGeometry::around_with(source.cell, sampling.placement, sampling.cameras, sampling.resolution)?;
    let texels = |slab: &Slab| {
        let all = if case.options.whole { Coverage::whole(slab) } else { Coverage::of_cell(slab, &source.cell) };
        all.texels()
    };
    let blocks = case.options.encoding == TexelEncoding::Bc1;
    let least = geometry.slabs().iter().map(texels).sum::<u64>() * if blocks { 1 } else { 8 } / 2;
    if least > budget.bytes {
        return Ok(());
    }
    let (captured, field) = captured(source, case, case.options, budget.folder)?;
    let storages: &[Storage] = if blocks {
        let environment = BlockField::new(&field)?;
        each(&of_slabs(&captured, case, None, stored(&field), Drawn::OnCpu(&environment)))?;
        &[Storage::Bc1Volume, Storage::Bc1Array, Storage::Rgba8Array]
    } else {
        let environment = SlabField::new(field.geometry().clone(), field.decode(MAX_DECODED_BYTES)?)?;
        each(&of_slabs(&captured, case, None, stored(&field), Drawn::OnCpu(&environment)))?;
        &[Storage::Rgba8Array]
    };
    for &storage in storages {
        let Some(gpu) = gpu else { break };
        match SlabTexture::with_storage(gpu, &field, storage) {
            Ok(texture) => {
                let pass = ReflectionPass::slabs(gpu, &texture)?;
                let drawn = Drawn::OnGpu(gpu, &pass);
                each(&of_slabs(&captured, case, Some(storage), texture.bytes(), drawn))?;
            }
            Err(error) => eprintln!("left out: {error}"),
        }
    }
    Ok(())
}

/// Captures slabs by way of a file, which is not kept.
pub(crate) fn captured(
    source: &Source,
    case: &SlabsCase,
    options: Options,
    folder: &Path,
) -> Result<(Captured, PackedLightField)> {
    let file = folder.join(format!("{}-slabs.lfslab", source.name()));
    let captured = capture_to(source, &case.sampling, case.focus, options, &file)?;
    let field = load(&FileArgs::new(&file))?;
    std::fs::remove_file(&file).with_context(|| file.display().to_string())?;
    Ok((captured, field))
}

fn of_slabs<'a>(
    captured: &Captured,
    case: &SlabsCase,
    storage: Option<Storage>,
    bytes: u64,
    drawn: Drawn<'a>,
) -> Contender<'a> {
    let cover = if case.options.whole { "whole" } else { "cropped" };
    let (codec, rays) = (case.codec.to_uppercase(), case.options.grid.pow(2));
    let storage = storage.map_or_else(String::new, |storage| format!(", {storage}"));
    Contender {
        name: "slabs",
        parameters: format!("{}; {cover}; {codec}{storage}; rays a texel: {rays}", case.layout),
        bytes,
        on_disk: Some(captured.file_bytes),
        preparation_s: captured.time.as_secs_f64(),
        rays: captured.rays,
        drawn,
    }
}

/// Bytes of the texels in a light field's tiles.
pub(crate) fn stored(field: &PackedLightField) -> u64 {
    (0..field.tilings().len()).flat_map(|slab| field.tiles(slab)).map(|tile| tile.len() as u64).sum()
}

/// Distance cubes of a total size.
struct CubeSet {
    cubes: Vec<PackedCube>,
    size: u32,
    rays: u32,
    bytes: u64,
    preparation_s: f64,
}

impl CubeSet {
    /// At some places, each as a function of place and size makes it, with so many rays a texel and axis.
    fn of(places: &[Vec3], bytes: f64, grid: u32, cube: impl Fn(Vec3, u32) -> Result<PackedCube>) -> Result<Self> {
        let (start, size) = (Instant::now(), cube_size(bytes / places.len() as f64));
        let cubes = places.iter().map(|&place| cube(place, size)).collect::<Result<Vec<_>>>()?;
        let bytes = cubes.iter().map(|cube| cube.bytes() as u64).sum();
        Ok(Self { cubes, size, rays: grid * grid, bytes, preparation_s: start.elapsed().as_secs_f64() })
    }

    /// Rays traced for it.
    fn traced(&self) -> u64 {
        6 * self.cubes.len() as u64 * u64::from(self.size).pow(2) * u64::from(self.rays)
    }

    fn decode(&self) -> Result<Vec<DistanceCube>> {
        Ok(self.cubes.iter().map(PackedCube::decode).collect::<Result<_, _>>()?)
    }
}

/// Texels along the edge of the largest cube of so many bytes: half a byte a texel for its colour, 20/64 for its depth. Blocks are at
/// most 8 texels wide.
fn cube_size(bytes: f64) -> u32 {
    ((bytes / (6.0 * (0.5 + 20.0 / 64.0))).sqrt() as u32 / 8 * 8).max(8)
}

/// A cube as the device holds it.
fn capture(source: &Source, place: Vec3, size: u32, grid: u32) -> Result<PackedCube> {
    let cube = capture_distance_cube(&source.tracer, &source.cell, place, [size; 2], grid)?;
    Ok(PackedCube::encode(&cube, Quality::Best)?)
}

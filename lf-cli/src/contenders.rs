//! The methods that `lfslab methods` compares, each ready to draw.
//!
//! Data is made as a device would hold it, and drawn as decoded from that: BC1 blocks for colours, blocks of two planes for depths,
//! for other people's methods as for ours.

use std::path::Path;
use std::time::Instant;

use anyhow::Result;
use glam::Vec3;
use lf_capture::Options;
use lf_compress::bc1::Quality;
use lf_compress::{PackOptions, PackedCube, PackedLightField};
use lf_gpu::{CubePicture, Gpu, GpuError, Proxy, ReflectionPass, SlabTexture, Storage};
use lf_ibr::{
    BlockField, BoxCube, CubeField, DepthGuide, DistanceField, Environment, GuidedField, ProbeField, SphereCube,
};
use lf_math::{Coverage, DistanceCube, LightFieldGeometry, PlanePlacement, Search};
use lf_scene::{capture_distance_cube, capture_inverse_depths, focus};

use crate::args::{FileArgs, Preset};
use crate::capture::{Captured, capture_to};
use crate::input::load;
use crate::sources::Source;

/// Texels along the edge of a single cube's faces.
const CUBE: u32 = 1024;
/// Steps of the searches in distance cubes. In the museum more of the fixed point gain a few hundredths of a decibel.
const SEARCHES: [(Search, &str); 2] = [
    (Search::FixedPoint(4), "fixed point, 4 steps"),
    (Search::March { steps: 64, halvings: 6 }, "64 steps, 6 halvings"),
];
/// Steps along the ray in eight cubes.
const PROBE_STEPS: [u32; 2] = [64, 128];
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

impl Budget<'_> {
    /// Sizes at which methods are compared that can have any, MB: the last two are those of eight and of 32 distance cubes of 512² texels in
    /// BC1 and BC4.
    fn sizes(&self) -> Vec<f64> {
        let most = self.bytes as f64 / 1e6;
        let fitting: Vec<f64> = [3.1, 12.6, 50.0].into_iter().filter(|size| *size <= most).collect();
        if fitting.is_empty() { vec![most] } else { fitting }
    }
}

/// A method ready to draw.
pub(crate) struct Contender<'a> {
    pub(crate) name: &'static str,
    pub(crate) parameters: String,
    /// On the device.
    pub(crate) bytes: u64,
    pub(crate) on_disk: Option<u64>,
    pub(crate) preparation_s: f64,
    pub(crate) drawn: Drawn<'a>,
}

/// What draws.
pub(crate) enum Drawn<'a> {
    OnCpu(&'a dyn Environment),
    OnGpu(&'a Gpu, &'a ReflectionPass),
}

type Each<'a> = dyn FnMut(&Contender<'_>) -> Result<()> + 'a;

/// Makes one method after another and hands it on.
pub(crate) fn contenders(source: &Source, budget: &Budget<'_>, gpu: Option<&Gpu>, each: &mut Each<'_>) -> Result<()> {
    let mut within = |contender: &Contender<'_>| if contender.bytes <= budget.bytes { each(contender) } else { Ok(()) };
    one_cube(source, budget, gpu, &mut within)?;
    for megabytes in budget.sizes() {
        probes(source, megabytes, &mut within)?;
    }
    for preset in [Preset::Small, Preset::Paper] {
        slabs(source, budget, preset, gpu, &mut within)?;
    }
    for megabytes in budget.sizes() {
        guided(source, megabytes, &mut within)?;
    }
    Ok(())
}

/// Everything that one cube map at the cell's centre can do, with and without its depths.
fn one_cube(source: &Source, budget: &Budget<'_>, gpu: Option<&Gpu>, each: &mut Each<'_>) -> Result<()> {
    let (start, edge) = (Instant::now(), cube_size(budget.bytes as f64).min(CUBE));
    let packed = capture(source, Vec3::ZERO, edge, 2)?;
    let cube = packed.decode()?;
    let preparation_s = start.elapsed().as_secs_f64();
    let picture: usize = packed.radiance().iter().map(Vec::len).sum();
    let map = CubeField::new(cube.radiance());
    let mut hand = |name, parameters: String, bytes: usize, environment: &dyn Environment| {
        let drawn = Drawn::OnCpu(environment);
        each(&Contender { name, parameters, bytes: bytes as u64, on_disk: None, preparation_s, drawn })
    };
    let size = format!("{edge}², BC1");
    hand(lf_report::BASELINE_METHOD, size.clone(), picture, &map)?;
    hand(
        "sphere-projected map",
        size.clone(),
        picture,
        &SphereCube::new(map.clone(), Vec3::ZERO, cube.median_distance()),
    )?;
    hand("box-projected map", size.clone(), picture, &BoxCube::new(map, Vec3::ZERO, cube.median_box()))?;
    for (search, steps) in SEARCHES {
        let field = DistanceField::new(cube.clone(), search);
        hand("distance cube", format!("{size}, depth blocks; {steps}"), packed.bytes(), &field)?;
    }
    let Some(gpu) = gpu else { return Ok(()) };
    let mut hand = |name, parameters: String, bytes: u64, pass: Result<ReflectionPass, GpuError>| {
        let pass = pass?;
        each(&Contender { name, parameters, bytes, on_disk: None, preparation_s, drawn: Drawn::OnGpu(gpu, &pass) })
    };
    let map = CubePicture::from(&packed);
    let (map_bytes, depth_bytes) = (map.bytes(gpu), (packed.bytes() - picture) as u64);
    let size = format!("{edge}², {}", if map.stays_blocks(gpu) { "BC1" } else { "RGBA8" });
    let proxy = |proxy| ReflectionPass::proxy(gpu, map, Vec3::ZERO, proxy);
    hand(lf_report::BASELINE_METHOD, size.clone(), map_bytes, ReflectionPass::environment(gpu, map))?;
    hand("sphere-projected map", size.clone(), map_bytes, proxy(Proxy::Sphere(cube.median_distance())))?;
    hand("box-projected map", size.clone(), map_bytes, proxy(Proxy::Box(cube.median_box())))?;
    for (search, steps) in SEARCHES {
        let pass = ReflectionPass::packed_distance_cube(gpu, &packed, search);
        hand("distance cube", format!("{size}, depth blocks; {steps}"), map_bytes + depth_bytes, pass)?;
    }
    Ok(())
}

/// Eight distance cubes, as many texels as fit.
fn probes(source: &Source, megabytes: f64, each: &mut Each<'_>) -> Result<()> {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    let places = (0..8).map(|i| PROBES_AT * corner(i) * source.cell.half_extent());
    // From this many bytes on one ray a texel is traced, not four: that would take minutes.
    let grid = if megabytes > 20.0 { 1 } else { 2 };
    let set = CubeSet::capture(source, &places.collect::<Vec<_>>(), megabytes * 1e6, grid)?;
    let cubes = set.decode()?;
    for steps in PROBE_STEPS {
        let field = ProbeField::new(cubes.clone(), steps, 6)?;
        each(&Contender {
            name: "8 distance cubes",
            parameters: format!(
                "{}², BC1, depth blocks; {steps} steps, 6 halvings; rays a texel: {}",
                set.size, set.rays
            ),
            bytes: set.bytes,
            on_disk: None,
            preparation_s: set.preparation_s,
            drawn: Drawn::OnCpu(&field),
        })?;
    }
    Ok(())
}

/// Five distance cubes and a guide.
fn guided(source: &Source, megabytes: f64, each: &mut Each<'_>) -> Result<()> {
    let start = Instant::now();
    let [cameras, resolution] = GUIDE;
    let geometry = LightFieldGeometry::around(source.cell, PlanePlacement::CellCenter, cameras, resolution)?;
    let geometry = focus(&source.tracer, &geometry)?;
    let guide = DepthGuide::new(geometry.clone(), &capture_inverse_depths(&source.tracer, &geometry)?)?;
    let guide_s = start.elapsed().as_secs_f64();
    let guide_bytes = guide.bytes() as u64;
    let corners = [[0.0; 3], [1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let places = corners.map(|corner| GUIDED_AT * Vec3::from(corner) * source.cell.half_extent());
    let set = CubeSet::capture(source, &places, megabytes * 1e6 - guide_bytes as f64, GUIDED_GRID)?;
    let field = GuidedField::new(&set.cubes, guide)?;
    each(&Contender {
        name: "guided cubes (ours)",
        parameters: format!(
            "5 × {}², BC1, depth blocks; guide {cameras}²×{resolution}²; rays a texel: {}",
            set.size, set.rays
        ),
        bytes: set.bytes + guide_bytes,
        on_disk: None,
        preparation_s: guide_s + set.preparation_s,
        drawn: Drawn::OnCpu(&field),
    })
}

/// Slabs of a preset, on the CPU and in every form that the device can hold.
fn slabs(source: &Source, budget: &Budget<'_>, preset: Preset, gpu: Option<&Gpu>, each: &mut Each<'_>) -> Result<()> {
    let sampling = preset.sampling();
    let geometry =
        LightFieldGeometry::around_with(source.cell, sampling.placement, sampling.cameras, sampling.resolution)?;
    let texels: u64 = geometry.slabs().iter().map(|slab| Coverage::of_cell(slab, &source.cell).texels()).sum();
    if texels / 2 > budget.bytes {
        return Ok(());
    }
    let file = budget.folder.join(format!("{}-{}.lfslab", source.name(), preset.name()));
    let encoding = lf_format::TexelEncoding::Bc1;
    let options = Options { grid: sampling.grid, encoding, pack: PackOptions::default(), whole: false, depth: false };
    let captured = capture_to(source, &sampling, options, &file)?;
    let field = load(&FileArgs::new(&file))?;
    let size = format!("6 × {0}² × {1}²", sampling.cameras[0], sampling.resolution[0]);
    let environment = BlockField::new(&field)?;
    each(&of_slabs(&captured, format!("{size}, BC1"), blocks(&field), Drawn::OnCpu(&environment)))?;
    for storage in [Storage::Bc1Volume, Storage::Bc1Array, Storage::Rgba8Array] {
        let Some(gpu) = gpu else { break };
        match SlabTexture::with_storage(gpu, &field, storage) {
            Ok(texture) => {
                let pass = ReflectionPass::slabs(gpu, &texture)?;
                each(&of_slabs(&captured, format!("{size}, {storage}"), texture.bytes(), Drawn::OnGpu(gpu, &pass)))?;
            }
            Err(error) => eprintln!("left out: {error}"),
        }
    }
    Ok(())
}

fn of_slabs<'a>(captured: &Captured, parameters: String, bytes: u64, drawn: Drawn<'a>) -> Contender<'a> {
    let (on_disk, preparation_s) = (Some(captured.file_bytes), captured.time.as_secs_f64());
    Contender { name: "slabs", parameters, bytes, on_disk, preparation_s, drawn }
}

/// Bytes of the blocks in a light field's tiles.
fn blocks(field: &PackedLightField) -> u64 {
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
    fn capture(source: &Source, places: &[Vec3], bytes: f64, grid: u32) -> Result<Self> {
        let (start, size) = (Instant::now(), cube_size(bytes / places.len() as f64));
        let cubes = places.iter().map(|&place| capture(source, place, size, grid)).collect::<Result<Vec<_>>>()?;
        let bytes = cubes.iter().map(|cube| cube.bytes() as u64).sum();
        Ok(Self { cubes, size, rays: grid * grid, bytes, preparation_s: start.elapsed().as_secs_f64() })
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

//! A driver that really has no memory left: every call says so by its type, and the device goes on drawing, or the error says that it is
//! lost.
//!
//! Mesa's software driver takes a device's memory from the process. A limit on the process's address space, little above what it has once
//! the device is open, makes the driver's own allocations fail. Each test runs in a process of its own, as the limit is the process's. Hardly
//! any of the memory is touched: the largest resident size is tested, too.

use std::io::Write;
use std::process::Command;
use std::time::Duration;

use glam::{DVec3, Vec2, Vec3};
use lf_compress::bc1::Quality;
use lf_compress::format::TexelEncoding;
use lf_compress::planes::PlaneBlock;
use lf_compress::{DepthGuide, GuidedCubes, PackedCube, PackedLightField};
use lf_gpu::{
    DeviceOptions, Gpu, GpuError, MirrorMesh, NormalMapTexture, Probe, ReflectionPass, SceneMesh, SlabTexture, Storage,
    StuvBuffer, Target, read_probes,
};
use lf_math::{
    Cell, CubeMap, DistanceCube, Face, Image, LightFieldGeometry, LitMesh, NormalMap, Pinhole, PlanePlacement, Search,
    Slab, SlabTexels, TriangleMesh,
};

const MIB: u64 = 1 << 20;

/// Address space that is left to the process. A new block of device memory takes 128 MiB (wgpu's allocator, the second block of memory
/// that the host sees): more, and it could be had; much less, and the host's own allocations would fail, which end a program.
const LITTLE: u64 = 100 * MIB;
const ENOUGH: u64 = 1024 * MIB;

/// Set in the process that has little memory.
const ALONE: &str = "LF_GPU_OUT_OF_MEMORY";

/// Runs `body` as the only test of a new process, if memory can be made to run out here.
fn alone(test: &str, body: fn()) {
    if std::env::var_os(ALONE).is_some() {
        std::thread::spawn(|| {
            std::thread::sleep(Duration::from_secs(60));
            let _ = writeln!(std::io::stderr(), "hangs");
            std::process::exit(3);
        });
        body();
        let resident = status_kib("VmHWM") << 10;
        assert!(resident < 1024 * MIB, "{} MiB were resident", resident / MIB);
        return;
    }
    if let Some(why) = unfit() {
        let _ = writeln!(std::io::stderr(), "NOT TESTED: {why}");
        return;
    }
    let mut child = Command::new(std::env::current_exe().expect("a path"));
    // An arena for each thread would reserve address space at times that differ from run to run.
    child
        .args(["--exact", test, "--nocapture"])
        .env(ALONE, "1")
        .env("MALLOC_ARENA_MAX", "1")
        .env("RUST_BACKTRACE", "0");
    let output = child.output().expect("starts");
    let said = String::from_utf8_lossy(&output.stdout);
    let passed = output.status.success() && said.contains("1 passed");
    assert!(passed, "{}\n{said}{}", output.status, String::from_utf8_lossy(&output.stderr));
    println!("{said}");
}

/// Why memory cannot be made to run out here.
fn unfit() -> Option<String> {
    if !cfg!(target_os = "linux") {
        return Some("only Linux tells and limits a process's memory so".to_owned());
    }
    if let Err(e) = Command::new("prlimit").arg("--version").output() {
        return Some(format!("no prlimit (util-linux), which sets limits: {e}"));
    }
    match Gpu::new() {
        Ok(gpu) if gpu.name().contains("llvmpipe") => None,
        Ok(gpu) => Some(format!("{} is not Mesa's software driver, whose memory is the process's", gpu.description())),
        Err(e) => Some(e.to_string()),
    }
}

fn status_kib(key: &str) -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("a process");
    let line = status.lines().find(|line| line.starts_with(key)).expect("is there");
    line.split_whitespace().nth(1).and_then(|kib| kib.parse().ok()).expect("a number")
}

/// Limits the process's address space to so many bytes more than it has.
fn leave(bytes: u64) {
    let limit = (status_kib("VmSize") << 10) + bytes;
    let mut prlimit = Command::new("prlimit");
    prlimit.args([format!("--pid={}", std::process::id()), format!("--as={limit}:")]);
    assert!(prlimit.status().expect("runs").success());
}

/// Something small that a device can draw, on the device from before its memory ran out.
struct Small<'a> {
    gpu: &'a Gpu,
    pass: ReflectionPass,
    mesh: MirrorMesh,
    target: Target,
}

impl<'a> Small<'a> {
    fn new(gpu: &'a Gpu) -> Self {
        let pass = ReflectionPass::environment(gpu, &cube_map(4)).expect("a pass");
        let mesh = MirrorMesh::new(gpu, &grid(2)).expect("a mesh");
        let small = Self { gpu, pass, mesh, target: Target::new(gpu, 64, 64).expect("a target") };
        let picture = small.draw().expect("draws");
        assert!(picture.texels().iter().any(|texel| texel[3] != 0), "the mirror is not seen");
        small
    }

    fn draw(&self) -> Result<Image<[u8; 4]>, GpuError> {
        let camera = Pinhole::look_at(Vec3::new(0.3, 0.2, 2.0), Vec3::ZERO, 0.7, 64, 64).expect("a camera");
        self.pass.draw(self.gpu, &self.target, &self.mesh, &camera)?;
        self.target.read(self.gpu)
    }
}

/// A square of 2 m in the plane z = 0, by `n²` vertices.
fn grid(n: u32) -> TriangleMesh {
    let at = |i: u32| 2.0 * i as f32 / (n - 1) as f32 - 1.0;
    let positions: Vec<_> = (0..n * n).map(|i| Vec3::new(at(i % n), at(i / n), 0.0)).collect();
    let corners = (0..(n - 1) * (n - 1)).map(|i| i / (n - 1) * n + i % (n - 1));
    let triangles = corners.flat_map(|i| [[i, i + 1, i + n], [i + 1, i + n + 1, i + n]]).collect();
    let normals = vec![Vec3::Z; positions.len()];
    TriangleMesh::new(positions, normals, triangles).expect("a mesh")
}

/// Its normals taken for light.
fn lit(mesh: &TriangleMesh) -> LitMesh {
    let [positions, light] = [mesh.positions(), mesh.normals()].map(<[Vec3]>::to_vec);
    LitMesh::new(positions, light, mesh.triangles().to_vec()).expect("a mesh")
}

fn cube_map(size: u32) -> CubeMap {
    let face = |i: u8| Image::filled(size, size, [40 * i, 255 - 40 * i, 128, 255]);
    CubeMap::new([0, 1, 2, 3, 4, 5].map(face)).expect("a cube map")
}

/// Pictures of `size` texels along an edge, and depths of `depth_size`.
fn distance_cube(size: u32, depth_size: u32) -> DistanceCube {
    let depths = [(); 6].map(|()| Image::filled(depth_size, depth_size, 0.5));
    DistanceCube::new(Vec3::ZERO, cube_map(size), depths).expect("a cube")
}

fn packed_cube(size: u32, depth_size: u32) -> PackedCube {
    PackedCube::encode(&distance_cube(size, depth_size), Quality::Realtime).expect("encodes")
}

fn geometry(cameras: u32, resolution: u32) -> LightFieldGeometry {
    let cell = Cell::cube(DVec3::ZERO, 1.0).expect("a cell");
    LightFieldGeometry::around(cell, PlanePlacement::CellFaces, cameras, resolution).expect("a light field")
}

fn texels<T: Copy>(geometry: &LightFieldGeometry, value: T) -> Vec<SlabTexels<T>> {
    let count = |slab: &Slab| slab.cameras().iter().chain(&slab.resolution()).product::<u32>() as usize;
    let slab = |slab| SlabTexels::new(slab, vec![value; count(slab)]).expect("texels");
    geometry.slabs().iter().map(slab).collect()
}

/// Six slabs of `cameras²` images of 128² texels.
fn field(cameras: u32) -> PackedLightField {
    let geometry = geometry(cameras, 128);
    let texels = texels(&geometry, [200, 100, 50, 255]);
    PackedLightField::encode(geometry, &texels, TexelEncoding::Bc1, Quality::Realtime).expect("encodes")
}

/// One cube of `size²` texels a face and a guide of `6 · (128 · cameras)²` half floats.
fn guided_cubes(size: u32, cameras: u32) -> GuidedCubes {
    let geometry = geometry(cameras, 128);
    let guide = DepthGuide::new(geometry.clone(), &texels(&geometry, 0.5)).expect("a guide");
    GuidedCubes::new(vec![packed_cube(size, size)], guide).expect("guided cubes")
}

/// What is asked for, how the error must call it, and the call.
type Case<'a> = (&'a str, &'a str, Box<dyn Fn() -> Result<(), GpuError> + 'a>);

const DEPTH_VALUES: &str = "the depths of a distance cube";
const DEPTH_BLOCKS: &str = "the depths of distance cubes";

const MARCH: Search = Search::March { steps: 8, halvings: 2 };

/// Holds all of the device's memory but about half a mebibyte: what is asked for, small frames have, and nothing of a mebibyte.
fn fill(gpu: &Gpu) -> Vec<Target> {
    let spare = [(); 4].map(|()| Target::new(gpu, 128, 128).expect("a target"));
    let mut held = vec![];
    for size in [2048, 1024, 512, 256, 128] {
        let refused = loop {
            match Target::new(gpu, size, size) {
                Ok(target) => held.push(target),
                Err(error) => break error,
            }
        };
        assert!(matches!(refused, GpuError::OutOfMemory { what: "the render target" }), "{size}²: {refused}");
        assert!(held.len() < 1000, "memory does not end");
    }
    drop(spare);
    held
}

/// Every call fails for lack of memory and says of what; after each the device draws what it drew before.
fn all_fail(cases: &[Case<'_>], small: &Small<'_>) {
    let expected = small.draw().expect("draws");
    for (name, named, call) in cases {
        let error = call().expect_err(name);
        println!("{name}: {error}");
        assert!(matches!(error, GpuError::OutOfMemory { what } if what == *named), "{name}: {error:?}");
        let picture = small.draw().unwrap_or_else(|e| panic!("after {name}: {e}"));
        assert!(picture == expected, "after {name} another picture is drawn");
    }
}

#[test]
fn what_does_not_fit_is_refused_and_the_device_goes_on() {
    alone("what_does_not_fit_is_refused_and_the_device_goes_on", || {
        let gpu = Gpu::new().expect("opens");
        let small = Small::new(&gpu);
        let (field, cube, depths) = (field(8), cube_map(512), distance_cube(8, 512));
        let [pictures, planes] = [[768, 8], [8, 768]].map(|[size, depths]| packed_cube(size, depths));
        let [probes, probe_planes] = [&pictures, &planes].map(|cube| [cube.clone(), cube.clone()]);
        let [guided, guide] = [guided_cubes(768, 1), guided_cubes(8, 4)];
        let (mesh, scene) = (grid(300), lit(&grid(300)));
        let normals = NormalMap::new(Image::filled(1024, 1024, [128, 128, 255, 255]), 1.0).expect("a map");
        let texture = SlabTexture::new(&gpu, &field).expect("fits");
        let large = Target::new(&gpu, 1024, 1024).expect("fits");
        let fetches = vec![Probe { face: Face::PosX, camera: [0, 0], uv: Vec2::ZERO }; 512 * 64];
        let slabs = |storage| SlabTexture::with_storage(&gpu, &field, storage).map(drop);
        let packed = |cube| ReflectionPass::packed_distance_cube(&gpu, cube, MARCH).map(drop);
        let several = |cubes| ReflectionPass::probes(&gpu, cubes, 8, 2).map(drop);
        let by_guide = |cubes| ReflectionPass::guided(&gpu, cubes).map(drop);
        let cases: [Case<'_>; 18] = [
            ("slabs", "the slab texture", Box::new(|| SlabTexture::new(&gpu, &field).map(drop))),
            ("a volume", "the slab texture", Box::new(|| slabs(Storage::Bc1Volume))),
            ("decoded slabs", "the slab texture", Box::new(|| slabs(Storage::Rgba8Array))),
            ("an environment", "the cube map", Box::new(|| ReflectionPass::environment(&gpu, &cube).map(drop))),
            ("depths", DEPTH_VALUES, Box::new(|| ReflectionPass::distance_cube(&gpu, &depths, MARCH).map(drop))),
            ("a packed cube", "the cube map", Box::new(|| packed(&pictures))),
            ("its depths", DEPTH_BLOCKS, Box::new(|| packed(&planes))),
            ("probes", "the cube map", Box::new(|| several(&probes))),
            ("depths of probes", DEPTH_BLOCKS, Box::new(|| several(&probe_planes))),
            ("guided cubes", "the cube map", Box::new(|| by_guide(&guided))),
            ("a guide", "the guide of distance cubes", Box::new(|| by_guide(&guide))),
            ("a target", "the render target", Box::new(|| Target::new(&gpu, 512, 512).map(drop))),
            ("two passes", "the stuv buffer", Box::new(|| StuvBuffer::new(&gpu, 512, 512).map(drop))),
            ("a read-back", "the read-back buffer", Box::new(|| large.read(&gpu).map(drop))),
            ("single fetches", "the probes", Box::new(|| read_probes(&gpu, &texture, &fetches).map(drop))),
            ("a mirror", "the mirror's buffers", Box::new(|| MirrorMesh::new(&gpu, &mesh).map(drop))),
            ("a scene", "the scene's buffers", Box::new(|| SceneMesh::new(&gpu, &scene).map(drop))),
            ("normals", "the normal map", Box::new(|| NormalMapTexture::new(&gpu, &normals).map(drop))),
        ];
        leave(LITTLE);
        let held = fill(&gpu);
        all_fail(&cases, &small);
        drop(held);
        gpu.wait().expect("is well");
        for (name, _, call) in &cases {
            call().unwrap_or_else(|e| panic!("{name}, with memory again: {e}"));
        }
    });
}

/// What goes up is copied once more on its way; there is memory for it, but not for the copy. A lack that wgpu itself meets loses the device.
#[test]
fn a_lack_of_memory_on_the_way_up_loses_no_device() {
    alone("a_lack_of_memory_on_the_way_up_loses_no_device", || {
        let decoded = DeviceOptions { blocks: false, ..DeviceOptions::default() };
        let gpu = Gpu::with_options(&decoded).expect("opens");
        let small = Small::new(&gpu);
        // They take 24 MiB, each of their images 4 or all.
        let (field, cube) = (field(8), cube_map(1024));
        let normals = NormalMap::new(Image::filled(2496, 2496, [128, 128, 255, 255]), 1.0).expect("a map");
        let cases: [Case<'_>; 3] = [
            ("slabs", "a slice of the slab texture", Box::new(|| SlabTexture::new(&gpu, &field).map(drop))),
            ("an environment", "the cube map", Box::new(|| ReflectionPass::environment(&gpu, &cube).map(drop))),
            ("normals", "the normal map", Box::new(|| NormalMapTexture::new(&gpu, &normals).map(drop))),
        ];
        let room_for_one = Target::new(&gpu, 2048, 1600).expect("25 MiB");
        leave(LITTLE);
        let held = fill(&gpu);
        drop(room_for_one);
        all_fail(&cases, &small);
        drop(held);
        leave(ENOUGH);
        for (name, _, call) in &cases {
            call().unwrap_or_else(|e| panic!("{name}, with memory again: {e}"));
        }
        gpu.destroy();
        let error = small.draw().expect_err("is lost");
        let GpuError::Lost { device, why } = &error else { panic!("{error}") };
        assert!(*device == gpu.name() && why == "it was given back", "{error}");
        assert!(error.to_string().contains(device), "{error}");
    });
}

/// Not even a frame's few hundred bytes are left. wgpu may lose the device over them; then the error says which, and that memory was why.
#[test]
fn a_frame_without_any_memory_fails_by_its_type() {
    alone("a_frame_without_any_memory_fails_by_its_type", || {
        let gpu = Gpu::new().expect("opens");
        let small = Small::new(&gpu);
        let expected = small.draw().expect("draws");
        leave(LITTLE);
        let targets = fill(&gpu);
        let mut meshes = vec![];
        for mesh in [grid(40), grid(2)] {
            let refused = loop {
                match MirrorMesh::new(&gpu, &mesh) {
                    Ok(mesh) => meshes.push(mesh),
                    Err(error) => break error,
                }
            };
            assert!(matches!(refused, GpuError::OutOfMemory { .. } | GpuError::Lost { .. }), "{refused}");
        }
        let error = small.draw().map(|picture| picture == expected).expect_err("has no memory");
        println!("{error}");
        match &error {
            GpuError::OutOfMemory { .. } => {}
            GpuError::Lost { device, why } => assert!(*device == gpu.name() && why.contains("memory"), "{error}"),
            other => panic!("{other}"),
        }
        drop((targets, meshes));
        leave(ENOUGH);
        let again = Gpu::new().expect("opens again");
        assert!(Small::new(&again).draw().expect("draws") == expected, "another picture is drawn");
    });
}

/// Adapters of all kinds have a budget; that of slabs is tested with their other forms, in `lf-tests`.
#[test]
fn a_budget_below_the_data_is_told_before_the_device_is_asked() {
    if let Err(e) = Gpu::new() {
        let _ = writeln!(std::io::stderr(), "NOT TESTED: {e}");
        return;
    }
    let (field, cube, values, packed) = (field(1), cube_map(60), distance_cube(4, 64), packed_cube(4, 64));
    let (probes, guided) = ([packed_cube(64, 4), packed_cube(64, 4)], guided_cubes(4, 1));
    let normals = NormalMap::new(Image::filled(20, 30, [0; 4]), 1.0).expect("a map");
    let planes = packed.inverse_depths().iter().map(|image| (image.blocks().len() * PlaneBlock::BYTES) as u64).sum();
    let words = guided.guide().bytes() as u64;
    // What the error calls the largest part, its bytes, and the call.
    type Part<'a> = (&'a str, u64, Box<dyn Fn(&Gpu) -> Result<(), GpuError> + 'a>);
    let cases: [Part<'_>; 9] = [
        ("of this light field", 6 * 128 * 128 * 4, Box::new(|gpu| SlabTexture::new(gpu, &field).map(drop))),
        ("the cube map", 6 * 60 * 60 * 4, Box::new(|gpu| ReflectionPass::environment(gpu, &cube).map(drop))),
        (DEPTH_VALUES, 6 * 64 * 64 * 2, Box::new(|gpu| ReflectionPass::distance_cube(gpu, &values, MARCH).map(drop))),
        (DEPTH_BLOCKS, planes, Box::new(|gpu| ReflectionPass::packed_distance_cube(gpu, &packed, MARCH).map(drop))),
        ("the cube map", 12 * 64 * 64 * 4, Box::new(|gpu| ReflectionPass::probes(gpu, &probes, 8, 2).map(drop))),
        ("the guide of distance cubes", words, Box::new(|gpu| ReflectionPass::guided(gpu, &guided).map(drop))),
        ("the render target", 20 * 30 * 4, Box::new(|gpu| Target::new(gpu, 20, 30).map(drop))),
        ("the stuv buffer", 20 * 30 * 16, Box::new(|gpu| StuvBuffer::new(gpu, 20, 30).map(drop))),
        ("the normal map", 20 * 30 * 4, Box::new(|gpu| NormalMapTexture::new(gpu, &normals).map(drop))),
    ];
    for (named, needed, call) in &cases {
        let within = |max_texture_bytes| {
            let options = DeviceOptions { blocks: false, max_texture_bytes, ..DeviceOptions::default() };
            call(&Gpu::with_options(&options).expect("opens"))
        };
        let error = within(needed - 1).expect_err(named);
        let GpuError::OverBudget { what, bytes, budget } = &error else { panic!("{named}: {error:?}") };
        assert!(what.contains(named) && (*bytes, *budget) == (*needed, needed - 1), "{error}");
        let text = error.to_string();
        for told in [named, &*needed.to_string(), "fewer cameras or texels", "BC1 blocks", "max_texture_bytes"] {
            assert!(text.contains(told), "{text}: {told}");
        }
        within(*needed).unwrap_or_else(|e| panic!("{named} just fits: {e}"));
    }
}

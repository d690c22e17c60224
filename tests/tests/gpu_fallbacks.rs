//! Devices with less than this machine's: the next form holds the light field and draws the same picture, or the error says what to do.

use std::process::Command;

use glam::Vec3;
use lf_compress::PackedLightField;
use lf_compress::bc1::Quality;
use lf_compress::format::TexelEncoding;
use lf_gpu::{
    DeviceOptions, Gpu, GpuError, MirrorMesh, Probe, ReflectionPass, SlabTexture, Storage, Target, read_probes,
};
use lf_ibr::{GBuffer, SlabField, reflect_frame};
use lf_math::{Cell, CubeMap, Face, Image, LightFieldGeometry, Pinhole, SampledAxis, Slab, SlabTexels, TriangleMesh};
use lf_scene::reflectors;
use lf_tests::{capture, museum, packed};

const SIZE: u32 = 512;
const ALL: fn() -> DeviceOptions = DeviceOptions::default;

fn open(options: &DeviceOptions) -> Gpu {
    Gpu::with_options(options).unwrap_or_else(|e| panic!("the GPU tests need an adapter: {e}"))
}

fn mirror() -> TriangleMesh {
    reflectors::teapot(10).fitted(Vec3::ZERO, 0.48).expect("fits")
}

fn camera() -> Pinhole {
    Pinhole::look_at(Vec3::new(1.2, 0.5, 0.7), Vec3::ZERO, 0.7, SIZE, SIZE).expect("a camera")
}

/// Six slabs, a slice of 512² texels each; 8 slices as a volume.
fn field() -> PackedLightField {
    packed(&capture(&museum(), 10, 48))
}

/// Share of the mirror's pixels whose channels agree within 2/255.
fn share_alike(a: &Image<[u8; 4]>, b: &Image<[u8; 4]>) -> f64 {
    let covered = a.texels().iter().zip(b.texels()).filter(|(a, b)| a[3] != 0 || b[3] != 0);
    let alike = |(a, b): (&[u8; 4], &[u8; 4])| (0..4).all(|c| a[c].abs_diff(b[c]) <= 2);
    let (all, same) = covered.fold((0usize, 0usize), |(all, same), pair| (all + 1, same + usize::from(alike(pair))));
    same as f64 / all as f64
}

#[test]
fn every_fallback_draws_what_the_cpu_draws() {
    let (field, mesh, camera) = (field(), mirror(), camera());
    assert_eq!(field.layout().size(), [512, 512, 8]);
    let twin = SlabField::new(field.geometry().clone(), field.decode(1 << 30).expect("decodes")).expect("a field");
    let expected = reflect_frame(&GBuffer::rasterize(&mesh, &camera), &twin);
    let plain = DeviceOptions { blocks: false, ..ALL() };
    let small = DeviceOptions { max_texture_array_layers: 3, max_texture_dimension_2d: SIZE, ..ALL() };
    for (what, options, storage, size) in [
        ("all", ALL(), Storage::Bc1Array, [512, 512, 6]),
        ("few layers", DeviceOptions { max_texture_array_layers: 3, ..ALL() }, Storage::Bc1Array, [1024, 512, 3]),
        ("few and small layers", small, Storage::Bc1Volume, [512, 512, 8]),
        ("no BC1", plain, Storage::Rgba8Array, [512, 512, 6]),
        (
            "no BC1, two layers, small textures",
            DeviceOptions { max_texture_array_layers: 2, max_texture_dimension_2d: 1024, ..plain },
            Storage::Rgba8Array,
            [1024, 1024, 2],
        ),
    ] {
        let gpu = open(&options);
        let texture = SlabTexture::new(&gpu, &field).expect("uploads");
        assert_eq!((texture.storage(), texture.size()), (storage, size), "{what}");
        let pass = ReflectionPass::slabs(&gpu, &texture).expect("a pass");
        let target = Target::new(&gpu, SIZE, SIZE).expect("a target");
        pass.draw(&gpu, &target, &MirrorMesh::new(&gpu, &mesh).expect("uploads"), &camera).expect("draws");
        let share = share_alike(&target.read(&gpu).expect("reads"), &expected);
        println!("{what}: {storage}, {:.4} % of the mirror's pixels within 2/255", 100.0 * share);
        assert!(share >= 0.999, "{what}: {share}");
    }
}

/// 300 slices for 256 layers, which is what WebGPU promises: two to a layer, and every texel in its place.
#[test]
fn more_slices_than_layers_share_them() {
    let axis = |count| SampledAxis::spanning(-1.0, 1.0, count).expect("an axis");
    let slab = Slab::new(Face::PosX, 0.5, [axis(600), axis(1)], [axis(512), axis(4)], None).expect("a slab");
    let texel = |camera: u32, i: u32| [camera as u8, (camera >> 8) as u8, (i % 251) as u8, 255];
    let texels = (0..600).flat_map(|camera| (0..512 * 4).map(move |i| texel(camera, i))).collect();
    let texels = SlabTexels::new(&slab, texels).expect("texels");
    let cell = Cell::cube(glam::DVec3::ZERO, 1.0).expect("a cell");
    let geometry = LightFieldGeometry::new(cell, vec![slab]).expect("a field");
    let field =
        PackedLightField::encode(geometry, &[texels], TexelEncoding::Rgba8, Quality::Standard).expect("encodes");
    assert_eq!(field.layout().size(), [1024, 4, 512]);
    let gpu = open(&DeviceOptions { max_texture_array_layers: 256, ..ALL() });
    let texture = SlabTexture::new(&gpu, &field).expect("uploads");
    assert_eq!(texture.size(), [2048, 4, 150]);
    let at = |camera, u: u16, v: u16| Probe { face: Face::PosX, camera: [camera, 0], uv: [u.into(), v.into()].into() };
    let probes: Vec<_> = (0..600).flat_map(|camera| [at(camera, 0, 0), at(camera, 511, 3)]).collect();
    let found = read_probes(&gpu, &texture, &probes).expect("reads");
    for (probe, found) in probes.iter().zip(found) {
        assert_eq!(found, texel(probe.camera[0], probe.uv.y as u32 * 512 + probe.uv.x as u32), "{probe:?}");
    }
}

fn refusal(options: &DeviceOptions, field: &PackedLightField) -> GpuError {
    SlabTexture::new(&open(options), field).map(|texture| texture.size()).expect_err("does not fit")
}

#[test]
fn what_fits_in_no_form_says_what_to_do() {
    let field = field();
    let small = DeviceOptions { max_texture_dimension_2d: 256, max_texture_dimension_3d: 256, ..ALL() };
    let error = refusal(&small, &field);
    assert!(matches!(error, GpuError::Storage { storage: Storage::Rgba8Array, .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains("512×512") && text.contains("256×256") && text.contains("at most 256 texels"), "{text}");

    let few =
        DeviceOptions { max_texture_array_layers: 1, max_texture_dimension_2d: 1024, block_volumes: false, ..ALL() };
    let text = refusal(&few, &field).to_string();
    assert!(text.contains("6 slices") && text.contains("1024×1024×1") && text.contains("crop"), "{text}");
}

/// The budget counts before anything is allocated, in the form that takes least.
#[test]
fn a_budget_is_checked_in_bytes() {
    let (field, blocks) = (field(), 512 * 512 * 6 / 2);
    let error = refusal(&DeviceOptions { max_texture_bytes: blocks - 1, ..ALL() }, &field);
    let GpuError::OverBudget { bytes, budget, .. } = error else { panic!("{error}") };
    assert_eq!((bytes, budget), (blocks, blocks - 1));
    assert!(error.to_string().contains("max_texture_bytes"), "{error}");
    let gpu = open(&DeviceOptions { max_texture_bytes: blocks, ..ALL() });
    assert_eq!(SlabTexture::new(&gpu, &field).expect("just fits").bytes(), blocks);
    // Decoded it takes eight times as much.
    let error = refusal(&DeviceOptions { max_texture_bytes: 8 * blocks - 1, blocks: false, ..ALL() }, &field);
    assert!(matches!(error, GpuError::OverBudget { bytes, .. } if bytes == 8 * blocks), "{error}");
}

#[test]
fn a_lost_device_fails_every_call_and_hangs_in_none() {
    let (gpu, field, mesh) = (open(&ALL()), field(), mirror());
    let texture = SlabTexture::new(&gpu, &field).expect("uploads");
    let pass = ReflectionPass::slabs(&gpu, &texture).expect("a pass");
    let device_mesh = MirrorMesh::new(&gpu, &mesh).expect("uploads");
    let target = Target::new(&gpu, SIZE, SIZE).expect("a target");
    pass.draw(&gpu, &target, &device_mesh, &camera()).expect("draws");
    // A frame is still on its way.
    gpu.destroy();
    let cube = CubeMap::new([(); 6].map(|()| Image::filled(4, 4, [0; 4]))).expect("a cube map");
    let probe = Probe { face: Face::PosX, camera: [0, 0], uv: glam::Vec2::ZERO };
    let calls: [(&str, Result<(), GpuError>); 9] = [
        ("wait", gpu.wait()),
        ("draw", pass.draw(&gpu, &target, &device_mesh, &camera())),
        ("read", target.read(&gpu).map(drop)),
        ("target", Target::new(&gpu, 8, 8).map(drop)),
        ("mesh", MirrorMesh::new(&gpu, &mesh).map(drop)),
        ("texture", SlabTexture::new(&gpu, &field).map(drop)),
        ("slabs", ReflectionPass::slabs(&gpu, &texture).map(drop)),
        ("environment", ReflectionPass::environment(&gpu, &cube).map(drop)),
        ("probes", read_probes(&gpu, &texture, &[probe]).map(drop)),
    ];
    for (what, result) in calls {
        assert!(matches!(result, Err(GpuError::Lost { .. })), "{what}: {result:?}");
    }
    // Another can be opened beside it.
    open(&ALL()).wait().expect("is well");
}

/// Set in the process that has no adapter.
const WITHOUT: &str = "LF_TESTS_WITHOUT_ADAPTER";

/// The Vulkan loader finds a driver by its file; named files are the only ones that it takes.
#[test]
#[cfg(target_os = "linux")]
fn without_an_adapter_the_error_is_typed() {
    if std::env::var_os(WITHOUT).is_some() {
        let error = Gpu::new().map(|gpu| gpu.description()).expect_err("no driver can be found");
        assert!(matches!(error, GpuError::NoAdapter(_)), "{error}");
        return;
    }
    let this = std::env::current_exe().expect("a path");
    let mut child = Command::new(this);
    child.args(["--exact", "without_an_adapter_the_error_is_typed", "--nocapture"]).env(WITHOUT, "1");
    child.env("VK_DRIVER_FILES", "nowhere.json").env("VK_ICD_FILENAMES", "nowhere.json");
    let output = child.output().expect("starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && said.contains("1 passed"), "{said}{}", String::from_utf8_lossy(&output.stderr));
}

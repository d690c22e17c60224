//! GPU and CPU pictures of the same light field and environment map.

use glam::{Vec3, Vec3Swizzles};
use half::f16;
use lf_compress::bc1::Quality;
use lf_compress::{DepthGuide, GuidedCubes, PackedCube, PackedLightField};
use lf_gpu::{
    CubePicture, DeviceOptions, Gpu, GpuError, MirrorMesh, Proxy, ReflectionPass, SlabTexture, Storage, Target,
};
use lf_ibr::{
    BoxCube, CubeField, DistanceField, Environment, GBuffer, GuidedField, ProbeField, SlabField, SphereCube, Texel,
    reflect_frame,
};
use lf_math::{
    Coverage, DistanceCube, Image, LightFieldGeometry, Pinhole, PlanePlacement, Ray, Search, Slab, SlabTexels,
    TriangleMesh, linear_from_srgb,
};
use lf_scene::{
    Tracer, capture_cube, capture_distance_cube, capture_inverse_depths, capture_mirror_cube, focus, mirror_box,
    museum, reflectors,
};
use lf_tests::{capture, gpu, museum, packed};

const SIZE: u32 = 512;

fn cameras() -> Vec<Pinhole> {
    let eyes = [Vec3::new(1.5, 0.4, 0.2), Vec3::new(-0.7, 0.8, 1.2), Vec3::new(0.3, -0.9, -1.3)];
    eyes.map(|eye| Pinhole::look_at(eye, Vec3::ZERO, 0.7, SIZE, SIZE).expect("a camera")).to_vec()
}

/// Mirrors, and how far 99.9 % of their pixels may be apart: on the teapot's creases neighbouring rays part, by rounding of its normals.
fn mirrors() -> [(&'static str, TriangleMesh, u8); 2] {
    [
        ("sphere", reflectors::sphere(5).fitted(Vec3::ZERO, 0.45).expect("fits"), 4),
        ("teapot", reflectors::teapot(10).fitted(Vec3::ZERO, 0.48).expect("fits"), 10),
    ]
}

/// How two pictures of a mirror agree.
struct Agreement {
    /// Share of all pixels whose channels agree within 2/255.
    all: f64,
    /// The same share of the pixels that the mirror covers in either picture.
    covered: f64,
    /// Pixels that only one picture covers.
    outline: usize,
    /// Largest difference of a channel where both cover, and that which one pixel in a thousand of those exceeds.
    worst: u8,
    high: u8,
}

fn agreement(a: &Image<[u8; 4]>, b: &Image<[u8; 4]>) -> Agreement {
    let (mut apart, mut covered, mut outline, mut inside) = (0usize, 0usize, 0, vec![0]);
    for (a, b) in a.texels().iter().zip(b.texels()).filter(|(a, b)| a[3] != 0 || b[3] != 0) {
        let difference = (0..4).map(|c| a[c].abs_diff(b[c])).max().unwrap_or(0);
        covered += 1;
        apart += usize::from(difference > 2);
        if a[3] == b[3] {
            inside.push(difference);
        } else {
            outline += 1;
        }
    }
    let share = |of: usize| 1.0 - apart as f64 / of as f64;
    inside.sort_unstable();
    let (worst, high) = (inside[inside.len() - 1], inside[(inside.len() - 1) * 999 / 1000]);
    Agreement { all: share(a.texels().len()), covered: share(covered), outline, worst, high }
}

/// `covered` is the least share of the mirror's own pixels that have to agree; of all pixels 99.9 % have to.
fn compare(gpu: &Gpu, what: &str, pass: &ReflectionPass, twin: &impl Environment, covered: f64) {
    compare_with(gpu, what, pass, twin, [0.999, covered], 1);
}

/// The same with the shares of all pixels and of the mirror's, and so many times as far apart.
fn compare_with(
    gpu: &Gpu,
    what: &str,
    pass: &ReflectionPass,
    twin: &impl Environment,
    [all, covered]: [f64; 2],
    times: u8,
) {
    for (name, mesh, apart) in mirrors() {
        let device_mesh = MirrorMesh::new(gpu, &mesh).expect("uploads");
        let target = Target::new(gpu, SIZE, SIZE).expect("a target");
        for (eye, camera) in cameras().iter().enumerate() {
            pass.draw(gpu, &target, &device_mesh, camera).expect("draws");
            let drawn = target.read(gpu).expect("reads");
            let expected = reflect_frame(&GBuffer::rasterize(&mesh, camera), twin);
            let found = agreement(&drawn, &expected);
            println!(
                "{what}, {name}, eye {eye}: within 2/255 {:.4} % of all pixels, {:.4} % of the mirror's; 99.9 % within {}, worst {}, {} on the outline",
                100.0 * found.all,
                100.0 * found.covered,
                found.high,
                found.worst,
                found.outline
            );
            assert!(found.all >= all && found.high <= times * apart, "{what}, {name}, eye {eye}");
            // What is left lies on creases, where neighbouring rays part, and on the outline.
            assert!(found.covered >= covered && found.outline <= 40, "{what}, {name}, eye {eye}");
        }
    }
}

/// BC1 blocks as they are, or decoded.
const FOR_BLOCKS: [Storage; 3] = [Storage::Bc1Volume, Storage::Bc1Array, Storage::Rgba8Array];

fn compare_slabs<T: Texel>(gpu: &Gpu, what: &str, field: &PackedLightField, storage: Storage, twin: &SlabField<T>) {
    let texture = SlabTexture::with_storage(gpu, field, storage).expect("uploads");
    let pass = ReflectionPass::slabs(gpu, &texture).expect("a pass");
    compare(gpu, &format!("{what}, {storage}"), &pass, twin, 0.999);
}

fn twin(field: &PackedLightField) -> SlabField {
    SlabField::new(field.geometry().clone(), field.decode(1 << 30).expect("decodes")).expect("a field")
}

#[test]
fn slabs_agree_within_two_steps_on_999_of_1000_pixels() {
    let (gpu, tracer) = (gpu(), museum());
    let field = packed(&capture(&tracer, 10, 48));
    for storage in FOR_BLOCKS {
        compare_slabs(&gpu, "whole", &field, storage, &twin(&field));
    }
}

/// Windows take less of the device's memory, and change no picture by more than rounding.
#[test]
fn cropped_slabs_agree_with_the_whole_ones() {
    let (gpu, tracer) = (gpu(), museum());
    let field = packed(&capture(&tracer, 10, 48));
    let cropped = field.cropped().expect("crops");
    let texels = |field: &PackedLightField| field.layout().size().map(u64::from).iter().product::<u64>();
    assert!(3 * texels(&cropped) < 2 * texels(&field), "{:?}, {:?}", cropped.layout().size(), field.layout().size());
    for storage in FOR_BLOCKS {
        compare_slabs(&gpu, "cropped", &cropped, storage, &twin(&field));
    }
}

/// Where cameras are missing both sides make up for them by the others.
#[test]
fn slabs_with_missing_cameras_agree() {
    let (gpu, tracer) = (gpu(), museum());
    let mut capture = capture(&tracer, 10, 48);
    for (slab, texels) in capture.geometry.slabs().iter().zip(&mut capture.texels) {
        // One in five, never two beside each other.
        let kept = (0..100).map(|camera| (camera % 10 + 2 * (camera / 10)) % 5 != 0).collect();
        let coverage = Coverage::of_cell(slab, capture.geometry.cell()).aligned(4).with_cameras(kept).expect("a mask");
        *texels = texels.crop(coverage).expect("crops");
    }
    let field = packed(&capture);
    compare_slabs(&gpu, "masked", &field, Storage::Bc1Volume, &twin(&field));
}

#[test]
fn linear_slabs_agree_within_two_steps_on_999_of_1000_pixels() {
    let (gpu, tracer) = (gpu(), museum());
    let capture = capture(&tracer, 10, 48);
    let linear = |slab: (&Slab, &SlabTexels)| {
        let texel = |texel: &[u8; 4]| {
            // Up to twice the brightness that can be shown.
            let value = |c: usize| f16::from_f32(2.0 * linear_from_srgb(f32::from(texel[c]) / 255.0));
            [value(0), value(1), value(2)]
        };
        SlabTexels::new(slab.0, slab.1.texels().iter().map(texel).collect()).expect("texels")
    };
    let texels: Vec<_> = capture.geometry.slabs().iter().zip(&capture.texels).map(linear).collect();
    let field = PackedLightField::encode_linear(capture.geometry.clone(), &texels).expect("encodes");
    let decoded = field.decode_linear(1 << 30).expect("decodes");
    assert_eq!(decoded, texels);
    let twin = SlabField::new(field.geometry().clone(), decoded).expect("a field");
    compare_slabs(&gpu, "linear", &field, Storage::Rgba16FArray, &twin);
}

#[test]
fn environment_maps_agree_within_two_steps_on_999_of_1000_pixels() {
    let (gpu, tracer) = (gpu(), museum());
    let cube = capture_cube(&tracer, &museum::cell(), 128, 2).expect("a cube map");
    let pass = ReflectionPass::environment(&gpu, &cube).expect("a pass");
    compare(&gpu, "environment map", &pass, &CubeField::new(&cube), 0.998);
}

/// A distance cube off the cell's centre, its depths half floats, as the device has them.
fn distance_cube() -> DistanceCube {
    let at = Vec3::new(0.1, -0.2, 0.15);
    let cube = capture_distance_cube(&museum(), &museum::cell(), at, [128, 256], 2).expect("a cube");
    let half = |face: Image<f32>| face.map(|inverse: f32| f16::from_f32(inverse).to_f32());
    DistanceCube::new(at, cube.radiance().clone(), cube.inverse_depths().clone().map(half)).expect("a cube")
}

#[test]
fn projected_maps_agree_within_two_steps_on_999_of_1000_pixels() {
    let (gpu, cube) = (gpu(), distance_cube());
    let (map, center) = (CubeField::new(cube.radiance()), cube.position());
    let sphere = ReflectionPass::proxy(&gpu, cube.radiance(), center, Proxy::Sphere(3.0)).expect("a pass");
    compare(&gpu, "sphere-projected map", &sphere, &SphereCube::new(map.clone(), center, 3.0), 0.998);
    let corners = cube.median_box();
    let walls = ReflectionPass::proxy(&gpu, cube.radiance(), center, Proxy::Box(corners)).expect("a pass");
    compare(&gpu, "box-projected map", &walls, &BoxCube::new(map, center, corners), 0.998);
}

/// A search is a chain of decisions; where one falls the other way the picture jumps. Those are few.
#[test]
fn distance_cubes_agree_within_two_steps_on_999_of_1000_pixels() {
    let (gpu, cube) = (gpu(), distance_cube());
    for (what, search) in [
        ("distance cube, fixed point", Search::FixedPoint(4)),
        ("distance cube, march", Search::March { steps: 48, halvings: 6 }),
    ] {
        let pass = ReflectionPass::distance_cube(&gpu, &cube, search).expect("a pass");
        compare(&gpu, what, &pass, &DistanceField::new(cube.clone(), search), 0.99);
    }
}

/// BC1 colours and blocks of depths on the device, against the CPU's decoded ones.
#[test]
fn packed_cubes_agree_within_two_steps_on_999_of_1000_pixels() {
    let gpu = gpu();
    let packed = PackedCube::encode(&distance_cube(), Quality::Standard).expect("encodes");
    let cube = packed.decode().expect("decodes");
    let (map, center) = (CubeField::new(cube.radiance()), cube.position());
    assert_eq!(CubePicture::from(&packed).bytes(&gpu), 6 * 128 * 128 / 2);
    let plain = ReflectionPass::environment(&gpu, &packed).expect("a pass");
    compare(&gpu, "environment map, BC1", &plain, &map, 0.998);
    let sphere = ReflectionPass::proxy(&gpu, &packed, center, Proxy::Sphere(3.0)).expect("a pass");
    compare(&gpu, "sphere-projected map, BC1", &sphere, &SphereCube::new(map, center, 3.0), 0.998);
    for search in [Search::FixedPoint(4), Search::March { steps: 48, halvings: 6 }] {
        let pass = ReflectionPass::packed_distance_cube(&gpu, &packed, search).expect("a pass");
        compare(&gpu, "distance cube in blocks", &pass, &DistanceField::new(cube.clone(), search), 0.99);
    }
}

/// Without BC1, or with faces that are no whole blocks, the texels are decoded first.
#[test]
fn packed_cubes_that_cannot_stay_blocks_are_decoded() {
    let plain = Gpu::with_options(&DeviceOptions { blocks: false, ..DeviceOptions::default() }).expect("a device");
    for (gpu, size) in [(plain, 128), (gpu(), 126)] {
        let cube = capture_distance_cube(&museum(), &museum::cell(), Vec3::ZERO, [size, 62], 1).expect("a cube");
        let packed = PackedCube::encode(&cube, Quality::Standard).expect("encodes");
        let cube = packed.decode().expect("decodes");
        assert_eq!(CubePicture::from(&packed).bytes(&gpu), 4 * 6 * u64::from(size).pow(2));
        let pass = ReflectionPass::environment(&gpu, &packed).expect("a pass");
        compare(&gpu, "environment map, decoded", &pass, &CubeField::new(cube.radiance()), 0.998);
        let search = Search::FixedPoint(4);
        let pass = ReflectionPass::packed_distance_cube(&gpu, &packed, search).expect("a pass");
        compare(&gpu, "distance cube, odd sizes", &pass, &DistanceField::new(cube, search), 0.99);
    }
}

/// Cubes at the corners of a smaller cell, encoded.
fn packed_cubes(places: &[[f32; 3]], size: u32) -> Vec<PackedCube> {
    let cube = |place: &[f32; 3]| {
        let at = 0.8 * Vec3::from(*place) * museum::cell().half_extent();
        let cube = capture_distance_cube(&museum(), &museum::cell(), at, [size; 2], 1).expect("a cube");
        PackedCube::encode(&cube, Quality::Standard).expect("encodes")
    };
    places.iter().map(cube).collect()
}

/// A device that samples BC1 and whole blocks, and one that does not and faces that are no whole blocks of either kind.
fn devices_and_sizes() -> [(Gpu, u32); 2] {
    let plain = Gpu::with_options(&DeviceOptions { blocks: false, ..DeviceOptions::default() }).expect("a device");
    [(gpu(), 128), (plain, 90)]
}

/// What a pass takes beside pictures and depths: positions, scales and uniforms.
const TABLES: u64 = 1000;

/// What is apart is where a step of the search or the choice of the cube goes one way here and the other there, by rounding: at edges of things, and
/// on the teapot's creases.
#[test]
fn probes_agree_within_two_steps_on_999_of_1000_pixels() {
    let corners: Vec<_> = (0..8).map(|i| [1, 2, 4].map(|bit| if i & bit == 0 { -1.0 } else { 1.0 })).collect();
    for (gpu, size) in devices_and_sizes() {
        let packed = packed_cubes(&corners, size);
        let cubes = packed.iter().map(|cube| cube.decode().expect("decodes")).collect();
        let pass = ReflectionPass::probes(&gpu, &packed, 48, 6).expect("a pass");
        let twin = ProbeField::new(cubes, 48, 6).expect("eight");
        compare(&gpu, &format!("8 distance cubes of {size}²"), &pass, &twin, 0.997);
        if CubePicture::from(&packed[0]).stays_blocks(&gpu) {
            let blocks: usize = packed.iter().map(PackedCube::bytes).sum();
            assert!((blocks as u64..blocks as u64 + TABLES).contains(&pass.bytes()), "{}", pass.bytes());
        }
    }
}

/// Something so far away that its inverse is lost beside that of what is near: the last step used to lead beyond infinity, to nothing.
#[test]
fn probes_agree_on_what_is_far_away() {
    let gpu = gpu();
    let farther = |cube: &PackedCube| {
        let cube = cube.decode().expect("decodes");
        let mut depths = cube.inverse_depths().clone();
        depths[0] = Image::filled(64, 64, 1e-9);
        let cube = DistanceCube::new(cube.position(), cube.radiance().clone(), depths).expect("a cube");
        PackedCube::encode(&cube, Quality::Standard).expect("encodes")
    };
    let packed: Vec<_> = packed_cubes(&[[-1.0; 3], [1.0; 3]], 64).iter().map(farther).collect();
    let cubes = packed.iter().map(|cube| cube.decode().expect("decodes")).collect();
    let pass = ReflectionPass::probes(&gpu, &packed, 48, 6).expect("a pass");
    compare(&gpu, "distance cubes and what is far away", &pass, &ProbeField::new(cubes, 48, 6).expect("two"), 0.997);
}

fn guide() -> DepthGuide {
    let tracer = museum();
    let geometry = LightFieldGeometry::around(museum::cell(), PlanePlacement::CellCenter, 5, 24).expect("slabs");
    let geometry = focus(&tracer, &geometry).expect("focal planes");
    let depths = capture_inverse_depths(&tracer, &geometry).expect("depths");
    DepthGuide::new(geometry, &depths).expect("whole slabs")
}

const CENTER_AND_CORNERS: [[f32; 3]; 5] =
    [[0.0; 3], [1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];

fn guided_cubes(size: u32) -> GuidedCubes {
    GuidedCubes::new(packed_cubes(&CENTER_AND_CORNERS, size), guide()).expect("five")
}

/// As with probes; where the search ends elsewhere, so do the votes of all cubes.
#[test]
fn guided_cubes_agree_within_two_steps_on_999_of_1000_pixels() {
    for (gpu, size) in devices_and_sizes() {
        let data = guided_cubes(size);
        let pass = ReflectionPass::guided(&gpu, &data).expect("a pass");
        compare(&gpu, &format!("guided cubes of {size}²"), &pass, &GuidedField::new(&data), 0.996);
        if CubePicture::from(&data.cubes()[0]).stays_blocks(&gpu) {
            let stored = data.bytes() as u64;
            assert!((stored..stored + TABLES).contains(&pass.bytes()), "{} {stored}", pass.bytes());
        }
    }
}

fn guided_cubes_with_mirrors() -> GuidedCubes {
    let (tracer, cell) = (Tracer::new(mirror_box::scene()), mirror_box::cell());
    let geometry = LightFieldGeometry::around(cell, PlanePlacement::CellCenter, 5, 24).expect("slabs");
    let geometry = focus(&tracer, &geometry).expect("focal planes");
    let depths = capture_inverse_depths(&tracer, &geometry).expect("depths");
    let guide = DepthGuide::new(geometry, &depths).expect("whole slabs");
    let cube = |place: [f32; 3]| {
        let at = 0.8 * Vec3::from(place) * cell.half_extent();
        let cube = capture_mirror_cube(&tracer, &cell, at, 128, 1).expect("a cube");
        PackedCube::encode(&cube, Quality::Standard).expect("encodes")
    };
    GuidedCubes::new(CENTER_AND_CORNERS.map(cube).to_vec(), guide).expect("five")
}

/// Each curved mirror takes rays that are off by their last bits apart, some twenty times: more pixels differ, most where one shows another.
#[test]
fn guided_cubes_that_show_mirrors_agree_within_two_steps_on_97_of_100_pixels() {
    let (gpu, data) = (gpu(), guided_cubes_with_mirrors());
    assert!(data.cubes().iter().all(PackedCube::has_mirrors));
    let pass = ReflectionPass::guided(&gpu, &data).expect("a pass");
    compare_with(&gpu, "guided cubes that show mirrors", &pass, &GuidedField::new(&data), [0.996, 0.97], 6);
    let stored = data.bytes() as u64;
    assert!((stored..stored + TABLES).contains(&pass.bytes()), "{} {stored}", pass.bytes());
}

/// An environment that is asked for rays which differ from those meant by their last bits.
struct Shaken<'a>(&'a dyn Environment);

impl Environment for Shaken<'_> {
    fn look_up(&self, ray: &Ray) -> Option<Vec3> {
        let shake = Vec3::new(1.0 + f32::EPSILON, 1.0 - f32::EPSILON, 1.0);
        self.0.look_up(&Ray { origin: ray.origin * shake, direction: ray.direction * shake.yzx() })
    }
}

/// What GPU and CPU do not agree on is decided by rounding: the CPU disagrees with itself about nearly as much when rays are off by
/// their last bits.
#[test]
fn guided_cubes_differ_by_rounding_only() {
    let (gpu, data) = (gpu(), guided_cubes(128));
    let (pass, twin) = (ReflectionPass::guided(&gpu, &data).expect("a pass"), GuidedField::new(&data));
    let ([(_, sphere, _), _], camera) = (mirrors(), &cameras()[0]);
    let buffer = GBuffer::rasterize(&sphere, camera);
    let expected = reflect_frame(&buffer, &twin);
    let target = Target::new(&gpu, SIZE, SIZE).expect("a target");
    pass.draw(&gpu, &target, &MirrorMesh::new(&gpu, &sphere).expect("uploads"), camera).expect("draws");
    let other = |picture: &Image<[u8; 4]>| 1.0 - agreement(picture, &expected).covered;
    let drawn = other(&target.read(&gpu).expect("reads"));
    let shaken = other(&reflect_frame(&buffer, &Shaken(&twin)));
    println!("apart: {:.4} % of the mirror's pixels, of shaken rays {:.4} %", 100.0 * drawn, 100.0 * shaken);
    assert!(shaken > 0.0 && drawn < 3.0 * shaken, "{drawn} {shaken}");
}

#[test]
fn probes_must_be_there_and_of_one_size() {
    let gpu = gpu();
    let [small, large] = [8, 16].map(|size| packed_cubes(&[[0.0; 3]], size).remove(0));
    for cubes in [&[][..], &[small, large]] {
        assert!(matches!(ReflectionPass::probes(&gpu, cubes, 8, 8), Err(GpuError::Geometry(_))));
    }
}

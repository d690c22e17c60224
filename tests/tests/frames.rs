//! Whole frames from slabs on the GPU and the CPU: views, two passes, several tinted reflectors, backgrounds.

use glam::{Quat, Vec3};
use half::f16;
use lf_compress::PackedLightField;
use lf_gpu::{Frame, Gpu, MirrorMesh, NormalMapTexture, SceneMesh, SlabRenderer, SlabTexture, StuvBuffer, Target};
use lf_ibr::{Behind, SlabField, Texel, draw_frame};
use lf_math::{
    Image, LightFieldGeometry, LitMesh, NormalMap, Pinhole, Placement, Reflectance, SampledAxis, Slab, SlabTexels,
    TriangleMesh, View, linear_from_srgb, srgb8_from_linear,
};
use lf_scene::{Capture, Tracer, rasterised, reference, reflectors};
use lf_tests::{capture, gpu, museum, packed};

const SIZE: u32 = 384;

/// A mesh of ours, where it stands, what it reflects.
#[derive(Clone)]
struct Mirror {
    mesh: TriangleMesh,
    placement: Placement,
    reflectance: Reflectance,
    normal_map: Option<NormalMap>,
}

/// Three mirrors that hide parts of each other: a plain one, one of gold, one of hammered glass.
fn mirrors() -> Vec<Mirror> {
    let place = |scale, turn: f32, at| Placement::new(scale, Quat::from_rotation_y(turn), at).expect("a placement");
    let gold = Reflectance::new(Vec3::new(1.0, 0.77, 0.34), None).expect("shares");
    let glass = Reflectance::new(Vec3::ONE, Some(0.04)).expect("shares");
    let (ball, pot) = (reflectors::sphere(5), reflectors::teapot(10).fitted(Vec3::ZERO, 1.0).expect("fits"));
    let mirror = |mesh: &TriangleMesh, placement, reflectance, normal_map| Mirror {
        mesh: mesh.clone(),
        placement,
        reflectance,
        normal_map,
    };
    vec![
        mirror(&ball, place(0.2, 0.0, Vec3::new(0.2, 0.1, 0.0)), Reflectance::MIRROR, None),
        mirror(&pot, place(0.25, 2.0, Vec3::new(-0.15, -0.1, 0.1)), gold, None),
        mirror(&ball, place(0.15, 0.7, Vec3::new(0.1, -0.15, 0.25)), glass, Some(waves())),
    ]
}

/// Waves of a 16th of a metre in the mesh's own space, up to 11° steep.
fn waves() -> NormalMap {
    let texel = |i: u32| {
        let phase = |n: u32| (std::f32::consts::TAU * (n as f32 + 0.5) / 32.0).cos();
        let normal = Vec3::new(0.2 * phase(i % 32), 0.2 * phase(i / 32), 1.0).normalize();
        let [x, y, z] = normal.to_array().map(|c| ((0.5 * c + 0.5) * 255.0).round() as u8);
        [x, y, z, 255]
    };
    NormalMap::new(Image::new(32, 32, (0..32 * 32).map(texel).collect()).expect("a picture"), 2.0).expect("a map")
}

fn bare(mirrors: &[Mirror]) -> Vec<Mirror> {
    mirrors.iter().map(|mirror| Mirror { reflectance: Reflectance::MIRROR, ..mirror.clone() }).collect()
}

/// One eye outside, one inside the cell.
fn cameras() -> [Pinhole; 2] {
    let look = |eye, fov| Pinhole::look_at(eye, Vec3::ZERO, fov, SIZE, SIZE).expect("a camera");
    [look(Vec3::new(0.9, 0.5, 1.0), 0.7), look(Vec3::new(0.45, 0.3, 0.48), 1.4)]
}

/// Meshes and normal maps on the device.
fn uploaded(gpu: &Gpu, mirrors: &[Mirror]) -> Vec<(MirrorMesh, Option<NormalMapTexture>)> {
    let upload = |mirror: &Mirror| {
        let map = mirror.normal_map.as_ref().map(|map| NormalMapTexture::new(gpu, map).expect("uploads"));
        (MirrorMesh::new(gpu, &mirror.mesh).expect("uploads"), map)
    };
    mirrors.iter().map(upload).collect()
}

fn placed<'a>(
    uploaded: &'a [(MirrorMesh, Option<NormalMapTexture>)],
    mirrors: &[Mirror],
) -> Vec<lf_gpu::Reflector<'a>> {
    let reflector = |((mesh, map), mirror): (&'a (MirrorMesh, Option<NormalMapTexture>), &Mirror)| lf_gpu::Reflector {
        mesh,
        placement: mirror.placement,
        reflectance: mirror.reflectance,
        normal_map: map.as_ref(),
    };
    uploaded.iter().zip(mirrors).map(reflector).collect()
}

/// The CPU's picture.
fn expected<T: Texel>(
    field: &SlabField<T>,
    mirrors: &[Mirror],
    behind: Behind<'_>,
    view: View,
    camera: &Pinhole,
) -> Image<[u8; 4]> {
    let mut reflectors = vec![];
    for Mirror { mesh, placement, reflectance, normal_map } in mirrors {
        let (placement, reflectance, normal_map) = (*placement, *reflectance, normal_map.as_ref());
        reflectors.push(lf_ibr::Reflector { mesh, placement, reflectance, normal_map });
    }
    draw_frame(&reflectors, behind, &field.viewed(view), camera).expect("draws")
}

/// Differences of a channel over the pixels that both cover.
struct Differences {
    max: u8,
    p999: u8,
    p99: u8,
}

/// Measures and prints them.
fn differences(what: &str, a: &Image<[u8; 4]>, b: &Image<[u8; 4]>) -> Differences {
    let both = a.texels().iter().zip(b.texels()).filter(|(a, b)| a[3] != 0 && b[3] != 0);
    let mut all: Vec<u8> = both.map(|(a, b)| (0..3).map(|c| a[c].abs_diff(b[c])).max().unwrap_or(0)).collect();
    let outline = a.texels().iter().zip(b.texels()).filter(|(a, b)| a[3] != b[3]).count();
    all.sort_unstable();
    let at = |share: f64| all[((all.len() - 1) as f64 * share) as usize];
    let found = Differences { max: at(1.0), p999: at(0.999), p99: at(0.99) };
    let Differences { max, p999, p99 } = found;
    println!("{what}: {} pixels, max {max}/255, p99.9 {p999}/255, p99 {p99}/255, {outline} on the outline", all.len());
    assert!(all.len() > 10_000 && outline <= 40, "{what}");
    found
}

/// Draws on the GPU in every view, from both eyes, with and without background, and compares.
fn compare<T: Texel>(what: &str, field: &PackedLightField, twin: &SlabField<T>, mirrors: &[Mirror]) {
    let gpu = gpu();
    let texture = SlabTexture::new(&gpu, field).expect("uploads");
    let mut renderer = SlabRenderer::new(&gpu, &texture).expect("a renderer");
    let target = Target::new(&gpu, SIZE, SIZE).expect("a target");
    let meshes = uploaded(&gpu, mirrors);
    let reflectors = placed(&meshes, mirrors);
    for (eye, camera) in cameras().iter().enumerate() {
        for (view, background) in View::ALL.into_iter().flat_map(|view| [(view, false), (view, true)]) {
            let behind = if background { lf_gpu::Behind::Slabs } else { lf_gpu::Behind::Nothing };
            let frame = Frame { camera, reflectors: &reflectors, behind, view };
            renderer.draw(&target, &frame).expect("draws");
            // Views do not heed reflectances.
            let shown = if view == View::Color { mirrors.to_vec() } else { bare(mirrors) };
            let behind = if background { Behind::Environment } else { Behind::Nothing };
            let twin = expected(twin, &shown, behind, view, camera);
            let label = format!("{what}, {view:?}, eye {eye}, background {background}");
            let found = differences(&label, &target.read(&gpu).expect("reads"), &twin);
            // What is left lies on creases of the teapot, where neighbouring rays part, and where slabs meet.
            assert!(found.p99 <= 1 && found.p999 <= 3, "{label}");
        }
    }
}

fn twin(field: &PackedLightField) -> SlabField {
    SlabField::new(field.geometry().clone(), field.decode(1 << 30).expect("decodes")).expect("a field")
}

/// The museum's slabs, with focal planes.
fn focused() -> Capture {
    let mut capture = capture(&museum(), 10, 48);
    let slabs = capture.geometry.slabs().iter().map(|slab| slab.with_focal_depth(Some(3.0)).expect("a slab")).collect();
    capture.geometry = LightFieldGeometry::new(*capture.geometry.cell(), slabs).expect("slabs");
    capture
}

#[test]
fn frames_of_several_mirrors_agree_in_all_views() {
    let field = packed(&focused());
    compare("six slabs", &field, &twin(&field), &mirrors());
}

#[test]
fn frames_from_one_slab_agree_in_all_views() {
    let capture = capture(&museum(), 10, 48);
    let one = vec![capture.geometry.slabs()[5]];
    let geometry = LightFieldGeometry::new(*capture.geometry.cell(), one).expect("a slab");
    let field = packed(&Capture { geometry, texels: vec![capture.texels[5].clone()], ..capture });
    compare("one slab", &field, &twin(&field), &mirrors());
}

/// Light brighter than can be shown is tinted before it is clipped.
#[test]
fn frames_from_linear_slabs_agree_in_all_views() {
    let capture = capture(&museum(), 10, 48);
    let linear = |(slab, texels): (&Slab, &SlabTexels)| {
        let value = |byte: u8| f16::from_f32(3.0 * linear_from_srgb(f32::from(byte) / 255.0));
        let texel = |texel: &[u8; 4]| [value(texel[0]), value(texel[1]), value(texel[2])];
        SlabTexels::new(slab, texels.texels().iter().map(texel).collect()).expect("texels")
    };
    let texels: Vec<_> = capture.geometry.slabs().iter().zip(&capture.texels).map(linear).collect();
    let field = PackedLightField::encode_linear(capture.geometry.clone(), &texels).expect("encodes");
    let twin = SlabField::new(capture.geometry, texels).expect("a field");
    compare("linear slabs", &field, &twin, &mirrors());
}

/// The paper's own form: the same picture, and the buffer holds what `lf-math` says.
#[test]
fn two_passes_draw_what_one_does() {
    let (gpu, field) = (gpu(), packed(&focused()));
    let texture = SlabTexture::new(&gpu, &field).expect("uploads");
    let mut renderer = SlabRenderer::new(&gpu, &texture).expect("a renderer");
    let (target, stuv) =
        (Target::new(&gpu, SIZE, SIZE).expect("a target"), StuvBuffer::new(&gpu, SIZE, SIZE).expect("a buffer"));
    let mirrors = bare(&mirrors());
    let meshes = uploaded(&gpu, &mirrors);
    let reflectors = placed(&meshes, &mirrors);
    for camera in &cameras() {
        for view in View::ALL {
            let frame = Frame { camera, reflectors: &reflectors, behind: lf_gpu::Behind::Slabs, view };
            renderer.draw(&target, &frame).expect("draws");
            let one = target.read(&gpu).expect("reads");
            renderer.ask(&stuv, &frame).expect("asks");
            renderer.answer(&stuv, &target, view).expect("draws");
            let found = differences(&format!("two passes, {view:?}"), &one, &target.read(&gpu).expect("reads"));
            assert!(found.max <= 1, "{view:?}");
        }
    }
    // Pixels of the background, by the view ray alone; the last camera is the one whose eye is inside.
    let camera = cameras()[1];
    let frame = Frame { camera: &camera, reflectors: &[], behind: lf_gpu::Behind::Slabs, view: View::Color };
    renderer.ask(&stuv, &frame).expect("asks");
    let asked = stuv.read(&gpu).expect("reads");
    for (x, y) in (0..SIZE).step_by(7).flat_map(|y| (0..SIZE).step_by(5).map(move |x| (x, y))) {
        let indexed = field.geometry().index_ray(&camera.ray(x, y)).expect("six slabs");
        let coord = indexed.coord.st.extend(indexed.coord.uv.x).extend(indexed.coord.uv.y).to_array();
        // Where two faces meet either may answer.
        let near = |found: [f32; 4]| found.iter().zip(coord).all(|(a, b)| (a - b).abs() < 2e-4 * 48.0);
        let d = camera.ray(x, y).direction.abs().to_array();
        let largest = d.into_iter().fold(0.0, f32::max);
        let tie = d.iter().filter(|c| **c > 0.9999 * largest).count() > 1;
        assert!(near(asked.get(x, y)) || tie, "{x} {y}: {:?} {coord:?}", asked.get(x, y));
    }
    let tinted = [lf_gpu::Reflector { reflectance: Reflectance::new(Vec3::X, None).expect("shares"), ..reflectors[0] }];
    let tinted = Frame { reflectors: &tinted, ..frame };
    assert!(renderer.ask(&stuv, &tinted).is_err());
    let scene =
        SceneMesh::new(&gpu, &rasterised(&museum(), field.geometry().cell(), 10.0).expect("cut")).expect("uploads");
    assert!(renderer.ask(&stuv, &Frame { behind: lf_gpu::Behind::Scene(&scene), ..frame }).is_err());
}

/// The paper's slabs hold every ray of a mirror inside the cell, from any eye; shrunken ones do not, and say so.
#[test]
fn rays_outside_the_slabs_are_painted() {
    let gpu = gpu();
    let painted = |capture: &Capture| {
        let texture_of = packed(capture);
        let texture = SlabTexture::new(&gpu, &texture_of).expect("uploads");
        let mut renderer = SlabRenderer::new(&gpu, &texture).expect("a renderer");
        let target = Target::new(&gpu, SIZE, SIZE).expect("a target");
        let mirrors = mirrors();
        let meshes = uploaded(&gpu, &mirrors);
        let frame = Frame {
            camera: &cameras()[0],
            reflectors: &placed(&meshes, &mirrors),
            behind: lf_gpu::Behind::Nothing,
            view: View::Range,
        };
        renderer.draw(&target, &frame).expect("draws");
        target.read(&gpu).expect("reads").texels().iter().filter(|texel| **texel == [255, 0, 255, 255]).count()
    };
    let paper = capture(&museum(), 10, 48);
    assert_eq!(painted(&paper), 0);
    let shrunken = |slab: &Slab| {
        let half = paper.geometry.cell().half_extent().x;
        let st = SampledAxis::spanning(-half, half, 10).expect("an axis");
        Slab::new(slab.face(), slab.plane(), [st, st], slab.uv(), None).expect("a slab")
    };
    let slabs = paper.geometry.slabs().iter().map(shrunken).collect();
    let geometry = LightFieldGeometry::new(*paper.geometry.cell(), slabs).expect("slabs");
    assert!(painted(&Capture { geometry, ..paper }) > 1000);
}

/// The museum's own triangles behind the mirrors, and in front of them.
fn museum_triangles() -> LitMesh {
    rasterised(&museum(), &lf_scene::museum::cell(), 0.25).expect("triangles")
}

/// Eyes outside the cell that look past a column, and one inside.
fn eyes_in_the_room() -> [Pinhole; 3] {
    let look = |eye, fov| Pinhole::look_at(eye, Vec3::ZERO, fov, SIZE, SIZE).expect("a camera");
    // The column's middle is 2.1 m from the cell's, at π/8; it hides half of what is in the cell.
    let angle = std::f32::consts::PI / 8.0 + 0.083;
    let beside = Vec3::new(angle.cos(), 0.0, angle.sin()) * 3.2;
    [look(beside, 0.4), look(Vec3::new(-1.0, 1.3, 4.0), 0.9), look(Vec3::new(0.45, 0.3, 0.48), 1.4)]
}

#[test]
fn frames_with_the_scenes_triangles_agree() {
    let (gpu, field) = (gpu(), packed(&focused()));
    let texture = SlabTexture::new(&gpu, &field).expect("uploads");
    let mut renderer = SlabRenderer::new(&gpu, &texture).expect("a renderer");
    let target = Target::new(&gpu, SIZE, SIZE).expect("a target");
    let (mirrors, geometry, twin) = (mirrors(), museum_triangles(), twin(&field));
    let scene = SceneMesh::new(&gpu, &geometry).expect("uploads");
    let meshes = uploaded(&gpu, &mirrors);
    let reflectors = placed(&meshes, &mirrors);
    for (eye, camera) in eyes_in_the_room().iter().enumerate() {
        for count in [mirrors.len(), 0] {
            let behind = lf_gpu::Behind::Scene(&scene);
            let frame = Frame { camera, reflectors: &reflectors[..count], behind, view: View::Color };
            renderer.draw(&target, &frame).expect("draws");
            let expected = expected(&twin, &mirrors[..count], Behind::Scene(&geometry), View::Color, camera);
            let label = format!("the scene's triangles, eye {eye}, {count} mirrors");
            let found = differences(&label, &target.read(&gpu).expect("reads"), &expected);
            assert!(found.p99 <= 1 && found.p999 <= 3, "{label}");
            assert!(expected.texels().iter().all(|texel| texel[3] == 255), "the room is closed");
        }
    }
}

/// Away from the edges of patterns and shadows the light is the ray tracer's.
#[test]
fn the_scenes_triangles_look_as_they_are_traced() {
    let (tracer, geometry) = (museum(), museum_triangles());
    let field = twin(&packed(&focused()));
    for camera in &eyes_in_the_room() {
        let drawn = expected(&field, &[], Behind::Scene(&geometry), View::Color, camera);
        let traced = reference::background(&tracer, &lf_scene::museum::cell(), camera).map(srgb8_from_linear);
        let pairs = drawn.texels().iter().zip(traced.texels());
        let mut apart: Vec<u8> = pairs.map(|(a, b)| (0..3).map(|c| a[c].abs_diff(b[c])).max().unwrap_or(0)).collect();
        apart.sort_unstable();
        let [half, most] = [0.5, 0.7].map(|share| apart[(apart.len() as f64 * share) as usize]);
        println!("half of the pixels are within {half}/255 of the traced ones, 70 % within {most}/255");
        assert!(half <= 1 && most <= 2, "{half} {most}");
    }
}

/// Where a ray tracer sees a mirror that stands in the museum, and how many more pixels would show it if nothing stood in front.
fn traced_mask(tracer: &Tracer, mirror: &reference::Mirror, camera: &Pinhole) -> (Image<bool>, usize) {
    let (cell, mut hidden) = (lf_scene::museum::cell(), 0);
    let mut mask = Image::filled(SIZE, SIZE, false);
    for (i, seen) in (0..SIZE * SIZE).zip(mask.texels_mut()) {
        let ray = camera.ray(i % SIZE, i / SIZE);
        let Some(reflected) = mirror.reflected(&ray) else { continue };
        let depth = (reflected.origin - ray.origin).length() / ray.direction.length();
        let wall = tracer.distance(cell.world_from_cell(ray.origin).as_vec3(), ray.direction);
        *seen = wall.is_none_or(|wall| depth < wall);
        hidden += usize::from(!*seen);
    }
    (mask, hidden)
}

/// A black mirror shows where it is: the museum is nowhere black.
#[test]
fn a_column_hides_a_mirror_where_a_ray_tracer_says_so() {
    let (gpu, field, tracer) = (gpu(), packed(&focused()), museum());
    let texture = SlabTexture::new(&gpu, &field).expect("uploads");
    let mut renderer = SlabRenderer::new(&gpu, &texture).expect("a renderer");
    let target = Target::new(&gpu, SIZE, SIZE).expect("a target");
    let (geometry, camera) = (museum_triangles(), eyes_in_the_room()[0]);
    let mesh = reflectors::sphere(5).fitted(Vec3::ZERO, 0.4).expect("fits");
    let black = Reflectance::new(Vec3::ZERO, None).expect("shares");
    let mirrors = [Mirror { mesh: mesh.clone(), placement: Placement::IDENTITY, reflectance: black, normal_map: None }];
    let scene = SceneMesh::new(&gpu, &geometry).expect("uploads");
    let meshes = uploaded(&gpu, &mirrors);
    let behind = lf_gpu::Behind::Scene(&scene);
    let frame = Frame { camera: &camera, reflectors: &placed(&meshes, &mirrors), behind, view: View::Color };
    renderer.draw(&target, &frame).expect("draws");
    let drawn = [
        ("GPU", target.read(&gpu).expect("reads")),
        ("CPU", expected(&twin(&field), &mirrors, Behind::Scene(&geometry), View::Color, &camera)),
    ];
    let (mask, hidden) = traced_mask(&tracer, &reference::Mirror::new(mesh), &camera);
    let seen = mask.texels().iter().filter(|seen| **seen).count();
    assert!(seen > 5000 && hidden > 5000, "{seen} {hidden}");
    // Pixels whose neighbours are all alike.
    let inner = |x: u32, y: u32| (y - 1..=y + 1).all(|j| (x - 1..=x + 1).all(|i| mask.get(i, j) == mask.get(x, y)));
    for (device, picture) in drawn {
        let within = (1..SIZE - 1).flat_map(|y| (1..SIZE - 1).map(move |x| (x, y))).filter(|&(x, y)| inner(x, y));
        let wrong = within.filter(|&(x, y)| (picture.get(x, y) == [0, 0, 0, 255]) != mask.get(x, y)).count();
        assert_eq!(wrong, 0, "{device}");
    }
}

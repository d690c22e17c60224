//! The indices that the GPU works out where mirrors are seen at grazing angles, against those of the CPU.

use glam::{Vec2, Vec3};
use lf_gpu::{Behind, Frame, MirrorMesh, Reflector, SlabRenderer, SlabTexture, StuvBuffer};
use lf_ibr::GBuffer;
use lf_math::{
    Image, IndexedRay, LightFieldGeometry, Pinhole, Placement, Ray, Reflectance, TriangleMesh, View, normalized,
    reflect,
};
use lf_scene::reflectors;
use lf_tests::{capture, gpu, museum, packed};

const SIZE: u32 = 384;

/// A plate, and a ball, whose rim is seen at grazing angles from anywhere.
fn meshes() -> [TriangleMesh; 2] {
    let corners = [[-0.4, -0.4], [0.4, -0.4], [0.4, 0.4], [-0.4, 0.4]].map(|[x, z]| Vec3::new(x, 0.0, z));
    let plate = TriangleMesh::new(corners.to_vec(), vec![Vec3::Y; 4], vec![[0, 1, 2], [0, 2, 3]]).expect("a mesh");
    [plate, reflectors::sphere(5).fitted(Vec3::ZERO, 0.45).expect("fits")]
}

/// What the CPU says of the mirrored ray at a pixel.
fn indexed(geometry: &LightFieldGeometry, gbuffer: &GBuffer, [x, y]: [u32; 2]) -> Option<IndexedRay> {
    let fragment = gbuffer.fragments().get(x, y)?;
    let normal = normalized(fragment.normal)?;
    geometry
        .index_ray(&Ray { origin: fragment.position, direction: reflect(fragment.position - gbuffer.eye(), normal) })
}

fn numbers(ray: &IndexedRay) -> [f32; 4] {
    let [st, uv]: [Vec2; 2] = [ray.coord.st, ray.coord.uv];
    [st.x, st.y, uv.x, uv.y]
}

/// Pixels that were compared, those that are further apart than the condition number allows, and the worst as a multiple of that.
#[derive(Debug, Default)]
struct Agreement {
    compared: usize,
    apart: usize,
    worst: f32,
}

/// The condition number is what a pixel's step changes: the two may place a vertex a few 256ths of a pixel apart. Where the neighbouring
/// pixels ask another slab or miss the mirror, there is none.
fn agreement(geometry: &LightFieldGeometry, gbuffer: &GBuffer, asked: &Image<[f32; 4]>) -> Agreement {
    let mut found = Agreement::default();
    for (x, y) in (1..SIZE - 1).flat_map(|y| (1..SIZE - 1).map(move |x| (x, y))) {
        let around = [[x, y], [x - 1, y], [x + 1, y], [x, y - 1], [x, y + 1]].map(|at| indexed(geometry, gbuffer, at));
        let [Some(here), Some(left), Some(right), Some(above), Some(below)] = around else { continue };
        if [left, right, above, below].iter().any(|other| other.slab != here.slab) {
            continue;
        }
        let [here, left, right, above, below] = [here, left, right, above, below].map(|ray| numbers(&ray));
        let step = |i: usize| 0.5 * ((right[i] - left[i]).abs() + (below[i] - above[i]).abs());
        let ratio = |i: usize| (asked.get(x, y)[i] - here[i]).abs() / (step(i) / 128.0 + 1e-5 * 48.0);
        let ratio = (0..4).map(ratio).fold(0.0, f32::max);
        found.compared += 1;
        found.apart += usize::from(ratio > 1.0);
        found.worst = found.worst.max(ratio);
    }
    found
}

#[test]
fn grazing_mirrors_ask_for_the_same_on_both_sides() {
    let (gpu, field) = (gpu(), packed(&capture(&museum(), 10, 48)));
    let texture = SlabTexture::new(&gpu, &field).expect("uploads");
    let mut renderer = SlabRenderer::new(&gpu, &texture).expect("a renderer");
    let stuv = StuvBuffer::new(&gpu, SIZE, SIZE).expect("a buffer");
    for mesh in meshes() {
        let device_mesh = MirrorMesh::new(&gpu, &mesh).expect("uploads");
        let (placement, reflectance) = (Placement::IDENTITY, Reflectance::MIRROR);
        let reflectors = [Reflector { mesh: &device_mesh, placement, reflectance, normal_map: None }];
        // Through a telescope where the plate would be a line.
        for (height, fov) in [(0.3, 0.8), (0.03, 0.8), (0.003, 0.03)] {
            let camera = Pinhole::look_at(Vec3::new(0.8, height, 0.9), Vec3::ZERO, fov, SIZE, SIZE).expect("a camera");
            let frame = Frame { camera: &camera, reflectors: &reflectors, behind: Behind::Nothing, view: View::Color };
            renderer.ask(&stuv, &frame).expect("asks");
            let asked = stuv.read(&gpu).expect("reads");
            let found = agreement(field.geometry(), &GBuffer::rasterize(&mesh, &camera), &asked);
            println!("eye at height {height}: {found:?}");
            assert!(found.compared > 1000 && found.apart * 1000 <= found.compared, "{height}: {found:?}");
        }
    }
}

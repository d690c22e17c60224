//! Rays per second: the tracer's nearest hit against the bare acceleration structure with its own triangle test, and
//! a whole shaded ray. Rays leave a mirror sphere inside a bumpy shell of 327 680 triangles.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{Vec2, Vec3};
use lf_math::{TriangleMesh, reflect};
use lf_scene::{Environment, Light, Lighting, Material, Scene, SceneBuilder, Tracer, Vertex, reflectors};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray as BareRay, RayHit};
use obvhs::triangle::Triangle;

const RAYS: usize = 1 << 16;

fn shell() -> TriangleMesh {
    let ball = reflectors::sphere(7);
    let bump = |p: &Vec3| p * (5.0 + 0.4 * (9.0 * p.x).sin() * (11.0 * p.y).cos() + 0.2 * (31.0 * p.z).sin());
    let positions = ball.positions().iter().map(bump).collect();
    TriangleMesh::new(positions, vec![], ball.triangles().to_vec()).expect("a mesh")
}

fn scene(mesh: &TriangleMesh) -> Scene {
    let mut builder = SceneBuilder::default();
    let grey = builder.material(Material::diffuse(Vec3::splat(0.5)));
    for triangle in mesh.triangles() {
        let vertex = |i: u32| Vertex {
            position: mesh.positions()[i as usize],
            normal: mesh.normals()[i as usize],
            uv: Vec2::ZERO,
        };
        builder.triangle(triangle.map(vertex), grey);
    }
    let lights = vec![Light::Point { position: Vec3::new(1.0, 2.0, 0.5), intensity: Vec3::splat(28.0) }];
    builder
        .build("shell", Lighting { lights, ambient: Vec3::splat(0.2), environment: Environment::BLACK })
        .expect("a scene")
}

/// Origin and direction of rays mirrored by a sphere, pixel by pixel.
fn rays() -> Vec<(Vec3, Vec3)> {
    let ray = |i: usize| {
        let (x, y) = ((i % 256) as f32 / 128.0 - 1.0, (i / 256) as f32 / 128.0 - 1.0);
        let normal = Vec3::new(x, y, 0.7).normalize();
        (0.4 * normal, reflect(Vec3::NEG_Z, normal))
    };
    (0..RAYS).map(ray).collect()
}

fn bench(c: &mut Criterion) {
    let mesh = shell();
    let tracer = Tracer::new(scene(&mesh));
    let corner = |i: u32| mesh.positions()[i as usize].into();
    let triangle = |t: &[u32; 3]| Triangle { v0: corner(t[0]), v1: corner(t[1]), v2: corner(t[2]) };
    let all: Vec<_> = mesh.triangles().iter().map(triangle).collect();
    let bvh = build_cwbvh_from_tris(&all, BvhBuildParams::medium_build(), &mut std::time::Duration::default());
    let ordered: Vec<_> = bvh.primitive_indices.iter().map(|&i| all[i as usize]).collect();
    let bare = |origin: Vec3, direction: Vec3| {
        let mut hit = RayHit::none();
        let ray = BareRay::new_inf(origin.into(), direction.into());
        bvh.ray_traverse(ray, &mut hit, |ray, i| ordered[i].intersect(ray));
        hit.t
    };
    let rays = rays();
    let mut slipped = 0;
    for &(origin, direction) in &rays {
        let t = tracer.distance(origin, direction).expect("the shell is closed");
        let found = bare(origin, direction);
        assert!(found > t * (1.0 - 1e-3), "the bare structure finds nothing nearer");
        slipped += usize::from(found > t * (1.0 + 1e-3));
    }
    println!("the bare triangle test lets {slipped} of {RAYS} rays slip through the closed shell");
    assert!(slipped < RAYS / 100, "both find the same surfaces");
    let mut group = c.benchmark_group("rays");
    group.throughput(Throughput::Elements(RAYS as u64));
    let distance = |o, d| tracer.distance(o, d).unwrap_or(0.0);
    group.bench_function("nearest hit", |b| {
        b.iter(|| rays.iter().map(|&(o, d)| distance(black_box(o), d)).sum::<f32>());
    });
    group.bench_function("bare obvhs", |b| b.iter(|| rays.iter().map(|&(o, d)| bare(black_box(o), d)).sum::<f32>()));
    let radiance = |o, d| tracer.trace(o, d).radiance;
    group.bench_function("shaded", |b| b.iter(|| rays.iter().map(|&(o, d)| radiance(black_box(o), d)).sum::<Vec3>()));
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);

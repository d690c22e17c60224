//! Rays per second: the tracer's nearest hit against the bare acceleration structure with its own triangle test, on rays that
//! leave a mirror sphere inside a bumpy shell; how it grows from 10³ to 10⁶ triangles; and whole paths in the museum.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{Vec2, Vec3};
use lf_math::{TriangleMesh, reflect};
use lf_scene::{
    Environment, Illumination, Lighting, Material, Quality, Scene, SceneBuilder, Tracer, Vertex, museum, reflectors,
};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray as BareRay, RayHit};
use obvhs::triangle::Triangle;

/// Rays that leave the mirror.
const RAYS: usize = 1 << 16;
/// Rays in the museum.
const PATHS: usize = 1 << 12;

/// A shell of 20·4ⁿ triangles.
fn shell(subdivisions: u32) -> TriangleMesh {
    let ball = reflectors::sphere(subdivisions);
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
    builder.build("shell", Lighting::from_environment(Environment::BLACK)).expect("a scene")
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

/// The acceleration structure alone.
struct Bare {
    bvh: CwBvh,
    triangles: Vec<Triangle>,
}

impl Bare {
    fn new(mesh: &TriangleMesh) -> Self {
        let corner = |i: u32| mesh.positions()[i as usize].into();
        let triangle = |t: &[u32; 3]| Triangle { v0: corner(t[0]), v1: corner(t[1]), v2: corner(t[2]) };
        let all: Vec<_> = mesh.triangles().iter().map(triangle).collect();
        let bvh = build_cwbvh_from_tris(&all, BvhBuildParams::medium_build(), &mut Duration::default());
        let triangles = bvh.primitive_indices.iter().map(|&i| all[i as usize]).collect();
        Self { bvh, triangles }
    }

    fn distance(&self, origin: Vec3, direction: Vec3) -> f32 {
        let mut hit = RayHit::none();
        let ray = BareRay::new_inf(origin.into(), direction.into());
        self.bvh.ray_traverse(ray, &mut hit, |ray, i| self.triangles[i].intersect(ray));
        hit.t
    }
}

/// Both find the same surfaces.
fn check(tracer: &Tracer, bare: &Bare, rays: &[(Vec3, Vec3)]) {
    let mut slipped = 0;
    for &(origin, direction) in rays {
        let t = tracer.distance(origin, direction).expect("the shell is closed");
        let found = bare.distance(origin, direction);
        assert!(found > t * (1.0 - 1e-3), "the bare structure finds nothing nearer");
        slipped += usize::from(found > t * (1.0 + 1e-3));
    }
    println!("the bare triangle test lets {slipped} of {RAYS} rays slip through the closed shell");
    assert!(slipped < RAYS / 100, "both find the same surfaces");
}

/// The fastest of many runs of each, taken in turn: what a busy machine disturbs least.
fn compare(ours: impl Fn() -> f32, bare: impl Fn() -> f32) {
    let time = |run: &dyn Fn() -> f32| {
        let start = Instant::now();
        black_box(run());
        start.elapsed().as_secs_f64()
    };
    let fastest = |(a, b): (f64, f64), _| (a.min(time(&ours)), b.min(time(&bare)));
    let (ours, bare) = (0..25).fold((f64::INFINITY, f64::INFINITY), fastest);
    let rate = |seconds: f64| RAYS as f64 / seconds / 1e6;
    println!("in turn: {:.2} Mray/s, bare {:.2} Mray/s, ratio {:.2}", rate(ours), rate(bare), bare / ours);
}

fn nearest_hits(c: &mut Criterion) {
    let rays = rays();
    let mut group = c.benchmark_group("nearest hit");
    group.throughput(Throughput::Elements(RAYS as u64)).sample_size(20);
    for subdivisions in [3, 5, 6, 7, 8] {
        let mesh = shell(subdivisions);
        let (tracer, bare) = (Tracer::new(scene(&mesh)), Bare::new(&mesh));
        let ours = || rays.iter().map(|&(o, d)| tracer.distance(black_box(o), d).unwrap_or(0.0)).sum::<f32>();
        let theirs = || rays.iter().map(|&(o, d)| bare.distance(black_box(o), d)).sum::<f32>();
        let triangles = mesh.triangles().len();
        group.bench_function(BenchmarkId::new("ours", triangles), |b| b.iter(ours));
        if subdivisions == 7 {
            check(&tracer, &bare, &rays);
            group.bench_function(BenchmarkId::new("bare obvhs", triangles), |b| b.iter(theirs));
            compare(ours, theirs);
        }
    }
    group.finish();
}

/// One sample a ray, all around from the cell's centre.
fn museum_paths(c: &mut Criterion) {
    let eye = museum::cell().center().as_vec3();
    let direction = |i: usize| {
        let (y, angle) = (1.0 - (2.0 * i as f32 + 1.0) / PATHS as f32, 2.399_963_2 * i as f32);
        let r = (1.0 - y * y).sqrt();
        Vec3::new(r * angle.cos(), y, r * angle.sin())
    };
    let mut group = c.benchmark_group("museum");
    group.throughput(Throughput::Elements(PATHS as u64)).sample_size(20);
    for (name, illumination) in
        [("direct", Illumination::Direct), ("global, 8 bounces", Illumination::Global { max_bounces: 8 })]
    {
        let quality = Quality { illumination, ..Quality::default() };
        let tracer = Tracer::new(museum::scene()).with_quality(quality);
        let all = || (0..PATHS).map(|i| tracer.trace(black_box(eye), direction(i)).radiance).sum::<Vec3>();
        group.bench_function(name, |b| b.iter(all));
    }
    group.finish();
}

criterion_group!(benches, nearest_hits, museum_paths);
criterion_main!(benches);

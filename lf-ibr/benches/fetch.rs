//! Lookups per second: slabs of the paper's set-up against an environment map, along coherent and incoherent rays.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, Vec3};
use lf_ibr::{CubeField, Environment, SlabField};
use lf_math::{Cell, CubeMap, Image, LightFieldGeometry, PlanePlacement, Ray, SlabTexels};

const RAYS: usize = 1 << 16;

/// A texel value that differs from its neighbours.
fn noise(i: usize) -> [u8; 4] {
    let hash = (i as u32).wrapping_mul(2_654_435_761).rotate_left(13).wrapping_mul(2_246_822_519);
    let [r, g, b, _] = hash.to_le_bytes();
    [r, g, b, 255]
}

fn slabs() -> SlabField {
    let cell = Cell::cube(DVec3::ZERO, 1.0).expect("a cell");
    let geometry = LightFieldGeometry::around(cell, PlanePlacement::CellFaces, 32, 128).expect("slabs");
    let texels = |slab| SlabTexels::new(slab, (0..32 * 32 * 128 * 128).map(noise).collect()).expect("texels");
    let texels = geometry.slabs().iter().map(texels).collect();
    SlabField::new(geometry, texels).expect("a field")
}

fn cube() -> CubeField {
    let face = |_| Image::new(512, 512, (0..512 * 512).map(noise).collect()).expect("a face");
    CubeField::new(&CubeMap::new([0; 6].map(face)).expect("a cube"))
}

/// Rays off a mirror sphere in the order of an image's pixels, or shuffled.
fn rays(coherent: bool) -> Vec<Ray> {
    let ray = |i: usize| {
        let i = if coherent { i } else { i.wrapping_mul(40_503) % RAYS };
        let (x, y) = ((i % 256) as f32 / 128.0 - 1.0, (i / 256) as f32 / 128.0 - 1.0);
        let normal = Vec3::new(x, y, 0.7).normalize();
        Ray { origin: 0.4 * normal, direction: lf_math::reflect(Vec3::NEG_Z, normal) }
    };
    (0..RAYS).map(ray).collect()
}

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("fetch");
    group.throughput(Throughput::Elements(RAYS as u64));
    let (slabs, cube) = (slabs(), cube());
    for (order, rays) in [("coherent", rays(true)), ("incoherent", rays(false))] {
        let mut run = |name: &str, environment: &dyn Environment| {
            assert!(rays.iter().all(|ray| environment.look_up(ray).is_some()), "every ray has an answer");
            group.bench_with_input(BenchmarkId::new(name, order), &rays, |b, rays| {
                b.iter(|| rays.iter().filter_map(|ray| environment.look_up(black_box(ray))).sum::<Vec3>());
            });
        };
        run("slabs 32x32x128x128", &slabs);
        run("environment map 512", &cube);
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);

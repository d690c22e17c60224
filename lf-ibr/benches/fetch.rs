//! Lookups per second on one core: slabs of the paper's set-up from BC1 blocks and from decoded texels, against an environment map.
//!
//! What counts is the time that the thread ran: what else the machine does shows less.

use std::hint::black_box;

use cpu_time::ThreadTime;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, Vec3};
use lf_compress::{PackedLightField, bc1::Quality, format::TexelEncoding};
use lf_ibr::{BlockField, CubeField, Environment, SlabField};
use lf_math::{Cell, CubeMap, Image, LightFieldGeometry, PlanePlacement, Ray, SlabTexels, reflect};

const EDGE: usize = 512;
const TEXELS: usize = 32 * 32 * 128 * 128;

fn hash(i: usize) -> u32 {
    let mixed = (i as u32 ^ 0x9E37_79B9).wrapping_mul(0x85EB_CA6B);
    let mixed = (mixed ^ mixed >> 15).wrapping_mul(0xC2B2_AE35);
    mixed ^ mixed >> 13
}

/// A texel value that differs from its neighbours.
fn noise(i: usize) -> [u8; 4] {
    let [r, g, b, _] = hash(i).to_le_bytes();
    [r, g, b, 255]
}

fn packed() -> PackedLightField {
    let cell = Cell::cube(DVec3::ZERO, 1.0).expect("a cell");
    let geometry = LightFieldGeometry::around(cell, PlanePlacement::CellFaces, 32, 128).expect("slabs");
    let texels = |slab| SlabTexels::new(slab, (0..TEXELS).map(noise).collect()).expect("texels");
    let texels: Vec<_> = geometry.slabs().iter().map(texels).collect();
    PackedLightField::encode(geometry, &texels, TexelEncoding::Bc1, Quality::Realtime).expect("blocks")
}

fn cube() -> CubeField {
    let face = |_| Image::new(512, 512, (0..512 * 512).map(noise).collect()).expect("a face");
    CubeField::new(&CubeMap::new([0; 6].map(face)).expect("a cube"))
}

/// Rays off a mirror sphere, in the order of a picture's pixels.
fn sphere() -> Vec<Ray> {
    let ray = |i: usize| {
        let [x, y] = [i % EDGE, i / EDGE].map(|p| (2 * p + 1) as f32 / EDGE as f32 - 1.0);
        let z = 1.0 - x * x - y * y;
        (z > 0.0).then(|| Vec3::new(x, y, z.sqrt()))
    };
    let mirrored = |normal: Vec3| Ray { origin: 0.4 * normal, direction: reflect(Vec3::NEG_Z, normal) };
    (0..EDGE * EDGE).filter_map(ray).map(mirrored).collect()
}

/// The same in no order (Fisher & Yates).
fn shuffled(mut rays: Vec<Ray>) -> Vec<Ray> {
    for i in (1..rays.len()).rev() {
        rays.swap(i, hash(i) as usize % (i + 1));
    }
    rays
}

/// From anywhere in the cell to anywhere.
fn random(len: usize) -> Vec<Ray> {
    let number = |i: usize| hash(i) as f32 / 2f32.powi(32) - 0.5;
    let vector = |i: usize| Vec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2));
    (0..len).map(|i| Ray { origin: vector(2 * i), direction: vector(2 * i + 1) }).collect()
}

fn bench(criterion: &mut Criterion) {
    let packed = packed();
    let (blocks, cube) = (BlockField::new(&packed).expect("a field"), cube());
    let texels = packed.decode(1 << 30).expect("texels");
    let slabs = SlabField::new(packed.geometry().clone(), texels).expect("a field");
    let contenders: [(&str, &dyn Environment); 3] =
        [("slabs, BC1", &blocks), ("slabs, RGBA8", &slabs), ("environment map", &cube)];
    let coherent = sphere();
    let orders = [("shuffled", shuffled(coherent.clone())), ("random", random(coherent.len())), ("coherent", coherent)];
    for (order, rays) in &orders {
        let mut group = criterion.benchmark_group(*order);
        group.throughput(Throughput::Elements(rays.len() as u64)).sample_size(20);
        for (name, environment) in contenders {
            let mut answers = vec![None; rays.len()];
            environment.look_up_all(rays, &mut answers);
            assert!(answers.iter().all(Option::is_some), "every ray has an answer");
            group.bench_function(name, |bencher| {
                bencher.iter_custom(|times| {
                    let start = ThreadTime::now();
                    for _ in 0..times {
                        environment.look_up_all(black_box(rays), black_box(&mut answers));
                    }
                    start.elapsed()
                });
            });
        }
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);

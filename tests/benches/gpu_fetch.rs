//! Reflected rays per second on this machine's GPU: slabs of the paper's set-up in every form that the device holds, against environment maps.
//!
//! Whole frames of 512² pixels of a sphere, until the device is done. Coherent rays come off the sphere, incoherent ones off the same sphere
//! whose normals point anywhere: neighbouring pixels share nothing but their triangle's three.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, Vec3};
use lf_compress::bc1::Quality;
use lf_compress::format::TexelEncoding;
use lf_compress::{PackedCube, PackedLightField};
use lf_gpu::{CubePicture, MirrorMesh, ReflectionPass, SlabTexture, Storage, Target};
use lf_math::{
    Cell, CubeMap, DistanceCube, Image, LightFieldGeometry, Pinhole, PlanePlacement, SlabTexels, TriangleMesh,
};
use lf_scene::reflectors;
use lf_tests::gpu;

const SIZE: u32 = 512;
const CUBE: u32 = 512;

fn hash(i: u32) -> u32 {
    i.wrapping_mul(0x9E37_79B1).rotate_left(15).wrapping_mul(0x85EB_CA77)
}

fn noise(count: u32) -> Vec<[u8; 4]> {
    (0..count).map(|i| (hash(i) | 0xff).to_be_bytes()).collect()
}

fn slabs() -> PackedLightField {
    let cell = Cell::cube(DVec3::ZERO, 1.0).expect("a cell");
    let geometry = LightFieldGeometry::around(cell, PlanePlacement::CellFaces, 32, 128).expect("slabs");
    let texels = |slab| SlabTexels::new(slab, noise(32 * 32 * 128 * 128)).expect("texels");
    let texels: Vec<_> = geometry.slabs().iter().map(texels).collect();
    PackedLightField::encode(geometry, &texels, TexelEncoding::Bc1, Quality::Realtime).expect("blocks")
}

fn map() -> PackedCube {
    let face = Image::new(CUBE, CUBE, noise(CUBE * CUBE)).expect("a face");
    let radiance = CubeMap::new([(); 6].map(|()| face.clone())).expect("a cube map");
    let cube = DistanceCube::new(Vec3::ZERO, radiance, [(); 6].map(|()| Image::filled(8, 8, 1.0))).expect("a cube");
    PackedCube::encode(&cube, Quality::Realtime).expect("blocks")
}

/// The sphere, and one whose normals are in no order.
fn spheres() -> [(&'static str, TriangleMesh); 2] {
    let sphere = reflectors::sphere(5).fitted(Vec3::ZERO, 0.48).expect("fits");
    let number = |i: u32| hash(i) as f32 / 2f32.powi(31) - 1.0;
    let anywhere = |i: u32| Vec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2)).normalize_or(Vec3::Y);
    let normals = (0..sphere.positions().len() as u32).map(anywhere).collect();
    let rough = TriangleMesh::new(sphere.positions().to_vec(), normals, sphere.triangles().to_vec()).expect("a mesh");
    [("coherent", sphere), ("incoherent", rough)]
}

fn bench(criterion: &mut Criterion) {
    let gpu = gpu();
    println!("{}", gpu.description());
    let (field, map) = (slabs(), map());
    let environment = ReflectionPass::environment(&gpu, CubePicture::from(&map)).expect("a pass");
    let mut passes = vec![("environment map, BC1".to_owned(), environment)];
    for storage in [Storage::Bc1Array, Storage::Bc1Volume, Storage::Rgba8Array] {
        match SlabTexture::with_storage(&gpu, &field, storage) {
            Ok(texture) => {
                passes.push((format!("slabs, {storage}"), ReflectionPass::slabs(&gpu, &texture).expect("a pass")));
            }
            Err(error) => eprintln!("left out: {error}"),
        }
    }
    let camera = Pinhole::look_at(Vec3::new(1.4, 0.5, 0.6), Vec3::ZERO, 0.67, SIZE, SIZE).expect("a camera");
    let target = Target::new(&gpu, SIZE, SIZE).expect("a target");
    for (order, mesh) in spheres() {
        let mesh = MirrorMesh::new(&gpu, &mesh).expect("uploads");
        let mut group = criterion.benchmark_group(order);
        for (name, pass) in &passes {
            let frame = || {
                pass.draw(&gpu, &target, &mesh, &camera).expect("draws");
                gpu.wait().expect("is well");
            };
            frame();
            let picture = target.read(&gpu).expect("reads");
            let rays = picture.texels().iter().filter(|texel| texel[3] != 0).count();
            assert!(rays > 100_000, "{name}: {rays} rays are drawn");
            group.throughput(Throughput::Elements(rays as u64)).sample_size(20);
            group.bench_function(name, |bencher| bencher.iter(frame));
        }
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);

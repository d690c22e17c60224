//! Whole light fields through encoder, container and back.

use glam::DVec3;
use lf_compress::PackedLightField;
use lf_compress::bc1::Quality;
use lf_compress::format::{Container, Limits, Metadata, TexelEncoding};
use lf_math::{Cell, Face, LightFieldGeometry, SampledAxis, Slab, SlabTexels};

/// Two slabs of uneven sizes with smooth texels.
fn field() -> (LightFieldGeometry, Vec<SlabTexels>) {
    let axis = |count| SampledAxis::spanning(-1.0, 1.0, count).expect("an axis");
    let slab = |face, [s, t]: [u32; 2], [u, v]: [u32; 2]| {
        Slab::new(face, 0.5, [axis(s), axis(t)], [axis(u), axis(v)], Some(2.0)).expect("a slab")
    };
    let slabs = vec![slab(Face::NegX, [3, 9], [130, 6]), slab(Face::PosZ, [5, 2], [16, 21])];
    let geometry = LightFieldGeometry::new(Cell::cube(DVec3::ONE, 1.0).expect("a cell"), slabs).expect("a field");
    let texels = geometry.slabs().iter().map(|slab| {
        let ([cameras_s, cameras_t], [width, height]) = (slab.cameras(), slab.resolution());
        let count = cameras_s * cameras_t * width * height;
        let texel = |i: u32| {
            let (x, camera) = (i % width, i / (width * height));
            [(x * 255 / width) as u8, (camera * 9 % 256) as u8, 90, 255]
        };
        SlabTexels::new(slab, (0..count).map(texel).collect()).expect("texels")
    });
    let texels = texels.collect();
    (geometry, texels)
}

#[test]
fn rgba_is_lossless_through_a_file() {
    let (geometry, texels) = field();
    let packed = PackedLightField::encode(geometry.clone(), &texels, TexelEncoding::Rgba8, Quality::Standard).unwrap();
    let bytes = packed.to_writer(Metadata::new()).unwrap().to_bytes().unwrap();
    let read = PackedLightField::read(&Container::parse(&bytes, &Limits::default()).unwrap()).unwrap();
    assert_eq!(read.geometry(), &geometry);
    assert_eq!(read.decode().unwrap(), texels);
}

#[test]
fn bc1_is_close_and_comes_back_bit_for_bit() {
    let (geometry, texels) = field();
    let packed = PackedLightField::encode(geometry, &texels, TexelEncoding::Bc1, Quality::Standard).unwrap();
    let decoded = packed.decode().unwrap();
    for (before, after) in texels.iter().zip(&decoded) {
        for (a, b) in before.texels().iter().zip(after.texels()) {
            assert!((0..4).all(|c| a[c].abs_diff(b[c]) <= 8), "{a:?} {b:?}");
        }
    }
    let bytes = packed.to_writer(Metadata::new()).unwrap().to_bytes().unwrap();
    let read = PackedLightField::read(&Container::parse(&bytes, &Limits::default()).unwrap()).unwrap();
    assert_eq!(read.decode().unwrap(), decoded);
    assert_eq!(read.layout(), packed.layout());
}

#[test]
fn texels_of_another_shape_are_refused() {
    let (geometry, mut texels) = field();
    texels.swap(0, 1);
    assert!(PackedLightField::encode(geometry.clone(), &texels, TexelEncoding::Bc1, Quality::Fast).is_err());
    texels.pop();
    assert!(PackedLightField::encode(geometry, &texels, TexelEncoding::Bc1, Quality::Fast).is_err());
}

#[test]
fn the_file_does_not_depend_on_the_threads() {
    let (geometry, texels) = field();
    let bytes = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let packed = PackedLightField::encode(geometry.clone(), &texels, TexelEncoding::Bc1, Quality::Standard);
            packed.unwrap().to_writer(Metadata::new()).unwrap().to_bytes().unwrap()
        })
    };
    assert_eq!(bytes(1), bytes(3));
}

//! The rules of clause 5.

use lf_format::{Rule, TexelEncoding};

use crate::assemble::{Chunk, File, entry_at};
use crate::layout::{Field, RED, Slab, smallest};
use crate::readers::{assert_breaks, assert_unsupported, sound};

/// Where the payload of `GEOM` is in a file of two chunks.
const GEOM: usize = 192;

/// The smallest file with a change to its geometry chunk, and right checksums.
fn with_geometry(at: usize, bytes: &[u8]) -> Vec<u8> {
    smallest().patch(0, at, bytes).to_bytes()
}

#[track_caller]
fn assert_refused(at: usize, bytes: &[u8], rule: Rule) {
    assert_breaks(&with_geometry(at, bytes), rule, GEOM + at);
}

/// What no field of the geometry may hold.
const NOT_FINITE: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
/// What no field may hold that has to be positive.
const NOT_POSITIVE: [f32; 6] = [0.0, -0.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

#[test]
fn cells() {
    for at in [0, 8, 16] {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_breaks(&with_geometry(at, &value.to_le_bytes()), Rule::Cell, GEOM);
        }
    }
    for at in [24, 28, 32] {
        for value in NOT_POSITIVE {
            assert_breaks(&with_geometry(at, &value.to_le_bytes()), Rule::Cell, GEOM);
        }
    }
}

#[test]
fn slab_counts_and_lengths() {
    for count in [0u32, 7, u32::MAX] {
        assert_refused(36, &count.to_le_bytes(), Rule::SlabCount);
    }
    assert_breaks(&with_geometry(36, &[2]), Rule::GeometryLength, GEOM + 108);
    let of_len = |len| {
        let mut file = smallest();
        file.chunks[0].payload.resize(len, 0);
        file.chunks[0].raw_len = len as u64;
        file
    };
    assert_breaks(&of_len(109).to_bytes(), Rule::GeometryLength, GEOM + 108);
    assert_breaks(&of_len(107).to_bytes(), Rule::GeometryLength, GEOM + 104);
    assert_breaks(&of_len(39).to_bytes(), Rule::GeometryLength, GEOM + 36);
    assert_breaks(&of_len(449).to_bytes(), Rule::GeometryLength, GEOM);
}

#[test]
fn what_a_record_may_hold() {
    assert_refused(40, &[6], Rule::Face);
    for encoding in [0, 4, 5, 255] {
        assert_unsupported(&with_geometry(41, &[encoding]), Rule::Encoding, GEOM + 41);
    }
    for transfer in [1, 2, 255] {
        assert_unsupported(&with_geometry(42, &[transfer]), Rule::Transfer, GEOM + 42);
    }
    assert_unsupported(&with_geometry(41, &[3]), Rule::Transfer, GEOM + 42);
    assert_refused(43, &[1], Rule::GeometryReserved);
    for value in NOT_FINITE {
        assert_refused(44, &value.to_le_bytes(), Rule::Plane);
    }
    for per_tile in [0u32, 2, u32::MAX] {
        assert_refused(100, &per_tile.to_le_bytes(), Rule::Tiling);
        assert_breaks(&with_geometry(104, &per_tile.to_le_bytes()), Rule::Tiling, GEOM + 100);
    }
}

#[test]
fn axes() {
    for axis in [48, 60, 72, 84] {
        let refused = |at, bytes: &[u8]| assert_breaks(&with_geometry(axis + at, bytes), Rule::Axis, GEOM + axis);
        for value in NOT_FINITE {
            refused(0, &value.to_le_bytes());
        }
        for value in NOT_POSITIVE {
            refused(4, &value.to_le_bytes());
        }
        for count in [0u32, (1 << 16) + 1, 1 << 24, u32::MAX] {
            refused(8, &count.to_le_bytes());
        }
    }
}

#[test]
fn axes_have_at_most_65_536_samples() {
    let with_u = |count: u32| {
        let uv = [(-0.75, 0.5, count), (-0.75, 0.5, 4)];
        let slab = Slab { uv, ..Slab::smallest() };
        Field::new(vec![slab]).file(|_, _| (1, vec![1])).to_bytes()
    };
    let most = with_u(1 << 16);
    assert_eq!(sound(&most).tilings()[0].resolution(), [1 << 16, 4]);
    assert_breaks(&with_u((1 << 16) + 1), Rule::Axis, GEOM + 72);
}

/// §5.7: first + (count − 1)·step, the product rounded before the sum.
#[test]
fn the_last_sample_is_finite_in_binary32() {
    let with_axis = |first: f32, step: f32, count: u32| {
        let axis = [first.to_le_bytes(), step.to_le_bytes(), count.to_le_bytes()].concat();
        with_geometry(72, &axis)
    };
    sound(&with_axis(0.0, 1e38, 4));
    assert_breaks(&with_axis(0.0, 1e38, 5), Rule::Axis, GEOM + 72);
    assert_breaks(&with_axis(3e38, 1e38, 2), Rule::Axis, GEOM + 72);
    // The exact sum is 1e38, but the product overflows.
    assert_breaks(&with_axis(-3e38, 1e38, 5), Rule::Axis, GEOM + 72);
}

#[test]
fn focal_depths() {
    let depth = |value: f32| with_geometry(96, &value.to_le_bytes());
    assert_eq!(sound(&depth(2.5)).geometry().slabs()[0].focal_depth(), Some(2.5));
    assert_eq!(sound(&smallest().to_bytes()).geometry().slabs()[0].focal_depth(), None);
    for value in NOT_POSITIVE.into_iter().filter(|value| value.to_bits() != 0) {
        assert_breaks(&depth(value), Rule::FocalDepth, GEOM + 96);
    }
    // So near that the disparity overflows: steps are 1 along s and t, 0.5 along u and v.
    sound(&depth(1e-38));
    for value in [4e-39, f32::from_bits(1)] {
        assert_breaks(&depth(value), Rule::FocalDepth, GEOM + 96);
    }
}

/// Two slabs of these faces.
fn with_faces(faces: [u8; 2]) -> File {
    let slabs = faces.map(|face| Slab { face, ..Slab::smallest() });
    Field::new(slabs.to_vec()).file(|_, _| (0, RED.to_vec()))
}

#[test]
fn slabs_are_in_the_order_of_their_faces() {
    sound(&with_faces([1, 4]).to_bytes());
    for faces in [[4, 4], [4, 1]] {
        // Three entries; the second record begins 108 bytes into the payload.
        assert_breaks(&with_faces(faces).to_bytes(), Rule::FaceOrder, 256 + 108);
    }
    assert_eq!(with_faces([1, 4]).chunks.len(), 3);
}

#[test]
fn encodings() {
    let file = |encoding, len| {
        let slab = Slab { encoding, ..Slab::smallest() };
        Field::new(vec![slab]).file(|_, _| (0, vec![0; len])).to_bytes()
    };
    for (encoding, len, known) in
        [(1, 8, TexelEncoding::Bc1), (2, 64, TexelEncoding::Rgba8), (3, 96, TexelEncoding::Rgb16F)]
    {
        let bytes = file(encoding, len);
        let read = sound(&bytes);
        assert_eq!(read.tilings()[0].encoding(), known);
        assert_eq!(read.tile(0, 0).unwrap().raw_len, len as u64);
    }
}

/// §5.9: fewer than 2³² tiles, pictures less than 2³² wide and high.
#[test]
fn sizes_fit_their_integers() {
    let most = (0.0, 1.0, 1 << 16);
    let refused = |slab: Slab| {
        // The tile is not looked at: there may be none of these.
        let mut file = smallest();
        file.chunks[0] = Field::new(vec![slab]).heads().remove(0);
        assert_breaks(&file.to_bytes(), Rule::Tiling, GEOM + 100);
    };
    refused(Slab { st: [most; 2], per_tile: [1; 2], ..Slab::smallest() });
    refused(Slab { st: [most; 2], uv: [most; 2], per_tile: [1 << 16, 1], ..Slab::smallest() });
    refused(Slab { st: [most; 2], uv: [most; 2], per_tile: [1, 1 << 16], ..Slab::smallest() });
}

/// §5.9: less than 2⁶⁴ raw bytes in all.
#[test]
fn raw_lengths_of_all_tiles_fit_64_bits() {
    let most = (0.0, 1e-9, 1 << 16);
    // 2^64 texels: 2^63 bytes of BC1 are fine, so that only the second tile is missing.
    let huge = Slab { st: [most; 2], uv: [most; 2], per_tile: [65_535, 65_535], ..Slab::smallest() };
    let file = |slabs: Vec<Slab>| {
        let mut chunks = Field::new(slabs).heads();
        let raw_len = 8 * (65_535 * 16_384u64).pow(2);
        chunks.push(Chunk { packing: 1, raw_len, ..Chunk::new(b"TILE", 1, vec![1]) });
        File::new(chunks).to_bytes()
    };
    assert_breaks(&file(vec![huge.clone()]), Rule::Order, entry_at(2));
    let rgba8 = Slab { encoding: 2, ..huge.clone() };
    assert_breaks(&file(vec![rgba8]), Rule::Tiling, GEOM + 100);
    let second = Slab { face: 5, ..huge.clone() };
    assert_breaks(&file(vec![huge, second]), Rule::Tiling, GEOM + 168);
}

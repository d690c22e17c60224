//! Images of inverse depth in blocks of two planes.

use lf_compress::planes::{PlaneBlock, PlaneImage};
use proptest::prelude::*;

/// The largest error as a share of the value, and the share of texels that are off by more than half-float rounding.
fn compare(values: &[f32], image: &PlaneImage) -> (f32, f32) {
    let errors = values.iter().zip(image.decode()).map(|(exact, found)| (found - exact).abs() / exact.max(1e-30));
    let errors: Vec<f32> = errors.collect();
    let off = errors.iter().filter(|&&e| e > 4e-3).count() as f32 / errors.len() as f32;
    (errors.into_iter().fold(0.0, f32::max), off)
}

fn encode(width: u32, height: u32, value: impl Fn(f32, f32) -> f32) -> (Vec<f32>, PlaneImage) {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x as f32, y as f32)));
    let values: Vec<f32> = places.map(|(x, y)| value(x, y)).collect();
    let image = PlaneImage::encode(width, height, &values).expect("the right number of values");
    (values, image)
}

/// A plane seen by a pinhole camera has an affine inverse depth: n·d / c for the ray's direction d = (x, y, 1).
#[test]
fn planes_in_space_are_exact() {
    for (normal, distance) in [([0.1f32, 0.9, 0.2], 1.4f32), ([0.7, -0.1, 0.7], 3.0), ([0.0, 0.0, 1.0], 900.0)] {
        let inverse = |x: f32, y: f32| {
            let d = [x / 32.0 - 1.0, y / 32.0 - 1.0, 1.0];
            (d.iter().zip(normal).map(|(d, n)| d * n).sum::<f32>() / distance).max(0.0)
        };
        let (values, image) = encode(64, 64, inverse);
        let largest = values.iter().copied().fold(0.0, f32::max);
        for (exact, found) in values.iter().zip(image.decode()) {
            assert!((exact - found).abs() < 1e-3 * largest, "{exact} {found}");
        }
    }
}

#[test]
fn twenty_bytes_a_block_and_any_size() {
    for (width, height) in [(1, 1), (8, 8), (9, 7), (17, 24)] {
        let (values, image) = encode(width, height, |x, y| 1.0 + 0.01 * x + 0.02 * y);
        let blocks = width.div_ceil(8) * height.div_ceil(8);
        assert_eq!((image.blocks().len(), image.bytes()), (blocks as usize, 20 * blocks as usize));
        assert_eq!((image.width(), image.height(), image.decode().len()), (width, height, values.len()));
        assert!(compare(&values, &image).0 < 1e-3);
    }
    assert!(PlaneImage::encode(8, 8, &[0.0; 63]).is_none());
    assert!(PlaneImage::encode(0, 0, &[]).is_none());
}

#[test]
fn what_is_no_inverse_depth_becomes_one() {
    let values = [f32::NAN, -1.0, f32::INFINITY, 0.0];
    let decoded = PlaneImage::encode(4, 1, &values).expect("four values").decode();
    assert!(decoded.iter().all(|value| value.is_finite() && *value >= 0.0), "{decoded:?}");
    assert_eq!((decoded[0], decoded[1], decoded[3]), (0.0, 0.0, 0.0));
    assert!(decoded[2] > 1e38);
}

/// Decoded by hand from the bytes.
#[test]
fn bytes_are_halves_and_a_mask() {
    let (_, image) = encode(8, 8, |x, _| if x < 4.0 { 1.0 } else { 0.25 });
    let bytes = image.blocks()[0].to_bytes();
    let half = |i: usize| half::f16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]).to_f32();
    let mask = u64::from_le_bytes(bytes[12..].try_into().expect("eight bytes"));
    for (x, y) in (0..8).flat_map(|y| (0..8).map(move |x| (x, y))) {
        let plane = 3 * (mask >> (8 * y + x) & 1) as usize;
        let value = half(plane) + (x as f32 - 3.5) * half(plane + 1) + (y as f32 - 3.5) * half(plane + 2);
        assert_eq!(value * image.scale(), if x < 4 { 1.0 } else { 0.25 }, "{x} {y}");
    }
    assert_eq!(PlaneBlock::BYTES, bytes.len());
}

/// A ball's inverse depth is curved; a block of it is nearly flat.
#[test]
fn a_ball_is_close() {
    let inverse = |x: f32, y: f32| {
        let d = [x / 256.0 - 0.5, y / 256.0 - 0.5, 1.0].map(f64::from);
        // |t·d − c|² = r², c = (0, 0, 2), r = 0.5.
        let (a, b) = (d.iter().map(|v| v * v).sum::<f64>(), 2.0 * d[2]);
        let root = b * b - a * (4.0 - 0.25);
        if root < 0.0 { 0.1 } else { (a / (b - root.sqrt())) as f32 }
    };
    let (values, image) = encode(256, 256, inverse);
    let (_, off) = compare(&values, &image);
    assert!(off < 0.01, "{off} of the texels are off");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Two surfaces with a straight edge between them, anywhere, in any unit of length.
    #[test]
    fn edges_between_two_planes_are_exact(
        a in prop::array::uniform3(1i32..=1000), b in prop::array::uniform3(1i32..=1000), turn in 0i32..=628, at in 0i32..=700,
        exponent in -60i32..=60
    ) {
        let unit = 2f32.powi(exponent);
        let plane = |p: [i32; 3], x: f32, y: f32| {
            let [base, dx, dy] = p.map(|n| n as f32 / 1000.0);
            unit * (0.2 + base + 0.02 * (dx - 0.5) * (x - 3.5) + 0.02 * (dy - 0.5) * (y - 3.5))
        };
        // Where they cross inside the block there are more than two regions.
        let apart = |x: f32, y: f32| plane(a, x, y) - plane(b, x, y);
        let corners = [(0.0, 0.0), (7.0, 0.0), (0.0, 7.0), (7.0, 7.0)].map(|(x, y)| apart(x, y));
        prop_assume!(corners.iter().all(|d| d.abs() > 0.05 * unit) && corners.iter().all(|d| d.signum() == corners[0].signum()));
        let (sin, cos) = (turn as f32 / 100.0).sin_cos();
        let side = |x: f32, y: f32| cos * (x - 3.5) + sin * (y - 3.5) < at as f32 / 100.0 - 3.5;
        let (values, image) = encode(8, 8, |x, y| plane(if side(x, y) { a } else { b }, x, y));
        let (worst, _) = compare(&values, &image);
        prop_assert!(worst < 4e-3, "{worst}");
    }

    #[test]
    fn any_values_come_back_finite(values in prop::collection::vec(any::<u32>(), 64)) {
        let values: Vec<f32> = values.into_iter().map(f32::from_bits).collect();
        let decoded = PlaneImage::encode(8, 8, &values).expect("64 values").decode();
        prop_assert!(decoded.iter().all(|value| value.is_finite() && *value >= 0.0));
    }
}

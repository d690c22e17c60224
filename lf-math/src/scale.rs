//! Lengths and triangle normals of vectors of any size: squares leave the range of `f32` below 1e-19 and above 1e19.
//!
//! Vectors are scaled by a power of two first, which rounds nothing: where squares would have stayed in range the result is the same to the bit.

use glam::Vec3;

/// The length of a vector, right for every one whose length `f32` holds; NaN or infinite if a component is.
#[must_use]
#[inline]
pub fn length(v: Vec3) -> f32 {
    let scale = to_one(v.abs().max_element());
    (v * scale).length() / scale
}

/// The unit normal of a triangle's plane, counter-clockwise corners seen from its tip; `None` if it has no area.
///
/// Relative error: a few ulp over the sine of the angle at the first corner.
#[must_use]
pub fn triangle_normal([a, b, c]: [Vec3; 3]) -> Option<Vec3> {
    let edge = |to: Vec3| (to - a) * to_one((to - a).abs().max_element());
    crate::normalized(edge(b).cross(edge(c)))
}

/// The power of two that brings a size to between 1 and 2, as far as a normal number can; 1 for 0, infinity and NaN.
#[inline]
pub(crate) fn to_one(size: f32) -> f32 {
    const BIAS: i32 = 127;
    match ((size.to_bits() >> 23) & 0xff) as i32 {
        255 => 1.0,
        0 if size == 0.0 => 1.0,
        exponent => f32::from_bits(((2 * BIAS - exponent).clamp(1, 2 * BIAS) as u32) << 23),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_come_to_between_one_and_two() {
        for size in [1e-38f32, 1e-30, 0.3, 1.0, 1.999, 7.0, 1e30] {
            assert!((1.0..2.0).contains(&(size * to_one(size))), "{size}");
        }
        // The largest numbers end just below 1: a scale of 2⁻¹²⁷ would not be normal. Subnormal ones stay small.
        assert!((0.5..4.0).contains(&(f32::MAX * to_one(f32::MAX))));
        assert!(1e-45 * to_one(1e-45) > 1e-8);
        assert_eq!([0.0, f32::INFINITY, f32::NAN].map(to_one), [1.0; 3]);
    }

    #[test]
    fn lengths_keep_their_bits_and_their_range() {
        for v in [Vec3::new(3.0, 4.0, 12.0), Vec3::new(0.1, -0.7, 0.3), Vec3::ZERO] {
            assert_eq!(length(v), v.length());
            for exponent in [-120, -70, 70, 120] {
                let scale = 2.0f32.powi(exponent);
                assert_eq!(length(v * scale), v.length() * scale, "{v} {exponent}");
            }
        }
        assert!((length(Vec3::splat(1e-42)) - 1.732e-42).abs() < 1e-44);
        assert_eq!(length(Vec3::new(0.0, f32::NEG_INFINITY, 1.0)), f32::INFINITY);
        assert!(length(Vec3::new(1.0, f32::NAN, 0.0)).is_nan());
    }

    #[test]
    fn normals_of_triangles_of_any_size() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        for size in [1e-44f32, 1e-30, 1e-20, 1.0, 1e20, 1e38] {
            assert_eq!(triangle_normal(corners.map(|c| c * size)), Some(Vec3::Z), "{size}");
        }
        // Edges of very different lengths.
        assert_eq!(triangle_normal([Vec3::ZERO, Vec3::X * 1e-30, Vec3::Y * 1e30]), Some(Vec3::Z));
        assert_eq!(triangle_normal([Vec3::ZERO, Vec3::ONE, Vec3::ONE * 2.0]), None);
        assert_eq!(triangle_normal([Vec3::ZERO, Vec3::ONE, Vec3::NAN]), None);
    }
}

//! The sRGB transfer function (IEC 61966-2-1).

use glam::Vec3;

/// Clamps to 0 … 1 and turns NaN into 0, which `clamp` would pass on.
#[expect(clippy::manual_clamp, reason = "clamp keeps NaN")]
fn unit_range(x: f32) -> f32 {
    x.max(0.0).min(1.0)
}

/// The sRGB encoding of one linear component. Input and output range over 0 … 1; what lies outside is clamped, NaN gives 0.
#[must_use]
pub fn srgb_from_linear(linear: f32) -> f32 {
    let x = unit_range(linear);
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::powf(x, 1.0 / 2.4) - 0.055 }
}

/// The linear value of one sRGB-encoded component in 0 … 1.
#[must_use]
pub fn linear_from_srgb(encoded: f32) -> f32 {
    let x = unit_range(encoded);
    if x <= 0.040_45 { x / 12.92 } else { libm::powf((x + 0.055) / 1.055, 2.4) }
}

/// A linear colour as 8-bit sRGB, rounded to nearest.
#[must_use]
pub fn srgb8_from_linear(linear: Vec3) -> [u8; 3] {
    linear.to_array().map(|c| (255.0 * srgb_from_linear(c) + 0.5) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_8_bit_value_round_trips() {
        for byte in 0..=255u8 {
            let linear = linear_from_srgb(f32::from(byte) / 255.0);
            assert_eq!(srgb8_from_linear(Vec3::splat(linear)), [byte; 3]);
        }
    }

    #[test]
    fn out_of_range_is_clamped() {
        let encoded = srgb8_from_linear(Vec3::new(f32::NAN, -1.0, f32::INFINITY));
        assert_eq!(encoded, [0, 0, 255]);
    }

    #[test]
    fn known_values() {
        assert_eq!(srgb8_from_linear(Vec3::new(0.5, 0.214_041_14, 0.0)), [188, 128, 0]);
    }
}

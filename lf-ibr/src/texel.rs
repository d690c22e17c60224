//! Kinds of texels that fields are made of.

use glam::Vec3;
use half::f16;
use lf_math::srgb_from_linear;

use crate::frame::decoded;

/// A texel as it is stored and interpolated.
pub trait Texel: Copy + Send + Sync {
    /// The value to interpolate.
    fn value(self) -> Vec3;
    /// The sRGB-encoded colour, 0 … 1, of an interpolated value.
    fn color(value: Vec3) -> Vec3;
    /// The linear light of an interpolated value, which may exceed 1.
    fn radiance(value: Vec3) -> Vec3;
}

/// 8-bit, sRGB-encoded; alpha is ignored.
impl Texel for [u8; 4] {
    fn value(self) -> Vec3 {
        let [r, g, b, _] = self;
        Vec3::new(f32::from(r), f32::from(g), f32::from(b))
    }

    fn color(value: Vec3) -> Vec3 {
        value / 255.0
    }

    fn radiance(value: Vec3) -> Vec3 {
        decoded(Self::color(value))
    }
}

/// Linear half floats. What is brighter than 1 is clipped.
impl Texel for [f16; 3] {
    fn value(self) -> Vec3 {
        Vec3::from(self.map(f16::to_f32))
    }

    fn color(value: Vec3) -> Vec3 {
        Vec3::from(value.to_array().map(|v| srgb_from_linear(v.clamp(0.0, 1.0))))
    }

    fn radiance(value: Vec3) -> Vec3 {
        value
    }
}

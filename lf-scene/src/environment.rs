//! Light from infinitely far away, all around.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use glam::Vec3;
use lf_math::{GeometryError, Image};

/// The radiance that arrives from outside the scene.
#[derive(Debug, Clone, PartialEq)]
pub enum Environment {
    /// Radiance of the zenith; the horizon has three quarters of it, the nadir half.
    Sky(Vec3),
    /// A panorama.
    Map(Arc<EnvironmentMap>),
}

/// A panorama of radiance in equirectangular projection. The first row looks up (+Y); the middle column looks along −Z, as
/// a glTF camera does, and the columns to its right towards +X. A turn moves the middle column towards +X.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentMap {
    radiance: Image<Vec3>,
    turn: f32,
}

impl Environment {
    /// Nothing shines.
    pub const BLACK: Self = Self::Sky(Vec3::ZERO);

    /// Radiance along a unit direction, linear RGB, W/(m²·sr).
    #[must_use]
    pub fn towards(&self, direction: Vec3) -> Vec3 {
        match self {
            Self::Sky(zenith) => zenith * (0.75 + 0.25 * direction.y),
            Self::Map(map) => map.towards(direction),
        }
    }
}

impl EnvironmentMap {
    /// A panorama of linear RGB radiance, W/(m²·sr), turned about +Y by `turn` radians.
    ///
    /// # Errors
    /// All values must be finite and none negative; the turn must be finite.
    pub fn new(radiance: Image<Vec3>, turn: f32) -> Result<Self, GeometryError> {
        let values = radiance.texels().iter().flat_map(|texel| texel.to_array()).chain([turn.abs()]);
        for value in values {
            if !(value.is_finite() && value >= 0.0) {
                return Err(GeometryError::NotFinite { what: "radiance of the environment", value });
            }
        }
        Ok(Self { radiance, turn })
    }

    /// Radiance along a unit direction, bilinearly interpolated.
    fn towards(&self, direction: Vec3) -> Vec3 {
        let (width, height) = (self.radiance.width(), self.radiance.height());
        let u = (direction.x.atan2(-direction.z) - self.turn) / TAU + 0.5;
        let v = direction.y.clamp(-1.0, 1.0).acos() / PI;
        let (x, y) = (u.rem_euclid(1.0) * width as f32 - 0.5, (v * height as f32 - 0.5).max(0.0));
        let (left, top) = (x.floor(), y.floor());
        let column = |i: i64| i.rem_euclid(i64::from(width)) as u32;
        let row = |i: f32| (i as u32).min(height - 1);
        let across = |y: u32| {
            let texel = |i: i64| self.radiance.get(column(i), y);
            texel(left as i64).lerp(texel(left as i64 + 1), x - left)
        };
        across(row(top)).lerp(across(row(top + 1.0)), y - top)
    }
}

//! How much of the mirrored light a surface gives back.

use glam::Vec3;

use crate::error::{GeometryError, finite};

/// The reflectance of a smooth surface: a tint, and how it falls off from grazing to perpendicular sight.
///
/// Works on linear light. What is not reflected is absorbed: the body below is black.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflectance {
    tint: Vec3,
    f0: Option<f32>,
}

impl Reflectance {
    /// A perfect mirror.
    pub const MIRROR: Self = Self { tint: Vec3::ONE, f0: None };

    /// Linear Rec. 709 shares of red, green and blue. With `f0`, the share reflected at perpendicular sight (0.04 is glass,
    /// 0.02 water), reflection grows towards grazing sight by Schlick's approximation of Fresnel's equations.
    ///
    /// # Errors
    /// All must be within 0 … 1.
    pub fn new(tint: Vec3, f0: Option<f32>) -> Result<Self, GeometryError> {
        for share in tint.to_array().into_iter().chain(f0) {
            let value = finite("reflectance", share)?;
            if !(0.0..=1.0).contains(&value) {
                return Err(GeometryError::TooLarge { what: "reflectance, which is from 0 to 1,", value, max: 1.0 });
            }
        }
        Ok(Self { tint, f0 })
    }

    /// Linear shares of red, green and blue.
    #[must_use]
    pub fn tint(&self) -> Vec3 {
        self.tint
    }

    /// The share reflected at perpendicular sight; `None` if it is the same everywhere.
    #[must_use]
    pub fn f0(&self) -> Option<f32> {
        self.f0
    }

    /// The shares of linear light reflected where normal and ray enclose an angle of this cosine (Schlick 1994, Eq. 15):
    /// tint·(f₀ + (1 − f₀)(1 − cos θ)⁵).
    #[must_use]
    pub fn at(&self, cosine: f32) -> Vec3 {
        let away = (1.0 - cosine.abs()).clamp(0.0, 1.0);
        let squared = away * away;
        self.tint * self.f0.map_or(1.0, |f0| f0 + (1.0 - f0) * squared * squared * away)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_out_of_range_are_refused() {
        assert!(Reflectance::new(Vec3::new(0.2, 1.0, 0.0), Some(1.0)).is_ok());
        assert!(Reflectance::new(Vec3::splat(1.1), None).is_err());
        assert!(Reflectance::new(Vec3::ONE, Some(-0.1)).is_err());
        assert!(Reflectance::new(Vec3::NAN, None).is_err() && Reflectance::new(Vec3::ONE, Some(f32::NAN)).is_err());
    }

    /// Fresnel's equations for unpolarised light on glass.
    #[test]
    fn schlick_is_near_fresnel() {
        let index = 1.5f64;
        let glass = Reflectance::new(Vec3::ONE, Some(0.04)).unwrap();
        for i in 0..=90 {
            let cosine = f64::from(i).to_radians().cos();
            let below = (1.0 - (1.0 - cosine * cosine) / (index * index)).sqrt();
            let s = (cosine - index * below) / (cosine + index * below);
            let p = (below - index * cosine) / (below + index * cosine);
            let exact = 0.5 * (s * s + p * p);
            let found = f64::from(glass.at(cosine as f32).x);
            assert!((found - exact).abs() < 0.05, "{i}°: {found} {exact}");
        }
        assert_eq!(glass.at(1.0), Vec3::splat(0.04));
        assert_eq!(glass.at(0.0), Vec3::ONE);
        assert_eq!(Reflectance::MIRROR.at(0.3), Vec3::ONE);
    }
}

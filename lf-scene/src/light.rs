//! The light of a scene, in radiometric units: what shines without being a surface. (Glowing surfaces are materials with
//! emission.)

use std::f32::consts::PI;

use glam::Vec3;

use crate::environment::Environment;

/// The largest radiance that a file may bring, W/(m²·sr): above it products of radiances would leave `f32` in long paths.
pub(crate) const MAX_RADIANCE: f32 = 1e9;

/// One light without extent, world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// Shines from a point; falls with the square of the distance.
    Point {
        /// Where it is, metres.
        position: Vec3,
        /// Radiant intensity, linear RGB, W/sr.
        intensity: Vec3,
    },
    /// Shines from a point into a cone.
    Spot {
        /// Where it is, metres.
        position: Vec3,
        /// Unit vector along the cone's axis, away from the light.
        direction: Vec3,
        /// Radiant intensity on the axis, linear RGB, W/sr.
        intensity: Vec3,
        /// Half angle up to which the intensity is full, radians, less than `outer`.
        inner: f32,
        /// Half angle of the cone, radians, at most π/2.
        outer: f32,
    },
    /// Shines from infinitely far away.
    Sun {
        /// Unit vector from the scene towards the light.
        towards: Vec3,
        /// Irradiance of a surface facing it, linear RGB, W/m².
        irradiance: Vec3,
    },
}

/// All the light of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Lighting {
    /// The lights that cast shadows.
    pub lights: Vec<Light>,
    /// Stands for indirect light where that is not traced: radiance that reaches a surface facing up from everywhere,
    /// without shadow; one facing down gets half. Left out of global illumination.
    pub ambient: Vec3,
    /// What rays see that leave the scene.
    pub environment: Environment,
}

/// What a light sends to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Illuminant {
    /// Unit vector from the point to the light.
    pub towards: Vec3,
    /// Distance of the light, metres; infinite for a sun.
    pub distance: f32,
    /// Irradiance of a surface at the point that faces the light, linear RGB, W/m², nothing being in between.
    pub irradiance: Vec3,
}

impl Light {
    /// What reaches a point; `None` at the light itself.
    #[must_use]
    pub fn at(&self, point: Vec3) -> Option<Illuminant> {
        match *self {
            Self::Sun { towards, irradiance } => Some(Illuminant { towards, distance: f32::INFINITY, irradiance }),
            Self::Point { position, intensity } => from_point(position, intensity, point),
            Self::Spot { position, direction, intensity, inner, outer } => {
                let mut seen = from_point(position, intensity, point)?;
                seen.irradiance *= falloff(-seen.towards.dot(direction), inner, outer);
                Some(seen)
            }
        }
    }
}

fn from_point(position: Vec3, intensity: Vec3, point: Vec3) -> Option<Illuminant> {
    let to = position - point;
    let distance = to.length();
    // Divided twice: the square of a small distance may be too small for a float.
    let at = || Illuminant { towards: to / distance, distance, irradiance: intensity / distance / distance };
    (distance > 0.0).then(at)
}

/// The share of the intensity at an angle of the given cosine from a spot light's axis (KHR_lights_punctual).
fn falloff(cosine: f32, inner: f32, outer: f32) -> f32 {
    let (full, none) = (inner.cos(), outer.cos());
    let share = ((cosine - none) / (full - none).max(1e-3)).clamp(0.0, 1.0);
    share * share
}

impl Lighting {
    /// Nothing shines but the surroundings.
    #[must_use]
    pub fn from_environment(environment: Environment) -> Self {
        Self { lights: vec![], ambient: Vec3::ZERO, environment }
    }

    /// Ambient irradiance of a surface of the given unit normal, W/m².
    #[must_use]
    pub fn ambient_on(&self, normal: Vec3) -> Vec3 {
        PI * self.ambient * (0.75 + 0.25 * normal.y)
    }
}

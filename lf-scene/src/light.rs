//! Direct light.
//!
//! Amounts of light are given as the radiance that a white diffuse surface facing it sends back, which is the radiometric
//! irradiance divided by π.

use glam::Vec3;

/// One light, world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// Shines from a point; falls with the square of the distance.
    Point {
        /// Where it is, metres.
        position: Vec3,
        /// What a white surface at 1 m sends back, linear RGB.
        intensity: Vec3,
    },
    /// Shines from infinitely far away.
    Sun {
        /// Unit vector from the scene towards the light.
        towards: Vec3,
        /// What a white surface facing it sends back, linear RGB.
        strength: Vec3,
    },
}

/// All the light of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Lighting {
    /// The lights that cast shadows.
    pub lights: Vec<Light>,
    /// Radiance that reaches a surface facing up from everywhere, without shadow; one facing down gets half.
    pub ambient: Vec3,
    /// Radiance of rays that leave the scene upwards; the horizon is half as bright.
    pub sky: Vec3,
}

impl Light {
    /// Direction to the light from a point (unit), distance, and what a white surface facing the light there sends back;
    /// `None` at the light itself.
    #[must_use]
    pub fn seen_from(&self, point: Vec3) -> Option<(Vec3, f32, Vec3)> {
        match *self {
            Self::Sun { towards, strength } => Some((towards, f32::INFINITY, strength)),
            Self::Point { position, intensity } => {
                let to = position - point;
                let distance = to.length();
                (distance > 0.0).then(|| (to / distance, distance, intensity / (distance * distance)))
            }
        }
    }
}

impl Lighting {
    /// Ambient radiance reflected by a white surface of the given unit normal.
    #[must_use]
    pub fn ambient_on(&self, normal: Vec3) -> Vec3 {
        self.ambient * (0.75 + 0.25 * normal.y)
    }

    /// Radiance of the sky along a unit direction.
    #[must_use]
    pub fn sky_towards(&self, direction: Vec3) -> Vec3 {
        self.sky * (0.75 + 0.25 * direction.y)
    }
}

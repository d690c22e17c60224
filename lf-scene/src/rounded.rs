//! Points on triangles, and how far rounding may have moved them.

use glam::{DVec3, Vec3};

use crate::bvh::interpolate;

/// A point of a triangle, calculated in single precision.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RoundedPoint {
    /// What came out.
    pub(crate) position: Vec3,
    /// How far each coordinate may be off.
    error: Vec3,
}

impl RoundedPoint {
    /// The point of given shares of the corners (Pharr, Jakob & Humphreys: Physically Based Rendering, 3rd ed., §3.9.4).
    pub(crate) fn new(corners: [Vec3; 3], shares: Vec3) -> Self {
        const UNIT: f32 = 0.5 * f32::EPSILON;
        const GAMMA_7: f32 = 7.0 * UNIT / (1.0 - 7.0 * UNIT);
        let error = GAMMA_7 * interpolate(corners.map(Vec3::abs), shares.abs());
        Self { position: interpolate(corners, shares), error }
    }

    /// The point moved along its plane's unit normal until it is surely on that side (ibid., §3.9.5).
    pub(crate) fn lifted(&self, normal: Vec3) -> Vec3 {
        let offset = normal * normal.abs().dot(self.error);
        let onwards = |axis: usize| match (self.position[axis], offset[axis]) {
            (from, step) if step > 0.0 => (from + step).next_up(),
            (from, step) if step < 0.0 => (from + step).next_down(),
            (from, _) => from,
        };
        Vec3::from_array(std::array::from_fn(onwards))
    }

    /// Whether the point may lie in a triangle's plane. A ray from there cannot meet the triangle, but rounding may say so:
    /// the other half of a square is met at a distance of 0 if the point is on the diagonal.
    pub(crate) fn may_lie_in(&self, corners: [Vec3; 3]) -> bool {
        let [a, b, c]: [DVec3; 3] = corners.map(Vec3::as_dvec3);
        let normal = (b - a).cross(c - a);
        let height = normal.dot(self.position.as_dvec3() - a);
        height.abs() <= normal.abs().dot(self.error.as_dvec3())
    }
}

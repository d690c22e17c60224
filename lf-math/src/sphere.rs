//! Lines and spheres.

use glam::Vec3;

/// How far along a unit direction a line leaves the sphere around the origin, for a line that starts at `from`; `None` if it passes
/// the sphere by.
///
/// The discriminant is that of the point of the line nearest to the centre, (r + n)(r − n), not b² − c, which cancels far from the
/// sphere (Haines et al., *Precision Improvements for Ray/Sphere Intersection*, Ray Tracing Gems, 2019). Forward error: a few ulp of
/// |from|·(1 + n/h), n being the line's distance from the centre and h half of its chord. Squares of lengths must be in the
/// range of `f32`.
#[must_use]
#[inline]
pub fn sphere_exit(from: Vec3, direction: Vec3, radius: f32) -> Option<f32> {
    let along = from.dot(direction);
    let nearest = (from - along * direction).length();
    let half_chord = (radius + nearest) * (radius - nearest);
    (half_chord >= 0.0).then(|| libm::sqrtf(half_chord) - along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_is_left_behind_its_centre() {
        assert_eq!(sphere_exit(Vec3::new(0.0, 3.0, -9.0), Vec3::Z, 5.0), Some(13.0));
        assert_eq!(sphere_exit(Vec3::new(0.0, 3.0, 9.0), Vec3::Z, 5.0), Some(-5.0));
        assert_eq!(sphere_exit(Vec3::new(0.0, 5.0, 0.0), Vec3::X, 5.0), Some(0.0));
        assert_eq!(sphere_exit(Vec3::new(0.0, 5.001, 0.0), Vec3::X, 5.0), None);
        assert_eq!(sphere_exit(Vec3::NAN, Vec3::X, 5.0), None);
    }
}

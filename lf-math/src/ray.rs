//! Rays and reflection.

use glam::Vec3;

/// A ray in cell space. The direction need not have unit length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where the ray starts, metres.
    pub origin: Vec3,
    /// Where it goes.
    pub direction: Vec3,
}

impl Ray {
    /// The point `origin + t·direction`.
    #[inline]
    #[must_use]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// Mirrors an incident direction about a unit normal: `D − 2·N·(D·N)`.
///
/// This is the paper's Eq. 2, whose printed plus sign is a slip: its own shader (Fig. 6) calls `reflect`, which has the
/// minus. The sign of the normal does not matter. `incident` may have any length up to 1e37.
#[must_use]
pub fn reflect(incident: Vec3, unit_normal: Vec3) -> Vec3 {
    incident - 2.0 * incident.dot(unit_normal) * unit_normal
}

/// The unit vector of `v`, or `None` if `v` is zero or not finite.
///
/// Scales by the largest component first, so that neither 1e-30 nor 1e30 leaves the range of `f32`.
#[inline]
#[must_use]
pub fn normalized(v: Vec3) -> Option<Vec3> {
    let largest = v.abs().max_element();
    // NaN components can hide from `max_element`, so the vector itself is asked too.
    (v.is_finite() && largest > 0.0).then(|| {
        // Two exact steps by powers of two would do; dividing costs half an ulp and also handles subnormals.
        (v / largest).normalize()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    #[test]
    fn reflection_keeps_the_tangent_and_flips_the_normal_part() {
        assert_eq!(reflect(Vec3::new(1.0, -2.0, 0.5), Vec3::Y), Vec3::new(1.0, 2.0, 0.5));
        assert_eq!(reflect(Vec3::new(1.0, -2.0, 0.5), -Vec3::Y), Vec3::new(1.0, 2.0, 0.5));
    }

    #[test]
    fn normalized_flags_what_has_no_direction() {
        for v in [Vec3::ZERO, Vec3::new(f32::NAN, 1.0, 0.0), Vec3::new(0.0, f32::INFINITY, 0.0)] {
            assert_eq!(normalized(v), None);
        }
    }

    proptest! {
        #[test]
        fn normalized_is_within_four_ulp(d in prop::array::uniform3(-1.0f32..1.0), exponent in -30i32..=30) {
            let v = Vec3::from(d) * 10f32.powi(exponent);
            prop_assume!(v.abs().max_element() > 1e-36);
            let exact = v.as_dvec3() / f64::sqrt(v.as_dvec3().dot(v.as_dvec3()));
            let error: DVec3 = normalized(v).unwrap().as_dvec3() - exact;
            prop_assert!(error.abs().max_element() <= 4.0 * f64::from(f32::EPSILON) / 2.0);
        }
    }
}

//! Where a ray ends, found by asking whether its points are hidden.
//!
//! A point of the ray is *free* of a cube if the cube sees past it. The ray ends at the first point that is not. It is looked for in
//! steps that are even in the inverse of the way, as the pictures are (Umenhoffer, Patow & Szirmay-Kalos 2007), then between
//! the last free point and the first that is not.

use glam::Vec3;
use lf_math::Ray;

/// A place is in front of what is seen if its relative depth is less than this; what is closer to 1 may be rounding, as devices
/// keep depths in half floats.
pub(crate) const IN_FRONT: f32 = 1.0 - 1.0 / 2048.0;

/// Where a ray ends, as parameters of the ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing {
    /// The last point found free.
    pub(crate) free: f32,
    /// The first found that is not.
    pub(crate) hidden: f32,
}

/// The first of `steps` points after `from` up to `to`, both greater than 0, that is not free, and the one before it, their distance
/// halved `halvings` times. `None` if all are free.
pub(crate) fn crossing(
    ray: &Ray,
    [from, to]: [f32; 2],
    steps: u32,
    halvings: u32,
    mut free: impl FnMut(Vec3) -> bool,
) -> Option<Crossing> {
    let (near, far) = (from.recip(), to.recip());
    let step = (near - far) / steps as f32;
    let mut last = near;
    for i in 1..=steps {
        // The last of the steps may round to beyond infinity.
        let mut next = (near - i as f32 * step).max(far);
        if free(ray.at(next.recip())) {
            last = next;
            continue;
        }
        for _ in 0..halvings {
            let middle = 0.5 * (last + next);
            *(if free(ray.at(middle.recip())) { &mut last } else { &mut next }) = middle;
        }
        return Some(Crossing { free: last.recip(), hidden: next.recip() });
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_wall_is_found_to_a_part_of_a_step() {
        let ray = Ray { origin: Vec3::ZERO, direction: Vec3::X };
        // Free from 0 to 3 and from 4 on.
        let free = |p: Vec3| p.x < 3.0 || p.x >= 4.0;
        let found = crossing(&ray, [0.5, 50.0], 32, 8, free).unwrap();
        assert!(found.free < 3.0 && found.hidden >= 3.0);
        let step = (2.0 - 0.02) / 32.0 / 256.0;
        assert!((found.free.recip() - found.hidden.recip() - step).abs() < 1e-6, "{found:?}");
        assert_eq!(crossing(&ray, [0.5, 2.9], 32, 8, free), None);
    }

    #[test]
    fn no_step_leads_beyond_the_end() {
        let ray = Ray { origin: Vec3::ZERO, direction: Vec3::X };
        // Far ends whose inverse is lost beside that of the near one.
        for far in [10.0, 1e7, 1e9, 1e20, 1e38] {
            for (near, steps) in [(0.01, 64), (0.3, 7), (0.5, 128)] {
                let mut last = near;
                let mut free = |p: Vec3| {
                    assert!(p.is_finite() && p.x >= last && p.x <= far * (1.0 + 1e-6), "{near} {far} {steps}: {p}");
                    last = p.x * (1.0 - 1e-6);
                    true
                };
                assert_eq!(crossing(&ray, [near, far], steps, 6, &mut free), None);
            }
        }
    }
}

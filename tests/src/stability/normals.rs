//! Unit vectors: of vectors, and of triangles' planes.

use glam::{DVec3, Vec3};
use lf_math::{normalized, triangle_normal};

use super::draws::Draws;
use super::{DRAWS, Row, Tally, U};

/// Distance of neighbouring `f32` near a number.
fn ulp(x: f64) -> f64 {
    let x = x.abs() as f32;
    f64::from(x.next_up()) - f64::from(x)
}

/// The textbook's way: squares leave the range of `f32`, and zero has no direction.
#[must_use]
pub fn plain_normalized(v: Vec3) -> Option<Vec3> {
    Some(v.normalize())
}

/// The cross product of the edges as they are.
#[must_use]
pub fn plain_triangle_normal([a, b, c]: [Vec3; 3]) -> Option<Vec3> {
    normalized((b - a).cross(c - a))
}

/// Each component in units of its own last place. Rule: none for what is zero or not finite.
#[must_use]
pub fn normalise() -> Row {
    normalised("normalise, any length", normalized, [4.0, 4.0])
}

/// By [`plain_normalized`].
#[must_use]
pub fn plain_normalise() -> Row {
    normalised("normalise by v / ‖v‖, for comparison", plain_normalized, [f64::INFINITY; 2])
}

fn normalised(name: &'static str, unit: fn(Vec3) -> Option<Vec3>, limits: [f64; 2]) -> Row {
    let (mut draws, mut tally) = (Draws::new(1), Tally::default());
    for _ in 0..2 * DRAWS {
        let v = draws.odd_vector(1e-30, 1e30);
        let exact = v.as_dvec3();
        let has_direction = v.is_finite() && exact.length_squared() > 0.0;
        let found = unit(v);
        tally.rule(found.is_some() == has_direction);
        if let Some(found) = found.filter(|_| has_direction) {
            let exact = exact / exact.length();
            let errors = [0, 1, 2].map(|i| (f64::from(found[i]) - exact[i]).abs() / ulp(exact[i]));
            tally.ratio(if found.is_nan() { f64::NAN } else { errors.into_iter().fold(0.0, f64::max) }, 1.0);
        }
    }
    tally.row(name, "ulp", limits)
}

/// Needles and slivers: κ is one over the sine of the angle at the first corner.
#[must_use]
pub fn triangle() -> Row {
    triangles("normal of a triangle", triangle_normal, [8.0, 16.0])
}

/// By [`plain_triangle_normal`].
#[must_use]
pub fn plain_triangle() -> Row {
    triangles("normal of a triangle, edges as they are, for comparison", plain_triangle_normal, [f64::INFINITY; 2])
}

/// A triangle of a size in a range, with any angle at its first corner.
pub fn needle(draws: &mut Draws, [least, most]: [f64; 2]) -> [Vec3; 3] {
    let size = draws.log(least, most);
    let along = draws.direction();
    let across = along.cross(draws.direction());
    let (sine, length) = (draws.log(1e-6, 1.0), draws.log(1e-4, 1e4));
    [DVec3::ZERO, along * size, (along + across * sine) * size * length].map(DVec3::as_vec3)
}

fn triangles(name: &'static str, normal_of: fn([Vec3; 3]) -> Option<Vec3>, limits: [f64; 2]) -> Row {
    let (mut draws, mut tally) = (Draws::new(2), Tally::default());
    for _ in 0..DRAWS {
        let corners = needle(&mut draws, [1e-30, 1e30]);
        let [b, c] = [1, 2].map(|i| corners[i].as_dvec3());
        let normal = b.cross(c);
        let kappa = b.length() * c.length() / normal.length();
        let found = normal_of(corners);
        // Corners may fall on one line when they are rounded.
        tally.rule(found.is_some() || kappa * U > 0.1);
        if let Some(found) = found
            && kappa * U < 0.1
        {
            tally.ratio((found.as_dvec3() - normal / normal.length()).length(), kappa * U);
        }
    }
    tally.row(name, "κ·u", limits)
}

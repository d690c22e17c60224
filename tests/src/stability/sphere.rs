//! Lines and spheres: the one that the product takes, and the textbook's for comparison.

use glam::Vec3;
use lf_math::{normalized, sphere_exit};

use super::draws::Draws;
use super::{DRAWS, Row, Tally, U};

/// A way to intersect.
pub type Exit = fn(Vec3, Vec3, f32) -> Option<f32>;

/// The quadratic's root by b² − c.
#[must_use]
pub fn naive_exit(from: Vec3, direction: Vec3, radius: f32) -> Option<f32> {
    let along = from.dot(direction);
    let discriminant = along * along - (from.length_squared() - radius * radius);
    (discriminant >= 0.0).then(|| discriminant.sqrt() - along)
}

/// A line, mostly close to the silhouette, from within and from up to 10⁴ radii away.
#[must_use]
pub fn line(draws: &mut Draws) -> (Vec3, Vec3, f32) {
    let radius = draws.log(1e-6, 1e6);
    let direction = draws.direction();
    let side = direction.cross(draws.direction()).normalize();
    let missed = draws.log(1e-7, 1.0);
    let away = radius * draws.log(0.1, 1e4) * draws.sign();
    let from = side * radius * (1.0 - missed) + direction * away;
    (from.as_vec3(), normalized(direction.as_vec3()).expect("a direction"), radius as f32)
}

/// The exact parameter and its condition number; `None` if the line passes by.
fn exact_exit(from: Vec3, direction: Vec3, radius: f32) -> Option<(f64, f64)> {
    let (from, d, radius) = (from.as_dvec3(), direction.as_dvec3(), f64::from(radius));
    let unit = d / d.length();
    let along = from.dot(unit);
    let nearest = (from - along * unit).length();
    let half_chord = ((radius + nearest) * (radius - nearest)).max(0.0).sqrt();
    // The line moves by |from| times the change of any input, the sphere by its radius, and the exit by n/h times as much.
    let kappa = from.length() + (from.length() + radius) * nearest / half_chord;
    (nearest <= radius).then(|| ((half_chord - along) / d.length(), kappa))
}

/// Rule: no hit is lost beyond 4u of the silhouette, as a share of how far the line's start and the sphere reach.
fn measured(name: &'static str, exit: Exit, limits: [f64; 2]) -> Row {
    let (mut draws, mut tally) = (Draws::new(40), Tally::default());
    for _ in 0..2 * DRAWS {
        let (from, direction, radius) = line(&mut draws);
        let Some((exact, kappa)) = exact_exit(from, direction, radius) else { continue };
        let reach = from.as_dvec3().length() + f64::from(radius);
        let nearest = from.as_dvec3().cross(direction.as_dvec3()).length() / direction.as_dvec3().length();
        let on_the_silhouette = f64::from(radius) - nearest <= 4.0 * U * reach;
        let found = exit(from, direction, radius);
        tally.rule(found.is_some() || on_the_silhouette);
        if let Some(t) = found.filter(|_| !on_the_silhouette) {
            tally.ratio(f64::from(t) - exact, kappa * U);
        }
    }
    tally.row(name, "κ·u", limits)
}

/// As the product does.
#[must_use]
pub fn robust() -> Row {
    measured("ray–sphere, grazing", sphere_exit, [64.0, 128.0])
}

/// As the textbook does: not in the product, and has nothing to pass.
#[must_use]
pub fn naive() -> Row {
    measured("ray–sphere by b² − c, for comparison", naive_exit, [f64::INFINITY; 2])
}

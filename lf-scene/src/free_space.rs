//! Finding room for a cell in a scene.

use std::f32::consts::TAU;

use glam::Vec3;
use lf_math::{Cell, Ray};

use crate::tracer::Tracer;

/// Directions cast to find how far the next surface is.
const DIRECTIONS: u32 = 256;

/// An empty ball in a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeSpace {
    /// Its centre, world space.
    pub center: Vec3,
    /// Distance to the nearest surface met, metres.
    pub radius: f32,
}

/// Distance from a point to the nearest surface, over 256 directions spread evenly; at most the scene's diagonal.
fn free_radius(tracer: &Tracer, point: Vec3) -> f32 {
    let (min, max) = tracer.scene().bounds();
    let hit = |direction| tracer.distance(point, direction);
    spiral(DIRECTIONS).filter_map(hit).fold((max - min).length(), f32::min)
}

/// Whether no surface is met inside a cell, along 256 directions spread evenly from its centre and towards its corners.
#[must_use]
pub fn is_free(tracer: &Tracer, cell: &Cell) -> bool {
    let corners = (0..8u32).map(|i| Vec3::new((i & 1) as f32, ((i >> 1) & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0);
    let center = cell.center().as_vec3();
    spiral(DIRECTIONS).chain(corners.map(|corner| corner * cell.half_extent())).all(|direction| {
        let exit = cell.exit(&Ray { origin: Vec3::ZERO, direction }).unwrap_or(0.0);
        tracer.distance(center, direction).is_none_or(|met| met > exit)
    })
}

/// The point with most room among places that can be seen from `eye`, looking along `forward` (any length), or all
/// around if `forward` is `None`. Places outside the scene's bounding box do not count, and none has more room than to
/// its sides, so that an open scene does not send the cell into the sky. `None` if there is no room at all, as when
/// `eye` lies in a surface.
#[must_use]
pub fn find_free_space(tracer: &Tracer, eye: Vec3, forward: Option<Vec3>) -> Option<FreeSpace> {
    let (min, max) = tracer.scene().bounds();
    let reach = 0.5 * (max - min).length();
    let ahead = forward.and_then(lf_math::normalized);
    // Within 40° of the line of sight, so that the cell is in the picture that the camera shows.
    let in_view = |direction: &Vec3| ahead.is_none_or(|ahead| direction.dot(ahead) > 0.766);
    let candidates = spiral(DIRECTIONS).filter(in_view).flat_map(|direction| {
        let free = tracer.distance(eye, direction).unwrap_or(reach).min(reach);
        (1..8).map(move |step| eye + direction * free * (step as f32 / 8.0))
    });
    let room = |center: Vec3| {
        let to_bounds = (center - min).min(max - center).min_element();
        FreeSpace { center, radius: if to_bounds > 0.0 { to_bounds.min(free_radius(tracer, center)) } else { 0.0 } }
    };
    candidates.map(room).filter(|space| space.radius > 0.0).max_by(|a, b| a.radius.total_cmp(&b.radius))
}

/// Unit vectors spread evenly over the sphere (a Fibonacci lattice).
fn spiral(count: u32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let y = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
        // Turning by the golden ratio's share of a circle leaves no two points close.
        let (sin, cos) = (TAU * (i as f32 * 0.618_034).fract()).sin_cos();
        let r = (1.0 - y * y).max(0.0).sqrt();
        Vec3::new(r * cos, y, r * sin)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Environment, Lighting, Material, SceneBuilder, museum};
    use glam::Vec2;

    #[test]
    fn the_museum_has_room_near_its_middle() {
        let tracer = Tracer::new(museum::scene());
        let found = find_free_space(&tracer, Vec3::new(0.0, 1.6, 3.5), Some(Vec3::NEG_Z)).expect("room");
        assert!(found.radius > 1.0, "{found:?}");
        assert!((found.radius - free_radius(&tracer, found.center)).abs() < 1e-6);
    }

    #[test]
    fn open_scenes_keep_the_cell_near_their_things() {
        let mut builder = SceneBuilder::default();
        let grey = builder.material(Material::diffuse(Vec3::splat(0.5)));
        builder.parallelogram(Vec3::ZERO, Vec3::Z * 10.0, Vec3::X * 10.0, Vec2::ONE, grey);
        builder.cuboid(Vec3::new(1.0, 0.0, 1.0), Vec3::new(2.0, 3.0, 2.0), grey);
        let lighting = Lighting::from_environment(Environment::BLACK);
        let tracer = Tracer::new(builder.build("open", lighting).unwrap());
        let found = find_free_space(&tracer, Vec3::new(5.0, 1.5, 5.0), None).expect("room");
        assert!(found.center.y + found.radius <= 3.0 && found.radius > 0.5, "{found:?}");
    }

    #[test]
    fn a_thing_inside_the_cell_is_noticed() {
        let tracer = Tracer::new(museum::scene());
        assert!(is_free(&tracer, &museum::cell()));
        let large = Cell::cube(museum::cell().center(), 2.9).unwrap();
        assert!(!is_free(&tracer, &large));
    }

    #[test]
    fn directions_are_unit_and_balanced() {
        let sum: Vec3 = spiral(DIRECTIONS).inspect(|d| assert!((d.length() - 1.0).abs() < 1e-5)).sum();
        assert!(sum.length() < 1.0, "{sum}");
    }
}

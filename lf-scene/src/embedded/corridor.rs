//! A corridor whose walls begin 1 m from the middle of the cell and whose far end is 1000 m away.
//!
//! It widens in steps, less than in proportion to the distance: from the cell a piece of wall is seen at every distance, and the
//! far end is still 7° wide. The squares on the walls grow with it.

use std::f32::consts::PI;

use glam::{DVec3, Vec2, Vec3};
use lf_math::Cell;

use crate::environment::Environment;
use crate::light::{Light, Lighting};
use crate::material::{Material, Pattern};
use crate::scene::{Scene, SceneBuilder};

/// Distance of the nearest walls from the cell's middle, metres.
const NEAR: f32 = 1.0;
/// Distance of the far end, metres.
const FAR: f32 = 1000.0;
/// Pieces of the corridor, each 1.8 times as long as the one before.
const SECTIONS: u32 = 12;
/// How fast it widens: with this power of the distance.
const WIDENING: f32 = 0.6;

/// The corridor, along +Z.
#[must_use]
pub fn scene() -> Scene {
    let mut builder = SceneBuilder::default();
    let lights = (0..SECTIONS).map(|section| add_section(&mut builder, section)).collect();
    let lighting = Lighting { lights, ambient: Vec3::splat(0.45), environment: Environment::BLACK };
    builder.build("corridor", lighting).unwrap_or_else(|_| unreachable!("the corridor is made of finite triangles"))
}

/// The cell: a cube of 0.5 m in the middle of the corridor's beginning.
#[must_use]
pub fn cell() -> Cell {
    Cell::cube(DVec3::ZERO, 0.5).unwrap_or_else(|_| unreachable!("a finite cube"))
}

/// Where a section begins, metres from the cell's middle; the first one begins behind the cell.
fn start(section: u32) -> f32 {
    if section == 0 { -NEAR } else { NEAR * (FAR / NEAR).powf(section as f32 / SECTIONS as f32) }
}

/// Half the width and height of a section, metres.
fn half_width(section: u32) -> f32 {
    NEAR * (start(section) / NEAR).max(1.0).powf(WIDENING)
}

/// A piece of the corridor, the frame between it and the one before, and its lamp.
fn add_section(builder: &mut SceneBuilder, section: u32) -> Light {
    let (near, far, half) = (start(section), start(section + 1), half_width(section));
    let tint = [Vec3::new(0.75, 0.3, 0.2), Vec3::new(0.2, 0.55, 0.3), Vec3::new(0.25, 0.35, 0.75)];
    let color = tint[(section % 3) as usize];
    let checker = |dark: f32| Material::patterned(Pattern::Checker([color, Vec3::splat(dark)]));
    let [floor, ceiling, walls] = [0.1, 0.8, 0.4].map(|dark| builder.material(checker(dark)));
    for (corner, across, material) in [
        (Vec3::new(-half, -half, near), Vec3::X, floor),
        (Vec3::new(half, half, near), Vec3::NEG_X, ceiling),
        (Vec3::new(-half, half, near), Vec3::NEG_Y, walls),
        (Vec3::new(half, -half, near), Vec3::Y, walls),
    ] {
        // Four squares over the width.
        let uv = Vec2::new(far - near, 2.0 * half) * 2.0 / half;
        builder.parallelogram(corner, Vec3::Z * (far - near), across * 2.0 * half, uv, material);
    }
    frame(builder, near, if section == 0 { 0.0 } else { half_width(section - 1) }, half, walls);
    if section + 1 == SECTIONS {
        end(builder, half);
    }
    let position = Vec3::new(0.2 * half, 0.5 * half, 0.5 * (near + far));
    Light::Point { position, intensity: Vec3::splat(0.25 * PI * half * half) }
}

/// What lies between an opening and the walls around it; without an opening, a wall.
fn frame(builder: &mut SceneBuilder, z: f32, inner: f32, outer: f32, material: u32) {
    let mut panel = |min: Vec2, max: Vec2| {
        let size = max - min;
        builder.parallelogram(min.extend(z), Vec3::X * size.x, Vec3::Y * size.y, size * 2.0 / outer, material);
    };
    panel(Vec2::splat(-outer), Vec2::new(outer, -inner));
    panel(Vec2::new(-outer, inner), Vec2::splat(outer));
    if inner > 0.0 {
        panel(Vec2::new(-outer, -inner), Vec2::new(-inner, inner));
        panel(Vec2::new(inner, -inner), Vec2::new(outer, inner));
    }
}

/// The wall at the far end.
fn end(builder: &mut SceneBuilder, half: f32) {
    let colors = [Vec3::new(0.8, 0.1, 0.1), Vec3::splat(0.85), Vec3::new(0.1, 0.2, 0.8), Vec3::new(0.85, 0.7, 0.1)];
    let fields = builder.material(Material::patterned(Pattern::Fields(colors, 4.0)));
    let corner = Vec3::new(half, -half, FAR);
    builder.parallelogram(corner, Vec3::NEG_X * 2.0 * half, Vec3::Y * 2.0 * half, Vec2::ONE, fields);
}

#[cfg(test)]
mod tests {
    use super::super::tests::directions;
    use super::*;
    use crate::Tracer;

    #[test]
    fn it_is_closed_and_reaches_from_1_to_1000_metres() {
        let tracer = Tracer::new(scene());
        // The far end takes a thousandth of the sphere.
        let distances: Vec<f32> =
            directions(100_000).map(|d| tracer.distance(Vec3::ZERO, d).expect("closed")).collect();
        let nearest = distances.iter().copied().fold(f32::INFINITY, f32::min);
        let farthest = distances.iter().copied().fold(0.0, f32::max);
        assert!((nearest - NEAR).abs() < 1e-3 && (farthest / FAR - 1.0).abs() < 0.01, "{nearest} … {farthest}");
        // Something is seen in every power of 2 between.
        for power in 0..10 {
            let range = (1u32 << power) as f32..(2u32 << power) as f32;
            let seen = distances.iter().filter(|distance| range.contains(distance)).count();
            assert!(seen >= 20, "{seen} of 100 000 rays end at {range:?} m");
        }
    }

    #[test]
    fn squares_show_at_the_far_end() {
        let tracer = Tracer::new(scene());
        let seen = (-20..20).map(|i| tracer.trace(Vec3::ZERO, Vec3::new(i as f32 * 0.002, 0.01, 1.0)).radiance);
        let seen: Vec<Vec3> = seen.collect();
        let edges = seen.windows(2).filter(|pair| (pair[0] - pair[1]).length() > 0.1).count();
        assert!(edges >= 3, "{edges} edges in {seen:?}");
    }
}

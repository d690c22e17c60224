//! A museum room in the manner of the paper's Fig. 10.
//!
//! Coloured columns stand between the cell and framed pictures on the walls, so that a moving eye sees the columns
//! cover other parts of the pictures. The floor is a checkerboard; some small objects stand close to the cell.

use std::f32::consts::{PI, TAU};

use glam::{DVec3, Vec2, Vec3};
use lf_math::Cell;

use crate::environment::Environment;
use crate::light::{Light, Lighting};
use crate::material::{Material, Pattern};
use crate::scene::{Scene, SceneBuilder};

/// Half the room's width and depth, metres.
const HALF_ROOM: f32 = 5.0;
/// The room's height, metres.
const HEIGHT: f32 = 4.0;

/// The room.
#[must_use]
pub fn scene() -> Scene {
    let mut builder = SceneBuilder::default();
    shell(&mut builder);
    columns(&mut builder);
    for wall in 0..4 {
        pictures(&mut builder, wall);
    }
    near_objects(&mut builder);
    let lamp =
        |x: f32, z: f32| Light::Point { position: Vec3::new(x, 3.6, z), intensity: PI * Vec3::new(4.2, 4.0, 3.6) };
    let lighting = Lighting {
        lights: vec![lamp(-1.6, 1.2), lamp(2.2, -2.0)],
        ambient: Vec3::new(0.34, 0.35, 0.38),
        environment: Environment::BLACK,
    };
    builder.build("museum", lighting).unwrap_or_else(|_| unreachable!("the museum is made of finite triangles"))
}

/// The cell in the middle of the room: a cube of 1 m at 1.4 m above the floor.
#[must_use]
pub fn cell() -> Cell {
    Cell::cube(DVec3::new(0.0, 1.4, 0.0), 1.0).unwrap_or_else(|_| unreachable!("a finite cube"))
}

/// Floor, ceiling and four walls, facing inwards.
fn shell(builder: &mut SceneBuilder) {
    let (r, h) = (HALF_ROOM, HEIGHT);
    let floor = builder
        .material(Material::patterned(Pattern::Checker([Vec3::new(0.55, 0.5, 0.42), Vec3::new(0.12, 0.13, 0.16)])));
    let ceiling = builder.material(Material::diffuse(Vec3::splat(0.75)));
    let wall = builder.material(Material::diffuse(Vec3::new(0.62, 0.57, 0.5)));
    let skirting = builder.material(Material::diffuse(Vec3::new(0.2, 0.1, 0.06)));
    let (across, up, along) = (Vec3::X * 2.0 * r, Vec3::Y * h, Vec3::Z * 2.0 * r);
    let low = Vec3::new(-r, 0.0, -r);
    let high = Vec3::new(r, h, r);
    builder.parallelogram(low, along, across, Vec2::splat(2.0 * r), floor);
    builder.parallelogram(high, -along, -across, Vec2::ONE, ceiling);
    for (corner, u) in [(low, across), (Vec3::new(r, 0.0, -r), along), (high - up, -across), (low + along, -along)] {
        builder.parallelogram(corner, u, up, Vec2::ONE, wall);
        // A thin board in front of the foot of the wall.
        let inwards = u.cross(Vec3::Y).normalize() * -0.02;
        builder.parallelogram(corner + inwards, u, Vec3::Y * 0.15, Vec2::ONE, skirting);
    }
}

/// Eight columns on a circle around the cell.
fn columns(builder: &mut SceneBuilder) {
    let colors = [
        Vec3::new(0.75, 0.1, 0.08),
        Vec3::new(0.08, 0.45, 0.12),
        Vec3::new(0.08, 0.18, 0.7),
        Vec3::new(0.8, 0.6, 0.05),
        Vec3::new(0.5, 0.08, 0.5),
        Vec3::new(0.05, 0.5, 0.55),
        Vec3::new(0.85, 0.35, 0.05),
        Vec3::new(0.7, 0.7, 0.72),
    ];
    let stone = builder.material(Material::diffuse(Vec3::splat(0.45)));
    for (i, color) in (0..).zip(colors) {
        let angle = TAU * (i as f32 + 0.5) / 8.0;
        let foot = Vec3::new(angle.cos(), 0.0, angle.sin()) * 2.1;
        let shaft = builder.material(Material::diffuse(color));
        builder.column(foot, 0.17, HEIGHT, 32, shaft);
        for y in [0.0, HEIGHT - 0.2] {
            let low = foot + Vec3::new(-0.25, y, -0.25);
            builder.cuboid(low, low + Vec3::new(0.5, 0.2, 0.5), stone);
        }
    }
}

/// Three framed pictures on one of the four walls.
fn pictures(builder: &mut SceneBuilder, wall: u32) {
    let quarter = TAU * wall as f32 / 4.0;
    let inwards = Vec3::new(-quarter.cos(), 0.0, -quarter.sin());
    let along = Vec3::new(inwards.z, 0.0, -inwards.x);
    let frame = builder.material(Material::diffuse(Vec3::new(0.45, 0.3, 0.08)));
    for place in 0..3 {
        let size = Vec2::new(if place == 1 { 2.2 } else { 1.5 }, 1.5);
        let middle = inwards * -(HALF_ROOM - 0.08) + along * (place as f32 - 1.0) * 3.0 + Vec3::Y * 1.9;
        let canvas = builder.material(Material::patterned(painting(3 * wall + place)));
        let mut panel = |extent: Vec2, lift: f32, material: u32| {
            let (u, v) = (along * extent.x, Vec3::NEG_Y * extent.y);
            let corner = middle + inwards * lift - 0.5 * (u + v);
            builder.parallelogram(corner, u, v, Vec2::ONE, material);
        };
        panel(size + 0.24, 0.0, frame);
        panel(size, 0.02, canvas);
    }
}

/// The motif of a picture: twelve different ones.
fn painting(number: u32) -> Pattern {
    let red = Vec3::new(0.7, 0.08, 0.05);
    let blue = Vec3::new(0.05, 0.12, 0.55);
    let yellow = Vec3::new(0.85, 0.65, 0.08);
    let white = Vec3::splat(0.8);
    let green = Vec3::new(0.1, 0.4, 0.15);
    let pairs = [[red, white], [blue, yellow], [green, white], [yellow, red]];
    let pair = pairs[(number / 3 % 4) as usize];
    match number % 3 {
        0 => Pattern::Stripes(pair, 5.0),
        1 => Pattern::Fields([white, pair[0], pair[1], blue], 4.0),
        _ => Pattern::Rings(pair, 4.0),
    }
}

/// Small things near the cell, and the pedestal under it.
fn near_objects(builder: &mut SceneBuilder) {
    let marble = builder.material(Material::diffuse(Vec3::splat(0.6)));
    builder.cuboid(Vec3::new(-0.3, 0.0, -0.3), Vec3::new(0.3, 0.8, 0.3), marble);
    let colors = [Vec3::new(0.8, 0.3, 0.1), Vec3::new(0.15, 0.55, 0.2), Vec3::new(0.2, 0.3, 0.8)];
    for (i, color) in (0..).zip(colors) {
        let angle = TAU * (i as f32 + 0.2) / 3.0;
        let place = Vec3::new(angle.cos(), 0.0, angle.sin()) * 1.5;
        let paint = builder.material(Material::diffuse(color));
        builder.column(place, 0.05, 1.1, 16, marble);
        if i == 1 {
            builder.cuboid(place + Vec3::new(-0.15, 1.1, -0.15), place + Vec3::new(0.15, 1.4, 0.15), paint);
        } else {
            builder.ball(place + Vec3::Y * 1.27, 0.17, 2, paint);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tracer;

    #[test]
    fn the_room_is_closed_and_the_cell_is_free() {
        let tracer = Tracer::new(scene());
        assert!(crate::is_free(&tracer, &cell()));
        let center = cell().center().as_vec3();
        for i in 0..10_000u32 {
            // A spiral of directions that covers the sphere evenly.
            let y = 1.0 - (2.0 * i as f32 + 1.0) / 10_000.0;
            let angle = 2.399_963_2 * i as f32;
            let r = (1.0 - y * y).sqrt();
            let traced = tracer.trace(center, Vec3::new(r * angle.cos(), y, r * angle.sin()));
            assert!(traced.distance.is_finite(), "a ray leaves the room");
            assert!(traced.radiance.is_finite() && traced.radiance.min_element() > 0.0);
        }
    }

    #[test]
    fn columns_hide_parts_of_the_pictures() {
        // From the cell's centre the first hit in half of the horizontal directions is nearer than the walls.
        let tracer = Tracer::new(scene());
        let near = (0..720)
            .filter(|&i| {
                let angle = TAU * i as f32 / 720.0;
                let direction = Vec3::new(angle.cos(), 0.1, angle.sin());
                tracer.distance(cell().center().as_vec3(), direction).is_some_and(|t| t < 2.8)
            })
            .count();
        assert!((100..400).contains(&near), "{near} of 720 directions meet a column or a near object");
    }
}

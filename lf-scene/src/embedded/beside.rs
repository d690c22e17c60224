//! A post and a ball that stand beside the cell, below the planes of its faces.
//!
//! Rays that leave the cell meet them before they reach the camera plane: a capture that starts its rays on the plane, as a
//! pinhole camera there does, misses them.

use std::f32::consts::PI;

use glam::{DVec3, Vec3};
use lf_math::Cell;

use super::{FINE, room};
use crate::environment::Environment;
use crate::light::{Light, Lighting};
use crate::material::{Material, Pattern};
use crate::scene::{Scene, SceneBuilder};

/// The room with post and ball.
#[must_use]
pub fn scene() -> Scene {
    let mut builder = SceneBuilder::default();
    let checker = Pattern::Checker([Vec3::new(0.5, 0.45, 0.4), Vec3::new(0.15, 0.15, 0.2)]);
    let fields = [Vec3::splat(0.75), Vec3::new(0.2, 0.4, 0.6), Vec3::new(0.6, 0.55, 0.3), Vec3::new(0.35, 0.55, 0.35)];
    let floor = builder.material(Material::patterned(checker));
    let ceiling = builder.material(Material::diffuse(Vec3::splat(0.7)));
    let walls = builder.material(Material::patterned(Pattern::Fields(fields, 1.0)));
    room(&mut builder, (Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 3.0, 3.0)), 2.0, [floor, ceiling, walls]);
    // Beside the +Z face; in +X and −X it ends before the planes of the faces.
    let stripes = Pattern::Stripes([Vec3::new(0.85, 0.1, 0.05), Vec3::splat(0.85)], 6.0);
    let post = builder.material(Material::patterned(stripes));
    builder.cuboid(Vec3::new(0.0, 0.0, 0.6), Vec3::new(0.4, 2.2, 0.8), post);
    // Beside the −X face, between the planes of all others.
    let yellow = builder.material(Material::diffuse(Vec3::new(0.85, 0.7, 0.05)));
    builder.ball(Vec3::new(-0.75, 1.3, -0.2), 0.2, FINE, yellow);
    let lamp = Light::Point { position: Vec3::new(1.5, 2.7, 1.8), intensity: PI * Vec3::new(3.2, 3.0, 2.7) };
    let lighting = Lighting { lights: vec![lamp], ambient: Vec3::splat(0.35), environment: Environment::BLACK };
    builder.build("beside", lighting).unwrap_or_else(|_| unreachable!("the room is made of finite triangles"))
}

/// The cell: a cube of 1 m at 1.4 m above the floor.
#[must_use]
pub fn cell() -> Cell {
    Cell::cube(DVec3::new(0.0, 1.4, 0.0), 1.0).unwrap_or_else(|_| unreachable!("a finite cube"))
}

#[cfg(test)]
mod tests {
    use super::super::tests::directions;
    use super::*;
    use crate::Tracer;

    #[test]
    fn cameras_on_the_face_planes_miss_what_stands_beside() {
        let tracer = Tracer::new(scene());
        let (center, half) = (cell().center().as_vec3(), 0.5);
        let (mut rays, mut missed) = (0, 0);
        for (i, direction) in directions(50_000).enumerate() {
            // A point of the cell, spread by the plastic number's powers.
            let spread = (i as f32 * Vec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5)).fract() - 0.5;
            let origin = center + spread;
            let met = tracer.distance(origin, direction).expect("the room is closed");
            // Where the ray crosses the plane of the face in its largest direction.
            let axis = direction.abs().max_position();
            let plane = (half * direction[axis].signum() - spread[axis]) / direction[axis];
            rays += 1;
            missed += u32::from(met < plane);
        }
        assert!(missed * 50 > rays, "{missed} of {rays} rays meet something before the face's plane");
    }
}

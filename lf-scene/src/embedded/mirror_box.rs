//! A room with mirror spheres around the cell, lit by glowing panels: what arrives along a ray depends on where it starts.
//!
//! No focal plane is right for what a curved mirror shows.

use glam::{DVec3, Vec2, Vec3};
use lf_math::Cell;

use super::{FINE, room};
use crate::environment::Environment;
use crate::light::Lighting;
use crate::material::{Material, Pattern, Surface};
use crate::scene::{Scene, SceneBuilder};

/// Centres and radii of the spheres, metres.
const BALLS: [(Vec3, f32); 7] = [
    (Vec3::new(1.5, 1.3, 0.3), 0.5),
    (Vec3::new(-1.6, 1.6, -0.5), 0.55),
    (Vec3::new(0.4, 1.2, 1.7), 0.6),
    (Vec3::new(-0.6, 1.5, -1.8), 0.6),
    (Vec3::new(1.6, 0.4, -1.5), 0.4),
    (Vec3::new(-1.5, 0.35, 1.4), 0.35),
    (Vec3::new(0.1, 0.3, 0.2), 0.3),
];

/// The room.
#[must_use]
pub fn scene() -> Scene {
    let mut builder = SceneBuilder::default();
    let (min, max) = (Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 3.0, 3.0));
    let checker = Pattern::Checker([Vec3::splat(0.7), Vec3::new(0.15, 0.2, 0.35)]);
    let fields = [Vec3::new(0.7, 0.15, 0.1), Vec3::splat(0.7), Vec3::new(0.1, 0.45, 0.2), Vec3::new(0.75, 0.6, 0.15)];
    let floor = builder.material(Material::patterned(checker));
    let ceiling = builder.material(Material::diffuse(Vec3::splat(0.7)));
    let walls = builder.material(Material::patterned(Pattern::Fields(fields, 1.0)));
    room(&mut builder, (min, max), 2.0, [floor, ceiling, walls]);
    for (center, radius) in BALLS {
        let mirror = builder.material(Material::mirror(Vec3::splat(0.95)));
        builder.ball(center, radius, FINE, mirror);
    }
    panels(&mut builder);
    let lighting = Lighting { ambient: Vec3::splat(0.25), ..Lighting::from_environment(Environment::BLACK) };
    builder.build("mirror-box", lighting).unwrap_or_else(|_| unreachable!("the box is made of finite triangles"))
}

/// The cell between the spheres: a cube of 1 m at 1.4 m above the floor.
#[must_use]
pub fn cell() -> Cell {
    Cell::cube(DVec3::new(0.0, 1.4, 0.0), 1.0).unwrap_or_else(|_| unreachable!("a finite cube"))
}

/// Two glowing panels just below the ceiling, shining downwards.
fn panels(builder: &mut SceneBuilder) {
    for (x, radiance) in [(-1.6, Vec3::new(9.0, 8.0, 6.5)), (1.1, Vec3::new(6.0, 7.0, 8.5))] {
        let black = Material::diffuse(Vec3::ZERO);
        let panel = builder.material(Material { emission: Surface::Uniform(radiance), ..black });
        let corner = Vec3::new(x, 2.98, -1.0);
        builder.parallelogram(corner, Vec3::X * 0.5, Vec3::Z * 2.0, Vec2::ONE, panel);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::directions;
    use super::*;
    use crate::Tracer;

    /// Where a ray of unit direction enters a ball.
    fn entry(origin: Vec3, direction: Vec3, (center, radius): (Vec3, f32)) -> Option<f32> {
        let to = center - origin;
        let along = to.dot(direction);
        let square = radius * radius - (to - along * direction).length_squared();
        (square > 0.0 && along > 0.0).then(|| along - square.sqrt())
    }

    #[test]
    fn it_is_closed_and_mirrors_take_a_seventh_of_the_view() {
        let tracer = Tracer::new(scene());
        let eye = cell().center().as_vec3();
        let mut mirrors = 0;
        for direction in directions(20_000) {
            let met = tracer.distance(eye, direction).expect("closed");
            let exact = BALLS.iter().filter_map(|ball| entry(eye, direction, *ball)).fold(f32::INFINITY, f32::min);
            // The mesh lies a little inside the sphere, most along grazing rays.
            assert!(exact.is_infinite() || met > exact - 1e-4, "{met} {exact}");
            mirrors += u32::from((met - exact).abs() < 0.01);
        }
        assert!((2_500..4_000).contains(&mirrors), "{mirrors} of 20 000 rays meet a mirror");
    }

    #[test]
    fn panels_shine_downwards() {
        let tracer = Tracer::new(scene());
        let up = tracer.trace(Vec3::new(-1.4, 2.0, 0.0), Vec3::Y).radiance;
        assert_eq!(up, Vec3::new(9.0, 8.0, 6.5));
    }
}

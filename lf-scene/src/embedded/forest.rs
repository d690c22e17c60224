//! Thin columns at distances from 3 to 60 m, each about 3 mrad wide as seen from the cell: thinner than a texel of a small
//! light field, and before a backdrop that moves the other way.

use std::f32::consts::{PI, TAU};

use glam::{DVec3, Vec2, Vec3};
use lf_math::Cell;

use crate::environment::Environment;
use crate::light::{Light, Lighting};
use crate::material::{Material, Pattern};
use crate::scene::{Scene, SceneBuilder};

/// How many columns.
const COLUMNS: u32 = 160;
/// Distances of the first and the last column, metres.
const DISTANCES: (f32, f32) = (3.0, 60.0);
/// Width of a column as seen from the cell's middle, radians.
const WIDTH: f32 = 3e-3;
/// Distance of the backdrop, metres.
const BACKDROP: f32 = 70.0;

/// The forest.
#[must_use]
pub fn scene() -> Scene {
    let mut builder = SceneBuilder::default();
    ground(&mut builder);
    columns(&mut builder);
    let towards = Vec3::new(0.4, 0.7, 0.3).normalize();
    let lighting = Lighting {
        lights: vec![Light::Sun { towards, irradiance: PI * Vec3::new(0.9, 0.85, 0.7) }],
        ambient: Vec3::new(0.25, 0.28, 0.35),
        environment: Environment::Sky(Vec3::new(0.45, 0.6, 0.9)),
    };
    builder.build("forest", lighting).unwrap_or_else(|_| unreachable!("the forest is made of finite triangles"))
}

/// The cell: a cube of 1 m at 1.5 m above the ground.
#[must_use]
pub fn cell() -> Cell {
    Cell::cube(DVec3::new(0.0, 1.5, 0.0), 1.0).unwrap_or_else(|_| unreachable!("a finite cube"))
}

/// A square of ground, and four walls of 12 m around it.
fn ground(builder: &mut SceneBuilder) {
    let checker = Pattern::Checker([Vec3::new(0.3, 0.4, 0.15), Vec3::new(0.45, 0.4, 0.25)]);
    let fields =
        [Vec3::new(0.2, 0.35, 0.2), Vec3::new(0.6, 0.6, 0.5), Vec3::new(0.5, 0.3, 0.15), Vec3::new(0.3, 0.4, 0.55)];
    let ground = builder.material(Material::patterned(checker));
    let backdrop = builder.material(Material::patterned(Pattern::Fields(fields, 1.0)));
    let (edge, height) = (2.0 * BACKDROP, 12.0);
    let corner = Vec3::new(-BACKDROP, 0.0, -BACKDROP);
    builder.parallelogram(corner, Vec3::Z * edge, Vec3::X * edge, Vec2::splat(0.5 * edge), ground);
    for quarter in 0..4 {
        let (sin, cos) = (0.25 * TAU * quarter as f32).sin_cos();
        let (out, along) = (Vec3::new(cos, 0.0, sin), Vec3::new(-sin, 0.0, cos));
        // Fields of 4 m.
        let uv = Vec2::new(edge, height) / 4.0;
        builder.parallelogram((out - along) * BACKDROP, along * edge, Vec3::Y * height, uv, backdrop);
    }
}

/// Columns on a spiral: any two that follow each other stand at the golden angle.
fn columns(builder: &mut SceneBuilder) {
    let colors =
        [Vec3::new(0.85, 0.8, 0.7), Vec3::new(0.7, 0.12, 0.08), Vec3::new(0.08, 0.08, 0.1), Vec3::new(0.8, 0.65, 0.1)];
    let colors = colors.map(|color| builder.material(Material::diffuse(color)));
    let (near, far) = DISTANCES;
    for i in 0..COLUMNS {
        let distance = near * (far / near).powf(i as f32 / (COLUMNS - 1) as f32);
        let (sin, cos) = (2.399_963_2 * i as f32).sin_cos();
        let foot = Vec3::new(cos, 0.0, sin) * distance;
        builder.column(foot, 0.5 * WIDTH * distance, 2.0 + 0.15 * distance, 12, colors[(i % 4) as usize]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tracer;

    /// Angular widths and distances of what stands before the backdrop at the height of the eye.
    fn seen() -> Vec<(f32, f32)> {
        const STEPS: u32 = 400_000;
        let tracer = Tracer::new(scene());
        let eye = cell().center().as_vec3();
        let mut runs: Vec<(f32, f32)> = vec![];
        let mut before = f32::INFINITY;
        for i in 0..STEPS {
            let (sin, cos) = (TAU * i as f32 / STEPS as f32).sin_cos();
            let distance = tracer.distance(eye, Vec3::new(cos, 0.0, sin)).expect("the backdrop is closed");
            if distance < 1.02 * DISTANCES.1 {
                // A jump in distance is another column.
                if (distance / before - 1.0).abs() > 0.005 {
                    runs.push((0.0, distance));
                }
                runs.last_mut().expect("pushed").0 += TAU / STEPS as f32;
                before = distance;
            } else {
                before = f32::INFINITY;
            }
        }
        runs
    }

    #[test]
    fn columns_are_thin_and_many_and_at_many_distances() {
        let runs = seen();
        assert!(runs.len() >= 120, "{} columns are seen", runs.len());
        let whole = runs.iter().filter(|(width, _)| (0.9 * WIDTH..1.01 * WIDTH).contains(width)).count();
        assert!(whole >= 100, "{whole} of {} are {WIDTH} rad wide", runs.len());
        assert!(runs.iter().all(|(width, _)| *width < 2.5 * WIDTH), "{runs:?}");
        let share = |range: std::ops::Range<f32>| runs.iter().filter(|(_, distance)| range.contains(distance)).count();
        assert!(share(3.0..6.0) >= 20 && share(6.0..20.0) >= 20 && share(20.0..61.0) >= 20);
    }
}

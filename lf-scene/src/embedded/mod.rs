//! Scenes made in code, each with a cell: the museum, and stiff ones that bring out what a method cannot do.

pub mod beside;
pub mod corridor;
pub mod forest;
pub mod mirror_box;
pub mod museum;

use glam::{Vec2, Vec3};
use lf_math::Cell;

use crate::scene::{Scene, SceneBuilder};

/// A scene that this crate carries.
#[derive(Debug, Clone, Copy)]
pub struct EmbeddedScene {
    /// Its name.
    pub name: &'static str,
    /// What it is for, in a few words.
    pub summary: &'static str,
    /// Makes the scene.
    pub scene: fn() -> Scene,
    /// The cell that belongs to it.
    pub cell: fn() -> Cell,
}

/// All embedded scenes; the first is the one to start with.
pub const EMBEDDED: [EmbeddedScene; 5] = [
    EmbeddedScene {
        name: "museum",
        summary: "a room with columns in front of pictures",
        scene: museum::scene,
        cell: museum::cell,
    },
    EmbeddedScene {
        name: "corridor",
        summary: "near and far: distances from 1 to 1000 m",
        scene: corridor::scene,
        cell: corridor::cell,
    },
    EmbeddedScene {
        name: "mirror-box",
        summary: "radiance that depends on the view: mirror spheres under area lights",
        scene: mirror_box::scene,
        cell: mirror_box::cell,
    },
    EmbeddedScene {
        name: "forest",
        summary: "thin things: columns of 3 mrad at many distances",
        scene: forest::scene,
        cell: forest::cell,
    },
    EmbeddedScene {
        name: "beside",
        summary: "things beside the cell, below the planes of its faces",
        scene: beside::scene,
        cell: beside::cell,
    },
];

/// Subdivisions of balls that mirror, or are seen from near: 20 480 triangles.
const FINE: u32 = 5;

/// Floor, ceiling and walls of a box, facing inwards. Texture coordinates are metres times `uv_per_m`.
fn room(builder: &mut SceneBuilder, (min, max): (Vec3, Vec3), uv_per_m: f32, [floor, ceiling, walls]: [u32; 3]) {
    let e = max - min;
    let (x, y, z) = (Vec3::X * e.x, Vec3::Y * e.y, Vec3::Z * e.z);
    let faces = [
        (min, z, x, floor),
        (max, -x, -z, ceiling),
        (min, x, y, walls),
        (max - y, -x, y, walls),
        (min + z, -z, y, walls),
        (min + x, z, y, walls),
    ];
    for (corner, u, v, material) in faces {
        builder.parallelogram(corner, u, v, uv_per_m * Vec2::new(u.length(), v.length()), material);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tracer;

    /// Unit vectors spread evenly.
    pub(super) fn directions(count: u32) -> impl Iterator<Item = Vec3> {
        (0..count).map(move |i| {
            let y = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
            // The golden angle.
            let (sin, cos) = (2.399_963_2 * i as f32).sin_cos();
            let r = (1.0 - y * y).max(0.0).sqrt();
            Vec3::new(r * cos, y, r * sin)
        })
    }

    #[test]
    fn names_are_unique_and_cells_are_free() {
        for (i, embedded) in EMBEDDED.iter().enumerate() {
            assert!(EMBEDDED[..i].iter().all(|other| other.name != embedded.name));
            let tracer = Tracer::new((embedded.scene)());
            assert_eq!(tracer.scene().name(), embedded.name);
            assert!(crate::is_free(&tracer, &(embedded.cell)()), "{}", embedded.name);
        }
    }

    #[test]
    fn rooms_face_inwards_and_are_closed() {
        let mut builder = SceneBuilder::default();
        room(&mut builder, (Vec3::new(-1.0, 0.0, -3.0), Vec3::new(4.0, 2.0, 5.0)), 1.0, [0; 3]);
        let area: f32 = builder
            .triangles()
            .iter()
            .map(|([a, b, c], _)| {
                let normal = (b.position - a.position).cross(c.position - a.position);
                assert!(normal.dot(Vec3::new(0.5, 1.0, 0.5) - a.position) > 0.0, "{normal}");
                0.5 * normal.length()
            })
            .sum();
        assert_eq!(area, 2.0 * (5.0 * 2.0 + 5.0 * 8.0 + 2.0 * 8.0));
    }
}

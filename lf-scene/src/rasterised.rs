//! Scenes for rasterisers: triangles with light at their corners.
//!
//! The environment "rendered as regular geometries" (§7 of Yu, Yang & McMillan). Each triangle is cut where its edges are too long, and the
//! tracer is asked for the light that leaves every corner, straight on. Interpolated in between, that is a diffuse scene to within what
//! the light does between corners: patterns and shadows finer than an edge blur; holes, mirrors and glass look as if painted.
//! Time is one of the tracer's rays for each corner.

use std::collections::HashMap;

use glam::Vec3;
use lf_math::{Cell, GeometryError, LitMesh, triangle_normal};
use rayon::prelude::*;

use crate::error::SceneError;
use crate::tracer::Tracer;

/// How far inside its triangle, and above it, a corner is looked at, as a share of the longest edge: corners lie in other
/// surfaces. More blurs, and looks through things closer together; less leaves them to rounding.
const ASIDE: f32 = 0.01;
/// Triangles that a scene may be cut into: with their corners less than 256 MiB, which is what any GPU takes as a buffer.
const MAX_TRIANGLES: usize = 1 << 21;

/// The scene around `cell` as triangles with no edge longer than `edge` metres, each corner with the light that the tracer sees
/// leave it, on the side that faces the cell's centre. Cell space. Triangles without area are left out.
///
/// # Errors
/// If `edge` is not greater than 0, if the scene would be cut into more than two million triangles
/// ([`SceneError::TooManyTriangles`]), or if its light is not finite.
pub fn rasterised(tracer: &Tracer, cell: &Cell, edge: f32) -> Result<LitMesh, SceneError> {
    if edge.is_nan() || edge <= 0.0 {
        return Err(GeometryError::NotPositive { what: "the longest edge", value: edge }.into());
    }
    let mut pieces = Pieces::default();
    for (corners, _) in tracer.scene().triangles() {
        pieces.cut(corners.map(|corner| corner.position), edge)?;
    }
    let center = cell.world_from_cell(Vec3::ZERO).as_vec3();
    let light = pieces.views.par_iter().map(|view| view.light(tracer, center)).collect();
    let positions = pieces.positions.iter().map(|p| cell.cell_from_world(p.as_dvec3())).collect();
    Ok(LitMesh::new(positions, light, pieces.triangles)?)
}

/// What triangles were cut into, world space.
#[derive(Default)]
struct Pieces {
    positions: Vec<Vec3>,
    /// Of each position.
    views: Vec<View>,
    triangles: Vec<[u32; 3]>,
}

/// Where to look at a corner.
struct View {
    /// A place on the triangle.
    place: Vec3,
    /// Its unit normal.
    normal: Vec3,
    /// How far above it.
    height: f32,
}

/// A triangle of the scene, while it is cut.
struct Whole {
    centroid: Vec3,
    normal: Vec3,
    /// The farthest corner from the centroid, or the longest edge, whichever is less.
    reach: f32,
}

impl Pieces {
    /// Halves edges that are too long. An edge is cut or not whatever triangle it belongs to, and always in its middle, so that
    /// neighbours fit together.
    fn cut(&mut self, corners: [Vec3; 3], edge: f32) -> Result<(), SceneError> {
        let Some(whole) = Whole::new(corners, edge) else { return Ok(()) };
        let mut middles = HashMap::new();
        let mut waiting = vec![corners.map(|corner| self.add(corner, &whole))];
        while let Some(triangle) = waiting.pop() {
            if self.triangles.len() + waiting.len() >= MAX_TRIANGLES {
                return Err(SceneError::TooManyTriangles { edge, max: MAX_TRIANGLES });
            }
            let (length, [a, b, c]) = self.longest_first(triangle);
            if length <= edge {
                self.triangles.push(triangle);
                continue;
            }
            let halfway = 0.5 * (self.positions[a as usize] + self.positions[b as usize]);
            let middle = *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| self.add(halfway, &whole));
            waiting.extend([[a, middle, c], [middle, b, c]]);
        }
        Ok(())
    }

    fn add(&mut self, position: Vec3, whole: &Whole) -> u32 {
        self.positions.push(position);
        self.views.push(whole.view(position));
        (self.positions.len() - 1) as u32
    }

    /// The length of a triangle's longest edge, and the triangle turned so that this is the first.
    fn longest_first(&self, [a, b, c]: [u32; 3]) -> (f32, [u32; 3]) {
        let length = |from: u32, to: u32| self.positions[from as usize].distance(self.positions[to as usize]);
        let turned = [(length(a, b), [a, b, c]), (length(b, c), [b, c, a]), (length(c, a), [c, a, b])];
        turned.into_iter().reduce(|best, other| if other.0 > best.0 { other } else { best }).unwrap_or(turned[0])
    }
}

impl Whole {
    /// `None` if it has no area.
    fn new(corners: [Vec3; 3], edge: f32) -> Option<Self> {
        let centroid = corners.iter().sum::<Vec3>() / 3.0;
        let reach = corners.iter().map(|corner| corner.distance(centroid)).fold(0.0, f32::max).min(edge);
        Some(Self { centroid, normal: triangle_normal(corners)?, reach })
    }

    fn view(&self, position: Vec3) -> View {
        let inwards = (self.centroid - position).clamp_length_max(self.reach);
        View { place: position + ASIDE * inwards, normal: self.normal, height: ASIDE * self.reach }
    }
}

impl View {
    /// What leaves the place on the side of `eye`.
    fn light(&self, tracer: &Tracer, eye: Vec3) -> Vec3 {
        let up = if self.normal.dot(eye - self.place) < 0.0 { -self.normal } else { self.normal };
        tracer.estimate(self.place + self.height * up, -up).radiance
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use glam::{DVec3, Vec2};

    use super::*;
    use crate::{Environment, Light, Lighting, Material, SceneBuilder, museum};

    const LAMP: Vec3 = Vec3::new(0.3, 2.5, -0.2);

    /// A white floor of 4 m × 3 m, seen from above, and a wall along its edge, under one lamp.
    fn corner() -> (Tracer, Cell) {
        let mut builder = SceneBuilder::default();
        let white = builder.material(Material::diffuse(Vec3::ONE));
        let low = Vec3::new(-2.0, 0.0, -1.5);
        builder.parallelogram(low, Vec3::Z * 3.0, Vec3::X * 4.0, Vec2::ONE, white);
        builder.parallelogram(low, Vec3::Y * 2.0, Vec3::Z * 3.0, Vec2::ONE, white);
        let lights = vec![Light::Point { position: LAMP, intensity: Vec3::splat(9.0 * PI) }];
        let lighting = Lighting { lights, ambient: Vec3::ZERO, environment: Environment::BLACK };
        let cell = Cell::cube(DVec3::new(0.0, 1.0, 0.0), 1.0).unwrap();
        (Tracer::new(builder.build("corner", lighting).unwrap()), cell)
    }

    fn corners(mesh: &LitMesh) -> impl Iterator<Item = [Vec3; 3]> {
        mesh.triangles().iter().map(|triangle| triangle.map(|i| mesh.positions()[i as usize]))
    }

    #[test]
    fn a_diffuse_corner_under_a_lamp_follows_the_cosine_and_inverse_square_laws() {
        let (tracer, cell) = corner();
        let mesh = rasterised(&tracer, &cell, 0.3).unwrap();
        let lamp = cell.cell_from_world(LAMP.as_dvec3());
        for triangle in mesh.triangles() {
            let places = triangle.map(|i| mesh.positions()[i as usize]);
            let normal = triangle_normal(places).unwrap();
            for (&vertex, place) in triangle.iter().zip(places) {
                let away = lamp - place;
                let exact = 9.0 * normal.dot(away).abs() / away.length().powi(3);
                // A corner is looked at within 3 mm of its place, a distance of 2 m from the lamp.
                let found = mesh.light()[vertex as usize].y;
                assert!((found - exact).abs() < 0.01 * exact, "{place}: {found} {exact}");
            }
        }
        // The other side of the floor is not lit, and of the wall neither.
        let below = Cell::cube(DVec3::new(-9.0, -9.0, 0.0), 1.0).unwrap();
        assert!(rasterised(&tracer, &below, 0.3).unwrap().light().iter().all(|light| *light == Vec3::ZERO));
    }

    /// What is cut has the same area, no longer edges, and no gaps: every edge inside a wall has a triangle on both sides.
    #[test]
    fn pieces_fit_together() {
        let (tracer, cell) = corner();
        let area = |mesh: &LitMesh| {
            corners(mesh).map(|[a, b, c]| 0.5 * (b - a).as_dvec3().cross((c - a).as_dvec3()).length()).sum::<f64>()
        };
        for edge in [100.0, 1.0, 0.17] {
            let mesh = rasterised(&tracer, &cell, edge).unwrap();
            assert!((area(&mesh) - 18.0).abs() < 1e-4, "{edge}: {}", area(&mesh));
            let mut sides = HashMap::new();
            for places in corners(&mesh) {
                for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (places[i], places[j])) {
                    assert!((b - a).length() <= edge, "{a} {b}");
                    let [a, b] = [a, b].map(|place| cell.world_from_cell(place).as_vec3());
                    let mut ends = [a, b].map(|place| place.to_array().map(|v| (v * 4096.0).round() as i32));
                    ends.sort_unstable();
                    *sides.entry(ends).or_insert(0) += 1;
                }
            }
            // The rim: 4 + 3 + 4 of the floor, 2 + 3 + 2 of the wall, in metres; they meet along 3.
            let alone = sides.iter().filter(|(_, count)| **count == 1);
            let rim: f64 = alone
                .map(|([a, b], _)| (0..3).map(|i| f64::from(a[i] - b[i]).powi(2)).sum::<f64>().sqrt() / 4096.0)
                .sum();
            assert!((rim - 18.0).abs() < 1e-2, "{edge}: {rim}");
            assert!(sides.values().all(|count| *count <= 2), "{edge}");
        }
    }

    #[test]
    fn too_many_pieces_are_refused() {
        let tracer = Tracer::new(museum::scene());
        let cut = |edge| rasterised(&tracer, &museum::cell(), edge);
        assert!(matches!(cut(1e-3), Err(SceneError::TooManyTriangles { .. })));
        // Shorter than coordinates can tell apart.
        assert!(matches!(cut(f32::MIN_POSITIVE), Err(SceneError::TooManyTriangles { .. })));
        for edge in [0.0, -1.0, f32::NAN] {
            assert!(matches!(cut(edge), Err(SceneError::Geometry(_))), "{edge}");
        }
        // Uncut.
        let whole = cut(f32::INFINITY).unwrap();
        assert_eq!(whole.triangles().len(), tracer.scene().triangles().len());
        assert!(whole.light().iter().all(|light| light.min_element() > 0.0));
    }
}

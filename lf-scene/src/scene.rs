//! A scene: triangles, their materials and the light.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};
use lf_math::GeometryError;

use crate::light::Lighting;
use crate::material::Material;
use crate::reflectors;

/// A corner of a triangle, world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Position, metres.
    pub position: Vec3,
    /// Shading normal; need not have unit length.
    pub normal: Vec3,
    /// Texture coordinate.
    pub uv: Vec2,
}

/// Triangles with materials under light. Not empty, all positions within ±1e12 m.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    name: String,
    triangles: Vec<([Vertex; 3], u32)>,
    materials: Vec<Material>,
    lighting: Lighting,
}

/// Collects the triangles of a [`Scene`].
#[derive(Debug, Default)]
pub struct SceneBuilder {
    triangles: Vec<([Vertex; 3], u32)>,
    materials: Vec<Material>,
}

impl Scene {
    /// Its name, for captions and metadata.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Corner vertices and material number of each triangle.
    #[must_use]
    pub fn triangles(&self) -> &[([Vertex; 3], u32)] {
        &self.triangles
    }

    /// The material of a triangle.
    ///
    /// # Panics
    /// If there is no such triangle.
    #[must_use]
    pub fn material(&self, triangle: usize) -> &Material {
        &self.materials[self.triangles[triangle].1 as usize]
    }

    /// All materials, by number.
    #[must_use]
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Memory of triangles and textures, bytes; a texture that several materials share is counted for each.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        let textures: usize = self.materials.iter().map(Material::memory_bytes).sum();
        size_of_val(self.triangles.as_slice()) + textures
    }

    /// The light.
    #[must_use]
    pub fn lighting(&self) -> &Lighting {
        &self.lighting
    }

    /// The same things under another light.
    #[must_use]
    pub fn with_lighting(self, lighting: Lighting) -> Self {
        Self { lighting, ..self }
    }

    /// The smallest box around all vertices: (min, max).
    #[must_use]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        bounds(&self.triangles)
    }
}

/// Refuses positions that the hierarchy cannot calculate with: products of three coordinates have to stay finite in `f32`.
pub(crate) fn check_positions(positions: impl Iterator<Item = Vec3>) -> Result<(), GeometryError> {
    const MAX: f32 = 1e12;
    for value in positions.flat_map(|p| p.to_array()) {
        if !value.is_finite() {
            return Err(GeometryError::NotFinite { what: "vertex position", value });
        }
        if value.abs() > MAX {
            return Err(GeometryError::TooLarge { what: "vertex position", value, max: MAX });
        }
    }
    Ok(())
}

fn bounds(triangles: &[([Vertex; 3], u32)]) -> (Vec3, Vec3) {
    let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    triangles
        .iter()
        .flat_map(|(corners, _)| corners)
        .fold(none, |(min, max), v| (min.min(v.position), max.max(v.position)))
}

impl SceneBuilder {
    /// Whether no triangle was added yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Corner vertices and material number of each triangle so far.
    #[must_use]
    pub fn triangles(&self) -> &[([Vertex; 3], u32)] {
        &self.triangles
    }

    /// All materials so far, by number.
    #[must_use]
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The smallest box around all vertices so far: (min, max).
    #[must_use]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        bounds(&self.triangles)
    }

    /// Adds a material and returns its number.
    pub fn material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        (self.materials.len() - 1) as u32
    }

    /// Adds a triangle of a material returned by [`Self::material`].
    pub fn triangle(&mut self, corners: [Vertex; 3], material: u32) {
        self.triangles.push((corners, material));
    }

    /// Adds a parallelogram from `corner` along `u` and `v`, facing `u × v`; texture coordinates run from 0 to `uv_scale`.
    pub fn parallelogram(&mut self, corner: Vec3, u: Vec3, v: Vec3, uv_scale: Vec2, material: u32) {
        let normal = u.cross(v);
        let vertex =
            |a: f32, b: f32| Vertex { position: corner + u * a + v * b, normal, uv: Vec2::new(a, b) * uv_scale };
        let quad = [vertex(0.0, 0.0), vertex(1.0, 0.0), vertex(1.0, 1.0), vertex(0.0, 1.0)];
        self.triangle([quad[0], quad[1], quad[2]], material);
        self.triangle([quad[0], quad[2], quad[3]], material);
    }

    /// Adds an axis-aligned box, facing outwards.
    pub fn cuboid(&mut self, min: Vec3, max: Vec3, material: u32) {
        let e = max - min;
        let (x, y, z) = (Vec3::X * e.x, Vec3::Y * e.y, Vec3::Z * e.z);
        for (corner, u, v) in [(min, y, x), (min, z, y), (min, x, z), (max, -x, -y), (max, -y, -z), (max, -z, -x)] {
            self.parallelogram(corner, u, v, Vec2::ONE, material);
        }
    }

    /// Adds an upright cylinder wall without caps, smoothly shaded.
    pub fn column(&mut self, base: Vec3, radius: f32, height: f32, sides: u32, material: u32) {
        let ring = |i: u32, y: f32| {
            let angle = TAU * i as f32 / sides as f32;
            let normal = Vec3::new(angle.cos(), 0.0, angle.sin());
            let position = base + normal * radius + Vec3::Y * y;
            Vertex { position, normal, uv: Vec2::new(i as f32 / sides as f32, y / height) }
        };
        for i in 0..sides {
            let (a, b, c, d) = (ring(i, 0.0), ring(i + 1, 0.0), ring(i + 1, height), ring(i, height));
            self.triangle([a, c, b], material);
            self.triangle([a, d, c], material);
        }
    }

    /// Adds a ball of 20·4ⁿ triangles, n being `subdivisions`, smoothly shaded.
    pub fn ball(&mut self, center: Vec3, radius: f32, subdivisions: u32, material: u32) {
        let mesh = reflectors::sphere(subdivisions);
        for triangle in mesh.triangles() {
            let corners = triangle.map(|i| {
                let normal = mesh.normals()[i as usize];
                Vertex { position: center + normal * radius, normal, uv: Vec2::ZERO }
            });
            self.triangle(corners, material);
        }
    }

    /// The finished scene.
    ///
    /// # Errors
    /// There must be at least one triangle, all positions must be within ±1e12 m and all material numbers exist.
    pub fn build(self, name: &str, lighting: Lighting) -> Result<Scene, GeometryError> {
        if self.triangles.is_empty() {
            return Err(GeometryError::ZeroCount { what: "triangle count" });
        }
        for (corners, material) in &self.triangles {
            if *material as usize >= self.materials.len() {
                return Err(GeometryError::VertexIndex { index: *material, vertices: self.materials.len() });
            }
            check_positions(corners.iter().map(|v| v.position))?;
        }
        let name = name.to_owned();
        Ok(Scene { name, triangles: self.triangles, materials: self.materials, lighting })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::Environment;

    #[test]
    fn cuboids_face_outwards() {
        let mut builder = SceneBuilder::default();
        let grey = builder.material(Material::diffuse(Vec3::splat(0.5)));
        builder.cuboid(Vec3::ZERO, Vec3::ONE, grey);
        assert_eq!(builder.triangles.len(), 12);
        for (corners, _) in &builder.triangles {
            let middle = (corners[0].position + corners[1].position + corners[2].position) / 3.0;
            assert!(corners[0].normal.dot(middle - 0.5) > 0.0);
        }
    }

    #[test]
    fn bad_scenes_are_refused() {
        let lighting = || Lighting::from_environment(Environment::BLACK);
        assert!(SceneBuilder::default().build("empty", lighting()).is_err());
        let mut builder = SceneBuilder::default();
        builder.parallelogram(Vec3::ZERO, Vec3::X, Vec3::Y, Vec2::ONE, 7);
        assert!(builder.build("no material", lighting()).is_err());
    }
}

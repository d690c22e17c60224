//! A scene as triangles with light at their corners, as rasterisers draw it.

use alloc::vec::Vec;

use glam::Vec3;

use crate::error::{GeometryError, finite};

/// Triangles with the light that leaves each vertex, interpolated in between: what a rasteriser needs of a diffuse scene. Cell
/// space. Every index is in range, every position finite, all light finite and not negative.
#[derive(Debug, Clone, PartialEq)]
pub struct LitMesh {
    positions: Vec<Vec3>,
    light: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl LitMesh {
    /// A mesh from its parts; `light` is linear radiance, one for each position.
    ///
    /// # Errors
    /// There must be at least one triangle; indices must be in range, positions finite, light finite and at least 0 and as much
    /// as there are positions.
    pub fn new(positions: Vec<Vec3>, light: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, GeometryError> {
        if triangles.is_empty() {
            return Err(GeometryError::ZeroCount { what: "triangle count" });
        }
        if light.len() != positions.len() {
            return Err(GeometryError::Length { what: "light", len: light.len(), expected: positions.len() });
        }
        for value in positions.iter().flat_map(Vec3::to_array) {
            finite("vertex position", value)?;
        }
        for value in light.iter().flat_map(Vec3::to_array) {
            if finite("light", value)? < 0.0 {
                return Err(GeometryError::Negative { what: "light", value });
            }
        }
        if let Some(&index) = triangles.iter().flatten().find(|&&i| i as usize >= positions.len()) {
            return Err(GeometryError::VertexIndex { index, vertices: positions.len() });
        }
        Ok(Self { positions, light, triangles })
    }

    /// Vertex positions, metres.
    #[must_use]
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Linear radiance that leaves each vertex.
    #[must_use]
    pub fn light(&self) -> &[Vec3] {
        &self.light
    }

    /// Vertex indices of each triangle.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The smallest box around the vertices: (min, max).
    #[must_use]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        self.positions.iter().fold(none, |(min, max), &p| (min.min(p), max.max(p)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn bad_parts_are_refused() {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = |light, triangles| LitMesh::new(corners.clone(), light, triangles);
        let good = mesh(vec![Vec3::ONE; 3], vec![[0, 1, 2]]).unwrap();
        assert_eq!(good.bounds(), (Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)));
        assert!(mesh(vec![Vec3::ONE; 2], vec![[0, 1, 2]]).is_err());
        assert!(mesh(vec![Vec3::NEG_ONE; 3], vec![[0, 1, 2]]).is_err());
        assert!(mesh(vec![Vec3::INFINITY; 3], vec![[0, 1, 2]]).is_err());
        assert!(mesh(vec![Vec3::ONE; 3], vec![[0, 1, 3]]).is_err());
        assert!(mesh(vec![Vec3::ONE; 3], vec![]).is_err());
        assert!(LitMesh::new(vec![Vec3::NAN; 3], vec![Vec3::ONE; 3], vec![[0, 1, 2]]).is_err());
    }
}

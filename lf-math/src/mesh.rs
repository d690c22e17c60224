//! Triangle meshes with a normal at each vertex.

use alloc::vec::Vec;

use glam::Vec3;

use crate::error::{GeometryError, finite, positive};
use crate::scale::to_one;
use crate::{Placement, length, normalized};

/// An indexed triangle mesh. Every index is in range, every position finite, every normal of unit length.
#[derive(Debug, Clone, PartialEq)]
pub struct TriangleMesh {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// A mesh from its parts; `normals` may be empty, then they are the mean of the
    /// adjacent triangles' normals weighted by area, and +Y where these cancel.
    ///
    /// A normal that is zero or not finite is replaced by the computed one.
    ///
    /// # Errors
    /// There must be at least one triangle; indices must be in range, positions finite, and the normals as many as the
    /// positions or none.
    pub fn new(positions: Vec<Vec3>, normals: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, GeometryError> {
        if triangles.is_empty() {
            return Err(GeometryError::ZeroCount { what: "triangle count" });
        }
        for position in &positions {
            for value in position.to_array() {
                finite("vertex position", value)?;
            }
        }
        if let Some(&index) = triangles.iter().flatten().find(|&&i| i as usize >= positions.len()) {
            return Err(GeometryError::VertexIndex { index, vertices: positions.len() });
        }
        if !normals.is_empty() && normals.len() != positions.len() {
            return Err(GeometryError::Length { what: "normals", len: normals.len(), expected: positions.len() });
        }
        let computed = Self::smooth_normals(&positions, &triangles);
        let given = normals.into_iter().map(normalized).chain(core::iter::repeat(None));
        let normals = given.zip(computed).map(|(given, computed)| given.unwrap_or(computed)).collect();
        Ok(Self { positions, normals, triangles })
    }

    /// Unit vertex normals: the mean of the adjacent triangles' normals weighted by area, +Y where they cancel.
    fn smooth_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
        // Areas are products of lengths: kept in range by a power of two, which rounds nothing.
        let reach = positions.iter().fold(0.0f32, |reach, p| reach.max((*p - positions[0]).abs().max_element()));
        let scale = to_one(reach);
        let mut sums = alloc::vec![Vec3::ZERO; positions.len()];
        for triangle in triangles {
            let [a, b, c] = triangle.map(|i| positions[i as usize]);
            let weighted = ((b - a) * scale).cross((c - a) * scale);
            for &i in triangle {
                sums[i as usize] += weighted;
            }
        }
        sums.into_iter().map(|n| normalized(n).unwrap_or(Vec3::Y)).collect()
    }

    /// Vertex positions.
    #[must_use]
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Unit vertex normals, one for each position.
    #[must_use]
    pub fn normals(&self) -> &[Vec3] {
        &self.normals
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

    /// The mesh in cell space, given where it stands.
    ///
    /// # Errors
    /// If a position is not finite there.
    pub fn placed(&self, placement: &Placement) -> Result<Self, GeometryError> {
        let positions = self.positions.iter().map(|&p| placement.point(p)).collect();
        let normals = self.normals.iter().map(|&n| placement.direction(n)).collect();
        Self::new(positions, normals, self.triangles.clone())
    }

    /// The mesh moved and scaled alike along all axes so that its bounding box is centred at `center` and its farthest
    /// vertex lies `radius` from there.
    ///
    /// # Errors
    /// `radius` and the mesh's own extent must be greater than 0, and the result finite.
    pub fn fitted(&self, center: Vec3, radius: f32) -> Result<Self, GeometryError> {
        positive("radius", radius)?;
        let (min, max) = self.bounds();
        let middle = min + 0.5 * (max - min);
        let reach = self.positions.iter().map(|p| length(p - middle)).fold(0.0, f32::max);
        let scale = radius / positive("the mesh's extent", reach)?;
        let positions = self.positions.iter().map(|p| center + (p - middle) * scale).collect();
        Self::new(positions, self.normals.clone(), self.triangles.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    fn corner() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        (vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])
    }

    #[test]
    fn normals_follow_the_winding() {
        let (positions, triangles) = corner();
        let mesh = TriangleMesh::new(positions, vec![], triangles).unwrap();
        assert_eq!(mesh.normals(), [Vec3::Z; 3]);
    }

    #[test]
    fn normals_do_not_depend_on_the_unit_of_length() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(-0.3, 0.2, 0.7)];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [3, 1, 0]];
        let normals = |scale: f32| {
            let positions = positions.iter().map(|&p| p * scale).collect();
            TriangleMesh::new(positions, vec![], triangles.clone()).unwrap().normals().to_vec()
        };
        for exponent in [-100, -70, 70, 120] {
            assert_eq!(normals(2.0f32.powi(exponent)), normals(1.0), "2^{exponent}");
        }
    }

    #[test]
    fn broken_normals_are_replaced() {
        let (positions, triangles) = corner();
        let normals = vec![Vec3::NAN, Vec3::new(2.0, 0.0, 0.0), Vec3::ZERO];
        let mesh = TriangleMesh::new(positions, normals, triangles).unwrap();
        assert_eq!(mesh.normals(), [Vec3::Z, Vec3::X, Vec3::Z]);
    }

    #[test]
    fn bad_parts_are_refused() {
        let (positions, _) = corner();
        assert!(TriangleMesh::new(positions.clone(), vec![], vec![[0, 1, 3]]).is_err());
        assert!(TriangleMesh::new(positions.clone(), vec![Vec3::X], vec![[0, 1, 2]]).is_err());
        assert!(TriangleMesh::new(positions, vec![], vec![]).is_err());
        assert!(TriangleMesh::new(vec![Vec3::NAN; 3], vec![], vec![[0, 1, 2]]).is_err());
    }

    #[test]
    fn placed_meshes_turn_their_normals() {
        let (positions, triangles) = corner();
        let mesh = TriangleMesh::new(positions, vec![], triangles).unwrap();
        let turn = glam::Quat::from_rotation_x(core::f32::consts::FRAC_PI_2);
        let placed = mesh.placed(&Placement::new(3.0, turn, Vec3::X).unwrap()).unwrap();
        assert!((placed.normals()[0] - Vec3::NEG_Y).length() < 1e-6);
        assert!((placed.positions()[2] - Vec3::new(1.0, 0.0, 3.0)).length() < 1e-6);
        assert!(mesh.placed(&Placement::new(f32::MAX, turn, Vec3::MAX).unwrap()).is_err());
    }

    #[test]
    fn fitted_fills_the_sphere() {
        let (positions, triangles) = corner();
        let mesh = TriangleMesh::new(positions, vec![], triangles).unwrap().fitted(Vec3::ONE, 2.0).unwrap();
        let far = mesh.positions().iter().map(|p| (p - Vec3::ONE).length()).fold(0.0, f32::max);
        assert!((far - 2.0).abs() < 1e-6);
        for size in [1e-30f32, 1e30] {
            let (positions, triangles) = corner();
            let positions = positions.into_iter().map(|p| p * size).collect();
            let mesh = TriangleMesh::new(positions, vec![], triangles).unwrap().fitted(Vec3::ONE, 2.0).unwrap();
            assert!((mesh.positions()[1] - mesh.positions()[2]).length() > 1.0, "{size}");
        }
        let point = TriangleMesh::new(vec![Vec3::ONE; 3], vec![], vec![[0, 1, 2]]).unwrap();
        assert!(point.fitted(Vec3::ZERO, 1.0).is_err());
        assert!(mesh.fitted(Vec3::NAN, 1.0).is_err() && mesh.fitted(Vec3::ONE, f32::INFINITY).is_err());
    }
}

//! Wavefront OBJ meshes, by the `tobj` crate.

use std::path::Path;

use glam::Vec3;
use lf_math::TriangleMesh;

use crate::SceneError;
use crate::scene::check_positions;

/// All triangles of an OBJ file as one mesh; polygons are cut into triangles, missing normals computed.
///
/// # Errors
/// If the file cannot be read or parsed, has no triangles, or has broken numbers.
pub fn import_obj(path: &Path) -> Result<TriangleMesh, SceneError> {
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ..Default::default() };
    let (models, _) =
        tobj::load_obj(path, &options).map_err(|source| SceneError::Obj { path: path.to_owned(), source })?;
    let (mut positions, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for model in models {
        let mesh = model.mesh;
        let first = positions.len() as u32;
        let vectors = |values: &[f32]| values.chunks_exact(3).map(Vec3::from_slice).collect::<Vec<_>>();
        positions.extend(vectors(&mesh.positions));
        normals.extend(vectors(&mesh.normals));
        // Vertices without a normal get a zero one, which the mesh then computes.
        normals.resize(positions.len(), Vec3::ZERO);
        triangles.extend(mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(|i| first.saturating_add(i))));
    }
    if triangles.is_empty() {
        return Err(SceneError::NoTriangles { path: path.to_owned() });
    }
    check_positions(positions.iter().copied())
        .map_err(|source| SceneError::Broken { path: path.to_owned(), source })?;
    TriangleMesh::new(positions, normals, triangles)
        .map_err(|source| SceneError::Broken { path: path.to_owned(), source })
}

//! Wavefront OBJ meshes, by the `tobj` crate.

use std::io::Cursor;
use std::path::Path;

use glam::Vec3;
use lf_math::TriangleMesh;

use super::MEMORY_BYTES;
use super::budget::Budget;
use crate::scene::check_positions;
use crate::{ImportError, SceneError};

/// All triangles of an OBJ file as one mesh; polygons are cut into triangles, missing normals computed. Materials are not read.
///
/// # Errors
/// [`SceneError::Import`] if the file cannot be read or parsed, has no triangles, has broken numbers, or needs more than
/// 4 GiB of memory.
pub fn import_obj(path: &Path) -> Result<TriangleMesh, SceneError> {
    import(path).map_err(|source| SceneError::Import { path: path.to_owned(), source })
}

fn import(path: &Path) -> Result<TriangleMesh, ImportError> {
    let mut budget = Budget::new(MEMORY_BYTES);
    let bytes = budget.read(path)?;
    // A face of seven characters, `f 1 2 3`, takes 100 bytes on its way.
    budget.take("the faces of the mesh", bytes.len() as u64, 16)?;
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ..Default::default() };
    let loaded = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, |_| Ok(Default::default()));
    let (models, _) = loaded.map_err(|error| ImportError::malformed("OBJ", error))?;
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
        return Err(ImportError::NoTriangles);
    }
    check_positions(positions.iter().copied())?;
    Ok(TriangleMesh::new(positions, normals, triangles)?)
}

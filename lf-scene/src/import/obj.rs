//! Wavefront OBJ meshes, by the `tobj` crate.

use std::io::Cursor;
use std::path::Path;

use glam::Vec3;
use lf_math::TriangleMesh;
use tobj::LoadOptions;

use super::budget::Budget;
use super::notes::Notes;
use super::{MEMORY_BYTES, flat_normal};
use crate::scene::check_positions;
use crate::{ImportError, SceneError};

/// A mesh from a file.
#[derive(Debug, Clone)]
pub struct ImportedMesh {
    /// The mesh.
    pub mesh: TriangleMesh,
    /// What the file holds that is not used, or not as it should be: one sentence each, with a count.
    pub warnings: Vec<String>,
}

/// All triangles of an OBJ file as one mesh; polygons are cut into triangles, missing normals computed.
///
/// Points, lines and triangles without area are left out and materials not read; the warnings count them.
///
/// # Errors
/// [`SceneError::Import`] if the file cannot be read or parsed, has no triangles, has broken numbers, or needs more than
/// 4 GiB of memory.
pub fn import_obj(path: &Path) -> Result<ImportedMesh, SceneError> {
    import(path).map_err(|source| SceneError::Import { path: path.to_owned(), source })
}

fn import(path: &Path) -> Result<ImportedMesh, ImportError> {
    let mut budget = Budget::new(MEMORY_BYTES);
    let mut bytes = budget.read(path)?;
    // A face of seven characters, `f 1 2 3`, takes 100 bytes on its way.
    budget.take("the faces of the mesh", bytes.len() as u64, 16)?;
    let mut notes = Notes::default();
    strike_unused(&mut bytes, &mut notes);
    // Faces of one or two corners are points and lines to `tobj`.
    let options = LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let loaded = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, |_| Ok(Default::default()));
    let (models, _) = loaded.map_err(|error| ImportError::malformed("OBJ", error))?;
    let mut parts = Parts::default();
    for model in models {
        parts.add(&model.mesh, &mut notes)?;
    }
    if parts.triangles.is_empty() {
        return Err(ImportError::NoTriangles);
    }
    let mesh = TriangleMesh::new(parts.positions, parts.normals, parts.triangles)?;
    Ok(ImportedMesh { mesh, warnings: notes.into_warnings() })
}

/// Notes statements that are not used, and makes comments of lines, as `tobj` would fill those of three points and more.
fn strike_unused(bytes: &mut [u8], notes: &mut Notes) {
    for line in bytes.split_mut(|&byte| byte == b'\n') {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"f") if words.count() < 3 => notes.add("faces have fewer than three corners and are left out"),
            Some(b"l" | b"p") => {
                notes.add("statements of points or lines are left out");
                line.fill(b'#');
            }
            Some(b"mtllib" | b"usemtl") => notes.add("statements of materials are not used"),
            Some(b"cstype" | b"curv" | b"curv2" | b"surf") => {
                notes.add("statements of curves or surfaces are not used");
            }
            _ => {}
        }
    }
}

/// Parts of the mesh, a normal for each position. Zero normals are computed in the end.
#[derive(Default)]
struct Parts {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Parts {
    /// Adds the triangles of an object that have an area, and the vertices that they use.
    fn add(&mut self, object: &tobj::Mesh, notes: &mut Notes) -> Result<(), ImportError> {
        let positions = vectors(&object.positions);
        check_positions(positions.iter().copied())?;
        let normals = normals(object, notes);
        let vertex = |i: u32| positions.get(i as usize).copied().zip(normals.get(i as usize).copied());
        let mut numbers = vec![None; positions.len()];
        let (triangles, _) = object.indices.as_chunks::<3>();
        for triangle in triangles {
            let [Some(a), Some(b), Some(c)] = triangle.map(vertex) else {
                return Err(ImportError::malformed("OBJ", "a face names a vertex that is missing"));
            };
            if flat_normal([a.0, b.0, c.0]).is_none() {
                notes.add("triangles have no area and are left out");
                continue;
            }
            let mut number = |i: u32, vertex| *numbers[i as usize].get_or_insert_with(|| self.vertex(vertex));
            let [i, j, k] = *triangle;
            let corners = [number(i, a), number(j, b), number(k, c)];
            self.triangles.push(corners);
        }
        Ok(())
    }

    /// Adds a vertex and returns its number.
    fn vertex(&mut self, (position, normal): (Vec3, Vec3)) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.positions.len() as u32 - 1
    }
}

/// A normal for each vertex of an object, or zero.
fn normals(object: &tobj::Mesh, notes: &mut Notes) -> Vec<Vec3> {
    if object.normals.len() != object.positions.len() {
        // Which vertices they belong to, `tobj` does not say.
        let some = usize::from(!object.normals.is_empty());
        notes.count("objects have normals at some of their vertices only, and all are computed", some);
        return vec![Vec3::ZERO; object.positions.len() / 3];
    }
    let normals = vectors(&object.normals);
    notes.normals(&normals);
    normals
}

fn vectors(values: &[f32]) -> Vec<Vec3> {
    let (triples, _) = values.as_chunks::<3>();
    triples.iter().copied().map(Vec3::from).collect()
}

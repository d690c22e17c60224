//! Triangles of a glTF file.

use glam::{Mat3, Mat4, Vec2, Vec3};
use gltf::mesh::Mode;
use gltf::{Primitive, Semantic};
use lf_math::normalized;

use super::super::budget::Budget;
use super::super::flat_normal;
use super::super::notes::Notes;
use super::accessors::{Accessors, is_plain};
use super::container::Container;
use super::materials::Mapping;
use crate::ImportError;
use crate::scene::{SceneBuilder, Vertex};

/// Gathers the triangles of one file.
pub(super) struct Meshes<'a> {
    pub(super) container: &'a Container<'a>,
    /// Of each material, and of the default one.
    pub(super) mappings: Vec<Mapping>,
    pub(super) builder: SceneBuilder,
}

/// The vertices of a primitive, world space.
struct Vertices {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
}

impl Meshes<'_> {
    /// Adds the triangles of a primitive under a transform.
    pub(super) fn add(
        &mut self,
        place: &str,
        primitive: &Primitive<'_>,
        world_from_node: Mat4,
        notes: &mut Notes,
        budget: &mut Budget,
    ) -> Result<(), ImportError> {
        if !self.is_used(primitive, notes) {
            return Ok(());
        }
        let number = primitive.material().index().unwrap_or(self.mappings.len().saturating_sub(1));
        let Some(mapping) = self.mappings.get(number).copied() else { return Ok(()) };
        let mut accessors = Accessors { container: self.container, budget };
        let vertices = Vertices::read(place, primitive, &mapping, world_from_node, &mut accessors, notes)?;
        let indices = match primitive.indices() {
            Some(accessor) => accessors.indices(&accessor)?,
            None => (0..vertices.positions.len() as u32).collect(),
        };
        let triangles = triangles(primitive.mode(), &indices);
        let size = size_of::<([Vertex; 3], u32)>() as u64;
        budget.take("the triangles", triangles.len() as u64, size)?;
        notes.count(
            "vertex indices are left over",
            indices.len().saturating_sub(match primitive.mode() {
                Mode::Triangles => 3 * triangles.len(),
                _ => triangles.len() + 2,
            }),
        );
        // A mirroring transform turns triangles inside out.
        let mirrored = world_from_node.determinant() < 0.0;
        for [a, b, c] in triangles {
            let order = if mirrored { [a, c, b] } else { [a, b, c] };
            match vertices.triangle(place, order)? {
                Some(corners) => self.builder.triangle(corners, number as u32),
                None => notes.add("triangles have no area and are left out"),
            }
        }
        Ok(())
    }

    /// Whether a primitive is made of triangles whose numbers are in the file.
    fn is_used(&self, primitive: &Primitive<'_>, notes: &mut Notes) -> bool {
        if matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            notes.add("primitives of points or lines are left out");
            return false;
        }
        let read =
            |semantic: &Semantic| matches!(semantic, Semantic::Positions | Semantic::Normals | Semantic::TexCoords(_));
        let mut attributes = primitive.attributes().filter(|(semantic, _)| read(semantic));
        if !(attributes.all(|(_, accessor)| is_plain(&accessor)) && primitive.indices().is_none_or(|a| is_plain(&a))) {
            notes.add("primitives have sparse or compressed numbers and are left out");
            return false;
        }
        if primitive.get(&Semantic::Positions).is_none() {
            notes.add("primitives have no positions and are left out");
            return false;
        }
        notes.count(
            "primitives have vertex colours, which are not used",
            usize::from(primitive.get(&Semantic::Colors(0)).is_some()),
        );
        notes.count(
            "primitives have morph targets, which are not used",
            usize::from(primitive.morph_targets().next().is_some()),
        );
        true
    }
}

impl Vertices {
    fn read(
        place: &str,
        primitive: &Primitive<'_>,
        mapping: &Mapping,
        world_from_node: Mat4,
        accessors: &mut Accessors<'_>,
        notes: &mut Notes,
    ) -> Result<Self, ImportError> {
        let Some(positions) = primitive.get(&Semantic::Positions) else { return Err(ImportError::NoTriangles) };
        let mut positions = accessors.vectors(&positions)?;
        for position in &mut positions {
            *position = world_from_node.transform_point3(*position);
        }
        if let Some(vertex) = positions.iter().position(|p| !p.is_finite()) {
            return Err(ImportError::malformed(place, format!("vertex {vertex} is not finite")));
        }
        let mut normals = primitive.get(&Semantic::Normals).map_or(Ok(vec![]), |a| accessors.vectors(&a))?;
        // Normals go by the inverse transpose, also under mirroring; a singular transform leaves the computed ones.
        let turn = Mat3::from_mat4(world_from_node).inverse().transpose();
        for normal in &mut normals {
            *normal = turn * *normal;
        }
        notes.normals(&normals);
        let uvs = primitive.get(&Semantic::TexCoords(mapping.set));
        let mut uvs = uvs.map_or(Ok(vec![]), |a| accessors.coordinates(&a))?;
        for uv in &mut uvs {
            *uv = mapping.transform.transform_point2(*uv);
        }
        for (what, len) in [("normals", normals.len()), ("texture coordinates", uvs.len())] {
            if len != 0 && len != positions.len() {
                return Err(ImportError::malformed(place, format!("{len} {what} for {} positions", positions.len())));
            }
        }
        note_coordinates(mapping, &mut uvs, notes);
        Ok(Self { positions, normals, uvs })
    }

    /// A triangle; `None` if it has no area.
    fn triangle(&self, place: &str, indices: [u32; 3]) -> Result<Option<[Vertex; 3]>, ImportError> {
        let corner = |index: u32| {
            self.positions.get(index as usize).copied().ok_or_else(|| {
                ImportError::malformed(place, format!("index {index} of {} vertices", self.positions.len()))
            })
        };
        let [a, b, c] = indices.map(corner);
        let corners = [a?, b?, c?];
        let Some(flat) = flat_normal(corners) else { return Ok(None) };
        let vertex = |(index, position): (u32, Vec3)| {
            let normal = self.normals.get(index as usize).copied().and_then(normalized);
            let uv = self.uvs.get(index as usize).copied().unwrap_or(Vec2::ZERO);
            Vertex { position, normal: normal.unwrap_or(flat.as_vec3()), uv }
        };
        let [i, j, k] = indices;
        let [a, b, c] = corners;
        Ok(Some([(i, a), (j, b), (k, c)].map(vertex)))
    }
}

/// Notes texture coordinates that are missing or mean something else to a texture that repeats, and mends those that mean
/// nothing.
fn note_coordinates(mapping: &Mapping, uvs: &mut [Vec2], notes: &mut Notes) {
    let missing = mapping.textured && uvs.is_empty();
    notes.count("primitives lack the texture coordinates that their material uses, taken for 0", usize::from(missing));
    for uv in uvs.iter_mut().filter(|uv| !uv.is_finite()) {
        *uv = Vec2::ZERO;
        notes.add("texture coordinates are not finite and taken for 0");
    }
    // Rounding takes coordinates at the picture's edge beyond it.
    let beyond = |uv: &Vec2| uv.min_element() < -1e-3 || uv.max_element() > 1.0 + 1e-3;
    if mapping.ends && uvs.iter().any(beyond) {
        notes.add("primitives reach beyond a texture that does not repeat; here it does");
    }
}

/// The corners of the triangles (glTF 2.0, section 3.7.2.1).
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    let (whole, _) = indices.as_chunks::<3>();
    let triples = indices.windows(3).filter_map(|window| window.first_chunk::<3>().copied());
    match mode {
        Mode::TriangleStrip => {
            let turned = |(i, [a, b, c]): (usize, [u32; 3])| if i % 2 == 0 { [a, b, c] } else { [a, c, b] };
            triples.enumerate().map(turned).collect()
        }
        Mode::TriangleFan => {
            let first = indices.first().copied().unwrap_or(0);
            triples.map(|[_, b, c]| [b, c, first]).collect()
        }
        _ => whole.to_vec(),
    }
}

//! glTF 2.0 scenes. The JSON is read and validated by the `gltf` crate; everything else here, with every access checked:
//!
//! | module | job |
//! |---|---|
//! | `container` | `.glb` chunks, JSON, buffers |
//! | `uri` | data URIs, files beside the scene |
//! | `accessors` | numbers from buffers |
//! | `textures` | PNG and JPEG pictures |
//! | `materials` | materials, texture transforms |
//! | `meshes` | triangles |
//! | `lights` | lights, suns, cameras |

mod accessors;
mod container;
mod lights;
mod materials;
mod meshes;
mod textures;
mod uri;

use std::collections::{HashMap, VecDeque};
use std::path::Path;

use glam::{Mat4, Vec3};
use gltf::Document;

use self::container::{Container, EXTENSIONS};
use self::materials::{Mapping, Materials};
use self::meshes::Meshes;
use self::textures::Textures;
use super::budget::Budget;
use super::notes::Notes;
use super::{ImportOptions, Imported, SceneCamera};
use crate::light::Light;
use crate::material::Material;
use crate::scene::SceneBuilder;
use crate::{ImportError, SceneError};

/// Reads a `.glb` or `.gltf` file.
///
/// Used are triangles with node transforms, metallic-roughness materials with their textures, emission, alpha masks,
/// transmission as clear glass, all perspective cameras, punctual lights, and a sun named in
/// `asset.extras.emitters[].sun_direction_world`. Without an environment there is a blue-white sky, and a scene in which
/// nothing shines gets a lamp at its camera; the warnings say so. What else the file holds is counted there. Candela and lux
/// become watts at 683 lm/W; emission is taken for W/(m²·sr) as it is.
///
/// Files that the scene names must lie in its folder or below.
///
/// # Errors
/// [`SceneError::Import`] if the file cannot be read, breaks the format, requires an extension that is not known, has numbers
/// that are not finite, indices that name nothing or nodes with two parents, has no triangles, or takes too much memory.
pub fn import_gltf(path: &Path, options: &ImportOptions) -> Result<Imported, SceneError> {
    let name = path.file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy());
    let mut budget = Budget::new(options.memory_bytes);
    let imported = budget
        .read(path)
        .and_then(|bytes| import(&name, &bytes, Some(path.parent().unwrap_or(Path::new("."))), options, &mut budget));
    imported.map_err(|source| SceneError::Import { path: path.to_owned(), source })
}

/// Reads a scene from the bytes of a `.glb` or `.gltf` file that names no other files.
///
/// # Errors
/// As [`import_gltf`].
pub fn import_gltf_slice(name: &str, bytes: &[u8], options: &ImportOptions) -> Result<Imported, ImportError> {
    import(name, bytes, None, options, &mut Budget::new(options.memory_bytes))
}

fn import(
    name: &str,
    bytes: &[u8],
    folder: Option<&Path>,
    options: &ImportOptions,
    budget: &mut Budget,
) -> Result<Imported, ImportError> {
    let mut notes = Notes::default();
    let container = Container::open(bytes, folder, budget)?;
    let document = &container.document;
    note_unused(document, &mut notes);
    let (builder, mappings) = materials(&container, &mut notes, budget)?;
    let meshes = Meshes { container: &container, mappings, builder };
    let mut walk = Walk { document, meshes, lights: vec![], cameras: vec![], notes, budget };
    if let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) {
        walk.scene(&scene)?;
    }
    let Walk { meshes: Meshes { builder, .. }, lights, cameras, mut notes, .. } = walk;
    if builder.is_empty() {
        return Err(ImportError::NoTriangles);
    }
    let lighting = lights::lighting(lights, document, &cameras, &builder, options, &mut notes);
    let scene = builder.build(name, lighting)?;
    let copyright = document.as_json().asset.copyright.clone();
    Ok(Imported { scene, cameras, copyright, warnings: notes.into_warnings() })
}

/// All materials by their number in the file, then glTF's default one.
fn materials(
    container: &Container<'_>,
    notes: &mut Notes,
    budget: &mut Budget,
) -> Result<(SceneBuilder, Vec<Mapping>), ImportError> {
    let mut builder = SceneBuilder::default();
    let textures = Textures { container, decoded: HashMap::new() };
    let mut convert = Materials { textures, notes, budget };
    let mut mappings = Vec::new();
    for material in container.document.materials() {
        let converted = convert.convert(&material)?;
        builder.material(converted.material);
        mappings.push(converted.mapping);
    }
    builder.material(Material::diffuse(Vec3::splat(0.8)));
    mappings.push(Mapping::NONE);
    Ok((builder, mappings))
}

/// Gathers what hangs on the nodes.
struct Walk<'a> {
    document: &'a Document,
    meshes: Meshes<'a>,
    lights: Vec<Light>,
    cameras: Vec<SceneCamera>,
    notes: Notes,
    budget: &'a mut Budget,
}

impl Walk<'_> {
    /// Walks the node tree. A node that is met twice has two parents or is its own ancestor, which glTF forbids.
    fn scene(&mut self, scene: &gltf::Scene<'_>) -> Result<(), ImportError> {
        let mut visited = vec![false; self.document.nodes().len()];
        let mut open: VecDeque<_> = scene.nodes().map(|node| (node, Mat4::IDENTITY)).collect();
        while let Some((node, world_from_parent)) = open.pop_front() {
            let Some(seen) = visited.get_mut(node.index()) else { continue };
            if std::mem::replace(seen, true) {
                return Err(ImportError::malformed(format!("node {}", node.index()), "it has two parents"));
            }
            let world_from_node = world_from_parent * Mat4::from_cols_array_2d(&node.transform().matrix());
            self.node(&node, world_from_node)?;
            open.extend(node.children().map(|child| (child, world_from_node)));
        }
        Ok(())
    }

    fn node(&mut self, node: &gltf::Node<'_>, world_from_node: Mat4) -> Result<(), ImportError> {
        self.cameras.extend(lights::convert_camera(self.document, node, world_from_node, &mut self.notes)?);
        if let Some(light) = node.light() {
            self.lights.extend(lights::convert_light(&light, world_from_node, &mut self.notes)?);
        }
        let Some(mesh) = node.mesh() else { return Ok(()) };
        for primitive in mesh.primitives() {
            let place = format!("node {}, mesh {}, primitive {}", node.index(), mesh.index(), primitive.index());
            self.meshes.add(&place, &primitive, world_from_node, &mut self.notes, self.budget)?;
        }
        Ok(())
    }
}

fn note_unused(document: &Document, notes: &mut Notes) {
    notes.count("skins are not used", document.skins().len());
    notes.count("animations are not used", document.animations().len());
    notes.count("scenes beside the first are not used", document.scenes().len().saturating_sub(1));
    let unknown = |name: &&str| !EXTENSIONS.contains(name);
    for name in document.extensions_used().filter(unknown) {
        let shown: String = name.chars().filter(|c| !c.is_control()).take(60).collect();
        notes.add(&format!("the extension {shown} is not used"));
    }
}

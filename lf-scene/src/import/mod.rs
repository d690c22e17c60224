//! Scenes and meshes from files.

mod gltf;
mod obj;

use glam::Vec3;

use crate::Scene;

pub use self::gltf::import_gltf;
pub use self::obj::import_obj;

/// A scene from a file.
#[derive(Debug)]
pub struct Imported {
    /// The scene.
    pub scene: Scene,
    /// Where its first camera stands and which way it looks, world space.
    pub camera: Option<(Vec3, Vec3)>,
    /// The file's own copyright or licence line.
    pub copyright: Option<String>,
    /// What the file holds that this importer does not use: one sentence each.
    pub warnings: Vec<String>,
}

//! Scenes, environments and meshes from files.
//!
//! Files may come from strangers: broken ones are errors that name the place, none panics, and what a file makes
//! allocate is paid from a budget.

mod budget;
mod environment;
mod gltf;
mod notes;
mod obj;

use glam::{DVec3, Vec3};
use lf_math::{GeometryError, Pinhole};

use crate::{EnvironmentMap, Scene};

pub use self::environment::{ImportedEnvironment, import_environment};
pub use self::gltf::{import_gltf, import_gltf_slice};
pub use self::obj::{ImportedMesh, import_obj};

/// How a scene is imported.
#[derive(Debug, Clone)]
pub struct ImportOptions {
    /// What rays see that leave the scene, and what lights it. Without one there is a plain sky.
    pub environment: Option<EnvironmentMap>,
    /// Memory that reading the file may take, bytes.
    pub memory_bytes: u64,
}

/// Memory that an import may take if nothing else is said, bytes: 4 GiB.
const MEMORY_BYTES: u64 = 4 << 30;

impl Default for ImportOptions {
    fn default() -> Self {
        Self { environment: None, memory_bytes: MEMORY_BYTES }
    }
}

/// A scene from a file.
#[derive(Debug)]
pub struct Imported {
    /// The scene.
    pub scene: Scene,
    /// Its perspective cameras.
    pub cameras: Vec<SceneCamera>,
    /// The file's own copyright or licence line.
    pub copyright: Option<String>,
    /// What the file holds that this importer does not use, or not as it should: one sentence each, with a count. Then what
    /// was made up where the file says nothing.
    pub warnings: Vec<String>,
}

/// A camera of a scene. World space.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneCamera {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Where it stands, metres.
    pub position: Vec3,
    /// Unit vector along which it looks.
    pub forward: Vec3,
    /// Unit vector that points up in its picture.
    pub up: Vec3,
    /// Vertical field of view, radians, within 0 … π.
    pub fov_y: f32,
}

impl SceneCamera {
    /// The camera with an image of `width × height` pixels. World space.
    ///
    /// # Errors
    /// Both sizes must be at least 1.
    pub fn pinhole(&self, width: u32, height: u32) -> Result<Pinhole, GeometryError> {
        Pinhole::looking(self.position, self.forward, self.up, self.fov_y, width, height)
    }
}

/// The unit normal of a triangle whose corners run anticlockwise; `None` if it has no area.
fn flat_normal(corners: [Vec3; 3]) -> Option<DVec3> {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    (b - a).cross(c - a).try_normalize()
}

//! The crate's one error type.

use std::path::PathBuf;

use lf_math::GeometryError;
use thiserror::Error;

/// Why a scene or a mesh could not be loaded or used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A glTF file could not be read.
    #[error("cannot read the glTF scene {}", path.display())]
    Gltf {
        /// The file.
        path: PathBuf,
        /// What the reader says.
        source: Box<gltf::Error>,
    },
    /// An OBJ file could not be read.
    #[error("cannot read the OBJ mesh {}", path.display())]
    Obj {
        /// The file.
        path: PathBuf,
        /// What the reader says.
        source: tobj::LoadError,
    },
    /// A file without triangles.
    #[error("{} holds no triangles", path.display())]
    NoTriangles {
        /// The file.
        path: PathBuf,
    },
    /// A file whose numbers make no geometry.
    #[error("{} holds broken geometry", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: GeometryError,
    },
    /// A scene without triangles, or with a vertex that is not finite.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
}

//! The crate's errors.

use std::path::PathBuf;

use lf_math::GeometryError;
use thiserror::Error;

/// Why a scene or a mesh could not be loaded or used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A file could not be imported.
    #[error("cannot import {}", path.display())]
    Import {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: ImportError,
    },
    /// A scene without triangles, or with a vertex that is not finite.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Edges would be cut too short.
    #[error("cut into triangles with edges of at most {edge} m, the scene has more than {max}; allow longer edges")]
    TooManyTriangles {
        /// The longest edge that was asked for, metres.
        edge: f32,
        /// How many triangles there may be.
        max: usize,
    },
}

/// What is wrong with a file that was to be imported.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImportError {
    /// A file could not be read.
    #[error("cannot read {}", path.display())]
    Io {
        /// The file, or one that it names.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file breaks its format.
    #[error("{place}: {problem}")]
    Malformed {
        /// Which part of the file.
        place: String,
        /// What is wrong with it.
        problem: String,
    },
    /// The file needs what this importer does not have.
    #[error("{what}, which this program does not support")]
    Unsupported {
        /// What it needs.
        what: String,
    },
    /// The file asks for more memory than it may take.
    #[error("{what} need {bytes} bytes of memory, and {left} are left of what the import may take")]
    LimitExceeded {
        /// What would take the memory.
        what: &'static str,
        /// How much it would take.
        bytes: u64,
        /// How much is left.
        left: u64,
    },
    /// There is nothing to see.
    #[error("it holds no triangles")]
    NoTriangles,
    /// Its numbers make no geometry.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
}

impl ImportError {
    /// A part of the file that breaks the format.
    #[expect(clippy::needless_pass_by_value, reason = "takes errors and texts alike, as map_err hands them over")]
    pub(crate) fn malformed(place: impl Into<String>, problem: impl ToString) -> Self {
        Self::Malformed { place: place.into(), problem: problem.to_string() }
    }
}

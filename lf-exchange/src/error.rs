//! The crate's one error type, grouped by who can act.

use std::error::Error as StdError;
use std::io;
use std::path::{Path, PathBuf};

use lf_math::GeometryError;
use thiserror::Error;

/// What a codec of another crate says.
type Source = Box<dyn StdError + Send + Sync>;

/// Why something could not be exported or imported.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExchangeError {
    /// The file system refused; the source says why.
    #[error("cannot access {}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A picture could not be decoded or encoded; the source says why.
    #[error("cannot {verb} the picture {}", path.display())]
    Picture {
        /// `read` or `write`.
        verb: &'static str,
        /// The file.
        path: PathBuf,
        /// What the codec said.
        source: Source,
    },
    /// A file or folder contradicts itself or the format it is meant to be in.
    #[error("{} cannot be used: {what}", path.display())]
    Malformed {
        /// The file or folder.
        path: PathBuf,
        /// What is wrong, and what would be right.
        what: String,
    },
    /// A file is sound as far as can be seen, or a light field is, but one side has no way to express it.
    #[error("not supported: {what}")]
    Unsupported {
        /// What cannot be expressed.
        what: String,
    },
    /// Importing would take more memory than the caller allows.
    #[error("{what} needs {bytes} bytes, over the limit of {limit}; raise the limit if the files can be trusted")]
    LimitExceeded {
        /// What would be loaded.
        what: String,
        /// The memory it needs; `u64::MAX` stands for anything that large or larger.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// The caller asked for what cannot be.
    #[error("{what}")]
    InvalidArgument {
        /// Which argument, and what it has to be.
        what: String,
    },
    /// Numbers that make no geometry.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
}

impl ExchangeError {
    pub(crate) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Io { path: path.to_owned(), source }
    }

    pub(crate) fn reading<E: Into<Source>>(path: &Path) -> impl FnOnce(E) -> Self {
        move |source| Self::Picture { verb: "read", path: path.to_owned(), source: source.into() }
    }

    pub(crate) fn writing<E: Into<Source>>(path: &Path) -> impl FnOnce(E) -> Self {
        move |source| Self::Picture { verb: "write", path: path.to_owned(), source: source.into() }
    }

    pub(crate) fn malformed(path: &Path, what: impl Into<String>) -> Self {
        Self::Malformed { path: path.to_owned(), what: what.into() }
    }

    pub(crate) fn unsupported(what: impl Into<String>) -> Self {
        Self::Unsupported { what: what.into() }
    }

    pub(crate) fn argument(what: impl Into<String>) -> Self {
        Self::InvalidArgument { what: what.into() }
    }
}

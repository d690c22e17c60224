//! Why a light field could not be captured or put together.

use std::io;
use std::path::{Path, PathBuf};

use lf_compress::PackError;
use lf_format::{FormatError, TexelEncoding};
use lf_math::GeometryError;
use thiserror::Error;

use crate::Shard;

/// Why a light field could not be captured or put together.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// The container refused it.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// A tile could not be encoded.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// A shape does not fit.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The file system refused; the source says why.
    #[error("could not {action} {}", path.display())]
    Io {
        /// What was to be done, such as `write`.
        action: &'static str,
        /// With which file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Captured texels have 8 bits.
    #[error("captured texels cannot be stored as {0:?}")]
    Encoding(TexelEncoding),
    /// Some other run has the journal open.
    #[error("{} is in use: another run is writing it", path.display())]
    InUse {
        /// The journal.
        path: PathBuf,
    },
    /// The file is no journal, or one that this version does not read.
    #[error("{} is not a journal of a capture: {what}", path.display())]
    NotAJournal {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// The journal is that of another capture.
    #[error("{} belongs to another capture: {}", path.display(), differences.join("; "))]
    Foreign {
        /// The journal.
        path: PathBuf,
        /// What differs.
        differences: Vec<String>,
    },
    /// Two journals hold the same shard.
    #[error("shard {shard} is there twice: {} and {}", first.display(), second.display())]
    DuplicateShard {
        /// The shard.
        shard: Shard,
        /// One journal.
        first: PathBuf,
        /// The other.
        second: PathBuf,
    },
    /// The journals of some shards were not given.
    #[error("the journals of shards {} of {count} are missing", list(missing))]
    MissingShards {
        /// Their numbers, from 1 on.
        missing: Vec<u32>,
        /// How many shards there are.
        count: u32,
    },
    /// A journal lacks tiles.
    #[error("{} lacks {missing} of its {tiles} tiles: its capture is not finished", path.display())]
    Unfinished {
        /// The journal.
        path: PathBuf,
        /// Tiles that it lacks.
        missing: usize,
        /// Tiles that it should hold.
        tiles: usize,
    },
    /// Inverse depths were captured and have nowhere to go, or the other way round.
    #[error("{}", if *captured { "inverse depths were captured, too, and need a file" } else { "no inverse depths were captured" })]
    DepthFile {
        /// Whether the journals hold inverse depths.
        captured: bool,
    },
}

fn list(numbers: &[u32]) -> String {
    numbers.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")
}

/// To map an error of the file system, saying what was to be done with which file.
pub(crate) fn io_error(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> CaptureError {
    let path = path.to_owned();
    move |source| CaptureError::Io { action, path, source }
}

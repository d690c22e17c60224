//! What can go wrong while codecs are compared.

use std::path::PathBuf;

/// Why a comparison could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// A file or folder could not be read or written.
    #[error("cannot access {path}: {source}")]
    Io {
        /// Which one.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file that should be an image is none.
    #[error("cannot read {path} as an image: {source}")]
    Image {
        /// Which file.
        path: PathBuf,
        /// What the decoder says.
        source: image::ImageError,
    },
    /// An option that the user gave asks for what is not there.
    #[error("{0}")]
    InvalidArgument(String),
    /// A codec refused its input or gave an answer that cannot be right.
    #[error("{codec} on {input}: {why}")]
    Codec {
        /// Name of the codec.
        codec: String,
        /// Name of the image.
        input: String,
        /// What it said or did.
        why: String,
    },
    /// A line of the recorded table does not parse.
    #[error("line {line} of the recorded peers: {why}")]
    Recorded {
        /// Line number from 1.
        line: usize,
        /// What is wrong with it.
        why: String,
    },
    /// A plot could not be drawn.
    #[error("cannot draw the plot: {0}")]
    Plot(String),
    /// The pool of one thread could not be made.
    #[error("cannot start the measuring thread: {0}")]
    Thread(#[from] rayon::ThreadPoolBuildError),
}

impl BenchError {
    /// An error about a path, for `map_err`.
    pub(crate) fn io(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, source }
    }
}

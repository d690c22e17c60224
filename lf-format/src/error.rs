//! The crate's one error type, grouped by who can act.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

/// Why a file could not be read or written. Clauses are those of `spec/lfslab-1.0.md`, written `§4.2`.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The file system refused; the source says why.
    #[error("could not write {}", path.display())]
    Io {
        /// The file that was to be written.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The bytes are of some other kind of file.
    #[error("not an .lfslab file: {found} (spec §3.1)")]
    NotLfslab {
        /// How the bytes begin.
        found: String,
    },
    /// The bytes break a rule of the specification: the file is damaged, or its writer is wrong.
    #[error("damaged .lfslab file: {what} (byte {offset}, spec {clause})")]
    Malformed {
        /// Distance in bytes from the start of the file to what is wrong.
        offset: u64,
        /// The clause that is broken.
        clause: &'static str,
        /// What is wrong, with the value found and the value needed.
        what: String,
    },
    /// The file is sound as far as can be seen, but uses something that this reader does not know.
    #[error(
        "unsupported .lfslab file: {what} (byte {offset}, spec {clause}); another version of the reader may know it"
    )]
    Unsupported {
        /// Distance in bytes from the start of the file to what is not known.
        offset: u64,
        /// The clause that leaves room for it.
        clause: &'static str,
        /// What is not known.
        what: String,
    },
    /// The file is larger than the caller's [`Limits`](crate::Limits) allow.
    #[error("{what} is {value}, over the limit of {limit}; raise the limit if the file can be trusted")]
    LimitExceeded {
        /// Which size or count.
        what: &'static str,
        /// Its value; `u64::MAX` stands for anything that large or larger.
        value: u64,
        /// The limit.
        limit: u64,
    },
    /// The caller asked for a file that cannot be.
    #[error("{what}")]
    InvalidArgument {
        /// Which argument, and what it has to be.
        what: String,
    },
}

impl FormatError {
    pub(crate) fn malformed(offset: u64, clause: &'static str, what: impl Into<String>) -> Self {
        Self::Malformed { offset, clause, what: what.into() }
    }

    pub(crate) fn unsupported(offset: u64, clause: &'static str, what: impl Into<String>) -> Self {
        Self::Unsupported { offset, clause, what: what.into() }
    }

    pub(crate) fn argument(what: impl Into<String>) -> Self {
        Self::InvalidArgument { what: what.into() }
    }
}

//! The crate's one error type, grouped by who can act.

use alloc::string::String;

use thiserror::Error;

use crate::Rule;

/// Why a file could not be read or written. Rules and clauses are those of `spec/lfslab-1.0.md`.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The file system refused; the source says why.
    #[cfg(feature = "std")]
    #[error("could not {action}")]
    Io {
        /// What was to be done, such as `write field.lfslab`.
        action: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// The bytes are of some other kind of file.
    #[error("not an .lfslab file: {found} (spec §3.1)")]
    NotLfslab {
        /// How the bytes begin.
        found: String,
    },
    /// The bytes break a rule of the specification: the file is damaged, or its writer is wrong.
    #[error("damaged .lfslab file: {what} (byte {offset}, spec {})", rule.clause())]
    Malformed {
        /// Distance in bytes from the start of the file to what is wrong.
        offset: u64,
        /// The rule that is broken.
        rule: Rule,
        /// What is wrong, with the value found and the value needed.
        what: String,
    },
    /// The file is sound as far as can be seen, but uses something that this reader does not know.
    #[error(
        "unsupported .lfslab file: {what} (byte {offset}, spec {}); another version of the reader may know it",
        rule.clause()
    )]
    Unsupported {
        /// Distance in bytes from the start of the file to what is not known.
        offset: u64,
        /// The rule that leaves room for it.
        rule: Rule,
        /// What is not known.
        what: String,
    },
    /// Reading would take more memory than the caller's [`Limits`](crate::Limits) allow.
    #[error(
        "{what} would take {bytes} bytes of memory, {left} of the budget are left; raise it if the file can be trusted"
    )]
    LimitExceeded {
        /// What the memory is for.
        what: &'static str,
        /// Bytes asked for; `u64::MAX` stands for anything that large or larger.
        bytes: u64,
        /// Bytes that are left.
        left: u64,
    },
    /// The caller asked for what cannot be.
    #[error("{what}")]
    InvalidArgument {
        /// Which argument, and what it has to be.
        what: String,
    },
}

impl FormatError {
    pub(crate) fn malformed(offset: u64, rule: Rule, what: impl Into<String>) -> Self {
        Self::Malformed { offset, rule, what: what.into() }
    }

    pub(crate) fn unsupported(offset: u64, rule: Rule, what: impl Into<String>) -> Self {
        Self::Unsupported { offset, rule, what: what.into() }
    }

    pub(crate) fn argument(what: impl Into<String>) -> Self {
        Self::InvalidArgument { what: what.into() }
    }

    #[cfg(feature = "std")]
    pub(crate) fn io(action: impl Into<String>, source: std::io::Error) -> Self {
        Self::Io { action: action.into(), source }
    }

    /// A name for programs that does not change between versions of this crate: the [rule's](Rule::id), or what else is
    /// wrong.
    #[must_use]
    pub fn id(&self) -> &'static str {
        match self {
            #[cfg(feature = "std")]
            Self::Io { .. } => "io",
            Self::NotLfslab { .. } => "foreign",
            Self::Malformed { rule, .. } | Self::Unsupported { rule, .. } => rule.id(),
            Self::LimitExceeded { .. } => "limit",
            Self::InvalidArgument { .. } => "argument",
        }
    }

    /// The rule that is broken and the byte of the file where, if a rule is.
    #[must_use]
    pub fn broken_rule(&self) -> Option<(Rule, u64)> {
        match self {
            &Self::Malformed { rule, offset, .. } | &Self::Unsupported { rule, offset, .. } => Some((rule, offset)),
            _ => None,
        }
    }
}

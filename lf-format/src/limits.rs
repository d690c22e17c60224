//! How much memory a file may cost.

use crate::FormatError;

/// Upper bound on the memory that reading a file may take (spec §10).
///
/// One budget covers everything that is allocated because of what the file says: directory, metadata, windows and masks
/// while it is opened, what is left of it each stored tile that is read, and whatever the caller unpacks, if the caller asks for it
/// by [`Budget::take`]. It is checked before anything is allocated.
///
/// ```
/// let small = lf_format::Limits { memory_bytes: 64 << 20 };
/// assert!(small.memory_bytes < lf_format::Limits::default().memory_bytes);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Bytes in all. Default 4 GiB.
    pub memory_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { memory_bytes: 4 << 30 }
    }
}

/// What is left of the memory that a file may cost.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Budget {
    left: u64,
}

impl Budget {
    pub(crate) fn new(limits: &Limits) -> Self {
        Self { left: limits.memory_bytes }
    }

    /// Takes `bytes` off; to be called before they are allocated. `what` they are for is said in the error.
    ///
    /// # Errors
    /// [`FormatError::LimitExceeded`] if less is left.
    pub fn take(&mut self, what: &'static str, bytes: u64) -> Result<(), FormatError> {
        let left = self.left;
        self.left = left.checked_sub(bytes).ok_or(FormatError::LimitExceeded { what, bytes, left })?;
        Ok(())
    }

    /// Bytes left.
    #[must_use]
    pub fn left(&self) -> u64 {
        self.left
    }
}

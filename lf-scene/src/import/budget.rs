//! How much memory an import may take.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::ImportError;

/// What is left of the memory that an import may take. Everything that a file makes grow is paid for before it is
/// allocated, and nothing is given back: that bounds the time, too.
pub(super) struct Budget {
    left: u64,
}

impl Budget {
    pub(super) fn new(bytes: u64) -> Self {
        Self { left: bytes }
    }

    /// Bytes that are left.
    pub(super) fn left(&self) -> u64 {
        self.left
    }

    /// Pays for `count` things of `each` bytes.
    pub(super) fn take(&mut self, what: &'static str, count: u64, each: u64) -> Result<(), ImportError> {
        let bytes = count.saturating_mul(each);
        let left = self.left;
        self.left = left.checked_sub(bytes).ok_or(ImportError::LimitExceeded { what, bytes, left })?;
        Ok(())
    }

    /// Reads a file, but no more of it than is left, whatever its length is said to be.
    pub(super) fn read(&mut self, path: &Path) -> Result<Vec<u8>, ImportError> {
        let failed = |source| ImportError::Io { path: path.to_owned(), source };
        let file = File::open(path).map_err(failed)?;
        let mut bytes = Vec::new();
        file.take(self.left.saturating_add(1)).read_to_end(&mut bytes).map_err(failed)?;
        self.take("the bytes of the file", bytes.len() as u64, 1)?;
        Ok(bytes)
    }
}

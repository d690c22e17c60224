//! Checked access to bytes that nobody has vouched for.

use alloc::format;
use core::fmt;

use crate::{FormatError, Rule};

/// Reads little-endian values one after the other, and knows where in the file they are.
pub(crate) struct Cursor<'a> {
    rest: &'a [u8],
    offset: u64,
    rule: Rule,
}

impl<'a> Cursor<'a> {
    /// A cursor over `bytes`, which begin at `offset` in the file; `rule` is broken when they end too early.
    pub(crate) fn new(bytes: &'a [u8], offset: u64, rule: Rule) -> Self {
        Self { rest: bytes, offset, rule }
    }

    /// Where in the file the next byte is.
    pub(crate) fn offset(&self) -> u64 {
        self.offset
    }

    /// The next `len` bytes.
    pub(crate) fn bytes(&mut self, len: usize) -> Result<&'a [u8], FormatError> {
        let (head, rest) = self.rest.split_at_checked(len).ok_or_else(|| self.too_short(len))?;
        self.advance(rest, len);
        Ok(head)
    }

    /// The next `N` bytes.
    pub(crate) fn array<const N: usize>(&mut self) -> Result<[u8; N], FormatError> {
        let (head, rest) = self.rest.split_first_chunk::<N>().ok_or_else(|| self.too_short(N))?;
        self.advance(rest, N);
        Ok(*head)
    }

    pub(crate) fn u8(&mut self) -> Result<u8, FormatError> {
        self.array().map(u8::from_le_bytes)
    }

    pub(crate) fn u16(&mut self) -> Result<u16, FormatError> {
        self.array().map(u16::from_le_bytes)
    }

    pub(crate) fn u32(&mut self) -> Result<u32, FormatError> {
        self.array().map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Result<u64, FormatError> {
        self.array().map(u64::from_le_bytes)
    }

    pub(crate) fn f32(&mut self) -> Result<f32, FormatError> {
        self.array().map(f32::from_le_bytes)
    }

    pub(crate) fn f64(&mut self) -> Result<f64, FormatError> {
        self.array().map(f64::from_le_bytes)
    }

    /// `N` reserved bytes, which must be zero.
    pub(crate) fn reserved<const N: usize>(&mut self, rule: Rule) -> Result<(), FormatError> {
        let at = self.offset;
        let reserved = self.array::<N>()?;
        zeros(&reserved, at, rule, "a reserved byte")
    }

    /// Makes sure that nothing is left.
    pub(crate) fn finish(self) -> Result<(), FormatError> {
        match self.rest.len() {
            0 => Ok(()),
            left => Err(FormatError::malformed(self.offset, self.rule, format!("{left} bytes too many"))),
        }
    }

    fn advance(&mut self, rest: &'a [u8], by: usize) {
        self.rest = rest;
        self.offset = self.offset.saturating_add(by as u64);
    }

    fn too_short(&self, wanted: usize) -> FormatError {
        let left = self.rest.len();
        FormatError::malformed(self.offset, self.rule, format!("{wanted} bytes are needed here, {left} are left"))
    }
}

/// The `len` bytes from `offset`, if there are as many.
pub(crate) fn range(bytes: &[u8], offset: u64, len: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    let end = usize::try_from(offset.checked_add(len)?).ok()?;
    bytes.get(start..end)
}

/// Makes sure that `bytes`, which begin at `offset` in the file, are all zero.
pub(crate) fn zeros(bytes: &[u8], offset: u64, rule: Rule, what: &str) -> Result<(), FormatError> {
    match bytes.iter().position(|&byte| byte != 0) {
        None => Ok(()),
        Some(i) => Err(FormatError::malformed(offset.saturating_add(i as u64), rule, format!("{what} is not zero"))),
    }
}

/// Compares a checksum, stored at `offset`, with the one computed for `name`.
pub(crate) fn checksum(
    stored: u64,
    computed: u64,
    offset: u64,
    rule: Rule,
    name: fmt::Arguments<'_>,
) -> Result<(), FormatError> {
    if stored == computed {
        return Ok(());
    }
    let what = format!("the checksum of {name} is {computed:016x}, stored is {stored:016x}");
    Err(FormatError::malformed(offset, rule, what))
}

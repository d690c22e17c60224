//! The `META` chunk: what people want to know about a file (spec §8).

use alloc::borrow::ToOwned;
use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use crate::bytes::Cursor;
use crate::{FormatError, Rule};

const MAX_KEY_LEN: usize = 64;
const MAX_VALUE_LEN: usize = 64 << 10;
/// Bytes of the whole chunk.
pub(crate) const MAX_LEN: u64 = 1 << 20;

/// Text values by key, in the order of the keys.
///
/// Keys are 1 to 64 bytes of `a`–`z`, `0`–`9`, `.`, `_` and `-`; values are at most 64 KiB of UTF-8 without
/// ASCII control characters other than tab and line feed, so that they can be shown in a terminal. The specification
/// names some keys, such as `generator`, `scene` and `license`; others are free. Nothing in here changes how
/// a file is rendered.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Metadata(BTreeMap<String, String>);

impl Metadata {
    /// No metadata.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the value of a key, in place of an earlier one.
    ///
    /// # Errors
    /// [`FormatError::InvalidArgument`] if the key or the value breaks the rules above.
    pub fn insert(&mut self, key: impl Into<String>, value: impl Into<String>) -> Result<(), FormatError> {
        let (key, value) = (key.into(), value.into());
        check_key(&key).and_then(|()| check_value(&value)).map_err(FormatError::argument)?;
        self.0.insert(key, value);
        Ok(())
    }

    /// The value of a key.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&str> {
        self.0.get(key).map(String::as_str)
    }

    /// Keys and values, in ascending order of the keys.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(key, value)| (key.as_str(), value.as_str()))
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Reads the chunk's payload, which begins at `offset` in the file.
    pub(crate) fn parse(payload: &[u8], offset: u64) -> Result<Self, FormatError> {
        let mut cursor = Cursor::new(payload, offset, Rule::MetadataOrder);
        let at = cursor.offset();
        let count = cursor.u32()?;
        if count == 0 {
            return Err(FormatError::malformed(at, Rule::MetadataCount, "there is a META chunk without entries"));
        }
        let mut metadata = Self::new();
        for _ in 0..count {
            metadata.parse_entry(&mut cursor)?;
        }
        cursor.finish()?;
        Ok(metadata)
    }

    fn parse_entry(&mut self, cursor: &mut Cursor<'_>) -> Result<(), FormatError> {
        let at = cursor.offset();
        let (key_len, value_len) = (cursor.u16()?, cursor.u32()?);
        let key = parse_text(cursor, key_len.into(), Rule::MetadataKey, check_key)?;
        if self.0.last_key_value().is_some_and(|(last, _)| *last >= key) {
            return Err(FormatError::malformed(
                at,
                Rule::MetadataOrder,
                format!("the key {key} is not in ascending order"),
            ));
        }
        let value = parse_text(cursor, value_len as usize, Rule::MetadataValue, check_value)?;
        self.0.insert(key, value);
        Ok(())
    }

    /// The chunk's payload, or `None` if there is nothing to store.
    pub(crate) fn to_bytes(&self) -> Option<Vec<u8>> {
        if self.is_empty() {
            return None;
        }
        let mut out = Vec::new();
        out.extend((self.0.len() as u32).to_le_bytes());
        for (key, value) in self.iter() {
            out.extend((key.len() as u16).to_le_bytes());
            out.extend((value.len() as u32).to_le_bytes());
            out.extend(key.as_bytes());
            out.extend(value.as_bytes());
        }
        Some(out)
    }
}

fn parse_text(
    cursor: &mut Cursor<'_>,
    len: usize,
    rule: Rule,
    check: impl Fn(&str) -> Result<(), &'static str>,
) -> Result<String, FormatError> {
    let at = cursor.offset();
    let text = core::str::from_utf8(cursor.bytes(len)?)
        .map_err(|error| FormatError::malformed(at, rule, format!("text is not UTF-8: {error}")))?;
    check(text).map_err(|what| FormatError::malformed(at, rule, what))?;
    Ok(text.to_owned())
}

fn check_key(key: &str) -> Result<(), &'static str> {
    let allowed = |byte: u8| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'.' | b'_' | b'-');
    if (1..=MAX_KEY_LEN).contains(&key.len()) && key.bytes().all(allowed) {
        return Ok(());
    }
    Err("a metadata key must be 1 to 64 of the characters a-z, 0-9, '.', '_' and '-'")
}

fn check_value(value: &str) -> Result<(), &'static str> {
    let allowed = |byte: u8| !byte.is_ascii_control() || matches!(byte, b'\t' | b'\n');
    if value.len() <= MAX_VALUE_LEN && value.bytes().all(allowed) {
        return Ok(());
    }
    Err("a metadata value must be at most 64 KiB and without control characters other than tab and line feed")
}

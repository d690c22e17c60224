//! The first 64 bytes of a file (spec §3).

use alloc::borrow::ToOwned;
use alloc::format;
use alloc::vec::Vec;
use core::cmp::Ordering;

use xxhash_rust::xxh64::xxh64;

use crate::bytes::{Cursor, checksum};
use crate::directory::ENTRY_LEN;
use crate::{FormatError, Rule};

pub(crate) const HEADER_LEN: usize = 64;
const MAGIC: [u8; 12] = *b"\x8ALFSLAB\0\r\n\x1A\n";
const NAME: &[u8] = b"LFSLAB";
/// The magic and the version: the part that is the same in every version of the format.
const PREFIX_LEN: usize = 16;
/// The header without its own checksum.
const CHECKED_LEN: usize = 56;
const VERSION: (u16, u16) = (1, 0);
/// Geometry and a tile.
const MIN_ENTRIES: u32 = 2;
pub(crate) const MAX_ENTRIES: u32 = 1 << 16;

/// What a sound header says.
pub(crate) struct Header {
    pub(crate) version: (u16, u16),
    pub(crate) file_len: u64,
    pub(crate) entry_count: u32,
    pub(crate) directory_checksum: u64,
}

impl Header {
    /// The header of a file of this version.
    pub(crate) fn new(file_len: u64, entry_count: u32, directory_checksum: u64) -> Self {
        Self { version: VERSION, file_len, entry_count, directory_checksum }
    }

    /// Reads the header, given the start of a file, as many bytes as there are, and holds the file's length to it.
    pub(crate) fn parse(start: &[u8], file_len: u64) -> Result<Self, FormatError> {
        check_magic(start, file_len)?;
        let prefix = start.get(..PREFIX_LEN).ok_or_else(|| cut_short(file_len, HEADER_LEN as u64))?;
        let version = parse_version(prefix)?;
        let header = start.get(..HEADER_LEN).ok_or_else(|| cut_short(file_len, HEADER_LEN as u64))?;
        check_checksum(header)?;
        let header = Self::parse_fields(version, header)?;
        check_file_len(header.file_len, file_len)?;
        check_entry_count(header.entry_count, file_len)?;
        Ok(header)
    }

    /// Length of the directory, bytes.
    pub(crate) fn directory_len(&self) -> u64 {
        u64::from(self.entry_count) * ENTRY_LEN as u64
    }

    fn parse_fields(version: (u16, u16), header: &[u8]) -> Result<Self, FormatError> {
        let mut cursor = Cursor::new(header, 0, Rule::Truncated);
        cursor.bytes(PREFIX_LEN)?;
        let file_len = cursor.u64()?;
        let at = cursor.offset();
        let directory_offset = cursor.u64()?;
        if directory_offset != HEADER_LEN as u64 {
            let what = format!("the directory offset is {directory_offset}, must be {HEADER_LEN}");
            return Err(FormatError::malformed(at, Rule::DirectoryOffset, what));
        }
        let entry_count = cursor.u32()?;
        cursor.reserved::<4>(Rule::HeaderReserved)?;
        let directory_checksum = cursor.u64()?;
        cursor.reserved::<8>(Rule::HeaderReserved)?;
        Ok(Self { version, file_len, entry_count, directory_checksum })
    }

    /// The header's 64 bytes.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(HEADER_LEN);
        out.extend(MAGIC);
        out.extend(self.version.0.to_le_bytes());
        out.extend(self.version.1.to_le_bytes());
        out.extend(self.file_len.to_le_bytes());
        out.extend((HEADER_LEN as u64).to_le_bytes());
        out.extend(self.entry_count.to_le_bytes());
        out.extend([0; 4]);
        out.extend(self.directory_checksum.to_le_bytes());
        out.extend([0; 8]);
        out.extend(xxh64(&out, 0).to_le_bytes());
        out
    }
}

/// Tells a foreign file from a damaged one: a transfer in text mode changes the line ends, or the first byte, but
/// leaves the name.
fn check_magic(file: &[u8], file_len: u64) -> Result<(), FormatError> {
    if file.starts_with(&MAGIC) {
        return Ok(());
    }
    if !file.is_empty() && MAGIC.starts_with(file) {
        return Err(cut_short(file_len, HEADER_LEN as u64));
    }
    let start = file.get(..PREFIX_LEN).unwrap_or(file);
    if start.windows(NAME.len()).any(|window| window == NAME) {
        let what = "the magic is damaged, as by a transfer in text mode; transfer the file again as binary";
        return Err(FormatError::malformed(0, Rule::Magic, what));
    }
    let found = match start {
        [] => "it is empty".to_owned(),
        _ => format!("it begins with {:02x?}", file.get(..MAGIC.len()).unwrap_or(file)),
    };
    Err(FormatError::NotLfslab { found })
}

fn parse_version(prefix: &[u8]) -> Result<(u16, u16), FormatError> {
    let mut cursor = Cursor::new(prefix, 0, Rule::Version);
    cursor.bytes(MAGIC.len())?;
    let (at, major, minor) = (cursor.offset(), cursor.u16()?, cursor.u16()?);
    if major == VERSION.0 {
        return Ok((major, minor));
    }
    let what = format!("it is of version {major}.{minor}, this reader knows version {}", VERSION.0);
    Err(FormatError::unsupported(at, Rule::Version, what))
}

fn check_checksum(header: &[u8]) -> Result<(), FormatError> {
    let mut cursor = Cursor::new(header, 0, Rule::HeaderChecksum);
    let computed = xxh64(cursor.bytes(CHECKED_LEN)?, 0);
    let (at, stored) = (cursor.offset(), cursor.u64()?);
    checksum(stored, computed, at, Rule::HeaderChecksum, format_args!("header bytes 0..{CHECKED_LEN}"))
}

fn check_file_len(declared: u64, actual: u64) -> Result<(), FormatError> {
    match declared.cmp(&actual) {
        Ordering::Equal => Ok(()),
        Ordering::Greater => Err(cut_short(actual, declared)),
        Ordering::Less => {
            let what = format!("the file has {actual} bytes but should end after {declared}");
            Err(FormatError::malformed(declared, Rule::FileLength, what))
        }
    }
}

fn check_entry_count(count: u32, file_len: u64) -> Result<(), FormatError> {
    let end = HEADER_LEN as u64 + u64::from(count) * ENTRY_LEN as u64;
    if !(MIN_ENTRIES..=MAX_ENTRIES).contains(&count) {
        let what = format!("there are {count} directory entries, must be {MIN_ENTRIES} to {MAX_ENTRIES}");
        return Err(FormatError::malformed(32, Rule::EntryCount, what));
    }
    if end > file_len {
        let what = format!("{count} directory entries do not fit into {file_len} bytes");
        return Err(FormatError::malformed(32, Rule::EntryCount, what));
    }
    Ok(())
}

fn cut_short(actual: u64, needed: u64) -> FormatError {
    let at_least = if needed == HEADER_LEN as u64 { "at least " } else { "" };
    let what = format!("the file is cut short: it has {actual} bytes, should have {at_least}{needed}");
    FormatError::malformed(actual, Rule::Truncated, what)
}

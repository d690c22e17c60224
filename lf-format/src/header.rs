//! The first 64 bytes of a file (spec §3).

use xxhash_rust::xxh64::xxh64;

use crate::FormatError;
use crate::bytes::{Cursor, checksum};

pub(crate) const HEADER_LEN: usize = 64;
const MAGIC: [u8; 12] = *b"\x8ALFSLAB\0\r\n\x1A\n";
const NAME: &[u8] = b"LFSLAB";
/// The magic and the version: the part that is the same in every version of the format.
const PREFIX_LEN: usize = 16;
/// The header without its own checksum.
const CHECKED_LEN: usize = 56;
const VERSION: (u16, u16) = (1, 0);

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

    /// Reads the header of a whole file and holds the file's length to it.
    pub(crate) fn parse(file: &[u8]) -> Result<Self, FormatError> {
        check_magic(file)?;
        let prefix = file.get(..PREFIX_LEN).ok_or_else(|| cut_short(file.len(), HEADER_LEN as u64))?;
        let version = parse_version(prefix)?;
        let header = file.get(..HEADER_LEN).ok_or_else(|| cut_short(file.len(), HEADER_LEN as u64))?;
        check_checksum(header)?;
        let header = Self::parse_fields(version, header)?;
        check_file_len(header.file_len, file.len())?;
        Ok(header)
    }

    fn parse_fields(version: (u16, u16), header: &[u8]) -> Result<Self, FormatError> {
        let mut cursor = Cursor::new(header, 0, "§3");
        cursor.bytes(PREFIX_LEN)?;
        let file_len = cursor.u64()?;
        let at = cursor.offset();
        let directory_offset = cursor.u64()?;
        if directory_offset != HEADER_LEN as u64 {
            let what = format!("the directory offset is {directory_offset}, must be {HEADER_LEN}");
            return Err(FormatError::malformed(at, "§3.4", what));
        }
        let entry_count = cursor.u32()?;
        cursor.reserved::<4>("§3.6")?;
        let directory_checksum = cursor.u64()?;
        cursor.reserved::<8>("§3.6")?;
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
fn check_magic(file: &[u8]) -> Result<(), FormatError> {
    if file.starts_with(&MAGIC) {
        return Ok(());
    }
    if !file.is_empty() && MAGIC.starts_with(file) {
        return Err(cut_short(file.len(), HEADER_LEN as u64));
    }
    let start = file.get(..PREFIX_LEN).unwrap_or(file);
    if start.windows(NAME.len()).any(|window| window == NAME) {
        let what = "the magic is damaged, as by a transfer in text mode; transfer the file again as binary";
        return Err(FormatError::malformed(0, "§3.1", what));
    }
    let found = match start {
        [] => "it is empty".to_owned(),
        _ => format!("it begins with {:02x?}", file.get(..MAGIC.len()).unwrap_or(file)),
    };
    Err(FormatError::NotLfslab { found })
}

fn parse_version(prefix: &[u8]) -> Result<(u16, u16), FormatError> {
    let mut cursor = Cursor::new(prefix, 0, "§3.2");
    cursor.bytes(MAGIC.len())?;
    let (at, major, minor) = (cursor.offset(), cursor.u16()?, cursor.u16()?);
    if major == VERSION.0 {
        return Ok((major, minor));
    }
    let what = format!("it is of version {major}.{minor}, this reader knows version {}", VERSION.0);
    Err(FormatError::unsupported(at, "§3.2", what))
}

fn check_checksum(header: &[u8]) -> Result<(), FormatError> {
    let mut cursor = Cursor::new(header, 0, "§3.8");
    let computed = xxh64(cursor.bytes(CHECKED_LEN)?, 0);
    let (at, stored) = (cursor.offset(), cursor.u64()?);
    checksum(stored, computed, at, "§3.8", format_args!("header bytes 0..{CHECKED_LEN}"))
}

fn check_file_len(declared: u64, actual: usize) -> Result<(), FormatError> {
    match declared.cmp(&(actual as u64)) {
        std::cmp::Ordering::Equal => Ok(()),
        std::cmp::Ordering::Greater => Err(cut_short(actual, declared)),
        std::cmp::Ordering::Less => {
            let what = format!("the file has {actual} bytes but should end after {declared}");
            Err(FormatError::malformed(declared, "§3.3", what))
        }
    }
}

fn cut_short(actual: usize, needed: u64) -> FormatError {
    let at_least = if needed == HEADER_LEN as u64 { "at least " } else { "" };
    let what = format!("the file is cut short: it has {actual} bytes, should have {at_least}{needed}");
    FormatError::malformed(actual as u64, "§3.3", what)
}

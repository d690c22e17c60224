//! The list of chunks that follows the header (spec §4).

use std::collections::BTreeSet;
use std::fmt;

use xxhash_rust::xxh64::{Xxh64, xxh64};

use crate::bytes::{Cursor, checksum, range, zeros};
use crate::header::{HEADER_LEN, Header};
use crate::{FormatError, Limits};

const ENTRY_LEN: usize = 48;
/// Payloads begin at multiples of this many bytes, which suits the alignment rules of every GPU copy.
const ALIGNMENT: u64 = 64;
const CRITICAL: u16 = 1;
const SAFE_TO_COPY: u16 = 2;

/// The kind of a chunk: four ASCII letters or digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Tag([u8; 4]);

impl Tag {
    /// The geometry of cell and slabs, and how the slabs are cut into tiles.
    pub const GEOM: Self = Self(*b"GEOM");
    /// Metadata.
    pub const META: Self = Self(*b"META");
    /// One tile of one slab.
    pub const TILE: Self = Self(*b"TILE");

    /// The four characters.
    #[must_use]
    pub fn bytes(self) -> [u8; 4] {
        self.0
    }

    /// The flags that a chunk of this kind must have; `None` for kinds this version does not know.
    fn flags(self) -> Option<u16> {
        match self {
            Self::GEOM | Self::TILE => Some(CRITICAL),
            Self::META => Some(SAFE_TO_COPY),
            _ => None,
        }
    }
}

impl fmt::Display for Tag {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.into_iter().try_for_each(|byte| write!(f, "{}", char::from(byte)))
    }
}

/// How the bytes of a chunk are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Packing {
    /// Not at all: stored are the raw bytes.
    None,
    /// One zstd frame (spec §7.5).
    Zstd,
    /// BC1 blocks in the tile codec (spec §7.8). Only tiles of BC1 slabs have it.
    Tile,
    /// In a way that this version does not know, by its number in the file. Only chunks that a reader skips have it,
    /// never a tile.
    Unknown(u8),
}

impl Packing {
    fn id(self) -> u8 {
        match self {
            Self::None => 0,
            Self::Zstd => 1,
            Self::Tile => 2,
            Self::Unknown(id) => id,
        }
    }

    fn from_id(id: u8) -> Self {
        match id {
            0 => Self::None,
            1 => Self::Zstd,
            2 => Self::Tile,
            _ => Self::Unknown(id),
        }
    }
}

/// What the directory says about one chunk.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct ChunkEntry {
    /// The kind of the chunk.
    pub tag: Tag,
    /// Whether a reader must know this kind to make sense of the file.
    pub critical: bool,
    /// Whether the chunk stays valid when other chunks change.
    pub safe_to_copy: bool,
    /// How the payload is packed.
    pub packing: Packing,
    /// The slab that the chunk belongs to, as a position in the geometry; 0 for chunks that belong to none.
    pub slab: u32,
    /// The tile within that slab; 0 for chunks that belong to none.
    pub tile: u32,
    /// Where the payload begins, bytes from the start of the file.
    pub offset: u64,
    /// Bytes of the payload as stored.
    pub stored_len: u64,
    /// Bytes of the payload unpacked.
    pub raw_len: u64,
    checksum: u64,
}

impl ChunkEntry {
    /// The entry of a chunk of a known kind, not yet placed in a file.
    pub(crate) fn new(tag: Tag, packing: Packing, [slab, tile]: [u32; 2], stored: &[u8], raw_len: u64) -> Self {
        let flags = tag.flags().unwrap_or(0);
        let mut entry = Self {
            tag,
            critical: flags & CRITICAL != 0,
            safe_to_copy: flags & SAFE_TO_COPY != 0,
            packing,
            slab,
            tile,
            offset: 0,
            stored_len: stored.len() as u64,
            raw_len,
            checksum: 0,
        };
        entry.checksum = entry.compute_checksum(stored);
        entry
    }

    /// The stored bytes of this chunk. All of them, as [`check_layout`] has made sure that they lie within the file.
    pub(crate) fn payload<'a>(&self, file: &'a [u8]) -> &'a [u8] {
        range(file, self.offset, self.stored_len).unwrap_or_default()
    }

    /// Where the payload ends, bytes from the start of the file.
    pub(crate) fn end(&self) -> u64 {
        self.offset.saturating_add(self.stored_len)
    }

    /// The first 16 bytes of the entry: what the chunk is, wherever it lies.
    fn identity(&self) -> [u8; 16] {
        let flags = u16::from(self.critical) * CRITICAL + u16::from(self.safe_to_copy) * SAFE_TO_COPY;
        let mut out = [0; 16];
        out[..4].copy_from_slice(&self.tag.0);
        out[4..6].copy_from_slice(&flags.to_le_bytes());
        out[6] = self.packing.id();
        out[8..12].copy_from_slice(&self.slab.to_le_bytes());
        out[12..].copy_from_slice(&self.tile.to_le_bytes());
        out
    }

    fn compute_checksum(&self, stored: &[u8]) -> u64 {
        let mut hash = Xxh64::new(0);
        hash.update(&self.identity());
        hash.update(stored);
        hash.digest()
    }

    fn write(&self, out: &mut Vec<u8>) {
        out.extend(self.identity());
        for value in [self.offset, self.stored_len, self.raw_len, self.checksum] {
            out.extend(value.to_le_bytes());
        }
    }

    fn parse(cursor: &mut Cursor<'_>) -> Result<Self, FormatError> {
        let at = cursor.offset();
        let tag = parse_tag(cursor)?;
        let flags = parse_flags(cursor, tag)?;
        let packing = parse_packing(cursor, tag)?;
        cursor.reserved::<1>("§4.9")?;
        let entry = Self {
            tag,
            critical: flags & CRITICAL != 0,
            safe_to_copy: flags & SAFE_TO_COPY != 0,
            packing,
            slab: cursor.u32()?,
            tile: cursor.u32()?,
            offset: cursor.u64()?,
            stored_len: cursor.u64()?,
            raw_len: cursor.u64()?,
            checksum: cursor.u64()?,
        };
        entry.check_fields(at)?;
        Ok(entry)
    }

    /// The rules between the fields of the entry that begins at `at`.
    fn check_fields(&self, at: u64) -> Result<(), FormatError> {
        if self.stored_len == 0 {
            return Err(FormatError::malformed(at.saturating_add(24), "§4.6", format!("{self} is empty")));
        }
        if self.packing == Packing::None && self.raw_len != self.stored_len {
            let (raw, stored) = (self.raw_len, self.stored_len);
            let what = format!("{self} is not packed, but has {stored} stored and {raw} raw bytes");
            return Err(FormatError::malformed(at.saturating_add(32), "§4.7", what));
        }
        if [Tag::GEOM, Tag::META].contains(&self.tag) { self.check_single(at) } else { Ok(()) }
    }

    /// The rules for a chunk that a file has once.
    fn check_single(&self, at: u64) -> Result<(), FormatError> {
        let wrong = [(6, self.packing != Packing::None), (8, self.slab != 0), (12, self.tile != 0)];
        match wrong.into_iter().find(|&(_, wrong)| wrong) {
            None => Ok(()),
            Some((field, _)) => {
                let what = format!("{self} must be unpacked, with slab and tile 0");
                Err(FormatError::malformed(at.saturating_add(field), "§4.4", what))
            }
        }
    }
}

/// Names the chunk as messages do: `chunk TILE (slab 0, tile 3)`.
impl fmt::Display for ChunkEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.tag {
            Tag::GEOM | Tag::META => write!(f, "chunk {}", self.tag),
            tag => write!(f, "chunk {tag} (slab {}, tile {})", self.slab, self.tile),
        }
    }
}

fn parse_tag(cursor: &mut Cursor<'_>) -> Result<Tag, FormatError> {
    let at = cursor.offset();
    let tag = cursor.array()?;
    if tag.iter().all(u8::is_ascii_alphanumeric) {
        return Ok(Tag(tag));
    }
    Err(FormatError::malformed(at, "§4.1", format!("a chunk's tag is {tag:02x?}, must be ASCII letters and digits")))
}

fn parse_flags(cursor: &mut Cursor<'_>, tag: Tag) -> Result<u16, FormatError> {
    let (at, flags) = (cursor.offset(), cursor.u16()?);
    match tag.flags() {
        Some(known) if known == flags => Ok(flags),
        Some(known) => {
            Err(FormatError::malformed(at, "§4.2", format!("the flags of a {tag} chunk are {flags}, must be {known}")))
        }
        None if flags == CRITICAL => {
            Err(FormatError::unsupported(at, "§4.2", format!("it has a critical chunk {tag}")))
        }
        None if flags & !SAFE_TO_COPY == 0 => Ok(flags),
        None => Err(FormatError::malformed(
            at,
            "§4.2",
            format!("the flags of a {tag} chunk are {flags}, must be 0, 1 or 2"),
        )),
    }
}

/// A chunk of a kind that is not known is skipped, however it is packed.
fn parse_packing(cursor: &mut Cursor<'_>, tag: Tag) -> Result<Packing, FormatError> {
    let (at, packing) = (cursor.offset(), Packing::from_id(cursor.u8()?));
    match packing {
        Packing::Unknown(id) if tag.flags().is_some() => {
            Err(FormatError::unsupported(at, "§4.3", format!("a {tag} chunk uses packing {id}")))
        }
        _ => Ok(packing),
    }
}

/// Reads the directory, and makes sure that its chunks cover the file and that all checksums are right.
pub(crate) fn parse(file: &[u8], header: &Header, limits: &Limits) -> Result<Vec<ChunkEntry>, FormatError> {
    let count = header.entry_count;
    limits.entries(count.into())?;
    let stored = range(file, HEADER_LEN as u64, u64::from(count) * ENTRY_LEN as u64).ok_or_else(|| {
        FormatError::malformed(32, "§3.5", format!("{count} directory entries do not fit into {} bytes", file.len()))
    })?;
    checksum(
        header.directory_checksum,
        xxh64(stored, 0),
        40,
        "§3.7",
        format_args!("the directory of {count} entries"),
    )?;
    let mut cursor = Cursor::new(stored, HEADER_LEN as u64, "§4");
    let entries = (0..count).map(|_| ChunkEntry::parse(&mut cursor)).collect::<Result<Vec<_>, _>>()?;
    check_unique(&entries)?;
    check_layout(file, &entries)?;
    check_payloads(file, &entries)?;
    Ok(entries)
}

/// Where an entry, given by its number, begins.
pub(crate) fn entry_offset(index: usize) -> u64 {
    (index as u64).saturating_mul(ENTRY_LEN as u64).saturating_add(HEADER_LEN as u64)
}

fn check_unique(entries: &[ChunkEntry]) -> Result<(), FormatError> {
    let mut seen = BTreeSet::new();
    match entries.iter().position(|entry| !seen.insert((entry.tag, entry.slab, entry.tile))) {
        None => Ok(()),
        Some(i) => Err(FormatError::malformed(entry_offset(i), "§4.4", "a chunk is listed twice")),
    }
}

/// Every byte after the directory belongs to one chunk or is padding.
fn check_layout(file: &[u8], entries: &[ChunkEntry]) -> Result<(), FormatError> {
    let mut end = entry_offset(entries.len());
    for (i, entry) in entries.iter().enumerate() {
        let expected = aligned(end);
        if entry.offset != expected {
            let what = format!("{entry} is at {}, must be at {expected}", entry.offset);
            return Err(FormatError::malformed(entry_offset(i).saturating_add(16), "§4.5", what));
        }
        if entry.end() > file.len() as u64 {
            let what = format!("{entry} reaches beyond the file");
            return Err(FormatError::malformed(entry_offset(i).saturating_add(24), "§4.6", what));
        }
        let padding = range(file, end, expected.saturating_sub(end)).unwrap_or_default();
        zeros(padding, end, "§4.5", "a padding byte")?;
        end = entry.end();
    }
    if end == file.len() as u64 {
        return Ok(());
    }
    Err(FormatError::malformed(end, "§4.5", "there are bytes after the last chunk"))
}

fn check_payloads(file: &[u8], entries: &[ChunkEntry]) -> Result<(), FormatError> {
    for (i, entry) in entries.iter().enumerate() {
        let computed = entry.compute_checksum(entry.payload(file));
        let name = format_args!("{entry} bytes {}..{}", entry.offset, entry.end());
        checksum(entry.checksum, computed, entry_offset(i).saturating_add(40), "§4.8", name)?;
    }
    Ok(())
}

/// The first place at or after `end` where a payload may begin.
fn aligned(end: u64) -> u64 {
    end.div_ceil(ALIGNMENT).saturating_mul(ALIGNMENT)
}

/// Gives every chunk its place, in order; returns the length of the file.
pub(crate) fn place<'e>(entries: impl ExactSizeIterator<Item = &'e mut ChunkEntry>) -> u64 {
    let start = entry_offset(entries.len());
    entries.fold(start, |end, entry| {
        entry.offset = aligned(end);
        entry.end()
    })
}

/// The directory of placed chunks, and its checksum.
pub(crate) fn to_bytes<'e>(entries: impl Iterator<Item = &'e ChunkEntry>) -> (Vec<u8>, u64) {
    let mut out = Vec::new();
    entries.for_each(|entry| entry.write(&mut out));
    let checksum = xxh64(&out, 0);
    (out, checksum)
}

//! The list of chunks that follows the header (spec §4).

use alloc::format;
use alloc::vec::Vec;
use core::fmt;

use xxhash_rust::xxh64::{Xxh64, xxh64};

use crate::bytes::{Cursor, checksum};
use crate::header::{HEADER_LEN, Header};
use crate::{FormatError, Packing, Rule};

pub(crate) const ENTRY_LEN: usize = 48;
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
    /// The windows of a slab's images.
    pub const CROP: Self = Self(*b"CROP");
    /// The cameras of a slab that are stored.
    pub const MASK: Self = Self(*b"MASK");
    /// One tile of one slab.
    pub const TILE: Self = Self(*b"TILE");

    /// The four characters.
    #[must_use]
    pub fn bytes(self) -> [u8; 4] {
        self.0
    }

    /// A tag for private use: three more ASCII letters or digits after a lower-case letter.
    ///
    /// # Errors
    /// [`FormatError::InvalidArgument`] for anything else.
    pub fn private(tag: [u8; 4]) -> Result<Self, FormatError> {
        if tag[0].is_ascii_lowercase() && tag.iter().all(u8::is_ascii_alphanumeric) {
            return Ok(Self(tag));
        }
        Err(FormatError::argument("a private tag is a lower-case letter and three ASCII letters or digits"))
    }

    /// Where chunks of this kind stand in the order of the directory (spec §4.10).
    pub(crate) fn rank(self) -> u8 {
        match self {
            Self::GEOM => 0,
            Self::META => 1,
            Self::CROP => 2,
            Self::MASK => 3,
            Self::TILE => 4,
            _ => 5,
        }
    }

    /// Whether this version knows the kind.
    #[must_use]
    pub fn is_known(self) -> bool {
        self.flags().is_some()
    }

    /// The flags that a chunk of this kind must have; `None` for kinds this version does not know.
    fn flags(self) -> Option<u16> {
        match self {
            Self::GEOM | Self::CROP | Self::MASK | Self::TILE => Some(CRITICAL),
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
    pub(crate) checksum: u64,
}

impl ChunkEntry {
    /// The entry of a chunk of a known kind that begins at `offset`.
    pub(crate) fn new(
        tag: Tag,
        packing: Packing,
        [slab, tile]: [u32; 2],
        offset: u64,
        stored: &[u8],
        raw_len: u64,
    ) -> Self {
        let flags = tag.flags().unwrap_or(0);
        let (critical, safe_to_copy) = (flags & CRITICAL != 0, flags & SAFE_TO_COPY != 0);
        let stored_len = stored.len() as u64;
        let entry = Self { tag, critical, safe_to_copy, packing, slab, tile, offset, stored_len, raw_len, checksum: 0 };
        entry.sealed(stored)
    }

    /// The entry with the checksum of its payload.
    pub(crate) fn sealed(mut self, stored: &[u8]) -> Self {
        self.checksum = self.compute_checksum(stored);
        self
    }

    /// Compares the checksum with that of the payload; `index` is the entry's number in the directory.
    pub(crate) fn verify(&self, index: usize, stored: &[u8]) -> Result<(), FormatError> {
        self.verify_digest(index, self.compute_checksum(stored))
    }

    /// Compares the checksum with a digest by [`Self::hasher`] of the whole payload.
    pub(crate) fn verify_digest(&self, index: usize, digest: u64) -> Result<(), FormatError> {
        let name = format_args!("{self} bytes {}..{}", self.offset, self.end());
        let at = entry_offset(index).saturating_add(40);
        checksum(self.checksum, digest, at, Rule::Checksum, name)
    }

    /// A checksum in the making that has taken in all that comes before the payload.
    pub(crate) fn hasher(&self) -> Xxh64 {
        let mut hash = Xxh64::new(0);
        hash.update(&self.identity());
        hash
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
        let mut hash = self.hasher();
        hash.update(stored);
        hash.digest()
    }

    pub(crate) fn write(&self, out: &mut Vec<u8>) {
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
        cursor.reserved::<1>(Rule::EntryReserved)?;
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
        if self.packing == Packing::None && self.raw_len != self.stored_len {
            let (raw, stored) = (self.raw_len, self.stored_len);
            let what = format!("{self} is not packed, but has {stored} stored and {raw} raw bytes");
            return Err(FormatError::malformed(at.saturating_add(32), Rule::RawLength, what));
        }
        if !self.tag.is_known() || self.tag == Tag::TILE {
            return Ok(());
        }
        if self.packing != Packing::None {
            let what = format!("{self} is packed, must not be");
            return Err(FormatError::malformed(at.saturating_add(6), Rule::Packing, what));
        }
        let no_slab = [Tag::GEOM, Tag::META].contains(&self.tag) && self.slab != 0;
        if no_slab || self.tile != 0 {
            let field = if no_slab { 8 } else { 12 };
            let what = format!("{self} is for slab {} and tile {}, must not be", self.slab, self.tile);
            return Err(FormatError::malformed(at.saturating_add(field), Rule::Subject, what));
        }
        Ok(())
    }

    /// What the order of the directory goes by.
    pub(crate) fn key(&self) -> (u8, Tag, u32, u32) {
        (self.tag.rank(), self.tag, self.slab, self.tile)
    }
}

/// Names the chunk as messages do: `chunk TILE (slab 0, tile 3)`.
impl fmt::Display for ChunkEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.tag {
            Tag::GEOM | Tag::META => write!(f, "chunk {}", self.tag),
            Tag::CROP | Tag::MASK => write!(f, "chunk {} (slab {})", self.tag, self.slab),
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
    Err(FormatError::malformed(at, Rule::Tag, format!("a chunk's tag is {tag:02x?}, must be ASCII letters and digits")))
}

fn parse_flags(cursor: &mut Cursor<'_>, tag: Tag) -> Result<u16, FormatError> {
    let (at, flags) = (cursor.offset(), cursor.u16()?);
    match tag.flags() {
        Some(known) if known == flags => Ok(flags),
        Some(known) => Err(FormatError::malformed(
            at,
            Rule::Flags,
            format!("the flags of a {tag} chunk are {flags}, must be {known}"),
        )),
        None if flags == CRITICAL => {
            Err(FormatError::unsupported(at, Rule::Critical, format!("it has a critical chunk {tag}")))
        }
        None if flags & !SAFE_TO_COPY == 0 => Ok(flags),
        None => Err(FormatError::malformed(
            at,
            Rule::Flags,
            format!("the flags of a {tag} chunk are {flags}, must be 0, 1 or 2"),
        )),
    }
}

/// A chunk of a kind that is not known is skipped, however it is packed.
fn parse_packing(cursor: &mut Cursor<'_>, tag: Tag) -> Result<Packing, FormatError> {
    let (at, packing) = (cursor.offset(), Packing::from_id(cursor.u8()?));
    match packing {
        Packing::Unknown(id) if tag.flags().is_some() => {
            Err(FormatError::unsupported(at, Rule::Packing, format!("a {tag} chunk uses packing {id}")))
        }
        _ => Ok(packing),
    }
}

/// Reads the directory, given its bytes, and makes sure that its chunks are in order and cover the file.
pub(crate) fn parse(stored: &[u8], header: &Header) -> Result<Vec<ChunkEntry>, FormatError> {
    let name = format_args!("the directory of {} entries", header.entry_count);
    checksum(header.directory_checksum, xxh64(stored, 0), 40, Rule::DirectoryChecksum, name)?;
    let mut cursor = Cursor::new(stored, HEADER_LEN as u64, Rule::EntryCount);
    let mut entries = Vec::with_capacity(header.entry_count as usize);
    let mut end = entry_offset(header.entry_count as usize);
    for index in 0..header.entry_count as usize {
        let entry = ChunkEntry::parse(&mut cursor)?;
        check_order(index, entries.last(), &entry)?;
        check_place(index, &entry, end, header.file_len)?;
        end = entry.end();
        entries.push(entry);
    }
    if end == header.file_len {
        return Ok(entries);
    }
    Err(FormatError::malformed(end, Rule::Tail, "there are bytes after the last chunk"))
}

/// Where an entry, given by its number, begins.
pub(crate) fn entry_offset(index: usize) -> u64 {
    (index as u64).saturating_mul(ENTRY_LEN as u64).saturating_add(HEADER_LEN as u64)
}

fn check_order(index: usize, before: Option<&ChunkEntry>, entry: &ChunkEntry) -> Result<(), FormatError> {
    let single = [Tag::GEOM, Tag::META].contains(&entry.tag);
    let what = match before {
        None if entry.tag == Tag::GEOM => return Ok(()),
        None => format!("the first chunk is {entry}, must be GEOM"),
        Some(before) if before.key() < entry.key() && !(single && before.tag == entry.tag) => return Ok(()),
        Some(before) => format!("{entry} must not stand after {before}"),
    };
    Err(FormatError::malformed(entry_offset(index), Rule::Order, what))
}

/// The payload comes right after what ends at `end`, with the least padding, and ends within the file.
fn check_place(index: usize, entry: &ChunkEntry, end: u64, file_len: u64) -> Result<(), FormatError> {
    let (at, expected) = (entry_offset(index), aligned(end));
    if entry.offset != expected {
        let what = format!("{entry} is at {}, must be at {expected}", entry.offset);
        return Err(FormatError::malformed(at.saturating_add(16), Rule::Offset, what));
    }
    let what = match entry.offset.checked_add(entry.stored_len) {
        Some(end) if end <= file_len && entry.stored_len > 0 => return Ok(()),
        _ if entry.stored_len == 0 => format!("{entry} is empty"),
        _ => format!("{entry} reaches beyond the file"),
    };
    Err(FormatError::malformed(at.saturating_add(24), Rule::StoredLength, what))
}

/// The first place at or after `end` where a payload may begin.
pub(crate) fn aligned(end: u64) -> u64 {
    end.div_ceil(ALIGNMENT).saturating_mul(ALIGNMENT)
}

/// The directory, and its checksum.
#[cfg(feature = "std")]
pub(crate) fn to_bytes(entries: &[ChunkEntry]) -> (Vec<u8>, u64) {
    let mut out = Vec::with_capacity(entries.len() * ENTRY_LEN);
    entries.iter().for_each(|entry| entry.write(&mut out));
    let checksum = xxh64(&out, 0);
    (out, checksum)
}

//! What a file consists of: everything but the payloads of its tiles.

use alloc::borrow::Cow;
use alloc::format;
use alloc::vec::Vec;

use lf_math::{Coverage, LightFieldGeometry};

use crate::directory::{entry_offset, parse as parse_directory};
use crate::geometry::Storage;
use crate::header::{HEADER_LEN, Header};
use crate::limits::Budget;
use crate::{ChunkEntry, FormatError, Limits, Metadata, Packing, Rule, SlabTiling, Tag, coverage, geometry, metadata};

/// Where the bytes of a file come from.
pub(crate) trait Source {
    /// Length of the file.
    fn file_len(&self) -> u64;
    /// Bytes of the file, all of which it has.
    fn read(&mut self, offset: u64, len: u64) -> Result<Cow<'_, [u8]>, FormatError>;
}

/// The validated structure of a file: header, directory, geometry, windows, masks and metadata (spec §3 to §6 and §8).
///
/// Holding one proves that the file has every chunk that it must have, each in its place, within the file and as long as
/// the geometry asks for. Tiles have not been looked at.
#[derive(Debug, Clone)]
pub struct Structure {
    version: (u16, u16),
    file_len: u64,
    geometry: LightFieldGeometry,
    tilings: Vec<SlabTiling>,
    metadata: Metadata,
    chunks: Vec<ChunkEntry>,
    /// The number in the directory of each slab's first tile.
    first_tiles: Vec<usize>,
    budget: Budget,
}

/// One tile as it is stored.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct StoredTile<'a> {
    /// How the bytes are packed: not at all, by zstd or by the tile codec.
    pub packing: Packing,
    /// The stored bytes: the raw tile itself, or one zstd frame of it or of its coded streams.
    pub bytes: &'a [u8],
    /// Length of the raw tile, bytes: [`SlabTiling::raw_len`]. What unpacks to any other length is damaged.
    pub raw_len: u64,
}

/// Shows the length of the bytes only: there may be gigabytes of them.
impl core::fmt::Debug for StoredTile<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { packing, bytes, raw_len } = self;
        write!(f, "StoredTile({packing:?}, {} of {raw_len} bytes)", bytes.len())
    }
}

impl Structure {
    /// The one validator behind all readers.
    pub(crate) fn read(source: &mut impl Source, limits: &Limits) -> Result<Self, FormatError> {
        let mut budget = Budget::new(limits);
        let file_len = source.file_len();
        let header = Header::parse(&source.read(0, file_len.min(HEADER_LEN as u64))?, file_len)?;
        let entry_bytes = size_of::<ChunkEntry>() as u64 * u64::from(header.entry_count);
        budget.take("the directory", header.directory_len().saturating_add(entry_bytes))?;
        let chunks = parse_directory(&source.read(HEADER_LEN as u64, header.directory_len())?, &header)?;
        let mut payloads = Payloads { source, budget: &mut budget };
        let (geometry, storage) = payloads.geometry(&chunks)?;
        let metadata = payloads.metadata(&chunks)?;
        let tilings = payloads.tilings(&chunks, &geometry, &storage)?;
        let first_tiles = check_tiles(&chunks, &tilings)?;
        Ok(Self { version: header.version, file_len, geometry, tilings, metadata, chunks, first_tiles, budget })
    }

    /// Cell and slabs.
    #[must_use]
    pub fn geometry(&self) -> &LightFieldGeometry {
        &self.geometry
    }

    /// How each slab is stored, in the order of the geometry's slabs.
    #[must_use]
    pub fn tilings(&self) -> &[SlabTiling] {
        &self.tilings
    }

    /// The metadata, empty if the file has none.
    #[must_use]
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// Major and minor version of the format that the file was written for.
    #[must_use]
    pub fn version(&self) -> (u16, u16) {
        self.version
    }

    /// Length of the file, bytes.
    #[must_use]
    pub fn file_len(&self) -> u64 {
        self.file_len
    }

    /// All chunks in the order of the file, those that this version does not know among them.
    #[must_use]
    pub fn chunks(&self) -> &[ChunkEntry] {
        &self.chunks
    }

    /// What opening the file has left of the memory that it may cost.
    #[must_use]
    pub fn budget(&self) -> Budget {
        self.budget.clone()
    }

    /// The number in [`Self::chunks`] of a tile's chunk; `None` if there is no such slab, a position in the geometry, or the
    /// tile is not stored.
    #[must_use]
    pub fn tile_chunk(&self, slab: usize, tile: u32) -> Option<usize> {
        let first = *self.first_tiles.get(slab)?;
        let end = self.first_tiles.get(slab + 1).copied().unwrap_or(self.chunks.len());
        let chunks = self.chunks.get(first..end)?;
        let slab = u32::try_from(slab).ok()?;
        chunks
            .binary_search_by_key(&(Tag::TILE.rank(), slab, tile), |c| (c.tag.rank(), c.slab, c.tile))
            .ok()
            .map(|i| first + i)
    }

    /// The tile in a chunk whose checksum was found right.
    pub(crate) fn tile<'a>(&self, index: usize, bytes: &'a [u8]) -> StoredTile<'a> {
        let entry = &self.chunks[index];
        StoredTile { packing: entry.packing, bytes, raw_len: entry.raw_len }
    }

    /// Where the padding before a chunk begins.
    pub(crate) fn padding_start(&self, index: usize) -> u64 {
        index.checked_sub(1).map_or(entry_offset(self.chunks.len()), |before| self.chunks[before].end())
    }
}

/// The payloads that the structure needs, each checked before it is used.
struct Payloads<'a, S> {
    source: &'a mut S,
    budget: &'a mut Budget,
}

impl<S: Source> Payloads<'_, S> {
    /// The payload of the chunk of number `index`, for which `cost` bytes of memory are taken.
    fn payload(
        &mut self,
        index: usize,
        entry: &ChunkEntry,
        what: &'static str,
        cost: u64,
    ) -> Result<Cow<'_, [u8]>, FormatError> {
        self.budget.take(what, cost)?;
        let payload = self.source.read(entry.offset, entry.stored_len)?;
        entry.verify(index, &payload)?;
        Ok(payload)
    }

    fn geometry(&mut self, chunks: &[ChunkEntry]) -> Result<(LightFieldGeometry, Vec<Storage>), FormatError> {
        // The directory begins with it.
        let Some(entry) = chunks.first() else {
            return Err(FormatError::malformed(entry_offset(0), Rule::Order, "there is no GEOM chunk"));
        };
        let len = entry.stored_len;
        if len > geometry::MAX_LEN {
            let what = format!("{entry} has {len} bytes, {} at most are needed", geometry::MAX_LEN);
            return Err(FormatError::malformed(entry.offset, Rule::GeometryLength, what));
        }
        let payload = self.payload(0, entry, "the geometry", len)?;
        geometry::parse(&payload, entry.offset)
    }

    fn metadata(&mut self, chunks: &[ChunkEntry]) -> Result<Metadata, FormatError> {
        let Some(entry) = chunks.get(1).filter(|entry| entry.tag == Tag::META) else {
            return Ok(Metadata::new());
        };
        if entry.stored_len > metadata::MAX_LEN {
            let what = format!("{entry} has {} bytes, must have at most {}", entry.stored_len, metadata::MAX_LEN);
            return Err(FormatError::malformed(entry.offset, Rule::MetadataLength, what));
        }
        // The payload, and keys and values on their own.
        let payload = self.payload(1, entry, "the metadata", 2 * entry.stored_len)?;
        Metadata::parse(&payload, entry.offset)
    }

    fn tilings(
        &mut self,
        chunks: &[ChunkEntry],
        geometry: &LightFieldGeometry,
        storage: &[Storage],
    ) -> Result<Vec<SlabTiling>, FormatError> {
        check_slabs(chunks, storage.len())?;
        let mut tilings = Vec::new();
        let mut total = 0u64;
        for (slab, stored) in storage.iter().enumerate() {
            let coverage = self.coverage(chunks, geometry, slab)?;
            let at = chunks.first().map_or(0, |entry| entry.offset).saturating_add(geometry::tiling_at(slab));
            if !coverage.keeps_any() {
                let what = format!("no camera of slab {slab} is stored");
                return Err(FormatError::malformed(at, Rule::NoCamera, what));
            }
            let tiling = SlabTiling::checked(stored.encoding, stored.cameras_per_tile, coverage);
            let raw = tiling.as_ref().and_then(|tiling| tiling.total_raw_len()?.checked_add(total));
            let (Some(tiling), Some(raw)) = (tiling, raw) else {
                let what = format!("slab {slab} or its tiles are too large");
                return Err(FormatError::malformed(at, Rule::Tiling, what));
            };
            total = raw;
            tilings.push(tiling);
        }
        Ok(tilings)
    }

    /// What is stored of a slab.
    fn coverage(
        &mut self,
        chunks: &[ChunkEntry],
        geometry: &LightFieldGeometry,
        slab: usize,
    ) -> Result<Coverage, FormatError> {
        let shape = &geometry.slabs()[slab];
        // They stand before all tiles.
        let before_tiles = chunks.iter().take_while(|entry| entry.tag.rank() < Tag::TILE.rank());
        let find = |tag| before_tiles.clone().position(|entry| entry.tag == tag && entry.slab as usize == slab);
        let mut found = Coverage::whole(shape);
        if let Some(index) = find(Tag::CROP) {
            let entry = &chunks[index];
            check_len(entry, coverage::crop_len(shape), Rule::CropLength)?;
            // The payload, windows as ranges, and their places in the tiles.
            let payload = self.payload(index, entry, "the windows of a slab", 4 * entry.stored_len)?;
            found = coverage::parse_crop(&payload, entry.offset, shape)?;
        }
        if let Some(index) = find(Tag::MASK) {
            let entry = &chunks[index];
            check_len(entry, coverage::mask_len(shape), Rule::MaskLength)?;
            // The payload, and a byte for each camera.
            let payload = self.payload(index, entry, "the mask of a slab", entry.stored_len.saturating_mul(9))?;
            found = coverage::parse_mask(&payload, entry.offset, found)?;
        }
        Ok(found)
    }
}

fn check_len(entry: &ChunkEntry, expected: u64, rule: Rule) -> Result<(), FormatError> {
    if entry.stored_len == expected {
        return Ok(());
    }
    let what = format!("{entry} has {} bytes, must have {expected}", entry.stored_len);
    Err(FormatError::malformed(entry.offset, rule, what))
}

/// Chunks that belong to a slab name one that there is.
fn check_slabs(chunks: &[ChunkEntry], slabs: usize) -> Result<(), FormatError> {
    let of_slab = |entry: &ChunkEntry| [Tag::CROP, Tag::MASK, Tag::TILE].contains(&entry.tag);
    match chunks.iter().position(|entry| of_slab(entry) && entry.slab as usize >= slabs) {
        None => Ok(()),
        Some(index) => {
            let what = format!("{} belongs to none of the {slabs} slabs", chunks[index]);
            Err(FormatError::malformed(entry_offset(index).saturating_add(8), Rule::Subject, what))
        }
    }
}

/// Makes sure that every tile of every slab is there, in order, and as long as the geometry says; returns where each slab's
/// tiles begin.
fn check_tiles(chunks: &[ChunkEntry], tilings: &[SlabTiling]) -> Result<Vec<usize>, FormatError> {
    let mut index = chunks.iter().take_while(|entry| entry.tag.rank() < Tag::TILE.rank()).count();
    let mut first_tiles = Vec::new();
    for (slab, tiling) in (0u32..).zip(tilings) {
        first_tiles.push(index);
        for tile in tiling.stored_tiles() {
            match chunks.get(index) {
                Some(entry) if (entry.tag, entry.slab, entry.tile) == (Tag::TILE, slab, tile) => {
                    check_tile(index, entry, tiling)?;
                }
                _ => {
                    let what = format!("chunk TILE (slab {slab}, tile {tile}) is missing or out of order");
                    return Err(FormatError::malformed(entry_offset(index), Rule::Order, what));
                }
            }
            index += 1;
        }
    }
    match chunks.get(index).filter(|entry| entry.tag == Tag::TILE) {
        None => Ok(first_tiles),
        Some(extra) => {
            let what = format!("{extra} is one too many");
            Err(FormatError::malformed(entry_offset(index), Rule::Order, what))
        }
    }
}

fn check_tile(index: usize, entry: &ChunkEntry, tiling: &SlabTiling) -> Result<(), FormatError> {
    let at = entry_offset(index);
    if !tiling.encoding().allows(entry.packing) {
        let what = format!("{entry} uses a packing that is for BC1 tiles only");
        return Err(FormatError::malformed(at.saturating_add(6), Rule::Packing, what));
    }
    let raw_len = tiling.raw_len(entry.tile);
    if entry.raw_len != raw_len {
        let what = format!("{entry} has {} raw bytes, the geometry makes it {raw_len}", entry.raw_len);
        return Err(FormatError::malformed(at.saturating_add(32), Rule::RawLength, what));
    }
    Ok(())
}

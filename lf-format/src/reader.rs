//! Reading a file that is already in memory.

use std::fmt;

use lf_math::LightFieldGeometry;

use crate::header::Header;
use crate::{ChunkEntry, FormatError, Limits, Metadata, Packing, SlabTiling, Tag, directory, geometry};

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
impl fmt::Debug for StoredTile<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { packing, bytes, raw_len } = self;
        write!(f, "StoredTile({packing:?}, {} of {raw_len} bytes)", bytes.len())
    }
}

/// A validated file. Tiles are borrowed from its bytes.
#[derive(Debug, Clone)]
pub struct Container<'a> {
    version: (u16, u16),
    geometry: LightFieldGeometry,
    tilings: Vec<SlabTiling>,
    metadata: Metadata,
    chunks: Vec<ChunkEntry>,
    /// By slab, then by tile.
    tiles: Vec<Vec<StoredTile<'a>>>,
}

impl<'a> Container<'a> {
    /// Validates a whole file: every rule of the specification but those about the contents of tiles.
    ///
    /// # Errors
    /// [`FormatError::NotLfslab`] for other kinds of files, `Malformed` for damage, `Unsupported` for what this
    /// version does not know, `LimitExceeded` for files larger than the caller wants to handle.
    pub fn parse(bytes: &'a [u8], limits: &Limits) -> Result<Self, FormatError> {
        limits.file_bytes(bytes.len() as u64)?;
        let header = Header::parse(bytes)?;
        let chunks = directory::parse(bytes, &header, limits)?;
        let (geometry, tilings) = parse_geometry(bytes, &chunks, limits)?;
        let metadata = parse_metadata(bytes, &chunks, limits)?;
        let tiles = collect_tiles(bytes, &chunks, &tilings)?;
        Ok(Self { version: header.version, geometry, tilings, metadata, chunks, tiles })
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

    /// A tile as it is stored; `None` if there is no such slab, a position in the geometry, or no such tile.
    #[must_use]
    pub fn tile(&self, slab: usize, tile: u32) -> Option<StoredTile<'a>> {
        self.tiles.get(slab)?.get(usize::try_from(tile).ok()?).copied()
    }

    /// All chunks in the order of the file, those that this version does not know among them.
    pub fn chunks(&self) -> impl Iterator<Item = &ChunkEntry> {
        self.chunks.iter()
    }
}

fn parse_geometry(
    file: &[u8],
    chunks: &[ChunkEntry],
    limits: &Limits,
) -> Result<(LightFieldGeometry, Vec<SlabTiling>), FormatError> {
    match chunks.first() {
        Some(entry) if entry.tag == Tag::GEOM => geometry::parse(entry.payload(file), entry.offset, limits),
        _ => Err(FormatError::malformed(directory::entry_offset(0), "§4.10", "the first chunk is not GEOM")),
    }
}

fn parse_metadata(file: &[u8], chunks: &[ChunkEntry], limits: &Limits) -> Result<Metadata, FormatError> {
    let Some(entry) = chunks.iter().find(|entry| entry.tag == Tag::META) else {
        return Ok(Metadata::new());
    };
    limits.metadata_bytes(entry.stored_len)?;
    Metadata::parse(entry.payload(file), entry.offset)
}

/// Makes sure that every tile of every slab is there, in order, and as long as the geometry says.
fn collect_tiles<'a>(
    file: &'a [u8],
    chunks: &[ChunkEntry],
    tilings: &[SlabTiling],
) -> Result<Vec<Vec<StoredTile<'a>>>, FormatError> {
    let mut stored = chunks.iter().enumerate().filter(|(_, entry)| entry.tag == Tag::TILE);
    let mut slabs = Vec::new();
    for (slab, tiling) in (0u32..).zip(tilings) {
        let mut tiles = Vec::new();
        for tile in 0..tiling.tile_count() {
            let (index, entry) = stored.next().ok_or_else(|| missing(chunks.len(), [slab, tile]))?;
            check_tile(index, entry, [slab, tile], tiling)?;
            tiles.push(StoredTile { packing: entry.packing, bytes: entry.payload(file), raw_len: entry.raw_len });
        }
        slabs.push(tiles);
    }
    match stored.next() {
        None => Ok(slabs),
        Some((index, extra)) => {
            let what = format!("{extra} is one too many");
            Err(FormatError::malformed(directory::entry_offset(index), "§4.10", what))
        }
    }
}

/// Holds the TILE entry of number `index` in the directory to the tile that must come next.
fn check_tile(index: usize, entry: &ChunkEntry, place: [u32; 2], tiling: &SlabTiling) -> Result<(), FormatError> {
    if [entry.slab, entry.tile] != place {
        return Err(missing(index, place));
    }
    let at = directory::entry_offset(index);
    if !tiling.encoding().allows(entry.packing) {
        let what = format!("{entry} uses a packing that is for BC1 tiles only");
        return Err(FormatError::malformed(at.saturating_add(6), "§4.3", what));
    }
    let raw_len = tiling.raw_len();
    if entry.raw_len != raw_len {
        let what = format!("{entry} has {} raw bytes, the geometry makes it {raw_len}", entry.raw_len);
        return Err(FormatError::malformed(at.saturating_add(32), "§4.7", what));
    }
    Ok(())
}

/// The error of a tile that should be listed by the entry of number `index`, or before.
fn missing(index: usize, [slab, tile]: [u32; 2]) -> FormatError {
    let what = format!("chunk TILE (slab {slab}, tile {tile}) is missing or out of order");
    FormatError::malformed(directory::entry_offset(index), "§4.10", what)
}

//! Writing a file, tile by tile.

use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;

use lf_math::{LightFieldGeometry, Slab};

use crate::directory::{aligned, entry_offset};
use crate::header::{Header, MAX_ENTRIES};
use crate::{
    AtomicFile, ChunkEntry, FormatError, Metadata, Packing, SlabTiling, Tag, coverage, directory, geometry, metadata,
};

/// What a file holds beside its tiles.
#[derive(Debug, Clone)]
pub struct Contents {
    /// Cell and slabs.
    pub geometry: LightFieldGeometry,
    /// How each slab is stored, in the order of the geometry's slabs.
    pub tilings: Vec<SlabTiling>,
    /// Text for people and tools.
    pub metadata: Metadata,
    /// Chunks of kinds that this version does not know.
    pub extra: Vec<ExtraChunk>,
}

/// A chunk of a kind that this version does not know: a private one, or one taken over from another file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExtraChunk {
    entry: ChunkEntry,
    payload: Vec<u8>,
}

impl ExtraChunk {
    /// A private chunk, not packed. `safe_to_copy` says whether it stays valid when tiles change.
    ///
    /// # Errors
    /// [`FormatError::InvalidArgument`] if the payload is empty or the tag not private: see [`Tag::private`].
    pub fn private(tag: [u8; 4], safe_to_copy: bool, payload: Vec<u8>) -> Result<Self, FormatError> {
        if payload.is_empty() {
            return Err(FormatError::argument("a chunk must not be empty"));
        }
        let entry = ChunkEntry::new(Tag::private(tag)?, Packing::None, [0; 2], 0, &payload, payload.len() as u64);
        Ok(Self { entry: ChunkEntry { safe_to_copy, ..entry }, payload })
    }

    /// A chunk of another file.
    pub(crate) fn copied(entry: &ChunkEntry, payload: Vec<u8>) -> Self {
        Self { entry: entry.clone(), payload }
    }

    /// The kind of the chunk.
    #[must_use]
    pub fn tag(&self) -> Tag {
        self.entry.tag
    }

    /// The stored bytes.
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        &self.payload
    }
}

impl Contents {
    /// Whole and cropped slabs, without extra chunks.
    #[must_use]
    pub fn new(geometry: LightFieldGeometry, tilings: Vec<SlabTiling>, metadata: Metadata) -> Self {
        Self { geometry, tilings, metadata, extra: Vec::new() }
    }

    /// The chunks before the tiles: kind, slab, payload.
    fn heads(&self) -> Vec<(Tag, u32, Vec<u8>)> {
        let mut heads = vec![(Tag::GEOM, 0, geometry::to_bytes(&self.geometry, &self.tilings))];
        heads.extend(self.metadata.to_bytes().map(|payload| (Tag::META, 0, payload)));
        let slabs = || (0u32..).zip(self.tilings.iter().map(SlabTiling::coverage));
        heads.extend(slabs().filter_map(|(slab, found)| Some((Tag::CROP, slab, coverage::crop_bytes(found)?))));
        heads.extend(slabs().filter_map(|(slab, found)| Some((Tag::MASK, slab, coverage::mask_bytes(found)?))));
        heads
    }

    fn check(&self) -> Result<(), FormatError> {
        check_tilings(self.geometry.slabs(), &self.tilings)?;
        if self.metadata.to_bytes().is_some_and(|bytes| bytes.len() as u64 > metadata::MAX_LEN) {
            return Err(FormatError::argument("the metadata is longer than 1 MiB"));
        }
        Ok(())
    }

    /// The extra chunks in the order of the directory.
    fn sorted_extra(&mut self) -> Result<Vec<ExtraChunk>, FormatError> {
        let mut extra = std::mem::take(&mut self.extra);
        extra.sort_by_key(|chunk| chunk.entry.key());
        match extra.windows(2).find(|pair| pair[0].entry.key() == pair[1].entry.key()) {
            None => Ok(extra),
            Some(pair) => Err(FormatError::argument(format!("there are two of {}", pair[0].entry))),
        }
    }
}

/// Writes a file in one pass, holding one entry of the directory for each tile.
///
/// Tiles come in the order of the file: by slab, then by number, those that the slab's tiling
/// [stores](SlabTiling::stored_tiles); [`next_tile`](Self::next_tile) says which. The same input gives the same bytes.
#[derive(Debug)]
pub struct Writer<W> {
    out: W,
    /// What messages call the output.
    name: String,
    tilings: Vec<SlabTiling>,
    extra: Vec<ExtraChunk>,
    /// Slab and tile of those that are still to come, the last first.
    waiting: Vec<(u32, u32)>,
    entries: Vec<ChunkEntry>,
    entry_count: usize,
    end: u64,
}

impl<W: Write + Seek> Writer<W> {
    /// Begins a file at the start of `out`.
    ///
    /// # Errors
    /// [`FormatError::InvalidArgument`] if the tilings are not those of the slabs, there would be more than 65,536 chunks, the metadata is
    /// longer than 1 MiB or two extra chunks are alike; [`FormatError::Io`] if the output cannot be written.
    pub fn new(out: W, contents: Contents) -> Result<Self, FormatError> {
        Self::named(out, "the file".to_owned(), contents)
    }

    fn named(mut out: W, name: String, mut contents: Contents) -> Result<Self, FormatError> {
        contents.check()?;
        let extra = contents.sorted_extra()?;
        let heads = contents.heads();
        let room = (MAX_ENTRIES as usize).saturating_sub(heads.len() + extra.len());
        let waiting = tiles_in_order(&contents.tilings, room)?;
        let entry_count = heads.len() + waiting.len() + extra.len();
        let start = entry_offset(entry_count);
        out.seek(SeekFrom::Start(0)).map_err(|source| cannot_write(&name, source))?;
        let tilings = contents.tilings;
        let mut writer = Self { out, name, tilings, extra, waiting, entries: Vec::new(), entry_count, end: 0 };
        writer.pad(start)?;
        for (tag, slab, payload) in heads {
            let len = payload.len() as u64;
            writer.chunk(&payload, |at| ChunkEntry::new(tag, Packing::None, [slab, 0], at, &payload, len))?;
        }
        Ok(writer)
    }

    /// Slab, a position in the geometry, and number of the tile that comes next; `None` when all are there.
    #[must_use]
    pub fn next_tile(&self) -> Option<(usize, u32)> {
        self.waiting.last().map(|&(slab, tile)| (slab as usize, tile))
    }

    /// Adds the next tile, packed as `packing` says. Packed bytes are not looked into.
    ///
    /// # Errors
    /// [`FormatError::InvalidArgument`] if all tiles are there, the packing is not for tiles of this encoding, or the bytes are
    /// empty, or not packed and not [`SlabTiling::raw_len`] long; [`FormatError::Io`] if the output cannot be written.
    pub fn tile(&mut self, packing: Packing, bytes: &[u8]) -> Result<(), FormatError> {
        let Some(&(slab, tile)) = self.waiting.last() else {
            return Err(FormatError::argument("all tiles were added before"));
        };
        let tiling = &self.tilings[slab as usize];
        let (len, raw_len) = (bytes.len() as u64, tiling.raw_len(tile));
        let refuse = |why: &str| Err(FormatError::argument(format!("tile {tile} of slab {slab} {why}")));
        if !tiling.encoding().allows(packing) {
            return refuse(&format!("must not be packed by {packing:?}"));
        }
        if len == 0 || (packing == Packing::None && len != raw_len) {
            return refuse(&format!("has {len} bytes, its raw length is {raw_len}"));
        }
        self.waiting.pop();
        self.chunk(bytes, |at| ChunkEntry::new(Tag::TILE, packing, [slab, tile], at, bytes, raw_len))
    }

    /// Ends the file and returns what it was written to.
    ///
    /// # Errors
    /// [`FormatError::InvalidArgument`] if a tile is missing; [`FormatError::Io`] if the output cannot be written.
    pub fn finish(mut self) -> Result<W, FormatError> {
        if let Some((slab, tile)) = self.next_tile() {
            return Err(FormatError::argument(format!("tile {tile} of slab {slab} was not added")));
        }
        for ExtraChunk { entry, payload } in std::mem::take(&mut self.extra) {
            self.chunk(&payload, |at| ChunkEntry { offset: at, ..entry }.sealed(&payload))?;
        }
        let (directory, checksum) = directory::to_bytes(&self.entries);
        let header = Header::new(self.end, self.entry_count as u32, checksum).to_bytes();
        let mut write = || {
            self.out.seek(SeekFrom::Start(0))?;
            self.out.write_all(&header)?;
            self.out.write_all(&directory)?;
            self.out.flush()
        };
        write().map_err(|source| cannot_write(&self.name, source))?;
        Ok(self.out)
    }

    /// Writes a payload at the next place; `entry` makes its entry from that.
    fn chunk(&mut self, payload: &[u8], entry: impl FnOnce(u64) -> ChunkEntry) -> Result<(), FormatError> {
        self.pad(aligned(self.end))?;
        let entry = entry(self.end);
        self.out.write_all(payload).map_err(|source| cannot_write(&self.name, source))?;
        self.end = entry.end();
        self.entries.push(entry);
        Ok(())
    }

    /// Writes zeros up to an offset.
    fn pad(&mut self, to: u64) -> Result<(), FormatError> {
        io::copy(&mut io::Read::take(io::repeat(0), to.saturating_sub(self.end)), &mut self.out)
            .map_err(|source| cannot_write(&self.name, source))?;
        self.end = to;
        Ok(())
    }
}

impl Writer<AtomicFile> {
    /// Begins a file that replaces what `path` holds when it is [saved](Self::save), and not before.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn create(path: &Path, contents: Contents) -> Result<Self, FormatError> {
        let name = path.display().to_string();
        let file = AtomicFile::create(path).map_err(|source| cannot_write(&name, source))?;
        Self::named(file, name, contents)
    }

    /// Ends the file and puts it in place; returns its length in bytes.
    ///
    /// # Errors
    /// As [`Self::finish`].
    pub fn save(self) -> Result<u64, FormatError> {
        let path = self.name.clone();
        let file = self.finish()?;
        file.commit().map_err(|source| cannot_write(&path, source))
    }
}

fn cannot_write(name: &str, source: io::Error) -> FormatError {
    FormatError::io(format!("write {name}"), source)
}

/// Slab and number of all stored tiles, the last first; an error if there are more than `room`.
fn tiles_in_order(tilings: &[SlabTiling], room: usize) -> Result<Vec<(u32, u32)>, FormatError> {
    let all = (0u32..).zip(tilings).flat_map(|(slab, tiling)| tiling.stored_tiles().map(move |tile| (slab, tile)));
    let mut tiles: Vec<_> = all.take(room + 1).collect();
    if tiles.len() > room {
        return Err(FormatError::argument(format!(
            "there would be more than {MAX_ENTRIES} chunks; put more cameras into a tile"
        )));
    }
    tiles.reverse();
    Ok(tiles)
}

fn check_tilings(slabs: &[Slab], tilings: &[SlabTiling]) -> Result<(), FormatError> {
    if tilings.len() != slabs.len() {
        let what = format!("{} tilings were given for {} slabs", tilings.len(), slabs.len());
        return Err(FormatError::argument(what));
    }
    for (i, (slab, tiling)) in slabs.iter().zip(tilings).enumerate() {
        if (tiling.cameras(), tiling.resolution()) != (slab.cameras(), slab.resolution()) {
            return Err(FormatError::argument(format!("tiling {i} was made for another slab")));
        }
        if slab.st().iter().chain(&slab.uv()).any(|axis| axis.count() > geometry::MAX_COUNT) {
            return Err(FormatError::argument(format!(
                "slab {i} has more than {} samples along an axis",
                geometry::MAX_COUNT
            )));
        }
    }
    Ok(())
}

//! Building a file in memory.

use std::borrow::Cow;
use std::path::Path;

use lf_math::LightFieldGeometry;

use crate::header::Header;
use crate::{ChunkEntry, FormatError, Limits, Metadata, Packing, SlabTiling, Tag, directory, geometry, write_atomic};

/// A file in the making: add every tile of every slab, in any order, then save.
///
/// All stored tiles are held in memory. The same input gives the same bytes, on any machine and in any order.
#[derive(Debug, Clone)]
pub struct Writer {
    geometry: LightFieldGeometry,
    tilings: Vec<SlabTiling>,
    metadata: Metadata,
    /// By slab, then by tile; `None` until it is added.
    tiles: Vec<Vec<Option<Tile>>>,
}

#[derive(Debug, Clone)]
struct Tile {
    packing: Packing,
    bytes: Vec<u8>,
}

struct Chunk<'a> {
    entry: ChunkEntry,
    payload: Cow<'a, [u8]>,
}

impl Writer {
    /// A file of `geometry` without tiles as yet. `tilings` has one entry for each slab, made for it.
    ///
    /// # Errors
    /// [`FormatError::InvalidArgument`] if the tilings are not those of the slabs, [`FormatError::LimitExceeded`] if a
    /// reader with default [`Limits`] would refuse the file.
    pub fn new(
        geometry: LightFieldGeometry,
        tilings: Vec<SlabTiling>,
        metadata: Metadata,
    ) -> Result<Self, FormatError> {
        check_tilings(&geometry, &tilings)?;
        let limits = Limits::default();
        limits.geometry(&geometry, &tilings)?;
        limits.metadata_bytes(metadata.to_bytes().map_or(0, |bytes| bytes.len() as u64))?;
        let tile_count: u64 = tilings.iter().map(|tiling| u64::from(tiling.tile_count())).sum();
        limits.entries(tile_count + 1 + u64::from(!metadata.is_empty()))?;
        let tiles = tilings.iter().map(|tiling| vec![None; tiling.tile_count() as usize]).collect();
        Ok(Self { geometry, tilings, metadata, tiles })
    }

    /// Adds one tile of a slab, a position in the geometry, packed as `packing` says.
    ///
    /// # Errors
    /// [`FormatError::InvalidArgument`] if there is no such tile, it is there already, the packing is
    /// [`Packing::Unknown`] or not for tiles of this encoding, the bytes are empty, or they are not packed and not [`SlabTiling::raw_len`] long. Packed
    /// bytes are not looked into.
    pub fn add_tile(&mut self, slab: usize, tile: u32, packing: Packing, bytes: Vec<u8>) -> Result<(), FormatError> {
        let refuse = |why: &str| Err(FormatError::argument(format!("tile {tile} of slab {slab} {why}")));
        let place = self.tiles.get_mut(slab).and_then(|tiles| tiles.get_mut(tile as usize));
        let (Some(place), Some(tiling)) = (place, self.tilings.get(slab)) else {
            return refuse("does not exist");
        };
        if place.is_some() {
            return refuse("was added before");
        }
        if let Packing::Unknown(id) = packing {
            return refuse(&format!("uses packing {id}, which no reader knows"));
        }
        if !tiling.encoding().allows(packing) {
            return refuse("uses a packing that is for BC1 tiles only");
        }
        let (len, raw_len) = (bytes.len() as u64, tiling.raw_len());
        if len == 0 || (packing == Packing::None && len != raw_len) {
            return refuse(&format!("has {len} bytes, its raw length is {raw_len}"));
        }
        *place = Some(Tile { packing, bytes });
        Ok(())
    }

    /// The whole file.
    ///
    /// # Errors
    /// [`FormatError::InvalidArgument`] if a tile is missing, [`FormatError::LimitExceeded`] if the file would be longer
    /// than a reader with default [`Limits`] accepts.
    pub fn to_bytes(&self) -> Result<Vec<u8>, FormatError> {
        Ok(self.parts()?.concat())
    }

    /// Writes the file by [`write_atomic`] and returns its length in bytes.
    ///
    /// # Errors
    /// As [`Self::to_bytes`]; [`FormatError::Io`] if the file cannot be written.
    pub fn save(&self, path: &Path) -> Result<u64, FormatError> {
        let parts = self.parts()?;
        write_atomic(path, |out| parts.iter().try_for_each(|part| out.write_all(part)))
            .map_err(|source| FormatError::Io { path: path.to_owned(), source })?;
        Ok(parts.iter().map(|part| part.len() as u64).sum())
    }

    /// The pieces that make up the file one after the other.
    fn parts(&self) -> Result<Vec<Cow<'_, [u8]>>, FormatError> {
        let mut chunks = self.chunks()?;
        let file_len = directory::place(chunks.iter_mut().map(|chunk| &mut chunk.entry));
        Limits::default().file_bytes(file_len)?;
        let (directory, checksum) = directory::to_bytes(chunks.iter().map(|chunk| &chunk.entry));
        let header = Header::new(file_len, chunks.len() as u32, checksum).to_bytes();
        let mut end = (header.len() + directory.len()) as u64;
        let mut parts = vec![Cow::Owned(header), Cow::Owned(directory)];
        for Chunk { entry, payload } in chunks {
            let padding = entry.offset.saturating_sub(end) as usize;
            end = entry.end();
            parts.extend([Cow::Owned(vec![0; padding]), payload]);
        }
        Ok(parts)
    }

    /// All chunks in the order of the file, not yet placed.
    fn chunks(&self) -> Result<Vec<Chunk<'_>>, FormatError> {
        let mut chunks = vec![single(Tag::GEOM, geometry::to_bytes(&self.geometry, &self.tilings))];
        chunks.extend(self.metadata.to_bytes().map(|payload| single(Tag::META, payload)));
        for ((slab, tiles), tiling) in (0u32..).zip(&self.tiles).zip(&self.tilings) {
            for (tile, stored) in (0u32..).zip(tiles) {
                let Some(Tile { packing, bytes }) = stored else {
                    return Err(FormatError::argument(format!("tile {tile} of slab {slab} was not added")));
                };
                let entry = ChunkEntry::new(Tag::TILE, *packing, [slab, tile], bytes, tiling.raw_len());
                chunks.push(Chunk { entry, payload: bytes.into() });
            }
        }
        Ok(chunks)
    }
}

/// A chunk that a file has once.
fn single(tag: Tag, payload: Vec<u8>) -> Chunk<'static> {
    let raw_len = payload.len() as u64;
    Chunk { entry: ChunkEntry::new(tag, Packing::None, [0, 0], &payload, raw_len), payload: payload.into() }
}

fn check_tilings(geometry: &LightFieldGeometry, tilings: &[SlabTiling]) -> Result<(), FormatError> {
    let slabs = geometry.slabs();
    if tilings.len() != slabs.len() {
        let what = format!("{} tilings were given for {} slabs", tilings.len(), slabs.len());
        return Err(FormatError::argument(what));
    }
    for (i, (slab, tiling)) in slabs.iter().zip(tilings).enumerate() {
        if SlabTiling::new(slab, tiling.encoding(), tiling.cameras_per_tile())? != *tiling {
            return Err(FormatError::argument(format!("tiling {i} was made for another slab")));
        }
    }
    Ok(())
}

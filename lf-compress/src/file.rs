//! Between encoded tiles and files: each tile packed as suits it, and unpacked again.

use std::borrow::Cow;
use std::io::{Cursor, Read, Seek, Write};
use std::path::Path;

use lf_format::{
    Container, Contents, FileReader, FormatError, Metadata, Packing, Rule, SlabTiling, StoredTile, Structure,
    TexelEncoding, Writer,
};
use rayon::prelude::*;

use crate::error::{PackError, check_buffer};
use crate::packed::{PackedLightField, tile_shape};
use crate::tile::{self, TileError};
use crate::{bc1, zstd_tile};

/// Tiles that are packed at once: as many as keep all threads busy, and no more memory than that.
const BATCH: usize = 16;

impl PackedLightField {
    /// Unpacks all tiles of a file in memory, on all threads. All of them must fit into what opening the file has left of its
    /// memory budget.
    ///
    /// # Errors
    /// A tile that is damaged, or more memory than allowed.
    pub fn read(container: &Container<'_>) -> Result<Self, PackError> {
        take_tiles(container)?;
        let read_slab = |(slab, tiling): (usize, &SlabTiling)| {
            let stored: Vec<u32> = tiling.stored_tiles().collect();
            let unpack = |tile| unpack(&container.tile(slab, tile)?, tiling, slab, tile);
            stored.into_par_iter().map(unpack).collect::<Result<Vec<_>, _>>()
        };
        let tiles = container.tilings().iter().enumerate().map(read_slab).collect::<Result<_, _>>()?;
        Self::from_tiles(container.geometry().clone(), container.tilings().to_vec(), tiles)
    }

    /// Reads and unpacks all tiles of a file, on all threads: as [`Self::read`], without the file in memory.
    ///
    /// # Errors
    /// As there, and if the file cannot be read.
    pub fn read_file<R: Read + Seek>(file: &mut FileReader<R>) -> Result<Self, PackError> {
        take_tiles(file)?;
        let (geometry, tilings) = (file.geometry().clone(), file.tilings().to_vec());
        let stored = tilings.iter().enumerate().flat_map(|(slab, t)| t.stored_tiles().map(move |tile| (slab, tile)));
        let stored: Vec<(usize, u32)> = stored.collect();
        let mut tiles = vec![Vec::new(); tilings.len()];
        let mut buffers = vec![Vec::new(); BATCH];
        for batch in stored.chunks(BATCH) {
            let mut found = Vec::new();
            for (&(slab, tile), buffer) in batch.iter().zip(&mut buffers) {
                found.push(file.tile(slab, tile, buffer)?);
            }
            let unpack = |(&(slab, tile), stored)| unpack(&stored, &tilings[slab], slab, tile);
            let raw = batch.par_iter().zip(found).map(unpack).collect::<Result<Vec<_>, _>>()?;
            batch.iter().zip(raw).for_each(|(&(slab, _), raw)| tiles[slab].push(raw));
        }
        Self::from_tiles(geometry, tilings, tiles)
    }

    /// Writes a file, BC1 tiles packed by the [tile codec](crate::tile) or by zstd, whichever is smaller, others by zstd, on all
    /// threads. A tile that does not shrink is stored as it is. The same light field gives the same bytes.
    ///
    /// # Errors
    /// See [`Writer`].
    pub fn write<'a, W: Write + Seek>(&'a self, writer: &mut Writer<W>) -> Result<(), PackError> {
        for (slab, tiling) in self.tilings().iter().enumerate() {
            let stored: Vec<(u32, &Vec<u8>)> = tiling.stored_tiles().zip(self.tiles(slab)).collect();
            for batch in stored.chunks(BATCH) {
                let pack = |&(tile, raw): &(u32, &'a Vec<u8>)| pack_tile(raw, tiling, tile);
                let packed = batch.par_iter().map(pack).collect::<Result<Vec<_>, _>>()?;
                for (packing, bytes) in packed {
                    writer.tile(packing, &bytes)?;
                }
            }
        }
        Ok(())
    }

    /// What a file of this light field holds beside its tiles.
    #[must_use]
    pub fn contents(&self, metadata: Metadata) -> Contents {
        Contents::new(self.geometry().clone(), self.tilings().to_vec(), metadata)
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// See [`Writer`].
    pub fn to_bytes(&self, metadata: Metadata) -> Result<Vec<u8>, PackError> {
        let mut writer = Writer::new(Cursor::new(Vec::new()), self.contents(metadata))?;
        self.write(&mut writer)?;
        Ok(writer.finish()?.into_inner())
    }

    /// Writes a file in one step and returns its length: see [`AtomicFile`](lf_format::AtomicFile).
    ///
    /// # Errors
    /// See [`Writer`].
    pub fn save(&self, path: &Path, metadata: Metadata) -> Result<u64, PackError> {
        let mut writer = Writer::create(path, self.contents(metadata))?;
        self.write(&mut writer)?;
        Ok(writer.save()?)
    }
}

/// Makes sure that all raw tiles may be held at once.
fn take_tiles(file: &Structure) -> Result<(), FormatError> {
    let raw = |tiling: &SlabTiling| tiling.stored_tiles().map(|tile| tiling.raw_len(tile)).fold(0, u64::saturating_add);
    let bytes = file.tilings().iter().map(raw).fold(0, u64::saturating_add);
    file.budget().take("the unpacked light field", bytes)
}

/// Packs a raw tile as it is stored in files: by the [tile codec](crate::tile) or by zstd, whichever is smaller, or not at all
/// if neither shrinks it. Surroundings that repeat themselves to the bit, as rendered tiles and bricks do, are better matched
/// than predicted.
///
/// # Errors
/// If zstd or the tile codec fails, for lack of memory say.
pub fn pack_tile<'a>(raw: &'a [u8], tiling: &SlabTiling, tile: u32) -> Result<(Packing, Cow<'a, [u8]>), PackError> {
    let (packing, packed) = smallest(raw, tiling, tile)?;
    Ok(if packed.len() < raw.len() { (packing, packed.into()) } else { (Packing::None, raw.into()) })
}

fn smallest(raw: &[u8], tiling: &SlabTiling, tile: u32) -> Result<(Packing, Vec<u8>), PackError> {
    let matched = |level| zstd_tile::pack(raw, level).map_err(PackError::Zstd);
    let quick = matched(zstd_tile::LEVEL)?;
    if tiling.encoding() != TexelEncoding::Bc1 {
        return Ok((Packing::Zstd, quick));
    }
    // Tiles that are too large for the codec are left to zstd.
    if let Ok(shape) = tile_shape(tiling, tile) {
        let predicted = tile::encode(&shape, raw, tile::LEVEL)?;
        if predicted.len() <= quick.len() {
            return Ok((Packing::Tile, predicted));
        }
    }
    Ok((Packing::Zstd, matched(zstd_tile::HIGH_LEVEL)?))
}

fn unpack(stored: &StoredTile<'_>, tiling: &SlabTiling, slab: usize, tile: u32) -> Result<Vec<u8>, PackError> {
    let len = usize::try_from(stored.raw_len).unwrap_or(usize::MAX);
    if stored.packing == Packing::None {
        return Ok(stored.bytes.to_vec());
    }
    let mut raw = vec![0; len];
    unpack_into(stored, tiling, slab, tile, &mut raw)?;
    Ok(raw)
}

/// Unpacks a tile of the file that `tiling` is of into a buffer of exactly [`SlabTiling::raw_len`] bytes.
///
/// # Errors
/// [`PackError::BufferLength`] for a buffer of another length; [`PackError::Tile`] if the bytes do not hold such a tile, in
/// which case the buffer's contents are of no use.
pub fn unpack_into(
    stored: &StoredTile<'_>,
    tiling: &SlabTiling,
    slab: usize,
    tile: u32,
    out: &mut [u8],
) -> Result<(), PackError> {
    check_buffer(tiling.raw_len(tile), out.len())?;
    let damaged = |rule, what: String| PackError::Tile { slab, tile, rule, what };
    match stored.packing {
        Packing::None if stored.bytes.len() == out.len() => {
            out.copy_from_slice(stored.bytes);
            Ok(())
        }
        Packing::Zstd => zstd_tile::unpack_into(stored.bytes, out).map_err(|what| damaged(Rule::Frame, what)),
        Packing::Tile => {
            tile::decode_into(&tile_shape(tiling, tile)?, stored.bytes, out).map_err(|error| match error {
                TileError::Frame(what) => damaged(Rule::Frame, what),
                other => damaged(Rule::TileCodec, format!("does not unpack: {other}")),
            })
        }
        other => Err(damaged(Rule::Packing, format!("is not packed by {other:?}"))),
    }
}

/// Decodes a raw tile of 8-bit texels into the texels of its picture, row after row, opaque.
///
/// # Errors
/// [`PackError::BufferLength`] if `raw` is not [`SlabTiling::raw_len`] bytes long, or `out` not as many texels as the
/// [picture](SlabTiling::tile_size) has; [`PackError::Encoding`] for other texels.
pub fn decode_into(raw: &[u8], tiling: &SlabTiling, tile: u32, out: &mut [[u8; 4]]) -> Result<(), PackError> {
    let [width, height] = tiling.tile_size(tile);
    check_buffer(tiling.raw_len(tile), raw.len())?;
    check_buffer(u64::from(width) * u64::from(height), out.len())?;
    match tiling.encoding() {
        TexelEncoding::Bc1 => Ok(bc1::decode_image_into(width, height, raw, out, width as usize)?),
        TexelEncoding::Rgba8 => {
            for (texel, &[r, g, b, _]) in out.iter_mut().zip(raw.as_chunks().0) {
                *texel = [r, g, b, 255];
            }
            Ok(())
        }
        other => Err(PackError::Encoding(other)),
    }
}

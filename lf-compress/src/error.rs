//! Why a light field could not be packed or unpacked.

use lf_format::{FormatError, Rule, TexelEncoding};
use lf_math::GeometryError;
use thiserror::Error;

use crate::bc1::Bc1Error;
use crate::tile::TileError;
use crate::volume::VolumeTooLarge;

/// Why a light field could not be packed or unpacked.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PackError {
    /// The container refused it.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The block codec refused it.
    #[error(transparent)]
    Bc1(#[from] Bc1Error),
    /// A shape does not fit.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The volume texture would be too large.
    #[error(transparent)]
    Volume(#[from] VolumeTooLarge),
    /// A tile's bytes do not hold what the file says they do.
    #[error("damaged .lfslab file: tile {tile} of slab {slab} {what} (spec {})", rule.clause())]
    Tile {
        /// Position of the slab in the file.
        slab: usize,
        /// The tile's number in the slab.
        tile: u32,
        /// The rule of the file format that is broken.
        rule: Rule,
        /// What is wrong, as the rest of a sentence.
        what: String,
    },
    /// This crate has no codec for an encoding, or not for texels of the kind asked for.
    #[error("{0:?} texels cannot be had in this form")]
    Encoding(TexelEncoding),
    /// A half-float texel is infinite or not a number.
    #[error("a texel is not finite")]
    NotFinite,
    /// The decoded texels would need more memory than allowed.
    #[error("the decoded light field takes {bytes} bytes, more than the {limit} allowed")]
    TooLarge {
        /// Bytes of the decoded texels.
        bytes: u64,
        /// The limit given.
        limit: u64,
    },
    /// A buffer has another length than the tile.
    #[error("the tile has {expected} bytes or texels, the buffer has room for {found}")]
    BufferLength {
        /// What the tile has.
        expected: usize,
        /// What was given.
        found: usize,
    },
    /// zstd failed to pack a tile.
    #[error("zstd could not pack a tile: {0}")]
    Zstd(std::io::Error),
    /// The tile codec refused a tile.
    #[error(transparent)]
    TileCodec(#[from] TileError),
    /// The texels given are not those of the geometry.
    #[error("the light field has {slabs} slabs but texels for {texels}")]
    SlabCount {
        /// Slabs in the geometry.
        slabs: usize,
        /// Slabs with texels.
        texels: usize,
    },
}

pub(crate) fn check_buffer(expected: u64, found: usize) -> Result<(), PackError> {
    if expected == found as u64 {
        return Ok(());
    }
    Err(PackError::BufferLength { expected: usize::try_from(expected).unwrap_or(usize::MAX), found })
}

//! The tile codec: lossless packing of BC1 blocks of a grid of camera images, and blocks that pack better.
//!
//! Neighbouring cameras of a slab see nearly the same, so their blocks at the same position resemble each other, but
//! they are seldom equal: a texel on an edge moves to the next palette entry, or the endpoints shift by a level. A byte
//! matcher such as zstd's finds only what is equal. This codec names for each block a neighbour, in the manner of the
//! prediction modes of video codecs, and stores the differences:
//!
//! * endpoints are those of one of six neighbours, or a step of a few levels away from the camera above or to the left;
//! * indices are predicted from the camera above or to the left, whose colours are looked up in the block's own palette
//!   (`block.rs`), and corrected row by row;
//! * a byte for each block says which, in one of four streams by how much the neighbours had to be corrected.
//!
//! The streams lie in one zstd frame, which by then finds few matches and is a fast Huffman coder. `spec/codecs.md`
//! describes the bytes. A tile of 8×8 cameras of 128×128 texels has 1.16 bits a texel where zstd on the same blocks, in
//! the same order, needs 1.66, and decodes at about four fifths of zstd's speed. Random access is by tile.
//!
//! [`optimise`] goes further: it trades error for bits, in blocks that any BC1 decoder reads.

mod block;
mod choice;
mod cost;
mod decode;
mod encode;
mod fit;
mod grid;
mod rdo;
mod streams;
mod transfer;

pub use decode::decode;
pub use encode::encode;
pub use rdo::{RdoOptions, optimise};

use std::io;

use block::RawBlock;
use thiserror::Error;

use crate::bc1::BLOCK_BYTES;

/// The level of zstd that tiles are packed at in files: above it time grows, but nothing shrinks.
pub const LEVEL: i32 = 19;

/// How many cameras a tile holds, and how many blocks each camera's image has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TileShape {
    cameras: [u32; 2],
    blocks: [u32; 2],
}

/// Blocks in a tile at most: its streams are then shorter than 2³² bytes.
const MAX_BLOCKS: u64 = 1 << 28;

impl TileShape {
    /// A tile of `cameras` images along (s, t), each of `blocks` 4×4 blocks along (u, v), all at least 1. The image of
    /// camera (s, t) is at column s and row t of the tile's picture.
    ///
    /// # Errors
    /// [`TileError::Shape`] if a number is 0 or there are more than 2²⁸ blocks, 2 GiB.
    pub fn new(cameras: [u32; 2], blocks: [u32; 2]) -> Result<Self, TileError> {
        let all = [cameras, blocks].concat().into_iter().fold(1, |product: u64, n| product.saturating_mul(n.into()));
        if all == 0 || all > MAX_BLOCKS {
            return Err(TileError::Shape { cameras, blocks });
        }
        Ok(Self { cameras, blocks })
    }

    /// Cameras along s and t.
    #[must_use]
    pub fn cameras(&self) -> [u32; 2] {
        self.cameras
    }

    /// Blocks of one image along u and v.
    #[must_use]
    pub fn blocks(&self) -> [u32; 2] {
        self.blocks
    }

    /// Bytes of the tile's blocks: 8 for each.
    #[must_use]
    pub fn raw_len(&self) -> usize {
        BLOCK_BYTES * self.block_count()
    }

    fn block_count(&self) -> usize {
        [self.cameras, self.blocks].concat().into_iter().map(|n| n as usize).product()
    }

    /// The blocks in `bytes`, if there are as many as there should be.
    fn check<'a>(&self, bytes: &'a [u8]) -> Result<&'a [RawBlock], TileError> {
        match bytes.as_chunks() {
            (blocks, []) if blocks.len() == self.block_count() => Ok(blocks),
            _ => Err(TileError::BlockBytes { expected: self.raw_len(), found: bytes.len() }),
        }
    }
}

/// Why a tile could not be packed or unpacked.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TileError {
    /// No tile has this shape.
    #[error("a tile of {cameras:?} cameras with {blocks:?} blocks is empty or holds more than 2^28 blocks")]
    Shape {
        /// Cameras along s and t.
        cameras: [u32; 2],
        /// Blocks of one image along u and v.
        blocks: [u32; 2],
    },
    /// The blocks do not fill the tile.
    #[error("the tile has {expected} bytes of blocks, {found} were given")]
    BlockBytes {
        /// [`TileShape::raw_len`].
        expected: usize,
        /// Bytes given.
        found: usize,
    },
    /// The texels do not fill the tile.
    #[error("the tile has {expected} texels, {found} were given")]
    TexelCount {
        /// 16 for each block.
        expected: usize,
        /// Texels given.
        found: usize,
    },
    /// The packed tile is not the zstd frame that it should be.
    #[error("the tile {0}")]
    Frame(String),
    /// The frame does not hold the streams of such a tile.
    #[error("the tile is damaged: {0}")]
    Malformed(&'static str),
    /// zstd failed to pack the streams.
    #[error("zstd could not pack a tile: {0}")]
    Zstd(io::Error),
}

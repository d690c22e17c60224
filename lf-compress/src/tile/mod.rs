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
//! Images may be whole or cropped: a tile holds a window of each camera's image ([`TileShape::windowed`]), and the
//! neighbours of a block are the nearest cameras whose windows hold its position.
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
mod shape;
mod streams;
mod transfer;

pub use decode::{decode, decode_into};
pub use encode::encode;
pub use rdo::{RdoOptions, optimise};
pub use shape::TileShape;

use std::io;

use thiserror::Error;

/// The level of zstd that tiles are packed at in files: above it time grows, but nothing shrinks.
pub const LEVEL: i32 = 19;

/// Why a tile could not be packed or unpacked.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TileError {
    /// No tile has this shape.
    #[error(
        "a tile of {0}×{1} cameras whose picture has {2}×{3} blocks is empty or too large: there may be 65536 columns \
         and rows of cameras, and 2^28 blocks",
        cameras[0], cameras[1], blocks[0], blocks[1]
    )]
    Shape {
        /// Columns and rows of cameras.
        cameras: [u64; 2],
        /// Blocks of the picture along u and v.
        blocks: [u64; 2],
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

//! Which blocks of which cameras a tile holds.

use std::ops::Range;

use super::TileError;
use super::block::RawBlock;
use crate::bc1::BLOCK_BYTES;

/// Blocks in a tile at most: its streams are then shorter than 2³² bytes.
const MAX_BLOCKS: u64 = 1 << 28;
/// Columns and rows of cameras at most, as in a file: those with empty windows take memory, but count for no block.
const MAX_CAMERAS: u64 = 1 << 16;

/// The cameras of a tile, and the blocks that it holds of each camera's image.
///
/// Each column of cameras has a window of block columns, each row a window of block rows; of a camera's image the tile
/// holds what lies in both. The windows of one axis need not overlap, nor follow any order, and may be empty. In the
/// tile's picture the windows stand side by side, without gaps, in the order of the cameras (spec §7.2).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TileShape {
    /// Those of the columns along u, those of the rows along v.
    windows: [Vec<Range<u32>>; 2],
    picture_blocks: [u32; 2],
}

impl TileShape {
    /// A tile of `cameras` whole images along (s, t), each of `blocks` 4×4 blocks along (u, v), all at least 1. The image
    /// of camera (s, t) is at column s and row t of the tile's picture.
    ///
    /// # Errors
    /// [`TileError::Shape`] if a number is 0, or there are more than 2²⁸ blocks, 2 GiB, or more than 65,536 columns or
    /// rows of cameras.
    pub fn new(cameras: [u32; 2], blocks: [u32; 2]) -> Result<Self, TileError> {
        let [cameras_wide, blocks_wide] = [cameras, blocks].map(|pair| pair.map(u64::from));
        let picture_blocks = check(cameras_wide, [0, 1].map(|i| cameras_wide[i] * blocks_wide[i]))?;
        let windows = [0, 1].map(|i| vec![0..blocks[i]; cameras[i] as usize]);
        Ok(Self { windows, picture_blocks })
    }

    /// A tile with a column of cameras for each of `columns`, its window along u, and a row of cameras for each of `rows`,
    /// its window along v. Windows are counted in blocks from the first of the whole image. A window that ends before it
    /// begins is empty.
    ///
    /// # Errors
    /// [`TileError::Shape`] if no block is in any window, or there are more than 2²⁸ blocks, 2 GiB, or more than 65,536
    /// columns or rows of cameras.
    pub fn windowed(columns: &[Range<u32>], rows: &[Range<u32>]) -> Result<Self, TileError> {
        let axes = [columns, rows];
        let picture_blocks = check(axes.map(|windows| windows.len() as u64), axes.map(length))?;
        Ok(Self { windows: axes.map(<[_]>::to_vec), picture_blocks })
    }

    /// Columns and rows of cameras, those with empty windows too.
    #[must_use]
    pub fn cameras(&self) -> [u32; 2] {
        self.windows.each_ref().map(|windows| windows.len() as u32)
    }

    /// Blocks along u and v from the first to the last that is in any window: those of one image where images are whole.
    #[must_use]
    pub fn blocks(&self) -> [u32; 2] {
        self.windows.each_ref().map(|windows| {
            let stored = || windows.iter().filter(|window| !window.is_empty());
            let (start, end) = (stored().map(|window| window.start).min(), stored().map(|window| window.end).max());
            end.unwrap_or(0) - start.unwrap_or(0)
        })
    }

    /// Blocks of the tile's picture along u and v: all windows side by side.
    #[must_use]
    pub fn picture_blocks(&self) -> [u32; 2] {
        self.picture_blocks
    }

    /// Bytes of the tile's blocks: 8 for each.
    #[must_use]
    pub fn raw_len(&self) -> usize {
        BLOCK_BYTES * self.block_count()
    }

    pub(super) fn block_count(&self) -> usize {
        self.picture_blocks.map(|blocks| blocks as usize).into_iter().product()
    }

    /// Those of the columns along u, those of the rows along v.
    pub(super) fn windows(&self) -> &[Vec<Range<u32>>; 2] {
        &self.windows
    }

    /// The blocks in `bytes`, if there are as many as there should be.
    pub(super) fn check<'a>(&self, bytes: &'a [u8]) -> Result<&'a [RawBlock], TileError> {
        match bytes.as_chunks() {
            (blocks, []) if blocks.len() == self.block_count() => Ok(blocks),
            _ => Err(TileError::BlockBytes { expected: self.raw_len(), found: bytes.len() }),
        }
    }
}

/// Blocks in all windows of an axis.
fn length(windows: &[Range<u32>]) -> u64 {
    let lengths = windows.iter().map(|window| u64::from(window.end.saturating_sub(window.start)));
    lengths.fold(0, u64::saturating_add)
}

/// The blocks of a picture along u and v, if there may be as many.
fn check(cameras: [u64; 2], blocks: [u64; 2]) -> Result<[u32; 2], TileError> {
    let all = blocks[0].saturating_mul(blocks[1]);
    if all == 0 || all > MAX_BLOCKS || cameras.into_iter().any(|count| count > MAX_CAMERAS) {
        return Err(TileError::Shape { cameras, blocks });
    }
    Ok(blocks.map(|count| count as u32))
}

//! The order in which blocks are coded, and the neighbours of each.
//!
//! Positions within a camera's image go row by row; at each position the blocks of all cameras follow each other, row
//! of cameras by row of cameras. The blocks at the current position lie in a small grid with a border, so that all
//! neighbours are found by fixed distances and stay in the first-level cache.

use super::TileShape;
use super::block::{Block, RawBlock};

/// Number of mode streams. A block's is the number of rows that were corrected in the camera above, but at most 3.
pub(super) const CONTEXTS: usize = 4;
/// The contexts before the first position.
const FIRST_CONTEXT: u8 = CONTEXTS as u8 - 1;

/// The blocks of all cameras at one position, with a border of blocks from earlier positions.
pub(super) struct Grid {
    cameras: [usize; 2],
    blocks: [usize; 2],
    /// Cameras in rows, with one more row above and one more column at either side.
    cells: Vec<Block>,
    /// The context of the next block to be coded in each column of cameras.
    contexts: Vec<u8>,
    /// Raster place of the block of camera (0, 0) at this position.
    here: usize,
    /// See [`Around`].
    back: [usize; 2],
}

/// What is known when a block is coded.
pub(super) struct Around<'a> {
    /// The blocks of the cameras above left, above and above right.
    pub(super) above: &'a [Block; 3],
    /// The block of the camera to the left.
    pub(super) left: Block,
    /// The mode stream.
    pub(super) context: usize,
    /// Raster place of the block.
    pub(super) place: usize,
    /// How far back the blocks before and above in the same image are; beyond the tile if they are not there.
    pub(super) back: [usize; 2],
}

impl Grid {
    pub(super) fn new(shape: &TileShape) -> Self {
        let [cameras, blocks] = [shape.cameras(), shape.blocks()].map(|pair| pair.map(|n| n as usize));
        let [across, down] = cameras;
        let cells = vec![Block::default(); (across + 2) * (down + 1)];
        let contexts = vec![FIRST_CONTEXT; across];
        Self { cameras, blocks, cells, contexts, here: 0, back: [usize::MAX; 2] }
    }

    /// How far apart in raster order the same blocks of neighbouring cameras are, along s and t.
    pub(super) fn camera_steps(shape: &TileShape) -> [usize; 2] {
        let grid = Self::new(shape);
        [grid.blocks[0], grid.camera_pitch()]
    }

    /// Visits every block in coding order: `visit` takes what is around it, may look at and write the tile, and returns
    /// the block and the number of its rows that are corrected.
    #[inline(always)]
    pub(super) fn walk(
        shape: &TileShape,
        tile: &mut [RawBlock],
        mut visit: impl FnMut(&Around<'_>, &mut [RawBlock]) -> (Block, u8),
    ) {
        let mut grid = Self::new(shape);
        let ([across, down], rows, stride, step) = (grid.blocks, grid.cameras[1], grid.stride(), grid.blocks[0]);
        for position in (0..down).flat_map(|y| (0..across).map(move |x| [x, y])) {
            grid.enter(position, tile);
            for t in 0..rows {
                let (mut place, back) = (grid.here + t * grid.camera_pitch(), grid.back);
                let (above, current) = grid.cells.split_at_mut((t + 1) * stride);
                let above = above[t * stride..].windows(3).filter_map(<[Block]>::first_chunk);
                let mut left = current[0];
                for ((above, cell), context) in above.zip(&mut current[1..]).zip(&mut grid.contexts) {
                    let around = Around { above, left, context: usize::from(*context), place, back };
                    let (block, rows) = visit(&around, tile);
                    (*context, *cell, left) = (rows.min(FIRST_CONTEXT), block, block);
                    place += step;
                }
            }
        }
    }

    fn stride(&self) -> usize {
        self.cameras[0] + 2
    }

    /// Blocks in one row of the tile.
    fn pitch(&self) -> usize {
        self.cameras[0] * self.blocks[0]
    }

    /// Raster distance between the blocks of cameras that are neighbours along t.
    fn camera_pitch(&self) -> usize {
        self.pitch() * self.blocks[1]
    }

    /// Moves on to a position: the border of the grid takes blocks of earlier positions from the tile.
    fn enter(&mut self, [x, y]: [usize; 2], tile: &[RawBlock]) {
        self.here = y * self.pitch() + x;
        self.back = match (x, y) {
            (0, 0) => [usize::MAX; 2],
            (0, _) => [self.pitch(); 2],
            (_, 0) => [1; 2],
            _ => [1, self.pitch()],
        };
        let ([across, down], stride, [west, north]) = (self.cameras, self.stride(), self.back);
        let last = (across - 1) * self.blocks[0];
        for s in 0..across {
            self.cells[s + 1] = earlier(tile, self.here + s * self.blocks[0], north);
        }
        for t in 0..down {
            let (row, place) = ((t + 1) * stride, self.here + t * self.camera_pitch());
            self.cells[row] = earlier(tile, place, west);
            self.cells[row + stride - 1] = earlier(tile, place + last, west);
        }
        self.cells[0] = self.cells[stride];
        self.cells[stride - 1] = self.cells[2 * stride - 1];
    }
}

/// The block `back` places before `place`, all zero where there is none.
#[inline(always)]
pub(super) fn earlier(tile: &[RawBlock], place: usize, back: usize) -> Block {
    tile.get(place.wrapping_sub(back)).filter(|_| back <= place).map_or(Block::default(), |&raw| Block::from_raw(raw))
}

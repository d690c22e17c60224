//! Choosing how each block is coded, by the statistics of the tile itself.

use super::block::{Block, RawBlock};
use super::choice::{Choice, Prediction, cheapest};
use super::cost::{Costs, Counts};
use super::grid;
use super::streams::Streams;
use super::{TileError, TileShape};

/// Passes over the tile that only gather statistics. A third changes the size by less than a thousandth.
const PASSES: usize = 2;

/// Packs the blocks of a tile, given in raster order, into one zstd frame (see the [module's text](super)).
///
/// `level` is zstd's, 1 to 22; below 16 its matches often cost more than they save, and up to 19 nothing is slow, as
/// little is left for it to do. The same blocks give the same bytes on every machine.
///
/// # Errors
/// [`TileError::BlockBytes`] unless `blocks` holds [`TileShape::raw_len`] bytes, [`TileError::Zstd`] if zstd fails, for
/// lack of memory say.
pub fn encode(shape: &TileShape, blocks: &[u8], level: i32) -> Result<Vec<u8>, TileError> {
    let tile = &mut shape.check(blocks)?.to_vec();
    let mut costs = Costs::guess();
    for _ in 0..PASSES {
        let mut counts = Counts::new();
        walk(shape, tile, &costs, |context, choice, _| counts.add(context, choice));
        costs = Costs::new(&counts);
    }
    let mut streams = Streams::default();
    walk(shape, tile, &costs, |context, choice, block| streams.push(context, choice, block));
    streams.to_frame(level).map_err(TileError::Zstd)
}

/// Hands every block to `sink` with its context and the cheapest way to code it.
pub(super) fn walk(
    shape: &TileShape,
    tile: &mut [RawBlock],
    costs: &Costs,
    mut sink: impl FnMut(usize, &Choice, Block),
) {
    grid::walk(shape, tile, |around, tile| {
        let block = Block::from_raw(tile[around.place]);
        let choice = cheapest(block, &Prediction::new(around, tile), costs);
        sink(around.context, &choice, block);
        (block, choice.row_count())
    });
}

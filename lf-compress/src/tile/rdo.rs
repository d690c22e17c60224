//! Trading error for bits: blocks that cost the tile codec less, and look nearly as good.

use super::block::{Block, RawBlock, split, transfer};
use super::choice::{Choice, Ends, Prediction, SOURCES, cheapest, mode, ways};
use super::cost::{Costs, Counts};
use super::encode::walk;
use super::fit::{Errors, Target};
use super::grid::Grid;
use super::{TileError, TileShape};
use crate::bc1::Texel;

/// Passes over the tile. A second would know what the first made of the blocks to come, and its statistics: it gains 1 to
/// 2 % in size for twice the time.
const PASSES: usize = 1;

/// More than the error of any opaque block, 48·255².
const MAX_ERROR: f32 = 4e6;

/// How much error a saved bit may cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RdoOptions {
    /// Squared error, summed over R, G and B of a block's 16 texels, that one bit of the packed tile is worth. 0 changes
    /// nothing; 10 is hard to see, 100 is rough. Values that are not above 0 count as 0.
    pub lambda: f32,
    /// By how much the squared error of any one block may grow, in the same unit; below 0 counts as 0.
    pub max_loss: f32,
}

impl Default for RdoOptions {
    /// No change.
    fn default() -> Self {
        Self { lambda: 0.0, max_loss: f32::INFINITY }
    }
}

/// Replaces blocks of a tile by such as pack into fewer bytes with [`encode`](super::encode).
///
/// For each block in coding order this minimises D + λ·R: D is the squared error against `texels`, as a BC1 decoder
/// shows it; R is the entropy of the block's symbols by the statistics of the tile. Tried are the endpoints of all
/// neighbours, also of those still to come, and those that suit the indices best within a step (Lloyd's iteration with
/// the cost of the step added); with each, every row of indices takes the best of its 256 values, for its price. Opaque blocks stay opaque, and three-colour blocks come only where
/// there were some. The same input gives the same blocks on every machine.
///
/// `texels` is the tile's picture in raster order, 16 for each block; alpha is ignored, but that blocks whose texels are
/// all transparent, as are those of cameras that are not there, stay as they are.
///
/// # Errors
/// [`TileError::TexelCount`] and [`TileError::BlockBytes`] if texels or blocks do not fill the tile.
pub fn optimise(shape: &TileShape, texels: &[Texel], blocks: &mut [u8], options: &RdoOptions) -> Result<(), TileError> {
    let mut tile = shape.check(blocks)?.to_vec();
    if texels.len() != 16 * tile.len() {
        return Err(TileError::TexelCount { expected: 16 * tile.len(), found: texels.len() });
    }
    if options.lambda > 0.0 {
        let picture = Picture { texels, width: 4 * (shape.cameras()[0] * shape.blocks()[0]) as usize };
        let originals = tile.clone();
        let mut counts = Counts::new();
        walk(shape, &mut tile, &Costs::guess(), |context, choice, _| counts.add(context, choice));
        for _ in 0..PASSES {
            let costs = Costs::new(&counts).scaled(options.lambda);
            counts = pass(shape, &picture, &originals, &mut tile, &costs, options.max_loss);
        }
        blocks.copy_from_slice(tile.as_flattened());
    }
    Ok(())
}

/// One pass over the tile; returns the statistics of its choices.
fn pass(
    shape: &TileShape,
    picture: &Picture<'_>,
    originals: &[RawBlock],
    tile: &mut [RawBlock],
    costs: &Costs,
    max_loss: f32,
) -> Counts {
    let mut counts = Counts::new();
    let next_cameras = Grid::camera_steps(shape);
    Grid::walk(shape, tile, |around, tile| {
        let place = around.place;
        let prediction = Prediction::new(around, tile);
        let original = Block::from_raw(originals[place]);
        let texels = picture.block(place);
        let (block, choice) = if texels.iter().all(|texel| texel[3] == 0) {
            (original, cheapest(original, &prediction, costs))
        } else {
            let mut search = Search::new(&texels, original, max_loss, &prediction, costs);
            let later = next_cameras.map(|step| tile.get(place + step));
            let ends = later.into_iter().flatten().chain([&tile[place]]).map(|&raw| Block::from_raw(raw).ends);
            search.run(ends)
        };
        counts.add(around.context, &choice);
        tile[place] = block.to_raw();
        (block, choice.row_count())
    });
    counts
}

/// The texels of a tile.
struct Picture<'a> {
    texels: &'a [Texel],
    width: usize,
}

impl Picture<'_> {
    fn block(&self, place: usize) -> [Texel; 16] {
        let across = self.width / 4;
        let corner = place / across * 4 * self.width + place % across * 4;
        std::array::from_fn(|i| self.texels[corner + i / 4 * self.width + i % 4])
    }
}

/// The search for the best block at one place.
struct Search<'a> {
    target: Target,
    /// Largest squared error allowed.
    limit: f32,
    prediction: &'a Prediction,
    costs: &'a Costs,
    /// Least D + λ·R so far, and what has it.
    least: f32,
    best: (Block, Choice),
    tried: Vec<u32>,
}

/// The four rows of a correction with their costs, if the row is zero and at best if it is not.
struct Rows {
    zero: [f32; 4],
    best: [(f32, u8); 4],
}

impl<'a> Search<'a> {
    fn new(texels: &[Texel; 16], original: Block, max_loss: f32, prediction: &'a Prediction, costs: &'a Costs) -> Self {
        let target = Target::new(texels);
        let error = target.errors(original.ends).of(original.indices);
        let choice = cheapest(original, prediction, costs);
        let least = error + choice.cost(prediction.context, costs);
        let best = (original, choice);
        let limit = (error + max_loss.max(0.0)).min(MAX_ERROR);
        Self { target, limit, prediction, costs, least, best, tried: Vec::with_capacity(16) }
    }

    fn run(&mut self, others: impl Iterator<Item = u32>) -> (Block, Choice) {
        self.attempt(self.best.0.ends);
        for ends in self.prediction.ends.into_iter().chain(others) {
            self.attempt(ends);
        }
        self.refine(self.best.0.indices);
        for source in self.prediction.sources {
            self.refine(transfer(self.best.0.ends, source));
        }
        self.best
    }

    /// Tries the endpoints that suit given indices.
    fn refine(&mut self, indices: u32) {
        let normal = self.target.normal(indices);
        let solution = normal.solve();
        let start = |source: Block| solution.unwrap_or(source.ends);
        let near = self.prediction.sources.map(|source| normal.descend(source.ends, start(source), self.costs));
        for ends in solution.into_iter().chain(near) {
            // In the other order the palette has three colours, which the indices do not mean.
            let [color0, color1] = split(ends);
            if color0 >= color1 {
                self.attempt(ends);
            }
        }
    }

    /// Tries all ways to code a block with these endpoints.
    fn attempt(&mut self, ends: u32) {
        if self.tried.contains(&ends) {
            return;
        }
        self.tried.push(ends);
        let errors = self.target.errors(ends);
        let least_error = errors.least();
        let ways: Vec<Ends> = ways(ends, self.prediction, self.costs).collect();
        let least_cost = ways.iter().map(|way| way.cost).fold(f32::INFINITY, f32::min);
        if least_error + least_cost + self.costs.least_mode(self.prediction.context) >= self.least
            || least_error > self.limit
        {
            return;
        }
        for source in 0..SOURCES {
            let predicted = transfer(ends, self.prediction.sources[source]);
            let rows = Rows::new(&errors, predicted, self.costs);
            for way in &ways {
                self.weigh(ends, &errors, *way, source, predicted, &rows);
            }
        }
    }

    /// Finds the best set of rows to correct.
    fn weigh(&mut self, ends: u32, errors: &Errors, way: Ends, source: usize, predicted: u32, rows: &Rows) {
        for set in 0..16 {
            let mode = mode(way.kind, source, set);
            let row = |i: usize| if set >> i & 1 == 0 { rows.zero[i] } else { rows.best[i].0 };
            let cost = row(0) + row(1) + row(2) + row(3) + way.cost + self.costs.mode(self.prediction.context, mode);
            if cost < self.least {
                let byte = |i: usize| if set >> i & 1 == 0 { 0 } else { rows.best[i].1 };
                let correction = u32::from_le_bytes(std::array::from_fn(byte));
                let indices = predicted ^ correction;
                if errors.of(indices) <= self.limit {
                    self.least = cost;
                    self.best = (Block { ends, indices }, Choice { mode, ends: way, correction });
                }
            }
        }
    }
}

impl Rows {
    fn new(errors: &Errors, predicted: u32, costs: &Costs) -> Self {
        let mut rows = Self { zero: [0.0; 4], best: [(0.0, 0); 4] };
        for (row, byte) in predicted.to_le_bytes().into_iter().enumerate() {
            let [first, last] = errors.pairs(row);
            rows.zero[row] = first[usize::from(byte & 15)] + last[usize::from(byte >> 4)];
            // Where even a perfect correction at the least price would not pay, none is looked for.
            let floor =
                first.into_iter().fold(f32::INFINITY, f32::min) + last.into_iter().fold(f32::INFINITY, f32::min);
            rows.best[row] = if floor + costs.least_row() < rows.zero[row] {
                best_correction(&permuted(&first, byte & 15), &permuted(&last, byte >> 4), costs.rows())
            } else {
                (f32::INFINITY, 0)
            };
        }
        rows
    }
}

/// Errors by what is changed in a pair of indices, from errors by pair.
fn permuted(errors: &[f32; 16], pair: u8) -> [f32; 16] {
    std::array::from_fn(|change| errors[change ^ usize::from(pair & 15)])
}

/// The cheapest row of corrections but zero, with its cost. Sixteen lanes at a time.
fn best_correction(first: &[f32; 16], last: &[f32; 16], costs: &[f32; 256]) -> (f32, u8) {
    let (mut least, mut high) = ([f32::INFINITY; 16], [0.0_f32; 16]);
    for (i, (costs, &last)) in costs.as_chunks::<16>().0.iter().zip(last).enumerate() {
        for lane in 0..16 {
            let cost = first[lane] + last + costs[lane];
            // A correction of zero is none.
            let better = cost < least[lane] && !(i == 0 && lane == 0);
            least[lane] = if better { cost } else { least[lane] };
            high[lane] = if better { i as f32 } else { high[lane] };
        }
    }
    let mut best = (f32::INFINITY, 0);
    for lane in 0..16 {
        if least[lane] < best.0 {
            best = (least[lane], high[lane] as u8 * 16 + lane as u8);
        }
    }
    best
}

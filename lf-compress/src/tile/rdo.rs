//! Trading error for bits: blocks that cost the tile codec less, and look nearly as good.

use super::block::{Block, RawBlock, split, transfer};
use super::choice::{Choice, Ends, Prediction, SOURCES, cheapest, mode, ways};
use super::cost::{Costs, Counts};
use super::encode::walk;
use super::fit::{Errors, Target, smaller};
use super::grid;
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
        let picture = Picture { texels, width: 4 * shape.picture_blocks()[0] as usize };
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
    grid::walk(shape, tile, |around, tile| {
        let place = around.place;
        let prediction = Prediction::new(around, tile);
        let original = Block::from_raw(originals[place]);
        let texels = picture.block(place);
        let (block, choice) = if texels.iter().all(|texel| texel[3] == 0) {
            (original, cheapest(original, &prediction, costs))
        } else {
            let [right, below] = around.next.map(|next| *tile.get(next).unwrap_or(&tile[place]));
            let others = [right, below, tile[place]].map(|raw| Block::from_raw(raw).ends);
            let search = Search::new(&texels, original, max_loss, &prediction, costs);
            search.run(others)
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

impl<'a> Search<'a> {
    fn new(texels: &[Texel; 16], original: Block, max_loss: f32, prediction: &'a Prediction, costs: &'a Costs) -> Self {
        let target = Target::new(texels);
        let error = target.errors(original.ends).of(original.indices);
        let choice = cheapest(original, prediction, costs);
        let least = error + choice.cost(prediction.context, costs);
        let best = (original, choice);
        let limit = (error + max_loss.max(0.0)).min(MAX_ERROR);
        Self { target, limit, prediction, costs, least, best, tried: Vec::with_capacity(32) }
    }

    fn run(mut self, others: [u32; 3]) -> (Block, Choice) {
        for ends in [self.best.0.ends].into_iter().chain(self.prediction.ends).chain(others) {
            self.attempt(ends);
        }
        let mut refined = [self.best.0.indices; 1 + SOURCES];
        self.refine(refined[0]);
        for (i, source) in self.prediction.sources.into_iter().enumerate() {
            let indices = transfer(self.best.0.ends, source);
            // What was refined before leads where it led.
            if !refined[..=i].contains(&indices) {
                self.refine(indices);
            }
            refined[i + 1] = indices;
        }
        self.best
    }

    /// Tries the endpoints that suit given indices.
    fn refine(&mut self, indices: u32) {
        for ends in self.candidates(indices).into_iter().flatten() {
            // In the other order the palette has three colours, which the indices do not mean.
            let [color0, color1] = split(ends);
            if color0 >= color1 {
                self.attempt(ends);
            }
        }
    }

    /// The endpoints that suit given indices best, and those that do so within a step of each source.
    fn candidates(&self, indices: u32) -> [Option<u32>; 1 + SOURCES] {
        let normal = self.target.normal(indices);
        let solution = normal.solve();
        let near = |source: Block| normal.descend(source.ends, solution.unwrap_or(source.ends), self.costs);
        let [up, left] = self.prediction.sources;
        [solution, Some(near(up)), Some(near(left))]
    }

    /// Tries all ways to code a block with these endpoints.
    fn attempt(&mut self, ends: u32) {
        if !self.tried.contains(&ends) {
            self.tried.push(ends);
            self.attempt_new(ends);
        }
    }

    /// Leaves as soon as a bound says that nothing better can be found.
    fn attempt_new(&mut self, ends: u32) {
        let errors = self.target.errors(ends);
        let least_error = errors.least();
        if least_error >= self.least || least_error > self.limit {
            return;
        }
        let ways = ways(ends, self.prediction, self.costs);
        for source in 0..SOURCES {
            let bound =
                |way: &Ends| way.cost + self.costs.least_mode(self.prediction.context, mode(way.kind, source, 0));
            let least_cost = ways.iter().map(bound).fold(f32::INFINITY, smaller);
            if least_error + least_cost >= self.least {
                continue;
            }
            let predicted = transfer(ends, self.prediction.sources[source]);
            if let Some(rows) = Rows::new(&errors, predicted, self.costs, self.least - least_cost) {
                for way in ways.iter() {
                    self.weigh(ends, &errors, *way, source, predicted, &rows);
                }
            }
        }
    }

    /// Finds the best set of rows to correct.
    #[inline(always)]
    fn weigh(&mut self, ends: u32, errors: &Errors, way: Ends, source: usize, predicted: u32, rows: &Rows) {
        let first = mode(way.kind, source, 0);
        if rows.least + way.cost + self.costs.least_mode(self.prediction.context, first) >= self.least {
            return;
        }
        for (set, mode_cost) in self.costs.modes(self.prediction.context, first).iter().enumerate() {
            let cost = rows.sets[set] + (way.cost + mode_cost);
            if cost < self.least {
                let byte = |i: usize| if set >> i & 1 == 0 { 0 } else { rows.best[i] };
                let correction = u32::from_le_bytes(std::array::from_fn(byte));
                let indices = predicted ^ correction;
                if errors.of(indices) <= self.limit {
                    self.least = cost;
                    self.best = (Block { ends, indices }, Choice { mode: first | set as u8, ends: way, correction });
                }
            }
        }
    }
}

/// The four rows of a correction.
struct Rows {
    /// What the rows cost, errors included, by the set of those that are corrected.
    sets: [f32; 16],
    /// The least of them.
    least: f32,
    /// The best correction of each row.
    best: [u8; 4],
}

impl Rows {
    /// `None` if all sets of rows cost at least `most`; those that do may be said to cost infinitely much.
    #[inline(always)]
    fn new(errors: &Errors, predicted: u32, costs: &Costs, most: f32) -> Option<Self> {
        let predicted = predicted.to_le_bytes();
        let mut cost = [[0.0, f32::INFINITY]; 4];
        // What each row costs at least: as predicted, or perfectly corrected at the least price.
        let mut floors = [0.0; 4];
        for row in 0..4 {
            cost[row][0] = errors.of_row(row, predicted[row]);
            floors[row] = smaller(cost[row][0], errors.least_of_row(row) + costs.least_row());
        }
        let mut best = [0; 4];
        for row in 0..4 {
            let total = (floors[0] + floors[1]) + (floors[2] + floors[3]);
            if total >= most {
                return None;
            }
            // Where even a perfect correction at the least price would not pay, none is looked for.
            if floors[row] < cost[row][0] {
                let room = most - (total - floors[row]);
                (cost[row][1], best[row]) = best_correction(errors, row, predicted[row], costs, room);
                floors[row] = smaller(cost[row][0], cost[row][1]);
            }
        }
        let (mut sets, mut least) = ([0.0; 16], f32::INFINITY);
        for (set, sum) in sets.iter_mut().enumerate() {
            let row = |i: usize| cost[i][set >> i & 1];
            *sum = (row(0) + row(1)) + (row(2) + row(3));
            least = smaller(least, *sum);
        }
        Some(Self { sets, least, best })
    }
}

/// The cheapest correction of a row, with its cost, if that is less than `most`. Sixteen lanes at a time.
#[inline(always)]
fn best_correction(errors: &Errors, row: usize, indices: u8, costs: &Costs, most: f32) -> (f32, u8) {
    let [first, last] = errors.changes(row, indices);
    let floor = first.into_iter().fold(f32::INFINITY, smaller);
    let (mut least, mut best) = (most, (f32::INFINITY, 0));
    for (high, last) in last.into_iter().enumerate() {
        if floor + last + costs.least_rows()[high] >= least {
            continue;
        }
        let mut sums = [0.0; 16];
        for lane in 0..16 {
            sums[lane] = first[lane] + last + costs.rows()[high][lane];
        }
        if sums.into_iter().fold(f32::INFINITY, smaller) < least {
            for (lane, sum) in sums.into_iter().enumerate() {
                if sum < least {
                    (least, best) = (sum, (sum, (16 * high + lane) as u8));
                }
            }
        }
    }
    best
}

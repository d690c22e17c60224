//! The ways to code one block, and the cheapest of them.

use super::block::{Block, ESCAPE, RawBlock, split, step, transfer};
use super::cost::Costs;
use super::grid::{Around, earlier};

/// How many neighbours' endpoints can be taken as they are.
pub(super) const COPIES: usize = 6;
/// How many neighbours' indices can be built on, and endpoints stepped from: the camera above and the one to the left.
pub(super) const SOURCES: usize = 2;

/// What a block is predicted from.
pub(super) struct Prediction {
    /// Endpoints of the cameras above, to the left, above right, above left, of the blocks before and above.
    pub(super) ends: [u32; COPIES],
    /// The blocks of the cameras above and to the left.
    pub(super) sources: [Block; SOURCES],
    /// The mode stream.
    pub(super) context: usize,
}

impl Prediction {
    pub(super) fn new(around: &Around<'_>, tile: &[RawBlock]) -> Self {
        let ([up_left, up, up_right], left) = (around.above, around.left);
        let [west, north] = around.back.map(|back| earlier(tile, around.place, back));
        let ends = [up, left, up_right, up_left, west, north].map(|block| block.ends);
        Self { ends, sources: [up, left], context: around.context }
    }
}

/// One way to say which endpoints a block has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ends {
    /// 0 to 5: those of a neighbour. 6 and 7: each a step from those of the camera above, to the left.
    pub(super) kind: u8,
    /// The two steps of the kinds 6 and 7.
    pub(super) steps: [u8; 2],
    /// Cost without the mode.
    pub(super) cost: f32,
}

impl Ends {
    pub(super) fn has_steps(self) -> bool {
        usize::from(self.kind) >= COPIES
    }
}

/// All ways to say `ends`, of which there are always two at least.
#[inline(always)]
pub(super) fn ways(ends: u32, around: &Prediction, costs: &Costs) -> Ways {
    let mut ways = Ways { list: [Ends { kind: 0, steps: [0; 2], cost: 0.0 }; COPIES + SOURCES], count: 0 };
    for (kind, theirs) in (0..).zip(around.ends) {
        if theirs == ends {
            ways.push(Ends { kind, steps: [0; 2], cost: 0.0 });
        }
    }
    for (kind, source) in (COPIES as u8..).zip(around.sources) {
        let ([from0, from1], [to0, to1]) = (split(source.ends), split(ends));
        let steps = [step(from0, to0).unwrap_or(ESCAPE), step(from1, to1).unwrap_or(ESCAPE)];
        ways.push(Ends { kind, steps, cost: costs.step(steps[0]) + costs.step(steps[1]) });
    }
    ways
}

/// Ways to say endpoints.
pub(super) struct Ways {
    list: [Ends; COPIES + SOURCES],
    count: usize,
}

impl Ways {
    #[inline(always)]
    fn push(&mut self, ends: Ends) {
        if let Some(place) = self.list.get_mut(self.count) {
            (*place, self.count) = (ends, self.count + 1);
        }
    }

    #[inline(always)]
    pub(super) fn iter(&self) -> impl Iterator<Item = &Ends> {
        self.list.iter().take(self.count)
    }
}

/// A block as it goes into the streams.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Choice {
    /// Bits 5 to 7 the kind of [`Ends`], bit 4 the source of the indices, bits 0 to 3 the rows that are corrected.
    pub(super) mode: u8,
    pub(super) ends: Ends,
    /// What turns the predicted indices into the true ones, by exclusive or.
    pub(super) correction: u32,
}

impl Choice {
    /// Cost of all symbols.
    pub(super) fn cost(&self, context: usize, costs: &Costs) -> f32 {
        let rows = self.correction.to_le_bytes().into_iter().filter(|&byte| byte != 0);
        costs.mode(context, self.mode) + self.ends.cost + rows.map(|byte| costs.row(byte)).sum::<f32>()
    }

    /// How many rows are corrected.
    pub(super) fn row_count(&self) -> u8 {
        (self.mode & 15).count_ones() as u8
    }
}

/// The mode byte.
pub(super) fn mode(kind: u8, source: usize, rows: usize) -> u8 {
    kind << 5 | (source as u8) << 4 | rows as u8
}

/// Which of the four rows of a correction are not zero, the first row in the lowest bit.
pub(super) fn rows_of(correction: u32) -> usize {
    let row = |(i, byte): (usize, u8)| usize::from(byte != 0) << i;
    correction.to_le_bytes().into_iter().enumerate().map(row).sum()
}

/// The cheapest way to code exactly this block.
pub(super) fn cheapest(block: Block, around: &Prediction, costs: &Costs) -> Choice {
    let corrections = around.sources.map(|source| transfer(block.ends, source) ^ block.indices);
    let mut best = Choice { mode: 0, ends: Ends { kind: 0, steps: [0; 2], cost: 0.0 }, correction: 0 };
    let mut least = f32::INFINITY;
    let ways = ways(block.ends, around, costs);
    for (source, correction) in corrections.into_iter().enumerate() {
        let (rows, bytes) = (rows_of(correction), correction.to_le_bytes());
        let row_cost: f32 = bytes.into_iter().filter(|&byte| byte != 0).map(|byte| costs.row(byte)).sum();
        for &ends in ways.iter() {
            let mode = mode(ends.kind, source, rows);
            let cost = ends.cost + row_cost + costs.mode(around.context, mode);
            if cost < least {
                (least, best) = (cost, Choice { mode, ends, correction });
            }
        }
    }
    best
}

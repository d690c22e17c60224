//! How well endpoints and indices show given texels, and which endpoints would show them better.

use super::block::{Block, STEP_SUM, join, split, step};
use super::cost::Costs;
use crate::bc1::{Texel, decode_block};

/// One value per texel of a block.
type Lanes = [f32; 16];

/// More than any error: the price of a transparent palette entry, which an opaque block must not use.
const FORBIDDEN: f32 = 1e9;

/// The texels of a block, channel by channel.
pub(super) struct Target {
    channels: [Lanes; 3],
}

/// Squared error of each texel with each of the four indices. All are integers below 2²⁴, so sums are exact.
pub(super) struct Errors([Lanes; 4]);

impl Target {
    pub(super) fn new(texels: &[Texel; 16]) -> Self {
        Self { channels: std::array::from_fn(|c| texels.map(|texel| f32::from(texel[c]))) }
    }

    /// The errors that a block with these endpoints would have.
    pub(super) fn errors(&self, ends: u32) -> Errors {
        // The first row shows the palette.
        let texels = decode_block(&Block { ends, indices: 0b11_10_01_00 }.to_raw());
        let mut errors = [[0.0; 16]; 4];
        for (lanes, entry) in errors.iter_mut().zip(&texels[..4]) {
            let floor = if entry[3] == 0 { FORBIDDEN } else { 0.0 };
            let [red, green, blue] = [0, 1, 2].map(|channel| f32::from(entry[channel]));
            let [reds, greens, blues] = &self.channels;
            for i in 0..16 {
                let difference = [reds[i] - red, greens[i] - green, blues[i] - blue];
                let [r, g, b] = difference.map(|d| d * d);
                lanes[i] = floor + (r + g + b);
            }
        }
        Errors(errors)
    }

    /// The normal equations of the endpoints for given indices.
    pub(super) fn normal(&self, indices: u32) -> Normal {
        // Thirds of color0 in the palette entries 0 to 3.
        let thirds: Lanes = std::array::from_fn(|i| [3.0, 0.0, 2.0, 1.0][(indices >> (2 * i) & 3) as usize]);
        let sum = |f: &dyn Fn(usize) -> f32| (0..16).map(f).sum::<f32>();
        let moments = [
            sum(&|i| thirds[i] * thirds[i]),
            sum(&|i| thirds[i] * (3.0 - thirds[i])),
            sum(&|i| (3.0 - thirds[i]) * (3.0 - thirds[i])),
        ];
        let sums = self
            .channels
            .each_ref()
            .map(|channel| [sum(&|i| thirds[i] * channel[i]), sum(&|i| (3.0 - thirds[i]) * channel[i])]);
        Normal { moments, sums }
    }
}

impl Errors {
    /// The error with the best indices.
    pub(super) fn least(&self) -> f32 {
        let [a, b, c, d] = &self.0;
        let smaller = |x: f32, y: f32| if y < x { y } else { x };
        (0..16).map(|i| smaller(smaller(a[i], b[i]), smaller(c[i], d[i]))).sum()
    }

    /// The error with these indices.
    pub(super) fn of(&self, indices: u32) -> f32 {
        (0..16).map(|i| self.0[(indices >> (2 * i) & 3) as usize][i]).sum()
    }

    /// For the first and the last two texels of a row, the error with each of 16 pairs of indices.
    pub(super) fn pairs(&self, row: usize) -> [[f32; 16]; 2] {
        [0, 2].map(|column| {
            let first = 4 * row + column;
            std::array::from_fn(|pair| self.0[pair & 3][first] + self.0[pair >> 2][first + 1])
        })
    }
}

/// Error as a function of the endpoints, for fixed indices: a quadratic form for each channel.
pub(super) struct Normal {
    /// Nine times the sums of w², w(1 − w) and (1 − w)², w being the share of color0.
    moments: [f32; 3],
    /// For each channel, three times the sums of w·x and (1 − w)·x.
    sums: [[f32; 2]; 3],
}

/// Levels of the channels of a 565 colour, and where each lies in its 16 bits.
const CHANNELS: [(u32, u16); 3] = [(11, 31), (5, 63), (0, 31)];

/// A level widened to 8 bits.
fn widened(level: u16, levels: u16) -> f32 {
    f32::from(if levels == 31 { level << 3 | level >> 2 } else { level << 2 | level >> 4 })
}

impl Normal {
    /// The least-squares endpoints, rounded to 565; `None` if the indices do not tell the endpoints apart.
    pub(super) fn solve(&self) -> Option<u32> {
        let [aa, ab, bb] = self.moments;
        let determinant = aa * bb - ab * ab;
        if determinant < 1.0 {
            return None;
        }
        let mut ends = [0; 2];
        for (&(shift, levels), [x, y]) in CHANNELS.iter().zip(self.sums) {
            let solution = [bb * x - ab * y, aa * y - ab * x].map(|numerator| 3.0 * numerator / determinant);
            for (end, value) in ends.iter_mut().zip(solution) {
                let level = (value * (f32::from(levels) / 255.0) + 0.5).clamp(0.0, f32::from(levels)) as u16;
                *end |= level << shift;
            }
        }
        Some(join(ends))
    }

    /// Improves `ends` one endpoint after the other, each among all steps from `source`, at the cost of the steps.
    pub(super) fn descend(&self, source: u32, ends: u32, costs: &Costs) -> u32 {
        let (from, mut ends) = (split(source), split(ends));
        for end in [0, 1, 0] {
            ends[end] = self.best_step(end, from[end], ends[1 - end], costs);
        }
        join(ends)
    }

    /// The best colour for one endpoint within a step of `from`, the other endpoint being `other`.
    fn best_step(&self, end: usize, from: u16, other: u16, costs: &Costs) -> u16 {
        let [reds, greens, blues] = [0, 1, 2].map(|channel| self.terms(channel, end, from, other));
        let (mut best, mut least) = (from, f32::INFINITY);
        for (pair, costs) in costs.steps().as_chunks::<5>().0[..45].iter().enumerate() {
            let others = reds[pair / 9] + greens[pair % 9];
            for (blue, cost) in costs.iter().enumerate() {
                let cost = others + blues[blue] + cost;
                if cost < least {
                    (least, best) = (cost, from.wrapping_add(STEP_SUM[5 * pair + blue]));
                }
            }
        }
        debug_assert!(least.is_infinite() || step(from, best).is_some());
        best
    }

    /// The part of the error that one channel of one endpoint decides, for the 5 or 9 levels around that of `from`.
    fn terms(&self, channel: usize, end: usize, from: u16, other: u16) -> [f32; 9] {
        let (shift, levels) = CHANNELS[channel];
        let (reach, level) = (if channel == 1 { 4 } else { 2 }, from >> shift & levels);
        let [aa, ab, bb] = self.moments;
        let square = if end == 0 { aa } else { bb };
        let linear = ab * widened(other >> shift & levels, levels) - 3.0 * self.sums[channel][end];
        std::array::from_fn(|i| match (level + i as u16).checked_sub(reach) {
            Some(level) if level <= levels => {
                let value = widened(level, levels);
                (square * value + 2.0 * linear) * value / 9.0
            }
            _ => FORBIDDEN,
        })
    }
}

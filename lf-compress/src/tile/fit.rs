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
pub(super) struct Errors {
    entries: [Lanes; 4],
    /// Each texel's error with its best index.
    least: Lanes,
}

impl Target {
    #[inline(always)]
    pub(super) fn new(texels: &[Texel; 16]) -> Self {
        Self { channels: std::array::from_fn(|c| texels.map(|texel| f32::from(texel[c]))) }
    }

    /// The errors that a block with these endpoints would have.
    #[inline(always)]
    pub(super) fn errors(&self, ends: u32) -> Errors {
        // The first row shows the palette.
        let texels = decode_block(&Block { ends, indices: 0b11_10_01_00 }.to_raw());
        let mut entries = [[0.0; 16]; 4];
        for (lanes, entry) in entries.iter_mut().zip(&texels) {
            let floor = if entry[3] == 0 { FORBIDDEN } else { 0.0 };
            let [red, green, blue] = [f32::from(entry[0]), f32::from(entry[1]), f32::from(entry[2])];
            let [reds, greens, blues] = &self.channels;
            for i in 0..16 {
                let (r, g, b) = (reds[i] - red, greens[i] - green, blues[i] - blue);
                lanes[i] = floor + (r * r + g * g + b * b);
            }
        }
        let [a, b, c, d] = &entries;
        let mut least = [0.0; 16];
        for i in 0..16 {
            least[i] = smaller(smaller(a[i], b[i]), smaller(c[i], d[i]));
        }
        Errors { entries, least }
    }

    /// The normal equations of the endpoints for given indices.
    #[inline(always)]
    pub(super) fn normal(&self, indices: u32) -> Normal {
        let (mut near, mut far) = ([0.0; 16], [0.0; 16]);
        for i in 0..16 {
            near[i] = THIRDS[(indices >> (2 * i) & 3) as usize];
            far[i] = 3.0 - near[i];
        }
        let moments = [product(&near, &near), product(&near, &far), product(&far, &far)];
        let [reds, greens, blues] = &self.channels;
        let sums = |channel: &Lanes| [product(&near, channel), product(&far, channel)];
        Normal { moments, sums: [sums(reds), sums(greens), sums(blues)] }
    }
}

/// `f32::min` for numbers, which is one instruction.
#[inline(always)]
pub(super) fn smaller(x: f32, y: f32) -> f32 {
    if y < x { y } else { x }
}

/// Sum of products of integers, exact in any order: four sums that need not wait for each other.
#[inline(always)]
fn product(a: &Lanes, b: &Lanes) -> f32 {
    let mut products = [0.0; 16];
    for i in 0..16 {
        products[i] = a[i] * b[i];
    }
    total(&products)
}

/// Sum of integers.
#[inline(always)]
fn total(lanes: &Lanes) -> f32 {
    let mut sums = [0.0; 4];
    for i in 0..16 {
        sums[i % 4] += lanes[i];
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

impl Errors {
    /// The error with the best indices.
    #[inline(always)]
    pub(super) fn least(&self) -> f32 {
        total(&self.least)
    }

    /// The error of a row with the best indices.
    #[inline(always)]
    pub(super) fn least_of_row(&self, row: usize) -> f32 {
        let least = |column: usize| self.least[4 * row + column];
        (least(0) + least(1)) + (least(2) + least(3))
    }

    /// The error of a row with these indices.
    #[inline(always)]
    pub(super) fn of_row(&self, row: usize, indices: u8) -> f32 {
        let of = |column: usize| self.entries[usize::from(indices >> (2 * column) & 3)][4 * row + column];
        (of(0) + of(1)) + (of(2) + of(3))
    }

    /// The error with these indices.
    #[inline(always)]
    pub(super) fn of(&self, indices: u32) -> f32 {
        let [a, b, c, d] = indices.to_le_bytes();
        (self.of_row(0, a) + self.of_row(1, b)) + (self.of_row(2, c) + self.of_row(3, d))
    }

    /// For the first and the last two texels of a row, the error with each of 16 changes of a pair of indices.
    #[inline(always)]
    pub(super) fn changes(&self, row: usize, indices: u8) -> [[f32; 16]; 2] {
        let mut errors = [[0.0; 16]; 2];
        for (half, errors) in errors.iter_mut().enumerate() {
            let (texel, pair) = (4 * row + 2 * half, usize::from(indices >> (4 * half)));
            for (change, error) in errors.iter_mut().enumerate() {
                let [low, high] = [(pair ^ change) & 3, (pair >> 2 ^ change >> 2) & 3];
                *error = self.entries[low][texel] + self.entries[high][texel + 1];
            }
        }
        errors
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
const CHANNELS: [(u32, i32); 3] = [(11, 31), (5, 63), (0, 31)];

/// Thirds of color0 in the palette entries 0 to 3.
const THIRDS: [f32; 4] = [3.0, 0.0, 2.0, 1.0];

/// A level widened to 8 bits.
#[inline(always)]
fn widened(level: i32, levels: i32) -> f32 {
    (if levels == 31 { level << 3 | level >> 2 } else { level << 2 | level >> 4 }) as f32
}

impl Normal {
    /// The least-squares endpoints, rounded to 565; `None` if the indices do not tell the endpoints apart.
    #[inline(always)]
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
                let level = (value * (levels as f32 / 255.0) + 0.5).clamp(0.0, levels as f32) as u16;
                *end |= level << shift;
            }
        }
        Some(join(ends))
    }

    /// Improves `ends` one endpoint after the other, each among all steps from `source`, at the cost of the steps.
    #[inline(always)]
    pub(super) fn descend(&self, source: u32, ends: u32, costs: &Costs) -> u32 {
        let (from, [_, start]) = (split(source), split(ends));
        let first = self.best_step(0, from[0], start, costs);
        let second = self.best_step(1, from[1], first, costs);
        // The first endpoint would come out as before where the second stayed.
        let first = if second == start { first } else { self.best_step(0, from[0], second, costs) };
        join([first, second])
    }

    /// The best colour for one endpoint within a step of `from`, the other endpoint being `other`.
    #[inline(always)]
    fn best_step(&self, end: usize, from: u16, other: u16, costs: &Costs) -> u16 {
        let reds = self.terms::<5>(0, end, from, other);
        let greens = self.terms::<9>(1, end, from, other);
        let blues = self.terms::<5>(2, end, from, other);
        let [red, green, blue] = [least(&reds), least(&greens), least(&blues)];
        // The best colour without regard to the costs sets a bound that leaves few others to look at.
        let symbol = 45 * red.0 + 5 * green.0 + blue.0;
        let (mut best, mut most) = (symbol, red.1 + green.1 + blue.1 + costs.steps()[symbol]);
        for (i, red) in reds.iter().enumerate() {
            if red + green.1 + blue.1 >= most {
                continue;
            }
            for (j, green) in greens.iter().enumerate() {
                let (pair, others) = (9 * i + j, red + green);
                if others + blue.1 + costs.least_steps()[pair] >= most {
                    continue;
                }
                for (k, blue) in blues.iter().enumerate() {
                    let cost = others + blue + costs.steps()[5 * pair + k];
                    if cost < most {
                        (most, best) = (cost, 5 * pair + k);
                    }
                }
            }
        }
        let best = from.wrapping_add(STEP_SUM[best]);
        debug_assert!(step(from, best).is_some());
        best
    }

    /// The part of the error that one channel of one endpoint decides, for the 5 or 9 levels around that of `from`.
    #[inline(always)]
    fn terms<const N: usize>(&self, channel: usize, end: usize, from: u16, other: u16) -> [f32; N] {
        let (shift, levels) = CHANNELS[channel];
        let level_of = |color: u16| i32::from(color) >> shift & levels;
        let level = level_of(from) - N as i32 / 2;
        let [aa, ab, bb] = self.moments;
        let square = if end == 0 { aa } else { bb };
        let linear = ab * widened(level_of(other), levels) - 3.0 * self.sums[channel][end];
        let mut terms = [0.0; N];
        for (i, term) in terms.iter_mut().enumerate() {
            let level = level + i as i32;
            let value = widened(level, levels);
            let possible = (0..=levels).contains(&level);
            *term = if possible { (square * value + 2.0 * linear) * value * (1.0 / 9.0) } else { FORBIDDEN };
        }
        terms
    }
}

/// The least of some values, and where it is.
#[inline(always)]
fn least(values: &[f32]) -> (usize, f32) {
    let mut least = (0, f32::INFINITY);
    for (i, &value) in values.iter().enumerate() {
        if value < least.1 {
            least = (i, value);
        }
    }
    least
}

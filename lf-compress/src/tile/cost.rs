//! What the symbols of a tile cost, in bits: the entropy of each stream, from counts of an earlier pass.
//!
//! Counts and logarithms are integers, so that every machine makes the same choices and hence the same bytes.

use super::block::ESCAPE;
use super::choice::Choice;
use super::grid::CONTEXTS;

/// Fractional bits of a logarithm.
const FRACTION: u32 = 10;
/// Steps of red and green.
const STEP_PAIRS: usize = 5 * 9;
/// What an escaped endpoint costs beside the escape symbol: 16 bits, which compress a little.
const ESCAPED_BITS: f32 = 14.5;
/// Least and greatest cost of a symbol, bits: what a Huffman code with a longest code of 11 can do.
const CODE_BITS: (f32, f32) = (1.0, 11.0);

/// How often each symbol occurred in each stream.
#[derive(Clone)]
pub(super) struct Counts {
    modes: [[u32; 256]; CONTEXTS],
    steps: [u32; 256],
    rows: [u32; 256],
}

impl Counts {
    pub(super) fn new() -> Self {
        Self { modes: [[0; 256]; CONTEXTS], steps: [0; 256], rows: [0; 256] }
    }

    pub(super) fn add(&mut self, context: usize, choice: &Choice) {
        self.modes[context][usize::from(choice.mode)] += 1;
        if choice.ends.has_steps() {
            for step in choice.ends.steps {
                self.steps[usize::from(step)] += 1;
            }
        }
        for byte in choice.correction.to_le_bytes().into_iter().filter(|&byte| byte != 0) {
            self.rows[usize::from(byte)] += 1;
        }
    }
}

/// Cost of every symbol, in bits or in a multiple of bits.
#[derive(Clone)]
pub(super) struct Costs {
    modes: [[f32; 256]; CONTEXTS],
    steps: [f32; 256],
    rows: [f32; 256],
    /// Bounds for the search, see the functions of these names.
    least_modes: [[f32; 16]; CONTEXTS],
    least_steps: [f32; STEP_PAIRS],
    least_rows: [f32; 16],
    least_row: f32,
}

impl Costs {
    /// A guess to begin with: fewer corrected rows are likelier, as are copies, small steps and lone changes.
    pub(super) fn guess() -> Self {
        let mode = |mode: usize| 3.0 + (mode & 15).count_ones() as f32 * 0.5 + if mode >> 4 < 4 { 0.0 } else { 1.0 };
        let step = |symbol: usize| if symbol == 112 { 3.0 } else { 7.0 };
        let row = |byte: usize| 4.0 + 0.5 * byte.count_ones() as f32;
        let modes = [std::array::from_fn(mode); CONTEXTS];
        Self::of(modes, std::array::from_fn(step), std::array::from_fn(row))
    }

    /// The entropy of the counts.
    pub(super) fn new(counts: &Counts) -> Self {
        Self::of(counts.modes.map(bits), bits(counts.steps), bits(counts.rows))
    }

    fn of(modes: [[f32; 256]; CONTEXTS], steps: [f32; 256], rows: [f32; 256]) -> Self {
        let (least_modes, least_steps) = ([[0.0; 16]; CONTEXTS], [0.0; STEP_PAIRS]);
        let mut costs = Self { modes, steps, rows, least_modes, least_steps, least_rows: [0.0; 16], least_row: 0.0 };
        costs.finish();
        costs
    }

    /// Charges the escapes, rules out the correction of a row that corrects nothing, and finds the least costs.
    fn finish(&mut self) {
        self.steps[usize::from(ESCAPE)] += ESCAPED_BITS;
        self.rows[0] = f32::INFINITY;
        self.bound();
    }

    fn bound(&mut self) {
        let least = |costs: &[f32]| costs.iter().copied().fold(f32::INFINITY, f32::min);
        let chunks = |costs: &[f32; 256]| std::array::from_fn(|i| least(&costs[16 * i..16 * i + 16]));
        self.least_modes = self.modes.each_ref().map(chunks);
        self.least_steps = std::array::from_fn(|i| least(&self.steps[5 * i..5 * i + 5]));
        self.least_rows = chunks(&self.rows);
        self.least_row = least(&self.rows);
    }

    /// All costs times `factor`.
    pub(super) fn scaled(&self, factor: f32) -> Self {
        let scale = |costs: [f32; 256]| costs.map(|cost| cost * factor);
        let (modes, steps, rows) = (self.modes.map(scale), scale(self.steps), scale(self.rows));
        let mut costs = Self { modes, steps, rows, ..*self };
        costs.bound();
        costs
    }

    #[inline(always)]
    pub(super) fn mode(&self, context: usize, mode: u8) -> f32 {
        self.modes[context % CONTEXTS][usize::from(mode)]
    }

    /// The step of an endpoint, with the bytes of an escape.
    #[inline(always)]
    pub(super) fn step(&self, symbol: u8) -> f32 {
        self.steps[usize::from(symbol)]
    }

    /// All steps.
    #[inline(always)]
    pub(super) fn steps(&self) -> &[f32; 256] {
        &self.steps
    }

    /// A row of corrections, which is not 0.
    #[inline(always)]
    pub(super) fn row(&self, byte: u8) -> f32 {
        self.rows[usize::from(byte)]
    }

    /// The modes of a context that differ only in the set of rows.
    #[inline(always)]
    pub(super) fn modes(&self, context: usize, mode: u8) -> &[f32; 16] {
        &self.modes[context % CONTEXTS].as_chunks().0[usize::from(mode >> 4)]
    }

    /// Cost of the cheapest of those modes.
    #[inline(always)]
    pub(super) fn least_mode(&self, context: usize, mode: u8) -> f32 {
        self.least_modes[context % CONTEXTS][usize::from(mode >> 4)]
    }

    /// For each step of red and green, the cost with the cheapest step of blue.
    #[inline(always)]
    pub(super) fn least_steps(&self) -> &[f32; STEP_PAIRS] {
        &self.least_steps
    }

    /// For each high half of a row of corrections, the cost with the cheapest low half.
    #[inline(always)]
    pub(super) fn least_rows(&self) -> &[f32; 16] {
        &self.least_rows
    }

    /// Cost of the cheapest row of corrections.
    #[inline(always)]
    pub(super) fn least_row(&self) -> f32 {
        self.least_row
    }

    /// All rows of corrections, by their high half. The one that corrects nothing costs infinitely much.
    #[inline(always)]
    pub(super) fn rows(&self) -> &[[f32; 16]] {
        self.rows.as_chunks().0
    }
}

/// −log₂ of the frequency of each symbol. What did not occur counts as half an occurrence.
fn bits(counts: [u32; 256]) -> [f32; 256] {
    let doubled = counts.map(|count| (2 * u64::from(count)).max(1));
    let total = log2(doubled.iter().sum());
    let scale = 1.0 / (1 << FRACTION) as f32;
    doubled.map(|count| ((total - log2(count)) as f32 * scale).clamp(CODE_BITS.0, CODE_BITS.1))
}

/// Logarithm of a positive integer to base 2, rounded down to 2⁻¹⁰: each squaring of the mantissa gives one more bit.
fn log2(x: u64) -> u32 {
    let whole = x.max(1).ilog2();
    let mut mantissa = ((u128::from(x.max(1)) << 32) >> whole) as u64;
    let mut log = whole;
    for _ in 0..FRACTION {
        let square = ((u128::from(mantissa) * u128::from(mantissa)) >> 32) as u64;
        let carry = u32::from(square >> 33 != 0);
        mantissa = square >> carry;
        log = 2 * log + carry;
    }
    log
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_are_right_to_their_last_bit() {
        for x in (1..5000).chain([u64::from(u32::MAX), 1 << 40]) {
            let exact = (x as f64).log2() * f64::from(1 << FRACTION);
            let error = exact - f64::from(log2(x));
            assert!((-1e-3..1.01).contains(&error), "log2({x}) is off by {error}");
        }
    }

    #[test]
    fn frequent_symbols_cost_less() {
        let mut counts = [0; 256];
        (counts[7], counts[9]) = (800, 200);
        let costs = bits(counts);
        assert!((costs[9] - 2.44).abs() < 0.1 && costs[7] == 1.0 && costs[0] == 11.0, "{costs:?}");
    }
}

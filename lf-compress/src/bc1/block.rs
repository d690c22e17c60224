//! The texels of a block in the form the fits compute with, and the few vector operations they need.
//!
//! Sums over the texels are of integers whose total stays below 2²⁴, held in `f32`. Such sums are exact, so their order
//! does not matter: the compiler may vectorise them, and every machine gets the same bits. What is not an integer, a
//! projection on an axis say, is computed texel by texel in a fixed order. Nothing is fused, and nothing but `+ − × ÷` and
//! comparisons is used.

use super::Texel;

/// One `f32` per texel of a block, row-major.
pub(super) type Lanes = [f32; 16];

/// A colour, or a direction in RGB.
pub(super) type Rgb = [f32; 3];

/// The texels of a block, channel by channel, with the moments that every fit needs.
pub(super) struct Block {
    pub(super) channels: [Lanes; 3],
    /// Per channel, the sum over the texels: at most 16·255.
    pub(super) sums: Rgb,
    /// Sum of squares over texels and channels: at most 48·255² < 2²².
    pub(super) energy: f32,
}

impl Block {
    /// Spreads the texels over the lanes; alpha is dropped.
    pub(super) fn new(texels: &[Texel; 16]) -> Self {
        let channel = |c: usize| lanes(|i| f32::from(texels[i][c]));
        let channels = [channel(0), channel(1), channel(2)];
        let [r, g, b] = &channels;
        Self { sums: [sum(r), sum(g), sum(b)], energy: dot(r, r) + dot(g, g) + dot(b, b), channels }
    }

    /// 256 times the covariance of two channels, `16·Σxy − Σx·Σy`: exact, as both terms are at most 256·255² < 2²⁴.
    #[inline(always)]
    pub(super) fn covariance(&self, a: usize, b: usize) -> f32 {
        16.0 * dot(&self.channels[a], &self.channels[b]) - self.sums[a] * self.sums[b]
    }

    /// Scalar products of the texels with a vector.
    #[inline(always)]
    pub(super) fn project(&self, axis: Rgb) -> Lanes {
        let [r, g, b] = &self.channels;
        lanes(|i| axis[0] * r[i] + axis[1] * g[i] + axis[2] * b[i])
    }
}

/// One value per texel. A plain loop: unlike `array::from_fn` it reliably becomes vector code.
#[inline(always)]
pub(super) fn lanes(value: impl Fn(usize) -> f32) -> Lanes {
    let mut out = [0.0; 16];
    for (i, lane) in out.iter_mut().enumerate() {
        *lane = value(i);
    }
    out
}

/// Combines all lanes by halving; the operation must not mind the order.
#[inline(always)]
fn reduce(all: &Lanes, op: impl Fn(f32, f32) -> f32) -> f32 {
    let mut eight = [0.0; 8];
    for (i, half) in eight.iter_mut().enumerate() {
        *half = op(all[i], all[i + 8]);
    }
    let mut four = [0.0; 4];
    for (i, quarter) in four.iter_mut().enumerate() {
        *quarter = op(eight[i], eight[i + 4]);
    }
    op(op(four[0], four[2]), op(four[1], four[3]))
}

/// Sum of the lanes.
#[inline(always)]
pub(super) fn sum(all: &Lanes) -> f32 {
    reduce(all, |a, b| a + b)
}

/// Sum of the lanes' products.
#[inline(always)]
pub(super) fn dot(a: &Lanes, b: &Lanes) -> f32 {
    sum(&lanes(|i| a[i] * b[i]))
}

/// The least and the greatest lane.
#[inline(always)]
pub(super) fn extremes(all: &Lanes) -> (f32, f32) {
    // `if` is one instruction where `f32::min` also cares for NaN, which cannot occur here.
    let lo = reduce(all, |a, b| if b < a { b } else { a });
    let hi = reduce(all, |a, b| if b > a { b } else { a });
    (lo, hi)
}

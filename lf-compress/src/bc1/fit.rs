//! Fits: a pair of endpoints, the palette entry each texel takes, and the squared error that leaves.

use fearless_simd::prelude::*;

use super::lanes::{F, Group, I, M, Rgb, U};
use super::least_squares::Moments;
use super::palette::{Metric, Palette, expand};

/// Endpoints as levels of 5, 6 and 5 bits, held as integers in `f32`.
#[derive(Clone, Copy)]
pub(super) struct Ends<S: Simd> {
    pub(super) levels: [Rgb<S>; 2],
}

impl<S: Simd> Ends<S> {
    /// The palette, by share of the first endpoint.
    #[inline(always)]
    pub(super) fn palette<P: Palette<S>>(&self) -> [Rgb<S>; 4] {
        let mut palette = [self.levels[0]; 4];
        for c in 0..3 {
            let entries = P::entries(expand::<S>(self.levels[0][c], c), expand::<S>(self.levels[1][c], c));
            for j in 0..4 {
                palette[j][c] = entries[j];
            }
        }
        palette
    }

    /// One endpoint as 565 bits.
    #[inline(always)]
    pub(super) fn color(&self, end: usize) -> U<S> {
        let [r, g, b] = self.levels[end];
        let bits: I<S> = (r * 2048.0 + g * 32.0 + b).to_int();
        bits.bitcast()
    }

    #[inline(always)]
    fn select(mask: M<S>, a: &Self, b: &Self) -> Self {
        let mut out = *b;
        for e in 0..2 {
            for c in 0..3 {
                out.levels[e][c] = mask.select(a.levels[e][c], b.levels[e][c]);
            }
        }
        out
    }
}

/// Endpoints, and how the block fares under them.
#[derive(Clone, Copy)]
pub(super) struct Fit<S: Simd> {
    pub(super) ends: Ends<S>,
    /// Weighted squared error over texels and channels, less the texels' own weighted squares.
    pub(super) error: I<S>,
    /// The palette entry of every texel, two bits each, texel 0 lowest.
    pub(super) shares: U<S>,
}

impl<S: Simd> Fit<S> {
    /// Gives every texel the nearest palette entry.
    ///
    /// The nearest minimises `|p|² − 2·p·x`. Times four plus the entry's number this is an integer below 2²⁴, so one
    /// minimum finds both the error and the entry, the lower of two that tie.
    #[inline(always)]
    pub(super) fn new<P: Palette<S>>(
        group: &Group<S>,
        metric: &Metric,
        palette: &P,
        ends: Ends<S>,
    ) -> (Self, Moments<S>) {
        let simd = group.simd;
        let (slope, offset) = scores::<S, P>(group, metric, &ends);
        let (mut error, mut shares) = (I::<S>::splat(simd, 0), I::<S>::splat(simd, 0));
        let mut moments = Moments::new(group, palette);
        for i in (0..16).rev() {
            let [r, g, b] = group.texel(i);
            let mut score = offset;
            for j in 0..4 {
                let at_blue = b.mul_add(slope[j][2], offset[j]);
                score[j] = r.mul_add(slope[j][0], g.mul_add(slope[j][1], at_blue));
            }
            score[3] = palette.penalize(score[3], i, 4.0);
            let best: I<S> = score[0].min(score[1]).min(score[2].min(score[3])).to_int();
            let share = best & 3;
            // An arithmetic shift: floor division by 4 takes the entry's number off again.
            error += best >> 2;
            shares = (shares << 2) | share;
            palette.count(&mut moments, group, i, share.to_float());
        }
        (Self { ends, error, shares: shares.bitcast() }, moments)
    }

    /// Lane by lane the fit with the smaller error, `self` where they tie.
    #[inline(always)]
    pub(super) fn or_better(&self, other: &Self) -> Self {
        let better = other.error.simd_lt(self.error);
        Self {
            ends: Ends::select(better, &other.ends, &self.ends),
            error: better.select(other.error, self.error),
            shares: better.select(other.shares, self.shares),
        }
    }
}

/// Slopes and offsets of four times the score of every entry, plus the entry's number.
#[inline(always)]
fn scores<S: Simd, P: Palette<S>>(group: &Group<S>, metric: &Metric, ends: &Ends<S>) -> ([Rgb<S>; 4], [F<S>; 4]) {
    let mut slope = ends.palette::<P>();
    let mut offset = [group.splat(0.0); 4];
    for j in 0..4 {
        let mut square = group.splat(0.0);
        for c in 0..3 {
            let weighted = slope[j][c] * metric.weights[c];
            square = weighted.mul_add(slope[j][c], square);
            slope[j][c] = weighted * -8.0;
        }
        offset[j] = square.mul_add(4.0, group.splat(j as f32));
    }
    (slope, offset)
}

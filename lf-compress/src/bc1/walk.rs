//! Descent on the grid of endpoint levels, measured as a decoder would.

use fearless_simd::prelude::*;

use super::fit::{Ends, Fit};
use super::lanes::{F, Group, M};
use super::palette::{MAX_LEVEL, Metric, Palette, expand};

/// Steps of one channel's two levels that are tried.
///
/// Both up or both down is left out: it adds a third to the time and nothing to the result.
const STEPS: [[f32; 2]; 6] = [[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0], [1.0, -1.0], [-1.0, 1.0]];

/// Moves one channel's levels at a time to the best of their neighbours, with every texel free to change its entry,
/// until no block gains or `sweeps` over the channels are done. Never makes a block worse.
#[inline(always)]
pub(super) fn descend<S: Simd, P: Palette<S>>(
    group: &Group<S>,
    metric: &Metric,
    palette: &P,
    fit: &Fit<S>,
    sweeps: usize,
) -> Fit<S> {
    if sweeps == 0 {
        return *fit;
    }
    group.simd.vectorize(
        #[inline(always)]
        || {
            let mut ends = fit.ends;
            let mut error: F<S> = fit.error.to_float();
            let mut idle = 0;
            for c in (0..3).cycle().take(3 * sweeps) {
                let moved = step(group, metric, palette, &mut ends, &mut error, c);
                idle = if moved.any_true() { 0 } else { idle + 1 };
                if idle == 3 {
                    break;
                }
            }
            Fit::new(group, metric, palette, ends).0
        },
    )
}

/// One channel's best step; returns the lanes that took one.
#[inline(always)]
fn step<S: Simd, P: Palette<S>>(
    group: &Group<S>,
    metric: &Metric,
    palette: &P,
    ends: &mut Ends<S>,
    error: &mut F<S>,
    c: usize,
) -> M<S> {
    let base = other_channels(group, metric, palette, ends, c);
    let (zero, max) = (group.splat(0.0), group.splat(MAX_LEVEL[c]));
    let (q0, q1) = (ends.levels[0][c], ends.levels[1][c]);
    let (mut least, mut best0, mut best1) = (*error, q0, q1);
    for [d0, d1] in STEPS {
        let (n0, n1) = ((q0 + d0).max(zero).min(max), (q1 + d1).max(zero).min(max));
        let mut slope = P::entries(expand::<S>(n0, c), expand::<S>(n1, c));
        let mut square = slope;
        for j in 0..4 {
            square[j] = slope[j] * slope[j] * metric.weights[c];
            slope[j] *= -2.0 * metric.weights[c];
        }
        let mut total = zero;
        for (x, base) in group.channels[c].iter().zip(&base) {
            let s0 = x.mul_add(slope[0], base[0] + square[0]);
            let s1 = x.mul_add(slope[1], base[1] + square[1]);
            let s2 = x.mul_add(slope[2], base[2] + square[2]);
            let s3 = x.mul_add(slope[3], base[3] + square[3]);
            total += s0.min(s1).min(s2.min(s3));
        }
        let better = total.simd_lt(least);
        least = total.min(least);
        (best0, best1) = (better.select(n0, best0), better.select(n1, best1));
    }
    let moved = least.simd_lt(*error);
    *error = least;
    (ends.levels[0][c], ends.levels[1][c]) = (best0, best1);
    moved
}

/// Every texel's score at every entry, from the channels other than `c`.
#[inline(always)]
fn other_channels<S: Simd, P: Palette<S>>(
    group: &Group<S>,
    metric: &Metric,
    palette: &P,
    ends: &Ends<S>,
    c: usize,
) -> [[F<S>; 4]; 16] {
    let entries = ends.palette::<P>();
    let (m, n) = ((c + 1) % 3, (c + 2) % 3);
    let (wm, wn) = (metric.weights[m], metric.weights[n]);
    let mut base = [[group.splat(0.0); 4]; 16];
    for j in 0..4 {
        let (pm, pn) = (entries[j][m], entries[j][n]);
        let square = pm * pm * wm + pn * pn * wn;
        let (sm, sn) = (pm * (-2.0 * wm), pn * (-2.0 * wn));
        for i in 0..16 {
            base[i][j] = sm.mul_add(group.channels[m][i], sn.mul_add(group.channels[n][i], square));
        }
    }
    for (i, base) in base.iter_mut().enumerate() {
        base[3] = palette.penalize(base[3], i, 1.0);
    }
    base
}

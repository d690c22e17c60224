//! Cluster fit: of all ways to cut a block's texels, in their order along an axis, into runs that share a palette entry,
//! the best (Simon Brown's *libsquish*, 2006; all 969 cuts in one pass of prefix sums).
//!
//! With the first i texels at share 3, those up to j at 2, up to k at 1 and the rest at 0, and colours measured from
//! the block's mean, `Σax = P(i) + P(j) + P(k)` with the prefix sums P, and `Σbx = −Σax`. So the least-squares endpoints
//! lower the error by `144 · |Σax|² / det`, where the determinant depends on i, j and k alone: a cut costs a dozen
//! operations for a whole group of blocks.

use std::ops::Range;

use fearless_simd::prelude::*;

use super::axis::{extremes, projections};
use super::lanes::{F, Group, I, MAX_LANES, Packed, Rgb, U, lanes, unpack};
use super::least_squares::Moments;
use super::palette::{FourColor, MAX_LEVEL, Metric};

/// One way to cut sixteen texels into four runs, some perhaps empty.
#[derive(Clone, Copy)]
struct Cut {
    /// Where the runs with shares 3, 2 and 1 end.
    at: [u8; 3],
    /// Place in the table; an integer.
    number: f32,
    /// `144 / det`, or 0 where all texels share one entry.
    factor: f32,
    /// `Σa` and `Σaa`.
    a: f32,
    aa: f32,
}

/// Ways to cut: 19 over 3.
const CUTS: usize = 969;

/// All cuts in lexicographic order of their ends.
static TABLE: [Cut; CUTS] = {
    let mut table = [Cut::new([0; 3], 0); CUTS];
    let (mut n, mut code) = (0, 0);
    while code < 17 * 17 * 17 {
        let at = [code / 289, code / 17 % 17, code % 17];
        if at[0] <= at[1] && at[1] <= at[2] {
            table[n] = Cut::new(at, n);
            n += 1;
        }
        code += 1;
    }
    table
};

/// Where the cuts with given first two ends start in [`TABLE`].
static ROWS: [[u16; 17]; 17] = {
    let mut rows = [[0; 17]; 17];
    let mut n = CUTS;
    while n > 0 {
        n -= 1;
        rows[TABLE[n].at[0] as usize][TABLE[n].at[1] as usize] = n as u16;
    }
    rows
};

impl Cut {
    const fn new([i, j, k]: [usize; 3], number: usize) -> Self {
        let (n3, n2, n1) = (i, j - i, k - j);
        let (a, aa) = (3 * n3 + 2 * n2 + n1, 9 * n3 + 4 * n2 + n1);
        let (ab, bb) = (3 * a - aa, 144 + aa - 6 * a);
        let det = aa * bb - ab * ab;
        let factor = if det > 0 { 144.0 / det as f32 } else { 0.0 };
        Self { at: [i as u8, j as u8, k as u8], number: number as f32, factor, a: a as f32, aa: aa as f32 }
    }
}

/// The best cut so far, lane by lane.
#[derive(Clone, Copy)]
pub(super) struct Best<S: Simd> {
    /// By how much the cut lowers the error, in the units of [`Ordered`].
    score: F<S>,
    /// The cut's number.
    cut: F<S>,
}

impl<S: Simd> Best<S> {
    #[inline(always)]
    fn none(group: &Group<S>) -> Self {
        Self { score: group.splat(0.0), cut: group.splat(0.0) }
    }

    /// Takes the cut at the given sums where it is better.
    #[inline(always)]
    fn offer(&mut self, group: &Group<S>, two: &Rgb<S>, third: &Rgb<S>, cut: &Cut) {
        let [r, g, b] = [two[0] + third[0], two[1] + third[1], two[2] + third[2]];
        let score = (r * r + g * g + b * b) * cut.factor;
        let better = score.simd_gt(self.score);
        self.score = score.max(self.score);
        self.cut = better.select(group.splat(cut.number), self.cut);
    }
}

/// A group's texels in order along an axis, ready to be cut.
pub(super) struct Ordered<S: Simd> {
    /// Sixteen times the prefix sums of the colours, measured from the mean, times the square roots of the weights.
    prefix: [Rgb<S>; 17],
}

/// The sets of two and more shares, as places in what [`Ordered::best_cuts`] returns.
const SETS: [usize; 11] = [1, 4, 5, 6, 8, 9, 10, 12, 13, 14, 15];

impl<S: Simd> Ordered<S> {
    #[inline(always)]
    pub(super) fn new(group: &Group<S>, metric: &Metric, texels: &Packed<S>, axis: &Rgb<S>) -> Self {
        let keys = sorted(group, metric, texels, axis);
        let roots = metric.weights.map(f32::sqrt);
        let mut sums = [group.splat(0.0); 3];
        let mut prefix = [sums; 17];
        for (key, prefix) in keys.iter().zip(&mut prefix[1..]) {
            let x = unpack::<S>(*key);
            for c in 0..3 {
                sums[c] += x[c] * 16.0 - group.sums[c];
                prefix[c] = sums[c] * roots[c];
            }
        }
        Self { prefix }
    }

    /// For every set of shares that texels may take, the cut that leaves the least error before endpoints are rounded.
    ///
    /// Near-equal colours can be fitted in many ways that differ little in that error but much in how well the coarse
    /// endpoints happen to serve them. The sets are what spreads the candidates out.
    #[inline(always)]
    pub(super) fn best_cuts(&self, group: &Group<S>) -> [Best<S>; 11] {
        let four = [self.scan(group, 0..1, false), self.scan(group, 0..1, true)];
        let more = [self.scan(group, 1..17, false), self.scan(group, 1..17, true)];
        let all = [four[0], four[1], more[0], more[1]];
        let mut best = [Best::none(group); 11];
        for (best, set) in best.iter_mut().zip(SETS) {
            *best = all[set / 4][set % 4];
        }
        best
    }

    /// The cuts whose first run ends in a range, and whose second run is empty or not; the best with k = j, with
    /// j < k < 16, with j < k = 16, and with j = 16.
    #[inline(always)]
    fn scan(&self, group: &Group<S>, first: Range<usize>, second: bool) -> [Best<S>; 4] {
        group.simd.vectorize(
            #[inline(always)]
            || {
                let mut best = [Best::none(group); 4];
                for i in first {
                    let ends = if second { i + 1..17 } else { i..i + 1 };
                    for j in ends {
                        self.scan_row(group, i, j, &mut best);
                    }
                }
                best
            },
        )
    }

    #[inline(always)]
    fn scan_row(&self, group: &Group<S>, i: usize, j: usize, best: &mut [Best<S>; 4]) {
        let (p, q) = (&self.prefix[i], &self.prefix[j]);
        let two = [p[0] + q[0], p[1] + q[1], p[2] + q[2]];
        let (cuts, thirds) = (&TABLE[usize::from(ROWS[i][j])..][..17 - j], &self.prefix[j..]);
        if j == 16 {
            best[3].offer(group, &two, &thirds[0], &cuts[0]);
            return;
        }
        best[0].offer(group, &two, &thirds[0], &cuts[0]);
        best[2].offer(group, &two, &thirds[16 - j], &cuts[16 - j]);
        let mut inner = best[1];
        for (cut, third) in cuts[1..16 - j].iter().zip(&thirds[1..]) {
            inner.offer(group, &two, third, cut);
        }
        best[1] = inner;
    }

    /// The moments of the cut that every lane chose.
    #[inline(always)]
    pub(super) fn moments(&self, group: &Group<S>, metric: &Metric, best: &Best<S>) -> Moments<S> {
        let (mut a, mut aa, mut sums) = ([0.0; MAX_LANES], [0.0; MAX_LANES], [[0.0; MAX_LANES]; 3]);
        let cuts: I<S> = best.cut.to_int();
        for (lane, &cut) in cuts.as_slice().iter().enumerate() {
            let cut = &TABLE[cut as usize];
            (a[lane], aa[lane]) = (cut.a, cut.aa);
            let [i, j, k] = cut.at;
            let (i, j, k) = (&self.prefix[i as usize], &self.prefix[j as usize], &self.prefix[k as usize]);
            for c in 0..3 {
                sums[c][lane] = i[c].as_slice()[lane] + j[c].as_slice()[lane] + k[c].as_slice()[lane];
            }
        }
        let mut moments = Moments::new(group, &FourColor);
        moments.a = F::<S>::from_slice(group.simd, &a[..lanes::<S>()]);
        moments.aa = F::<S>::from_slice(group.simd, &aa[..lanes::<S>()]);
        for c in 0..3 {
            // Σax = Σa(x − mean) + mean · Σa
            let scaled = F::<S>::from_slice(group.simd, &sums[c][..lanes::<S>()]);
            let centred = (scaled * (1.0 / metric.weights[c].sqrt())).round_ties_even();
            moments.ax[c] = (centred + moments.a * group.sums[c]) * (1.0 / 16.0);
        }
        moments
    }
}

/// The moments among all sets' best cuts that leave the least error once endpoints are rounded.
#[inline(always)]
pub(super) fn best_rounded<S: Simd>(
    group: &Group<S>,
    metric: &Metric,
    ordered: &Ordered<S>,
    cuts: &[Best<S>; 11],
) -> Moments<S> {
    let mut best = ordered.moments(group, metric, &cuts[0]);
    let mut least = rounded_error(group, metric, &best);
    for cut in &cuts[1..] {
        let moments = ordered.moments(group, metric, cut);
        let error = rounded_error(group, metric, &moments);
        best = Moments::select(error.simd_lt(least), &moments, &best);
        least = error.min(least);
    }
    best
}

/// What the nearest levels to the least-squares endpoints cost, less what the cut gains.
#[inline(always)]
fn rounded_error<S: Simd>(group: &Group<S>, metric: &Metric, moments: &Moments<S>) -> F<S> {
    let [aa, ab, bb] = moments.normal::<FourColor>();
    let det = aa * bb - ab * ab;
    let solvable = det.simd_gt(0.0);
    let scale = group.splat(1.0) / det.max(group.splat(1.0));
    let bias = ab * 0.25;
    let (zero, mut total) = (group.splat(0.0), group.splat(0.0));
    for c in 0..3 {
        let (max, top) = (MAX_LEVEL[c], group.splat(MAX_LEVEL[c]));
        let ax = moments.ax[c] + bias;
        let bx = group.sums[c] * 3.0 - moments.ax[c] + bias;
        let to_levels = scale * (3.0 * max / 255.0);
        let (g0, g1) = ((bb * ax - ab * bx) * to_levels, (aa * bx - ab * ax) * to_levels);
        let d0 = g0.round_ties_even().max(zero).min(top) - g0;
        let d1 = g1.round_ties_even().max(zero).min(top) - g1;
        let excess = d0 * (d0 * aa + d1 * ab * 2.0) + d1 * d1 * bb;
        let centred = moments.ax[c] - moments.a * group.sums[c] * (1.0 / 16.0);
        let square_unit = (255.0 / max) * (255.0 / max) / 9.0;
        total += (excess * square_unit - centred * centred * 144.0 * scale) * metric.weights[c];
    }
    solvable.select(total, zero)
}

/// The packed colours of every block in descending order along an axis.
///
/// The sort key holds the position on the axis in 8 bits above the colour itself, so that colours follow their keys.
/// Texels nearer than 1/256 of the range are not told apart, which no palette of four entries does either.
#[inline(always)]
fn sorted<S: Simd>(group: &Group<S>, metric: &Metric, texels: &Packed<S>, axis: &Rgb<S>) -> Packed<S> {
    let along = projections(group, metric, axis);
    let (lo, hi) = extremes::<S>(&along);
    let scale = group.splat(255.0) / (hi - lo).max(group.splat(1e-6));
    let mut keys = *texels;
    for (key, t) in keys.iter_mut().zip(&along) {
        let rank: I<S> = ((*t - lo) * scale).to_int();
        *key = (*key & 0xff_ffff) | rank.bitcast::<U<S>>() << 24;
    }
    for [a, b] in COMPARATORS {
        (keys[a], keys[b]) = (keys[a].max(keys[b]), keys[a].min(keys[b]));
    }
    keys
}

/// Batcher's merge exchange for sixteen (Knuth, *The Art of Computer Programming* 3, 5.2.2 M): 63 comparators that do
/// not depend on the data.
const COMPARATORS: [[usize; 2]; 63] = {
    let mut pairs = [[0; 2]; 63];
    let (mut n, mut p) = (0, 1);
    while p < 16 {
        let mut k = p;
        while k >= 1 {
            let mut i = k % p;
            while i + k < 16 {
                if (i - k % p) / k % 2 == 0 && i / (2 * p) == (i + k) / (2 * p) {
                    pairs[n] = [i, i + k];
                    n += 1;
                }
                i += 1;
            }
            k /= 2;
        }
        p *= 2;
    }
    pairs
};

//! The endpoints that are best for given shares.

use fearless_simd::prelude::*;

use super::fit::Ends;
use super::lanes::{F, Group, Rgb};
use super::palette::{MAX_LEVEL, Palette};

/// Sums over texels `x` with shares `a` of the first endpoint: what a least-squares fit needs.
#[derive(Clone, Copy)]
pub(super) struct Moments<S: Simd> {
    pub(super) n: F<S>,
    pub(super) x: Rgb<S>,
    pub(super) a: F<S>,
    pub(super) aa: F<S>,
    pub(super) ax: Rgb<S>,
}

impl<S: Simd> Moments<S> {
    /// Before any share is added.
    #[inline(always)]
    pub(super) fn new<P: Palette<S>>(group: &Group<S>, _: &P) -> Self {
        let zero = group.splat(0.0);
        let (n, x) = P::uncounted(group);
        Self { n, x, a: zero, aa: zero, ax: [zero; 3] }
    }

    /// Adds the share of texel `i`. All sums are integers of at most 16·9·255, hence exact.
    #[inline(always)]
    pub(super) fn add(&mut self, group: &Group<S>, i: usize, share: F<S>) {
        self.a += share;
        self.aa = share.mul_add(share, self.aa);
        for c in 0..3 {
            self.ax[c] = share.mul_add(group.channels[c][i], self.ax[c]);
        }
    }

    /// Solves the normal equations and rounds the solution to levels.
    ///
    /// With `p` parts from one endpoint to the other and `b = p − a` the error `Σ ((a·e0 + b·e1)/p − x)²` is least where
    ///
    /// ```text
    /// | Σaa  Σab | | e0 |       | Σax |
    /// | Σab  Σbb | | e1 |  = p · | Σbx |
    /// ```
    ///
    /// Interpolated entries are truncated: thirds lose a third of a unit on average, halves a quarter. Their texels are
    /// taken as that much larger; either way that adds a quarter of `Σab` to both right-hand sides. Lanes whose texels
    /// share one entry have no unique solution; both endpoints take the mean.
    #[inline(always)]
    pub(super) fn solve<P: Palette<S>>(&self, simd: S) -> Ends<S> {
        let parts = P::PARTS;
        let [aa, ab, bb] = self.normal::<P>();
        let det = aa * bb - ab * ab;
        let solvable = det.simd_gt(0.0);
        let one = F::<S>::splat(simd, 1.0);
        let scale = F::<S>::splat(simd, parts) / det.max(one);
        let bias = ab * 0.25;
        let mut levels = [self.x; 2];
        for c in 0..3 {
            let ax = self.ax[c] + bias;
            let bx = self.x[c] * parts - self.ax[c] + bias;
            let mean = self.x[c] / self.n.max(one);
            let e0 = solvable.select((bb * ax - ab * bx) * scale, mean);
            let e1 = solvable.select((aa * bx - ab * ax) * scale, mean);
            [levels[0][c], levels[1][c]] = round_pair(simd, [aa, ab, bb], e0, e1, MAX_LEVEL[c]);
        }
        Ends { levels }
    }

    /// `Σaa`, `Σab`, `Σbb`.
    #[inline(always)]
    pub(super) fn normal<P: Palette<S>>(&self) -> [F<S>; 3] {
        let parts = P::PARTS;
        let ab = self.a * parts - self.aa;
        [self.aa, ab, self.n * (parts * parts) - self.a * (2.0 * parts) + self.aa]
    }

    /// Lane by lane one of two.
    #[inline(always)]
    pub(super) fn select(mask: super::lanes::M<S>, a: &Self, b: &Self) -> Self {
        let mut out = *b;
        (out.n, out.a, out.aa) = (mask.select(a.n, b.n), mask.select(a.a, b.a), mask.select(a.aa, b.aa));
        for c in 0..3 {
            out.x[c] = mask.select(a.x[c], b.x[c]);
            out.ax[c] = mask.select(a.ax[c], b.ax[c]);
        }
        out
    }
}

/// Of the four grid points around a solution, the one with the least error.
///
/// Rounding each endpoint for itself would ignore that they trade against each other. A step `d` off the solution costs
/// `d0²·Σaa + 2·d0·d1·Σab + d1²·Σbb`; compared are the differences to the lower corner.
#[inline(always)]
fn round_pair<S: Simd>(simd: S, [aa, ab, bb]: [F<S>; 3], e0: F<S>, e1: F<S>, max: f32) -> [F<S>; 2] {
    let (zero, one) = (F::<S>::splat(simd, 0.0), F::<S>::splat(simd, 1.0));
    let (e0, e1) = (e0 * (max / 255.0), e1 * (max / 255.0));
    let top = F::<S>::splat(simd, max - 1.0);
    let (low0, low1) = (e0.floor().max(zero).min(top), e1.floor().max(zero).min(top));
    let (d0, d1) = (low0 - e0, low1 - e1);
    let cross = ab * 2.0;
    let up0 = aa * (d0 * 2.0 + 1.0) + cross * d1;
    let up1 = bb * (d1 * 2.0 + 1.0) + cross * d0;
    let both = up0 + up1 + cross;
    let first = both.simd_lt(up1).select(one, zero);
    // Raise the second endpoint where the better of the two corners above beats the better of those below.
    let raise1 = up1.min(both).simd_lt(up0.min(zero));
    let raise0 = up0.simd_lt(zero).select(one, zero);
    [low0 + raise1.select(first, raise0), low1 + raise1.select(one, zero)]
}

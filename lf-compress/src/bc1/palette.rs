//! What two endpoints make of a block: its palette, by mode, and the error measure.

use fearless_simd::prelude::*;

use super::lanes::{F, Group, Rgb};
use super::least_squares::Moments;

/// The greatest levels of the endpoints' channels.
pub(super) const MAX_LEVEL: [f32; 3] = [31.0, 63.0, 31.0];

/// Channel weights of the squared error: integers that sum to at most 16, so that weighted errors are exact.
#[derive(Clone, Copy)]
pub(super) struct Metric {
    pub(super) weights: [f32; 3],
}

/// Widens a level of channel `c` to 8 bits by bit replication.
#[inline(always)]
pub(super) fn expand<S: Simd>(level: F<S>, c: usize) -> F<S> {
    let (shift, back) = if c == 1 { (4.0, 1.0 / 16.0) } else { (8.0, 1.0 / 4.0) };
    level.mul_add(shift, (level * back).floor())
}

/// How the mode of a block makes four palette entries of two endpoints.
///
/// Entries are numbered by the *share* of the first endpoint: entry 0 is the second endpoint, entry [`PARTS`] the first.
///
/// [`PARTS`]: Self::PARTS
pub(super) trait Palette<S: Simd>: Copy {
    /// Steps from one endpoint to the other.
    const PARTS: f32;

    /// One channel's entries, from the endpoints' 8-bit values, first endpoint first.
    fn entries(e0: F<S>, e1: F<S>) -> [F<S>; 4];

    /// Adds to texel `i`'s score at entry 3 what the entry costs beyond its squared distance, times `scale`.
    fn penalize(&self, score: F<S>, i: usize, scale: f32) -> F<S>;

    /// Counts texel `i` with its entry into the moments, unless the endpoints have no part in the entry.
    fn count(&self, moments: &mut Moments<S>, group: &Group<S>, i: usize, share: F<S>);

    /// Texels counted, and their sums, before any texel is.
    fn uncounted(group: &Group<S>) -> (F<S>, Rgb<S>);
}

/// 4-colour mode: two entries between the endpoints.
#[derive(Clone, Copy)]
pub(super) struct FourColor;

impl<S: Simd> Palette<S> for FourColor {
    const PARTS: f32 = 3.0;

    #[inline(always)]
    fn entries(e0: F<S>, e1: F<S>) -> [F<S>; 4] {
        [e1, third::<S>(e1, e0), third::<S>(e0, e1), e0]
    }

    #[inline(always)]
    fn penalize(&self, score: F<S>, _: usize, _: f32) -> F<S> {
        score
    }

    #[inline(always)]
    fn count(&self, moments: &mut Moments<S>, group: &Group<S>, i: usize, share: F<S>) {
        moments.add(group, i, share);
    }

    /// All texels always count.
    #[inline(always)]
    fn uncounted(group: &Group<S>) -> (F<S>, Rgb<S>) {
        (group.splat(16.0), group.sums)
    }
}

/// 3-colour mode: one entry between the endpoints, and black.
#[derive(Clone, Copy)]
pub(super) struct ThreeColor<S: Simd> {
    /// What black costs each texel: see [`BLACK_FREE`], [`BLACK_FORCED`] and [`BLACK_BARRED`].
    pub(super) black: [F<S>; 16],
}

/// Black is an entry like the others.
pub(super) const BLACK_FREE: f32 = 0.0;
/// The texel must be black: no other entry of a black texel costs less than nothing.
pub(super) const BLACK_FORCED: f32 = -1.0;
/// No texel is as far from any entry, and four times this is still well below 2²⁴.
pub(super) const BLACK_BARRED: f32 = (1 << 21) as f32;

impl<S: Simd> Palette<S> for ThreeColor<S> {
    const PARTS: f32 = 2.0;

    #[inline(always)]
    fn entries(e0: F<S>, e1: F<S>) -> [F<S>; 4] {
        [e1, ((e0 + e1) * 0.5).floor(), e0, e0 * 0.0]
    }

    #[inline(always)]
    fn penalize(&self, score: F<S>, i: usize, scale: f32) -> F<S> {
        score + self.black[i] * scale
    }

    #[inline(always)]
    fn count(&self, moments: &mut Moments<S>, group: &Group<S>, i: usize, share: F<S>) {
        let zero = group.splat(0.0);
        let counts = share.simd_lt(2.5);
        moments.add(group, i, counts.select(share, zero));
        moments.n += counts.select(group.splat(1.0), zero);
        for c in 0..3 {
            moments.x[c] += counts.select(group.channels[c][i], zero);
        }
    }

    #[inline(always)]
    fn uncounted(group: &Group<S>) -> (F<S>, Rgb<S>) {
        let zero = group.splat(0.0);
        (zero, [zero; 3])
    }
}

/// `⌊(2·near + far) / 3⌋` for integers from 0 to 255.
///
/// The constant is the `f32` just above 1/3, so multiples of three come out exact and nothing else reaches the next
/// integer: the numerator is at most 765.
#[inline(always)]
fn third<S: Simd>(near: F<S>, far: F<S>) -> F<S> {
    (near.mul_add(2.0, far) * (1.0 / 3.0)).floor()
}

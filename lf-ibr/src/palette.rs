//! Two texels of each lane, decoded from the endpoints of their blocks (`lf_compress::bc1` has the definition).
//!
//! Only the colour that an index selects is computed. Every entry of a palette is one endpoint, or lies between the *near* and the *far*
//! one of it: `⌊(2·near + far) / 3⌋`. If far is near too, that is the endpoint itself.

use fearless_simd::prelude::*;

use crate::lanes::{F, Pairs, U, real};

/// The endpoints of a colour.
#[derive(Clone, Copy)]
pub(crate) struct Pair<S: Simd> {
    near: Pairs<S>,
    far: Pairs<S>,
    /// Whether the colour lies half way between the two, by all bits.
    halves: Pairs<S>,
}

impl<S: Simd> Pair<S> {
    /// From the endpoints and the indices of two texels.
    #[inline(always)]
    pub(crate) fn new(simd: S, ends: [U<S>; 2], indices: [U<S>; 2]) -> Self {
        let first: Pairs<S> = ((ends[0] & 0xffff) | ends[1] << 16).bitcast();
        let second: Pairs<S> = (ends[0] >> 16 | (ends[1] & 0xffff_0000)).bitcast();
        let index: Pairs<S> = (indices[0] | indices[1] << 16).bitcast();
        let zero = Pairs::<S>::splat(simd, 0);
        let odd = (index & 1).simd_eq(1);
        let near = odd.select(second, first);
        let between = index.simd_gt(1);
        let far = between.select(odd.select(first, second), near);
        let three = between & first.simd_le(second);
        let black = three & odd;
        let halves = three.select(Pairs::<S>::splat(simd, 0xffff), zero);
        Self { near: black.select(zero, near), far: black.select(zero, far), halves }
    }

    /// Adds the two colours, weighted, to the sums of each channel, 0 to 255.
    #[inline(always)]
    pub(crate) fn accumulate(self, weights: [F<S>; 2], sums: &mut [F<S>; 3]) {
        let (near, far) = (channels::<S>(self.near), channels::<S>(self.far));
        for c in 0..3 {
            let third = third::<S>(near[c], far[c]);
            let half = (near[c] + far[c]) >> 1;
            let color: U<S> = (third ^ ((third ^ half) & self.halves)).bitcast();
            sums[c] = real::<S>(color & 0xffff).mul_add(weights[0], sums[c]);
            sums[c] = real::<S>(color >> 16).mul_add(weights[1], sums[c]);
        }
    }
}

/// Red, green and blue of 565 colours, widened to 8 bits by bit replication.
#[inline(always)]
fn channels<S: Simd>(color: Pairs<S>) -> [Pairs<S>; 3] {
    [color >> 8 & 0xf8 | color >> 13, color >> 3 & 0xfc | color >> 9 & 0x03, color << 3 & 0xf8 | color >> 2 & 0x07]
}

/// `⌊(2·near + far) / 3⌋` of 8-bit values, in 16 bits. `lf_compress::bc1` decodes whole blocks by the same formula, and shows why it is exact.
#[inline(always)]
fn third<S: Simd>(near: Pairs<S>, far: Pairs<S>) -> Pairs<S> {
    let sum = near + near + far;
    (sum * 85 + (sum >> 2) + 70) >> 8
}

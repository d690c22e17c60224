//! Texels, one to a lane, decoded from their blocks (`lf_compress::bc1` has the definition).
//!
//! Every entry of a palette is a blend of the two endpoints: ⌊(2·near + far) / 3⌋ or ⌊(near + far) / 2⌋ of 8-bit values. A code gives the
//! shares of both in units of 2⁻¹⁴, one dot product and a shift a channel. Thirds are rounded up to 5462: at most 3 · 255 of them are
//! too much by 765 · 2 / 3 units, 1 / 32 of a level, and the fraction that is cut off is 2 / 3 at most. So the result is exact.

use fearless_simd::prelude::*;

use super::lanes::{F, I, Pairs, Shorts, U};

const SHIFT: u32 = 14;
const THIRD: u32 = (1u32 << SHIFT).div_ceil(3);
const HALF: u32 = 1 << (SHIFT - 1);

/// The shares of code 0, `count` parts of the first endpoint, in the low half, and none of the second; and what each next code adds:
/// one part more of the second and one less of the first.
const fn start_and_step(part: u32, count: u32) -> [u32; 2] {
    [count * part, (part << 16) - part]
}

/// The endpoints of each lane's block, 8 bits a channel, the first in the low half.
#[derive(Clone, Copy)]
pub(super) struct Ends<S: Simd> {
    channels: [Shorts<S>; 3],
    colors: U<S>,
}

impl<S: Simd> Ends<S> {
    /// From 565 colours, widened by bit replication.
    #[inline(always)]
    pub(super) fn new(colors: U<S>) -> Self {
        let both: Pairs<S> = colors.bitcast();
        let red = both >> 8 & 0xf8 | both >> 13;
        let green = both >> 3 & 0xfc | both >> 9 & 0x03;
        let blue = both << 3 & 0xf8 | both >> 2 & 0x07;
        Self { channels: [red.bitcast(), green.bitcast(), blue.bitcast()], colors }
    }

    /// Adds the colour that a code selects, weighted, to the sums of each channel, 0 to 255. Unless `three`, no block has three
    /// colours, which takes less.
    #[inline(always)]
    pub(super) fn accumulate(&self, simd: S, code: U<S>, three: bool, weight: F<S>, sums: &mut [F<S>; 3]) {
        let shares =
            if three { self.shares_of_any(simd, code) } else { shares::<S>(simd, code, start_and_step(THIRD, 3)) };
        for (ends, sum) in self.channels.into_iter().zip(sums) {
            let level: I<S> = ends.pairwise_dot_product(shares) >> SHIFT;
            let level: F<S> = level.to_float();
            *sum = level.mul_add(weight, *sum);
        }
    }

    #[inline(always)]
    fn shares_of_any(&self, simd: S, code: U<S>) -> Shorts<S> {
        let halves = (self.colors & 0xffff).simd_lt(self.colors >> 16);
        let black = halves & code.simd_eq(3);
        let (three, four) = (start_and_step(HALF, 2), start_and_step(THIRD, 3));
        let three: U<S> = shares::<S>(simd, code, three).bitcast();
        let four: U<S> = shares::<S>(simd, code, four).bitcast();
        black.select(U::<S>::splat(simd, 0), halves.select(three, four)).bitcast()
    }
}

#[inline(always)]
fn shares<S: Simd>(simd: S, code: U<S>, [start, step]: [u32; 2]) -> Shorts<S> {
    (code * U::<S>::splat(simd, step) + U::<S>::splat(simd, start)).bitcast()
}

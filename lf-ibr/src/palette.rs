//! Texels, one to a lane, decoded from their blocks (`lf_compress::bc1` has the definition).
//!
//! Every entry of a palette is a blend of the two endpoints: ⌊(2·near + far) / 3⌋ or ⌊(near + far) / 2⌋ of 8-bit values. A code gives the
//! shares of both in units of 2⁻¹⁴, one dot product and a shift a channel. Thirds are rounded up to 5462: at most 3 · 255 of them are
//! too much by 765 · 2 / 3 units, 1 / 32 of a level, and the fraction that is cut off is 2 / 3 at most. So the result is exact.

use std::cmp::Ordering;

use fearless_simd::prelude::*;

use crate::lanes::{F, I, Pairs, Shorts, U};

const SHIFT: u32 = 14;
const THIRD: u32 = (1u32 << SHIFT).div_ceil(3);
const HALF: u32 = 1 << (SHIFT - 1);

/// A block: its two endpoints, the first in the low half, and an index or code for each texel, texel 0 lowest.
pub(crate) type Block = [u32; 2];

/// The shares of code 0, `count` parts of the first endpoint, in the low half, and none of the second; and what each next code adds:
/// one part more of the second and one less of the first.
const fn start_and_step(part: u32, count: u32) -> [u32; 2] {
    [count * part, (part << 16) - part]
}

/// The endpoints of each lane's block, 8 bits a channel, the first in the low half.
#[derive(Clone, Copy)]
pub(crate) struct Ends<S: Simd> {
    channels: [Shorts<S>; 3],
    colors: U<S>,
}

impl<S: Simd> Ends<S> {
    /// From 565 colours, widened by bit replication.
    #[inline(always)]
    pub(crate) fn new(colors: U<S>) -> Self {
        let both: Pairs<S> = colors.bitcast();
        let red = both >> 8 & 0xf8 | both >> 13;
        let green = both >> 3 & 0xfc | both >> 9 & 0x03;
        let blue = both << 3 & 0xf8 | both >> 2 & 0x07;
        Self { channels: [red.bitcast(), green.bitcast(), blue.bitcast()], colors }
    }

    /// Adds the colour that a code selects, weighted, to the sums of each channel, 0 to 255. Unless `three`, no block has three
    /// colours, which takes less.
    #[inline(always)]
    pub(crate) fn accumulate(&self, simd: S, code: U<S>, three: bool, weight: F<S>, sums: &mut [F<S>; 3]) {
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

/// The endpoints and codes of a block's bytes.
pub(crate) fn words(&[a, b, c, d, e, f, g, h]: &[u8; 8]) -> Block {
    recode([u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h])])
}

/// A BC1 block's texels, with codes for indices that are the share of the second endpoint: in thirds, or, if the block
/// [`has_three_colors`], in halves, where 3 is black.
///
/// Few blocks need three colours: those of one colour and those of endpoints alone do not.
pub(crate) fn recode([ends, indices]: Block) -> Block {
    const LOW: u32 = 0x5555_5555;
    let (low, high) = (indices & LOW, indices >> 1 & LOW);
    let (first, second) = (ends & 0xffff, ends >> 16);
    let black = low & high;
    match first.cmp(&second) {
        Ordering::Greater => [ends, low << 1 | (low ^ high)],
        // Of one colour.
        Ordering::Equal if black == 0 => [ends, 0],
        Ordering::Equal => [second << 16, (LOW ^ black) << 1],
        // Of endpoints only.
        Ordering::Less if high == 0 => [ends.rotate_left(16), (low ^ LOW) * 3],
        Ordering::Less => [ends, low << 1 | high],
    }
}

/// Whether a recoded block has two endpoints, what is half way between them, and black.
pub(crate) fn has_three_colors(&[ends, _]: &Block) -> bool {
    ends & 0xffff < ends >> 16
}

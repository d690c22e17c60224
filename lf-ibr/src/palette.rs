//! Texels, one to a lane, decoded from their blocks (`lf_compress::bc1` has the definition).
//!
//! Every entry of a palette is a blend of the two endpoints: ⌊(2·near + far) / 3⌋ or ⌊(near + far) / 2⌋ of 8-bit values. A code gives the
//! shares of both in units of 2⁻¹⁴, one dot product and a shift a channel. Thirds are rounded up to 5462: at most 3 · 255 of them are
//! too much by 765 · 2 / 3 units, 1 / 32 of a level, and the fraction that is cut off is 2 / 3 at most. So the result is exact.

use std::cmp::Ordering;

use fearless_simd::prelude::*;
use glam::Vec3;

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

/// The colour, 0 … 1, of a recoded block's texel, numbered row by row.
pub(crate) fn color(block: &Block, texel: u32) -> Vec3 {
    let [ends, codes] = *block;
    let code = codes >> (2 * texel) & 3;
    let parts = if has_three_colors(block) { 2 } else { 3 };
    if code > parts {
        return Vec3::ZERO;
    }
    let channel = |shift: u32, bits: u32| {
        let wide = |end: u32| {
            let level = (end >> shift & ((1 << bits) - 1)) << (8 - bits);
            level | level >> bits
        };
        ((parts - code) * wide(ends) + code * wide(ends >> 16)) / parts
    };
    Vec3::new(channel(11, 5) as f32, channel(5, 6) as f32, channel(0, 5) as f32) / 255.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use lf_compress::bc1::decode_texel_f32;

    /// Blocks of every kind: four colours, three, equal endpoints; and all indices.
    #[test]
    fn texels_are_those_of_the_codec() {
        for i in 0..4096u32 {
            let hash = i.wrapping_mul(0x9E37_79B9).wrapping_mul(i | 1);
            let ends = if i % 3 == 0 { (hash & 0xffff) * 0x1_0001 } else { hash };
            let indices = if i % 2 == 0 { hash.rotate_left(13) } else { hash & 0x5555_5555 };
            let bytes = (u64::from(ends) | u64::from(indices) << 32).to_le_bytes();
            for texel in 0..16 {
                let [r, g, b, _] = decode_texel_f32(&bytes, texel as usize % 4, texel as usize / 4);
                let apart = (color(&words(&bytes), texel) - Vec3::new(r, g, b)).abs().max_element();
                assert!(apart < 1e-6, "{ends:x} {indices:x} {texel}");
            }
        }
    }
}

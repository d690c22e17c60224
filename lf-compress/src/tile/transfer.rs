//! The prediction of indices in vector form, for the decoder; `block.rs` defines it.
//!
//! Endpoints lie in the 16-bit lanes of one vector as r0 r1 g0 g1 b0 b1 and two zeros, so that sums over the channels
//! are two additions of the vector turned by a pair. No sum exceeds 3·63², which 16 bits hold.

use fearless_simd::prelude::*;
use fearless_simd::{i16x8, i32x4, u16x8, u32x4};

use super::block::{Block, EVEN};

/// For each set of palette entries, as bits, the coefficients that make of an index' low bit l and high bit h whether
/// the entry is in the set: `c0 ⊕ c1·l ⊕ c2·h ⊕ c3·l·h`.
const MEMBER: [[u32; 4]; 16] = {
    let mut member = [[0; 4]; 16];
    let mut set = 0;
    while set < 16 {
        let (t0, t1, t2, t3) = (set as u32 & 1, set as u32 >> 1 & 1, set as u32 >> 2 & 1, set as u32 >> 3);
        member[set] = [t0 * EVEN, (t0 ^ t1) * EVEN, (t0 ^ t2) * EVEN, (t0 ^ t1 ^ t2 ^ t3) * EVEN];
        set += 1;
    }
    member
};

/// As [`block::transfer`](super::block::transfer).
#[inline(always)]
pub(super) fn transfer<S: Simd>(simd: S, ends: u32, neighbour: Block) -> u32 {
    if ends == neighbour.ends {
        return neighbour.indices;
    }
    let (second, from) = (twice(ends >> 16), levels(simd, neighbour.ends));
    let origin = levels(simd, second);
    let axis = levels(simd, twice(ends & 0xffff)) - origin;
    let length = sums((axis * axis).bitcast());
    let near_far = sums(((from - origin) * axis).bitcast());
    let times = |pairs: i16x8<S>, factors: [i16; 8]| -> i32x4<S> {
        pairs.pairwise_dot_product(i16x8::load_array(simd, factors))
    };
    let places = times(near_far, [6, 0, 0, 6, 4, 2, 2, 4]);
    let beyond = |sixths: i16| places.simd_gt(times(length, [sixths, 0, sixths, 0, sixths, 0, sixths, 0])).to_bitmask();
    let (low, high) = (neighbour.indices & EVEN, neighbour.indices >> 1 & EVEN);
    let both = low & high;
    let among = |set: u64| {
        let [c0, c1, c2, c3] = MEMBER[set as usize & 15];
        c0 ^ (c1 & low) ^ (c2 & high) ^ (c3 & both)
    };
    among(!beyond(3)) | among(beyond(1) ^ beyond(5)) << 1
}

/// A colour as both endpoints.
#[inline(always)]
fn twice(color: u32) -> u32 {
    color | color << 16
}

/// Channels of both endpoints, each about 0 to 63.
#[inline(always)]
fn levels<S: Simd>(simd: S, ends: u32) -> i16x8<S> {
    let ends: u16x8<S> = u32x4::splat(simd, ends).bitcast();
    // Shifts the channel to the top, then all down to six bits.
    let tops = ends * u16x8::load_array(simd, [1, 1, 32, 32, 2048, 2048, 0, 0]);
    ((tops >> 10) & u16x8::load_array(simd, [0x3e, 0x3e, 0x3f, 0x3f, 0x3e, 0x3e, 0, 0])).bitcast()
}

/// Sums over the channels, in every pair of lanes.
#[inline(always)]
fn sums<S: Simd>(pairs: u32x4<S>) -> i16x8<S> {
    let one: i16x8<S> = pairs.bitcast();
    let two = one + pairs.rotate_elements_left::<1>().bitcast::<i16x8<S>>();
    let turned: u32x4<S> = two.bitcast();
    two + turned.rotate_elements_left::<2>().bitcast::<i16x8<S>>()
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    use super::super::block;
    use super::*;

    proptest! {
        #[test]
        fn vectors_predict_as_scalars_do(mut ends: u32, near in 0_u32..4, flat: bool, neighbour: (u32, u32)) {
            if flat {
                ends = twice(ends & 0xffff);
            }
            // Also neighbours whose endpoints are the same or almost.
            let other = if near == 3 { neighbour.0 } else { ends ^ near };
            let neighbour = Block { ends: other, indices: neighbour.1 };
            let expected = block::transfer(ends, neighbour);
            for level in [Level::new(), Level::fallback()] {
                let found = dispatch!(level, simd => transfer(simd, ends, neighbour));
                prop_assert_eq!(found, expected);
            }
        }
    }
}

//! Optimal endpoints for a block of one colour.
//!
//! The 565 grid misses 8-bit values by up to 4, but interpolated entries lie between its points, and the three
//! channels choose their pairs of levels independently. So for each 8-bit value one table names the pair of levels
//! whose index-2 entry `⌊(2·e0 + e1) / 3⌋` comes nearest. Equal pairs take part, so the endpoints themselves are
//! covered. Index 3 gives the same set with the endpoints exchanged.

use super::decode::{expand, third};

/// A pair of endpoint levels, `[e0, e1]`.
type Pair = [u8; 2];

static PAIRS5: [Pair; 256] = nearest_pairs::<5>();
static PAIRS6: [Pair; 256] = nearest_pairs::<6>();

/// The endpoints, each as 565 bits, whose index-2 entry comes nearest to `rgb` in every channel.
///
/// They are in no particular order: where the first is the smaller, exchange them and use index 3.
pub(super) fn solid_endpoints([r, g, b]: [u8; 3]) -> (u16, u16) {
    let pairs = [PAIRS5[usize::from(r)], PAIRS6[usize::from(g)], PAIRS5[usize::from(b)]];
    let color = |end: usize| u16::from(pairs[0][end]) << 11 | u16::from(pairs[1][end]) << 5 | u16::from(pairs[2][end]);
    (color(0), color(1))
}

const fn nearest_pairs<const BITS: u32>() -> [Pair; 256] {
    let exact = exact_pairs::<BITS>();
    let mut nearest = [[0, 0]; 256];
    let mut value = 0;
    while value < 256 {
        nearest[value] = nearest_exact(&exact, value);
        value += 1;
    }
    nearest
}

/// For each 8-bit value, the closest pair of levels that yields it exactly, if one does.
///
/// The closest, because decoders that round the interpolation differently then agree best.
const fn exact_pairs<const BITS: u32>() -> [Option<Pair>; 256] {
    let mut exact: [Option<Pair>; 256] = [None; 256];
    let mut packed: u16 = 0;
    while packed < 1 << (2 * BITS) {
        let pair = [(packed >> BITS) as u8, (packed & ((1 << BITS) - 1)) as u8];
        let value = third(expand::<BITS>(pair[0]), expand::<BITS>(pair[1])) as usize;
        exact[value] = match exact[value] {
            Some(old) if old[0].abs_diff(old[1]) <= pair[0].abs_diff(pair[1]) => Some(old),
            _ => Some(pair),
        };
        packed += 1;
    }
    exact
}

/// The pair of the reachable value nearest to `value`, the lower of two equally near.
const fn nearest_exact(exact: &[Option<Pair>; 256], value: usize) -> Pair {
    let mut distance = 0;
    // Ends: 0 is reachable, so at the latest when distance == value.
    loop {
        if value >= distance
            && let Some(pair) = exact[value - distance]
        {
            return pair;
        }
        if value + distance < 256
            && let Some(pair) = exact[value + distance]
        {
            return pair;
        }
        distance += 1;
    }
}

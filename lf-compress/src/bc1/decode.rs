//! Palette arithmetic and the decoding of single blocks and texels; `group.rs` decodes many blocks at once. The encoder
//! measures its error against the same palette.

pub(super) mod group;

use super::Texel;
use group::Decoded;

const TRANSPARENT_BLACK: Texel = [0, 0, 0, 0];

/// Widens a level of `BITS` (5 or 6) bits to 8 by bit replication, so the extremes map to 0 and 255.
pub(super) const fn expand<const BITS: u32>(level: u8) -> u8 {
    level << (8 - BITS) | level >> (2 * BITS - 8)
}

/// One channel of the entry a third of the way from `near` to `far`: `⌊(2·near + far) / 3⌋`.
///
/// 8-bit operands, integer division, no rounding term.
pub(super) const fn third(near: u8, far: u8) -> u8 {
    ((2 * near as u16 + far as u16) / 3) as u8
}

const fn half(a: u8, b: u8) -> u8 {
    ((a as u16 + b as u16) / 2) as u8
}

/// Splits an endpoint `rrrrrggg gggbbbbb` and widens each channel to 8 bits.
pub(super) const fn unpack565(color: u16) -> [u8; 3] {
    let red = (color >> 11) as u8;
    let green = (color >> 5 & 0x3f) as u8;
    let blue = (color & 0x1f) as u8;
    [expand::<5>(red), expand::<6>(green), expand::<5>(blue)]
}

const fn opaque([r, g, b]: [u8; 3]) -> Texel {
    [r, g, b, 255]
}

/// The four colours that the indices 0 to 3 select.
fn palette(color0: u16, color1: u16) -> [Texel; 4] {
    let (a, b) = (unpack565(color0), unpack565(color1));
    let mix = |f: fn(u8, u8) -> u8, a: [u8; 3], b: [u8; 3]| opaque([f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2])]);
    if color0 > color1 {
        [opaque(a), opaque(b), mix(third, a, b), mix(third, b, a)]
    } else {
        [opaque(a), opaque(b), mix(half, a, b), TRANSPARENT_BLACK]
    }
}

/// Splits a block into its endpoints and its 32 index bits, texel 0 lowest.
fn split(block: &[u8; 8]) -> (u16, u16, u32) {
    let &[a, b, c, d, e, f, g, h] = block;
    (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]), u32::from_le_bytes([e, f, g, h]))
}

/// Decodes one block to 4×4 texels in row-major order.
///
/// Every bit pattern is a valid block. With `color0 > color1` all texels are opaque; otherwise index 2 is the
/// midpoint of the endpoints and index 3 is transparent black, `[0, 0, 0, 0]`.
pub fn decode_block(block: &[u8; 8]) -> [Texel; 16] {
    let (color0, color1, indices) = split(block);
    let colors = palette(color0, color1);
    std::array::from_fn(|i| colors[(indices >> (2 * i) & 3) as usize])
}

/// Decodes the texel in column `x` and row `y` of a block, as [`decode_block`] would.
///
/// Only the two low bits of `x` and `y` are used, so image coordinates can be passed as they are.
#[inline]
pub fn decode_texel(block: &[u8; 8], x: usize, y: usize) -> Texel {
    let (color0, color1, indices) = split(block);
    let index = indices >> (2 * (4 * (y & 3) + (x & 3))) & 3;
    let [near, far, alpha] = SIXTHS[usize::from(color0 > color1)][index as usize];
    let (a, b) = (unpack565(color0), unpack565(color1));
    let mix = |c: usize| ((near * u16::from(a[c]) + far * u16::from(b[c])) / 6) as u8;
    [mix(0), mix(1), mix(2), alpha as u8]
}

/// Sixths of the first and the second endpoint in a palette's entries, and their alpha, for 3 and for 4 colours: all
/// entries by one formula, as branches on indices are hard to predict.
const SIXTHS: [[[u16; 3]; 4]; 2] =
    [[[6, 0, 255], [0, 6, 255], [3, 3, 255], [0, 0, 0]], [[6, 0, 255], [0, 6, 255], [4, 2, 255], [2, 4, 255]]];

/// Decodes a texel as [`decode_texel`] does, to 0 to 1: every channel is its 8-bit level divided by 255.
///
/// The levels are taken as they come; nothing is converted from sRGB to linear.
#[inline]
pub fn decode_texel_f32(block: &[u8; 8], x: usize, y: usize) -> [f32; 4] {
    Decoded::from_levels(decode_texel(block, x, y))
}

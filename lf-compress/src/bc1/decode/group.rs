//! Eight blocks side by side: the unit in which images are decoded.
//!
//! The palettes of eight blocks are computed together, one 16-bit lane per endpoint and channel: the endpoints lie in
//! the blocks as pairs of 16-bit words, so both interpolated entries come from one addition of the lanes to their
//! swapped neighbours, `2·v + swap(v)`. Interleaving the channels puts the 16 bytes of a palette into one 128-bit block
//! of a register. A row of four texels is one byte of indices; a table has for each such byte the shuffle that takes
//! the 16 bytes of the palette to those of the row. Row after row the group then writes 128 bytes, two cache lines.
//!
//! Speed is that of writing the output to the cache or memory it goes to.

use fearless_simd::{Simd, f32x8, i32x8, mask16x16, prelude::*, u8x16, u8x32, u16x16, u32x8, u64x4};

use super::decode_block;
use crate::bc1::{BLOCK_BYTES, Texel};

/// Blocks of a group.
const BLOCKS: usize = 8;

/// Bytes of a group of blocks.
pub(in crate::bc1) const GROUP_BYTES: usize = BLOCKS * BLOCK_BYTES;

/// Texels in a row of a group.
pub(in crate::bc1) const GROUP_WIDTH: usize = 4 * BLOCKS;

/// Four rows of texels of a group.
pub(in crate::bc1) type GroupRows<'a, T> = [&'a mut [T; GROUP_WIDTH]; 4];

/// A way to decode groups; all ways agree to the bit.
pub(in crate::bc1) trait GroupDecoder: Copy {
    /// Decodes eight blocks into the four rows of texels that they cover.
    fn decode_group<T: Decoded>(self, blocks: &[u8; GROUP_BYTES], rows: GroupRows<'_, T>);
}

/// One block after another, without vectors.
#[derive(Clone, Copy)]
pub(in crate::bc1) struct Scalar;

impl GroupDecoder for Scalar {
    fn decode_group<T: Decoded>(self, blocks: &[u8; GROUP_BYTES], mut rows: GroupRows<'_, T>) {
        for (x, block) in blocks.as_chunks::<BLOCK_BYTES>().0.iter().enumerate() {
            let texels = decode_block(block).map(T::from_levels);
            for (row, source) in rows.iter_mut().zip(texels.as_chunks::<4>().0) {
                row[4 * x..4 * x + 4].copy_from_slice(source);
            }
        }
    }
}

/// Eight blocks at a time with the vectors of one SIMD level, on little-endian machines.
#[derive(Clone, Copy)]
pub(in crate::bc1) struct Vector<S>(pub(in crate::bc1) S);

impl<S: Simd> GroupDecoder for Vector<S> {
    #[inline(always)]
    fn decode_group<T: Decoded>(self, blocks: &[u8; GROUP_BYTES], rows: GroupRows<'_, T>) {
        T::spread(self.0, palettes(self.0, blocks), blocks, rows);
    }
}

/// A type of texels that images are decoded to.
pub(in crate::bc1) trait Decoded: Copy + Default + Send {
    /// What an RGBA texel of 8 bits a channel becomes.
    fn from_levels(texel: Texel) -> Self;

    /// Writes the texels that the blocks' indices select from their palettes, two palettes to a vector.
    fn spread<S: Simd>(simd: S, palettes: [u8x32<S>; 4], blocks: &[u8; GROUP_BYTES], rows: GroupRows<'_, Self>);
}

impl Decoded for Texel {
    #[inline]
    fn from_levels(texel: Texel) -> Self {
        texel
    }

    #[inline(always)]
    fn spread<S: Simd>(simd: S, palettes: [u8x32<S>; 4], blocks: &[u8; GROUP_BYTES], rows: GroupRows<'_, Self>) {
        for (y, row) in rows.into_iter().enumerate() {
            for (pair, out) in row.as_flattened_mut().as_chunks_mut::<32>().0.iter_mut().enumerate() {
                let left = row_shuffle(simd, indices(blocks, 2 * pair, y));
                let right = row_shuffle(simd, indices(blocks, 2 * pair + 1, y));
                palettes[pair].swizzle_dyn_within_blocks(left.combine(right)).store_array(out);
            }
        }
    }
}

impl Decoded for [f32; 4] {
    #[inline]
    fn from_levels(texel: Texel) -> Self {
        texel.map(|level| f32::from(level) / 255.0)
    }

    #[inline(always)]
    fn spread<S: Simd>(simd: S, palettes: [u8x32<S>; 4], blocks: &[u8; GROUP_BYTES], rows: GroupRows<'_, Self>) {
        let mut scaled = [0.0; 16 * BLOCKS];
        for (pair, out) in palettes.iter().zip(scaled.as_chunks_mut::<32>().0) {
            unorm(simd, *pair, out);
        }
        let palettes = scaled.as_chunks::<4>().0.as_chunks::<4>().0;
        for (y, row) in rows.into_iter().enumerate() {
            for ((block, palette), out) in palettes.iter().enumerate().zip(row.as_chunks_mut::<4>().0) {
                let indices = indices(blocks, block, y);
                for (x, texel) in out.iter_mut().enumerate() {
                    *texel = palette[usize::from(indices >> (2 * x) & 3)];
                }
            }
        }
    }
}

/// The indices of one row of one block, two bits each.
#[inline(always)]
fn indices(blocks: &[u8; GROUP_BYTES], block: usize, y: usize) -> u8 {
    blocks[BLOCK_BYTES * block + 4 + y]
}

/// Aligned so that no entry crosses a cache line.
#[repr(align(64))]
struct Shuffles([[u8; 16]; 256]);

/// For each byte of indices the byte shuffle that takes a palette to the row's four texels.
static ROW_SHUFFLES: Shuffles = Shuffles(row_shuffles());

#[inline(always)]
fn row_shuffle<S: Simd>(simd: S, indices: u8) -> u8x16<S> {
    u8x16::load_array_ref(simd, &ROW_SHUFFLES.0[usize::from(indices)])
}

const fn row_shuffles() -> [[u8; 16]; 256] {
    let mut table = [[0; 16]; 256];
    let mut i = 0;
    while i < 256 * 16 {
        let (indices, byte) = (i / 16, i % 16);
        let entry = indices >> (2 * (byte / 4)) & 3;
        table[indices][byte] = (4 * entry + byte % 4) as u8;
        i += 1;
    }
    table
}

/// The palettes of eight blocks, two to a vector, each four RGBA texels.
///
/// Written without `map`: closures that hold vectors may be compiled without the vectors' instructions.
#[inline(always)]
fn palettes<S: Simd>(simd: S, blocks: &[u8; GROUP_BYTES]) -> [u8x32<S>; 4] {
    let endpoints = endpoints(simd, blocks);
    let near = channels(endpoints);
    let far = [swap(simd, near[0]), swap(simd, near[1]), swap(simd, near[2])];
    let thirds = pack(simd, [third(near[0], far[0]), third(near[1], far[1]), third(near[2], far[2])]);
    let ends = pack(simd, near);
    let halves = [half(ends[0], swap(simd, ends[0])), half(ends[1], swap(simd, ends[1]))];

    // In the 3-colour mode entry 3, the upper of two lanes, is transparent black.
    let entry_2: u16x16<S> = u32x8::splat(simd, 0xffff).bitcast();
    let four_colours = four_colours(simd, endpoints);
    let red_green = four_colours.select(thirds[0], halves[0] & entry_2);
    let blue_alpha = four_colours.select(thirds[1], halves[1] & entry_2);

    let ends = interleave(ends);
    let mids = interleave([red_green, blue_alpha]);
    [
        ends[0].zip_low(mids[0]).bitcast(),
        ends[0].zip_high(mids[0]).bitcast(),
        ends[1].zip_low(mids[1]).bitcast(),
        ends[1].zip_high(mids[1]).bitcast(),
    ]
}

/// `color0` and `color1` of the eight blocks, alternating.
#[inline(always)]
fn endpoints<S: Simd>(simd: S, blocks: &[u8; GROUP_BYTES]) -> u16x16<S> {
    let halves = blocks.as_chunks::<32>().0;
    let left: u32x8<S> = u8x32::load_array_ref(simd, &halves[0]).bitcast();
    let right: u32x8<S> = u8x32::load_array_ref(simd, &halves[1]).bitcast();
    left.unzip_low(right).bitcast()
}

/// Red, green and blue of 565 colours, widened to 8 bits by bit replication.
#[inline(always)]
fn channels<S: Simd>(color: u16x16<S>) -> [u16x16<S>; 3] {
    [color >> 8 & 0xf8 | color >> 13, color >> 3 & 0xfc | color >> 9 & 0x03, color << 3 & 0xf8 | color >> 2 & 0x07]
}

/// Red with green and blue with an alpha of 255, two bytes to a lane.
#[inline(always)]
fn pack<S: Simd>(simd: S, [red, green, blue]: [u16x16<S>; 3]) -> [u16x16<S>; 2] {
    [red | green << 8, blue | u16x16::splat(simd, 0xff00)]
}

/// Whole colours, the two of a block to a lane.
#[inline(always)]
fn interleave<S: Simd>([red_green, blue_alpha]: [u16x16<S>; 2]) -> [u64x4<S>; 2] {
    [red_green.zip_low(blue_alpha).bitcast(), red_green.zip_high(blue_alpha).bitcast()]
}

/// The other lane of the same block.
#[inline(always)]
fn swap<S: Simd>(simd: S, lanes: u16x16<S>) -> u16x16<S> {
    pick(simd, lanes, &[2, 3, 0, 1, 6, 7, 4, 5, 10, 11, 8, 9, 14, 15, 12, 13])
}

/// Whether a block has four colours, `color0 > color1`, in both of its lanes.
#[inline(always)]
fn four_colours<S: Simd>(simd: S, endpoints: u16x16<S>) -> mask16x16<S> {
    let color0 = pick(simd, endpoints, &[0, 1, 0, 1, 4, 5, 4, 5, 8, 9, 8, 9, 12, 13, 12, 13]);
    let color1 = pick(simd, endpoints, &[2, 3, 2, 3, 6, 7, 6, 7, 10, 11, 10, 11, 14, 15, 14, 15]);
    color0.simd_gt(color1)
}

/// Bytes picked from each 128 bits.
#[inline(always)]
fn pick<S: Simd>(simd: S, lanes: u16x16<S>, bytes: &[u8; 16]) -> u16x16<S> {
    lanes.swizzle_dyn_within_blocks(u8x32::block_splat(u8x16::load_array_ref(simd, bytes)))
}

/// `⌊(a + b) / 2⌋` of the two bytes of each lane: the bits in common and half of those that differ.
#[inline(always)]
fn half<S: Simd>(a: u16x16<S>, b: u16x16<S>) -> u16x16<S> {
    (a & b) + ((a ^ b) >> 1 & 0x7f7f)
}

/// `⌊(2·near + far) / 3⌋` of 8-bit values, in 16 bits.
///
/// With the sum `s = 3·q + r ≤ 765` the code computes `⌊(85·s + ⌊s/4⌋ + 70) / 256⌋`. The dividend is
/// `256·q + (85·r + 70 − (q − ⌊s/4⌋))`. As `s/3 − s/4 = s/12`, the last term is from 0 to 64, so what is added to `256·q`
/// is from 6 to 240: the quotient is `q`. The dividend is at most 65286.
#[inline(always)]
fn third<S: Simd>(near: u16x16<S>, far: u16x16<S>) -> u16x16<S> {
    let sum = near + near + far;
    (sum * 85 + (sum >> 2) + 70) >> 8
}

/// 32 levels divided by 255.
#[inline(always)]
fn unorm<S: Simd>(simd: S, levels: u8x32<S>, out: &mut [f32; 32]) {
    let (low, high) = levels.widen();
    let ((a, b), (c, d)) = (low.widen(), high.widen());
    for (lanes, out) in [a, b, c, d].iter().zip(out.as_chunks_mut::<8>().0) {
        // Small values are the same signed, and signed conversion is one instruction everywhere.
        let lanes: i32x8<S> = lanes.bitcast();
        (f32x8::float_from(lanes) / f32x8::splat(simd, 255.0)).store_array(out);
    }
}

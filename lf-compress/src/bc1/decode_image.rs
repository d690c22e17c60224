//! Whole images, decoded row of blocks by row of blocks.
//!
//! A row of blocks covers up to four rows of texels. Groups of blocks that lie wholly in the image are written in
//! place; those that reach past its edges are decoded to the stack and cut.

use std::array;

use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

use super::decode::group::{Decoded, GROUP_BYTES, GROUP_WIDTH, GroupDecoder, Scalar, Vector};
use super::layout::Layout;
use super::{Bc1Error, Texel};

/// Decodes row-major blocks to a row-major image of `width` × `height` texels; what the edge blocks hold beyond is cut.
///
/// Rows of blocks are shared among the threads of the current rayon pool.
///
/// # Errors
///
/// [`Bc1Error::EmptyImage`] for a side of zero, [`Bc1Error::BlockBytes`] unless `blocks` holds exactly
/// ⌈width / 4⌉ · ⌈height / 4⌉ · 8 bytes, [`Bc1Error::TooLarge`] if the texels exceed the address space.
pub fn decode_image(width: u32, height: u32, blocks: &[u8]) -> Result<Vec<Texel>, Bc1Error> {
    decode_parallel(width, height, blocks)
}

/// Decodes an image as [`decode_image`] does, to 0 to 1: every channel is its 8-bit level divided by 255.
///
/// The levels are taken as they come; nothing is converted from sRGB to linear.
///
/// # Errors
///
/// As of [`decode_image`].
pub fn decode_image_f32(width: u32, height: u32, blocks: &[u8]) -> Result<Vec<[f32; 4]>, Bc1Error> {
    decode_parallel(width, height, blocks)
}

/// Decodes row-major blocks into a buffer of the caller's, on the calling thread alone.
///
/// Texel (x, y) becomes `out[y * stride + x]`; no other texel of `out` is touched. `stride` counts texels. With a
/// height of at most 4 this decodes a single row of blocks.
///
/// # Errors
///
/// As of [`decode_image`], and [`Bc1Error::Stride`] if `stride` is less than `width`, [`Bc1Error::BufferTexels`] if
/// `out` is shorter than (height − 1) · stride + width.
pub fn decode_image_into(
    width: u32,
    height: u32,
    blocks: &[u8],
    out: &mut [Texel],
    stride: usize,
) -> Result<(), Bc1Error> {
    decode_serial(Level::new(), width, height, blocks, out, stride)
}

/// Decodes into a buffer of the caller's as [`decode_image_into`] does, to the values of [`decode_image_f32`].
///
/// # Errors
///
/// As of [`decode_image_into`].
pub fn decode_image_f32_into(
    width: u32,
    height: u32,
    blocks: &[u8],
    out: &mut [[f32; 4]],
    stride: usize,
) -> Result<(), Bc1Error> {
    decode_serial(Level::new(), width, height, blocks, out, stride)
}

fn decode_parallel<T: Decoded>(width: u32, height: u32, blocks: &[u8]) -> Result<Vec<T>, Bc1Error> {
    let layout = Layout::new::<T>(width, height)?;
    layout.check_blocks(blocks)?;
    let level = Level::new();
    let mut texels = vec![T::default(); layout.texels];
    let strips = texels.par_chunks_mut(4 * layout.width).zip(blocks.par_chunks(layout.row_bytes));
    strips.for_each(|(strip, row)| decode_row(level, layout.width, row, strip, layout.width));
    Ok(texels)
}

fn decode_serial<T: Decoded>(
    level: Level,
    width: u32,
    height: u32,
    blocks: &[u8],
    out: &mut [T],
    stride: usize,
) -> Result<(), Bc1Error> {
    let layout = Layout::new::<T>(width, height)?;
    layout.check_blocks(blocks)?;
    let span = layout.span(out.len(), stride)?;
    let out = &mut out[..span];
    let strips = out.chunks_mut(stride.saturating_mul(4)).zip(blocks.chunks_exact(layout.row_bytes));
    strips.for_each(|(strip, row)| decode_row(level, layout.width, row, strip, stride));
    Ok(())
}

/// Decodes one row of blocks into the rows of texels that begin in `strip`, one every `stride` texels.
fn decode_row<T: Decoded>(level: Level, width: usize, blocks: &[u8], strip: &mut [T], stride: usize) {
    if shuffles_bytes(level) {
        dispatch!(level, simd => decode_groups(Vector(simd), width, blocks, strip, stride));
    } else {
        decode_groups(Scalar, width, blocks, strip, stride);
    }
}

/// Whether a shuffle of bytes is one instruction; without it, and on big-endian machines, scalar code is the faster.
fn shuffles_bytes(level: Level) -> bool {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    return level.as_sse4_2().is_some();
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    return !level.is_fallback() && cfg!(target_endian = "little");
}

#[inline(always)]
fn decode_groups<T: Decoded>(decoder: impl GroupDecoder, width: usize, blocks: &[u8], strip: &mut [T], stride: usize) {
    let mut lines = strip.chunks_mut(stride);
    // Below the image's last row there is nothing to write to.
    let mut rows: [&mut [T]; 4] = array::from_fn(|_| lines.next().map_or(&mut [][..], |line| &mut line[..width]));
    let inside = rows.iter().map(|row| row.len()).min().unwrap_or(0) / GROUP_WIDTH;

    let [a, b, c, d] = rows.each_mut().map(|row| row.as_chunks_mut::<GROUP_WIDTH>().0);
    let whole = a.iter_mut().zip(b).zip(c).zip(d).map(|(((a, b), c), d)| [a, b, c, d]);
    for (blocks, rows) in blocks.as_chunks::<GROUP_BYTES>().0.iter().zip(whole) {
        decoder.decode_group(blocks, rows);
    }

    for (group, blocks) in blocks.chunks(GROUP_BYTES).enumerate().skip(inside) {
        decode_edge(decoder, blocks, rows.each_mut().map(|row| row.get_mut(GROUP_WIDTH * group..).unwrap_or_default()));
    }
}

/// Decodes a group of which only a part lies in the image: fewer than eight blocks, or past the right or bottom edge.
#[inline(always)]
fn decode_edge<T: Decoded>(decoder: impl GroupDecoder, blocks: &[u8], rows: [&mut [T]; 4]) {
    let mut padded = [0; GROUP_BYTES];
    padded[..blocks.len()].copy_from_slice(blocks);
    let mut decoded = [[T::default(); GROUP_WIDTH]; 4];
    decoder.decode_group(&padded, decoded.each_mut());
    for (row, decoded) in rows.into_iter().zip(&decoded) {
        let width = row.len().min(GROUP_WIDTH);
        row[..width].copy_from_slice(&decoded[..width]);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::decode_block;
    use super::super::levels::levels;
    use super::*;

    /// A buffer of rows `stride` apart with the image decoded block by block, `outside` everywhere else.
    fn reference<T: Decoded>(width: usize, height: usize, blocks: &[u8], stride: usize, outside: T) -> Vec<T> {
        let mut buffer = vec![outside; height * stride + 3];
        for (i, block) in blocks.as_chunks::<8>().0.iter().enumerate() {
            let (left, top) = (4 * (i % width.div_ceil(4)), 4 * (i / width.div_ceil(4)));
            for (n, texel) in decode_block(block).into_iter().enumerate() {
                let (x, y) = (left + n % 4, top + n / 4);
                if x < width && y < height {
                    buffer[y * stride + x] = T::from_levels(texel);
                }
            }
        }
        buffer
    }

    /// Compares all levels with `decode_block`, for an image and what lies around it.
    fn check<T>(width: usize, height: usize, blocks: &[u8], stride: usize, outside: T) -> Result<(), TestCaseError>
    where
        T: Decoded + PartialEq + std::fmt::Debug,
    {
        let expected = reference(width, height, blocks, stride, outside);
        for level in levels() {
            let mut buffer = vec![outside; expected.len()];
            let decoded = decode_serial(level, width as u32, height as u32, blocks, &mut buffer, stride);
            prop_assert_eq!(decoded, Ok(()));
            prop_assert!(buffer == expected, "{level:?} differs at {width}×{height}, stride {stride}");
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn all_levels_agree_on_any_image(
            (width, height) in (1_usize..150, 1_usize..14),
            gap in 0_usize..40,
            bytes in prop::collection::vec(any::<u8>(), 38 * 4 * 8),
        ) {
            let blocks = &bytes[..width.div_ceil(4) * height.div_ceil(4) * 8];
            check(width, height, blocks, width + gap, [1, 2, 3, 4])?;
            check(width, height, blocks, width + gap, [-1.0; 4])?;
        }
    }

    /// Every pair of levels of every channel in both modes: red decides the mode, or runs through its own pairs.
    #[test]
    fn all_levels_agree_on_every_pair_of_channel_levels() -> Result<(), TestCaseError> {
        let mut blocks = Vec::new();
        for (a, b) in (0..64_u16).flat_map(|a| (0..64).map(move |b| (a, b))) {
            for (red0, red1) in [(0_u16, 31_u16), (31, 0), (a >> 1, b >> 1)] {
                blocks.extend((red0 << 11 | a << 5 | a >> 1).to_le_bytes());
                blocks.extend((red1 << 11 | b << 5 | b >> 1).to_le_bytes());
                blocks.extend([0b11_10_01_00; 4]);
            }
        }
        let width = blocks.len() / 2;
        check(width, 4, &blocks, width, [0; 4])?;
        check(width, 4, &blocks, width, [0.0; 4])
    }
}

//! Decoding of whole images through the public API, against two independent decoders.

use lf_compress::bc1::{
    Bc1Error, Texel, decode_block, decode_image, decode_image_f32, decode_image_f32_into, decode_image_into,
    decode_texel, decode_texel_f32,
};
use proptest::collection::vec;
use proptest::prelude::*;

/// Blocks for any image of up to 130×21 texels.
const BLOCKS: usize = 33 * 6;

fn block_bytes(width: u32, height: u32) -> usize {
    (width.div_ceil(4) * height.div_ceil(4) * 8) as usize
}

/// An image as texture2ddecoder sees it; it truncates interpolated entries as this crate does.
fn oracle(width: u32, height: u32, blocks: &[u8]) -> Vec<Texel> {
    let (w, h) = (width as usize, height as usize);
    let mut bgra = vec![0; w * h];
    texture2ddecoder::decode_bc1a(blocks, w, h, &mut bgra).unwrap();
    let rgba = |word: u32| {
        let [b, g, r, a] = word.to_le_bytes();
        [r, g, b, a]
    };
    bgra.into_iter().map(rgba).collect()
}

fn unorm(texels: &[Texel]) -> Vec<[f32; 4]> {
    texels.iter().map(|texel| texel.map(|level| f32::from(level) / 255.0)).collect()
}

proptest! {
    #[test]
    fn images_match_the_independent_decoder(
        (width, height) in (1_u32..=130, 1_u32..=21),
        bytes in vec(any::<u8>(), BLOCKS * 8),
    ) {
        let blocks = &bytes[..block_bytes(width, height)];
        let expected = oracle(width, height, blocks);
        prop_assert_eq!(&decode_image(width, height, blocks).unwrap(), &expected);
        prop_assert_eq!(decode_image_f32(width, height, blocks).unwrap(), unorm(&expected));
    }

    #[test]
    fn nothing_outside_the_image_is_touched(
        (width, height) in (1_u32..=130, 1_u32..=21),
        (gap, after) in (0_usize..50, 0_usize..50),
        bytes in vec(any::<u8>(), BLOCKS * 8),
    ) {
        let blocks = &bytes[..block_bytes(width, height)];
        let (w, h) = (width as usize, height as usize);
        let stride = w + gap;
        let mut expected = vec![[9; 4]; (h - 1) * stride + w + after];
        for (y, row) in oracle(width, height, blocks).chunks(w).enumerate() {
            expected[y * stride..y * stride + w].copy_from_slice(row);
        }
        let mut buffer = vec![[9; 4]; expected.len()];
        decode_image_into(width, height, blocks, &mut buffer, stride).unwrap();
        prop_assert_eq!(&buffer, &expected);
        let mut buffer = vec![[9.0 / 255.0; 4]; expected.len()];
        decode_image_f32_into(width, height, blocks, &mut buffer, stride).unwrap();
        prop_assert_eq!(buffer, unorm(&expected));
    }

    #[test]
    fn blocks_and_texels_agree(block: [u8; 8], low: bool) {
        // Half of the blocks with equal endpoints or endpoints that differ in one bit.
        let mut block = block;
        if low {
            [block[2], block[3]] = [block[0] ^ block[2] & 1, block[1]];
        }
        let texels = decode_block(&block);
        for (i, &texel) in texels.iter().enumerate() {
            let (x, y) = (i % 4 + 4 * i, i / 4 + 64);
            prop_assert_eq!(decode_texel(&block, x, y), texel);
            prop_assert_eq!(decode_texel_f32(&block, x, y), unorm(&[texel])[0]);
        }
        prop_assert_eq!(&decode_image(4, 4, &block).unwrap()[..], texels);
    }

    /// bcdec rounds the interpolated entries to nearest; formats allow both.
    #[test]
    fn another_rounding_is_at_most_one_level_away(block: [u8; 8]) {
        let mut other = [0; 64];
        bcdec_rs::bc1(&block, &mut other, 16);
        for (ours, other) in decode_block(&block).iter().zip(other.as_chunks::<4>().0) {
            prop_assert!(ours.iter().zip(other).all(|(a, b)| a.abs_diff(*b) <= 1), "{ours:?} {other:?}");
            prop_assert_eq!(ours[3], other[3]);
        }
    }
}

#[test]
fn wrong_blocks_and_sizes_are_refused() {
    let mut out = [[0; 4]; 64];
    let mut into = |width, height, blocks: &[u8]| decode_image_into(width, height, blocks, &mut out, 8);
    assert_eq!(into(0, 4, &[]), Err(Bc1Error::EmptyImage { width: 0, height: 4 }));
    assert_eq!(into(4, 0, &[]), Err(Bc1Error::EmptyImage { width: 4, height: 0 }));
    for found in [0, 15, 17, 24] {
        assert_eq!(into(5, 4, &vec![0; found]), Err(Bc1Error::BlockBytes { expected: 16, found }));
    }
    let too_large = Err(Bc1Error::TooLarge { width: u32::MAX, height: u32::MAX });
    assert_eq!(into(u32::MAX, u32::MAX, &[]), too_large);
    assert_eq!(decode_image_f32(u32::MAX, u32::MAX, &[]).map(|_| ()), too_large);
    assert_eq!(out, [[0; 4]; 64], "a refused image must not be written");
}

#[test]
fn wrong_buffers_are_refused() {
    let blocks = [0xff; 2 * 2 * 8];
    let mut out = [[0; 4]; 64];
    let mut into = |length: usize, stride| decode_image_into(5, 6, &blocks, &mut out[..length], stride);
    assert_eq!(into(64, 4), Err(Bc1Error::Stride { width: 5, stride: 4 }));
    assert_eq!(into(64, 0), Err(Bc1Error::Stride { width: 5, stride: 0 }));
    assert_eq!(into(29, 5), Err(Bc1Error::BufferTexels { expected: 30, found: 29 }));
    assert_eq!(into(44, 8), Err(Bc1Error::BufferTexels { expected: 45, found: 44 }));
    assert_eq!(into(64, usize::MAX), Err(Bc1Error::BufferTexels { expected: usize::MAX, found: 64 }));
    assert_eq!(into(30, 5), Ok(()));
    assert_eq!(into(45, 8), Ok(()));
    // One row of texels needs no stride but must not overflow by it.
    assert_eq!(decode_image_into(5, 1, &blocks[..16], &mut out[..5], usize::MAX), Ok(()));
}

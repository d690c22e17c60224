//! Whole images: gathering and scattering blocks, row of blocks by row of blocks in parallel.

use rayon::prelude::*;

use super::{BLOCK_BYTES, Bc1Error, Quality, Texel, decode_block, encode_block};

/// Sizes that follow from an image's extent, checked once.
struct Layout {
    width: usize,
    height: usize,
    /// Bytes of one row of blocks.
    row_bytes: usize,
    texels: usize,
    bytes: usize,
}

impl Layout {
    fn new(width: u32, height: u32) -> Result<Self, Bc1Error> {
        if width == 0 || height == 0 {
            return Err(Bc1Error::EmptyImage { width, height });
        }
        Self::checked(width, height).ok_or(Bc1Error::TooLarge { width, height })
    }

    /// `None` where the texels would not fit in an allocation.
    fn checked(width: u32, height: u32) -> Option<Self> {
        let (width, height) = (usize::try_from(width).ok()?, usize::try_from(height).ok()?);
        let texels = width.checked_mul(height)?;
        texels.checked_mul(size_of::<Texel>()).filter(|&bytes| isize::try_from(bytes).is_ok())?;
        let row_bytes = width.div_ceil(4).checked_mul(BLOCK_BYTES)?;
        let bytes = row_bytes.checked_mul(height.div_ceil(4)).filter(|&bytes| isize::try_from(bytes).is_ok())?;
        Some(Self { width, height, row_bytes, texels, bytes })
    }
}

/// Encodes an image of any size to row-major blocks, ⌈width / 4⌉ · ⌈height / 4⌉ · 8 bytes.
///
/// `texels` is row-major without gaps. Blocks that reach past the right or bottom edge repeat the last column or row.
/// Rows of blocks are shared among the threads of the current rayon pool; their number does not change the bytes.
///
/// # Errors
///
/// [`Bc1Error::EmptyImage`] for a side of zero, [`Bc1Error::TexelCount`] unless there are width × height texels,
/// [`Bc1Error::TooLarge`] if that product exceeds the address space.
pub fn encode_image(width: u32, height: u32, texels: &[Texel], quality: Quality) -> Result<Vec<u8>, Bc1Error> {
    let layout = Layout::new(width, height)?;
    if texels.len() != layout.texels {
        return Err(Bc1Error::TexelCount { expected: layout.texels, found: texels.len() });
    }
    let mut blocks = vec![0; layout.bytes];
    blocks.par_chunks_mut(layout.row_bytes).enumerate().for_each(|(block_y, row)| {
        for (block_x, block) in row.as_chunks_mut::<BLOCK_BYTES>().0.iter_mut().enumerate() {
            *block = encode_block(&gather(&layout, texels, block_x, block_y), quality);
        }
    });
    Ok(blocks)
}

/// The 4×4 texels of one block; past the image's edge its last column and row repeat.
fn gather(layout: &Layout, texels: &[Texel], block_x: usize, block_y: usize) -> [Texel; 16] {
    let mut block = [[0; 4]; 16];
    for (y, row) in block.as_chunks_mut::<4>().0.iter_mut().enumerate() {
        let start = (4 * block_y + y).min(layout.height - 1) * layout.width;
        let source = &texels[start..start + layout.width];
        match source[4 * block_x..].first_chunk() {
            Some(inside) => *row = *inside,
            None => *row = std::array::from_fn(|x| source[(4 * block_x + x).min(layout.width - 1)]),
        }
    }
    block
}

/// Decodes row-major blocks to a row-major image of `width` × `height` texels; what the edge blocks hold beyond is cut.
///
/// Rows of blocks are shared among the threads of the current rayon pool.
///
/// # Errors
///
/// [`Bc1Error::EmptyImage`] for a side of zero, [`Bc1Error::BlockBytes`] unless `blocks` holds exactly
/// ⌈width / 4⌉ · ⌈height / 4⌉ · 8 bytes, [`Bc1Error::TooLarge`] if the texels exceed the address space.
pub fn decode_image(width: u32, height: u32, blocks: &[u8]) -> Result<Vec<Texel>, Bc1Error> {
    let layout = Layout::new(width, height)?;
    if blocks.len() != layout.bytes {
        return Err(Bc1Error::BlockBytes { expected: layout.bytes, found: blocks.len() });
    }
    let mut texels = vec![[0; 4]; layout.texels];
    let strips = texels.par_chunks_mut(4 * layout.width);
    strips.zip(blocks.par_chunks(layout.row_bytes)).for_each(|(strip, row)| decode_row(layout.width, row, strip));
    Ok(texels)
}

/// Decodes one row of blocks into the up to four rows of texels it covers.
fn decode_row(width: usize, blocks: &[u8], strip: &mut [Texel]) {
    for (block_x, block) in blocks.as_chunks::<BLOCK_BYTES>().0.iter().enumerate() {
        let decoded = decode_block(block);
        let left = 4 * block_x;
        let right = width.min(left + 4);
        for (row, source) in strip.chunks_exact_mut(width).zip(decoded.as_chunks::<4>().0) {
            row[left..right].copy_from_slice(&source[..right - left]);
        }
    }
}

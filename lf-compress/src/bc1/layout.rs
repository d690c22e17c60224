//! Sizes that follow from an image's extent, checked once.

use super::{BLOCK_BYTES, Bc1Error};

/// The extent of an image and of its blocks; both fit in an allocation.
pub(super) struct Layout {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Bytes of one row of blocks.
    pub(super) row_bytes: usize,
    pub(super) texels: usize,
    /// Bytes of all blocks.
    pub(super) bytes: usize,
}

impl Layout {
    /// Of an image whose texels are `T`s.
    pub(super) fn new<T>(width: u32, height: u32) -> Result<Self, Bc1Error> {
        if width == 0 || height == 0 {
            return Err(Bc1Error::EmptyImage { width, height });
        }
        Self::checked(width, height, size_of::<T>()).ok_or(Bc1Error::TooLarge { width, height })
    }

    /// `None` where texels or blocks would not fit in an allocation.
    fn checked(width: u32, height: u32, texel_bytes: usize) -> Option<Self> {
        let (width, height) = (usize::try_from(width).ok()?, usize::try_from(height).ok()?);
        let texels = width.checked_mul(height)?;
        allocatable(texels.checked_mul(texel_bytes)?)?;
        let row_bytes = width.div_ceil(4).checked_mul(BLOCK_BYTES)?;
        let bytes = allocatable(row_bytes.checked_mul(height.div_ceil(4))?)?;
        Some(Self { width, height, row_bytes, texels, bytes })
    }

    /// Refuses blocks of any other length than the image's.
    pub(super) fn check_blocks(&self, blocks: &[u8]) -> Result<(), Bc1Error> {
        if blocks.len() != self.bytes {
            return Err(Bc1Error::BlockBytes { expected: self.bytes, found: blocks.len() });
        }
        Ok(())
    }

    /// The texels of a buffer of `found` that the image's rows span, one beginning every `stride` texels; refuses rows
    /// that overlap and a buffer that ends before the last row does.
    pub(super) fn span(&self, found: usize, stride: usize) -> Result<usize, Bc1Error> {
        if stride < self.width {
            return Err(Bc1Error::Stride { width: self.width, stride });
        }
        // No slice is longer than `isize::MAX`, so a size that saturates is refused.
        let expected = (self.height - 1).saturating_mul(stride).saturating_add(self.width);
        if found < expected { Err(Bc1Error::BufferTexels { expected, found }) } else { Ok(expected) }
    }
}

fn allocatable(bytes: usize) -> Option<usize> {
    isize::try_from(bytes).is_ok().then_some(bytes)
}

//! Images of inverse depth as two planes a block.
//!
//! In a perspective picture the inverse depth of a plane is an affine function of the pixel. A block of 8×8 texels therefore keeps
//! two such functions and a bit for each texel that says which holds: 20 bytes, 2.5 bits a texel. Flat surfaces and the edges
//! between two of them come out to the rounding of half floats, wherever they lie and however steep; curved ones to the second
//! order of their size in the block. Where three surfaces meet in one block one of them is off.
//!
//! Block formats of textures keep values instead (BC4: eight steps between two 8-bit numbers), in which a slanted floor is a
//! staircase: looked up from elsewhere, its pixels land in the wrong places.

mod fit;

use half::f16;
use rayon::prelude::*;

use fit::fit_block;

/// Texels along a side of a block.
pub const BLOCK_EDGE: usize = 8;
/// Texels of a block.
const BLOCK_TEXELS: usize = BLOCK_EDGE * BLOCK_EDGE;
/// Distance of a block's middle from the centre of its first texel.
const MIDDLE: f32 = 0.5 * (BLOCK_EDGE as f32 - 1.0);

/// An affine function over a block: its value in the middle and what it grows by to the next texel along x and along y.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Plane([f16; 3]);

/// One block.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlaneBlock {
    /// The two functions.
    pub planes: [Plane; 2],
    /// Bit `8·y + x` is set where the second one holds.
    pub mask: u64,
}

/// An image of numbers that are at least 0, in blocks.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneImage {
    width: u32,
    height: u32,
    /// Power of two by which the blocks' values are multiplied.
    scale: f32,
    blocks: Vec<PlaneBlock>,
}

impl Plane {
    /// Its value at the centre of the block's first texel, and what it grows by to the next texel along x and along y.
    #[must_use]
    pub fn coefficients(self) -> [f32; 3] {
        let [_, dx, dy] = self.0.map(f16::to_f32);
        [self.at(0, 0), dx, dy]
    }

    fn at(self, x: usize, y: usize) -> f32 {
        let [middle, dx, dy] = self.0.map(f16::to_f32);
        middle + (x as f32 - MIDDLE) * dx + (y as f32 - MIDDLE) * dy
    }
}

impl PlaneBlock {
    /// Bytes of a block: both planes' halves, then the mask, little-endian.
    pub const BYTES: usize = 20;

    /// The value at a texel of the block.
    #[must_use]
    pub fn get(&self, x: usize, y: usize) -> f32 {
        let second = self.mask >> (BLOCK_EDGE * y + x) & 1;
        self.planes[second as usize].at(x, y).max(0.0)
    }

    /// The bytes of the block.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        let halves = self.planes.iter().flat_map(|plane| plane.0);
        for (to, half) in bytes.chunks_exact_mut(2).zip(halves) {
            to.copy_from_slice(&half.to_le_bytes());
        }
        bytes[12..].copy_from_slice(&self.mask.to_le_bytes());
        bytes
    }
}

impl PlaneImage {
    /// Encodes rows of numbers. What is negative or not a number counts as 0, what is infinite as the largest number.
    ///
    /// `None` if there are not `width · height` values, or none at all.
    #[must_use]
    pub fn encode(width: u32, height: u32, values: &[f32]) -> Option<Self> {
        let expected = (width as usize).checked_mul(height as usize)?;
        if values.is_empty() || values.len() != expected {
            return None;
        }
        let largest = values.iter().copied().fold(0.0, f32::max).min(f32::MAX);
        let scale = power_of_two_above(largest);
        let image = |x: usize, y: usize| {
            let value = values[y * width as usize + x];
            if value > 0.0 { value.min(f32::MAX) / scale } else { 0.0 }
        };
        let [across, down] = [width, height].map(|n| (n as usize).div_ceil(BLOCK_EDGE));
        let block = |number: usize| {
            let corner = [number % across * BLOCK_EDGE, number / across * BLOCK_EDGE];
            let size = [width as usize - corner[0], height as usize - corner[1]].map(|rest| rest.min(BLOCK_EDGE));
            fit_block(size, |x, y| image(corner[0] + x, corner[1] + y))
        };
        let blocks = (0..across * down).into_par_iter().map(block).collect();
        Some(Self { width, height, scale, blocks })
    }

    /// Width in texels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in texels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The power of two by which the blocks' values are multiplied.
    #[must_use]
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// The blocks, row after row.
    #[must_use]
    pub fn blocks(&self) -> &[PlaneBlock] {
        &self.blocks
    }

    /// Bytes of all blocks.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.blocks.len() * PlaneBlock::BYTES
    }

    /// The numbers again, row after row: at least 0 and finite.
    #[must_use]
    pub fn decode(&self) -> Vec<f32> {
        let across = (self.width as usize).div_ceil(BLOCK_EDGE);
        let value = |x: usize, y: usize| {
            let block = &self.blocks[y / BLOCK_EDGE * across + x / BLOCK_EDGE];
            // Twice the scale may be past the largest float.
            (block.get(x % BLOCK_EDGE, y % BLOCK_EDGE) * self.scale).min(f32::MAX)
        };
        let (width, height) = (self.width as usize, self.height as usize);
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| value(x, y)).collect()
    }
}

/// The least power of two that is greater than half of a number, so that the quotient is below 2; 1 for 0.
fn power_of_two_above(value: f32) -> f32 {
    if value == 0.0 { 1.0 } else { f32::from_bits((value.to_bits() & 0x7f80_0000).max(0x0080_0000)) }
}

//! Whole images, encoded row of blocks by row of blocks, from any of the usual pixel layouts.

use std::array;

use rayon::prelude::*;

use super::encode::encode_rows;
use super::layout::Layout;
use super::options::{Alpha, EncodeOptions};
use super::{BLOCK_BYTES, Bc1Error, Texel};

/// Encodes an image of any size to row-major blocks, ⌈width / 4⌉ · ⌈height / 4⌉ · 8 bytes.
///
/// `texels` is row-major without gaps. A [`Quality`](super::Quality) will do for the options. Blocks that reach past the
/// right or bottom edge repeat the last column or row. Rows of blocks are shared among the threads of the current rayon
/// pool; their number does not change the bytes.
///
/// # Errors
///
/// [`Bc1Error::EmptyImage`] for a side of zero, [`Bc1Error::TexelCount`] unless there are width × height texels,
/// [`Bc1Error::TooLarge`] if that product exceeds the address space, [`Bc1Error::NotOpaque`] if alpha is to be refused
/// and there is some.
pub fn encode_image(
    width: u32,
    height: u32,
    texels: &[Texel],
    options: impl Into<EncodeOptions>,
) -> Result<Vec<u8>, Bc1Error> {
    let layout = Layout::new::<Texel>(width, height)?;
    if texels.len() != layout.texels {
        return Err(Bc1Error::TexelCount { expected: layout.texels, found: texels.len() });
    }
    encode_pixels(width, height, Pixels::Rgba8(texels.as_flattened()), layout.width, options)
}

/// Pixels in memory, row-major; values are taken as they come, sRGB-encoded or linear.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Pixels<'a> {
    /// Red, green, blue and alpha, 0 to 255.
    Rgba8(&'a [u8]),
    /// Red, green and blue, 0 to 255.
    Rgb8(&'a [u8]),
    /// Red, green, blue and alpha, 0 to 1. What is beyond is clamped, infinite or not; NaN becomes 0.
    RgbaF32(&'a [f32]),
    /// Red, green and blue as in [`Self::RgbaF32`].
    RgbF32(&'a [f32]),
}

impl Pixels<'_> {
    /// Numbers a pixel.
    fn channels(&self) -> usize {
        match self {
            Self::Rgba8(_) | Self::RgbaF32(_) => 4,
            Self::Rgb8(_) | Self::RgbF32(_) => 3,
        }
    }

    /// Whole pixels.
    fn len(&self) -> usize {
        match self {
            Self::Rgba8(values) | Self::Rgb8(values) => values.len() / self.channels(),
            Self::RgbaF32(values) | Self::RgbF32(values) => values.len() / self.channels(),
        }
    }

    /// Appends the pixels from `start` on to `row`, as 8-bit RGBA.
    fn append(&self, start: usize, len: usize, row: &mut Vec<Texel>) {
        let values = self.channels() * start..self.channels() * (start + len);
        match self {
            Self::Rgba8(all) => row.extend_from_slice(all[values].as_chunks().0),
            Self::Rgb8(all) => row.extend(all[values].as_chunks().0.iter().map(|&[r, g, b]| [r, g, b, 255])),
            Self::RgbaF32(all) => row.extend(all[values].as_chunks::<4>().0.iter().map(|rgba| rgba.map(to_u8))),
            Self::RgbF32(all) => {
                row.extend(
                    all[values].as_chunks::<3>().0.iter().map(|rgb| rgb.map(to_u8)).map(|[r, g, b]| [r, g, b, 255]),
                );
            }
        }
    }
}

/// The nearest of 256 levels; a cast of NaN gives 0.
fn to_u8(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Encodes an image from pixels of any layout; row `y` starts at pixel `y * stride`.
///
/// Otherwise as [`encode_image`].
///
/// # Errors
///
/// As of [`encode_image`], but [`Bc1Error::Stride`] if `stride` is less than `width` and [`Bc1Error::BufferTexels`] if
/// there are fewer than (height − 1) · stride + width pixels.
pub fn encode_pixels(
    width: u32,
    height: u32,
    pixels: Pixels<'_>,
    stride: usize,
    options: impl Into<EncodeOptions>,
) -> Result<Vec<u8>, Bc1Error> {
    let image = Source::new(width, height, pixels, stride, options.into())?;
    let mut blocks = vec![0; image.layout.bytes];
    let rows = blocks.par_chunks_mut(image.layout.row_bytes).enumerate();
    rows.try_for_each(|(strip, blocks)| image.encode_strip(strip, blocks))?;
    Ok(blocks)
}

/// Encodes into a buffer of the caller's as [`encode_pixels`] does, on the calling thread alone.
///
/// # Errors
///
/// As of [`encode_pixels`], and [`Bc1Error::BlockBytes`] unless `blocks` holds exactly
/// ⌈width / 4⌉ · ⌈height / 4⌉ · 8 bytes.
pub fn encode_pixels_into(
    width: u32,
    height: u32,
    pixels: Pixels<'_>,
    stride: usize,
    options: impl Into<EncodeOptions>,
    blocks: &mut [u8],
) -> Result<(), Bc1Error> {
    let image = Source::new(width, height, pixels, stride, options.into())?;
    image.layout.check_blocks(blocks)?;
    let mut rows = blocks.chunks_mut(image.layout.row_bytes).enumerate();
    rows.try_for_each(|(strip, blocks)| image.encode_strip(strip, blocks))
}

/// An image to encode, whose pixels are known to cover its extent.
struct Source<'a> {
    layout: Layout,
    pixels: Pixels<'a>,
    stride: usize,
    options: EncodeOptions,
}

impl<'a> Source<'a> {
    fn new(
        width: u32,
        height: u32,
        pixels: Pixels<'a>,
        stride: usize,
        options: EncodeOptions,
    ) -> Result<Self, Bc1Error> {
        let layout = Layout::new::<Texel>(width, height)?;
        layout.span(pixels.len(), stride)?;
        Ok(Self { layout, pixels, stride, options })
    }

    /// Encodes one row of blocks. RGBA in 8 bits is read where it lies, other pixels are converted first.
    fn encode_strip(&self, strip: usize, blocks: &mut [u8]) -> Result<(), Bc1Error> {
        let (width, blocks) = (self.layout.width, blocks.as_chunks_mut::<BLOCK_BYTES>().0);
        let start = |y: usize| (4 * strip + y).min(self.layout.height - 1) * self.stride;
        if let Pixels::Rgba8(all) = self.pixels {
            let texels = all.as_chunks::<4>().0;
            let rows = array::from_fn(|y| &texels[start(y)..start(y) + width]);
            return encode_strip(rows, 4 * strip, &self.options, blocks);
        }
        let mut texels = Vec::with_capacity(4 * width);
        (0..4).for_each(|y| self.pixels.append(start(y), width, &mut texels));
        encode_strip(array::from_fn(|y| &texels[y * width..][..width]), 4 * strip, &self.options, blocks)
    }
}

/// Encodes a row of blocks; `top` is the number of its first row of texels, for errors.
fn encode_strip(
    rows: [&[Texel]; 4],
    top: usize,
    options: &EncodeOptions,
    blocks: &mut [[u8; BLOCK_BYTES]],
) -> Result<(), Bc1Error> {
    if options.alpha == Alpha::Refuse {
        for (y, row) in rows.iter().enumerate() {
            if let Some(x) = row.iter().position(|texel| texel[3] < 255) {
                return Err(Bc1Error::NotOpaque { x, y: top + y, alpha: row[x][3] });
            }
        }
    }
    encode_rows(rows, options, blocks);
    Ok(())
}

/// Encodes an image that comes row by row, holding at most four rows: for images larger than memory.
///
/// The blocks are those of [`encode_pixels`].
///
/// ```
/// use lf_compress::bc1::{Pixels, Quality, StreamEncoder};
///
/// let mut encoder = StreamEncoder::new(6, Quality::Standard)?;
/// let mut blocks = Vec::new();
/// for row in [[0u8; 18], [90; 18], [180; 18], [255; 18], [30; 18]] {
///     encoder.push(Pixels::Rgb8(&row), &mut blocks)?;
/// }
/// encoder.finish(&mut blocks)?;
/// assert_eq!(blocks.len(), 4 * 8);
/// # Ok::<(), lf_compress::bc1::Bc1Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct StreamEncoder {
    width: usize,
    options: EncodeOptions,
    /// Rows that wait for a fourth.
    texels: Vec<Texel>,
    /// Rows encoded.
    top: usize,
}

impl StreamEncoder {
    /// For an image of a known width.
    ///
    /// # Errors
    /// [`Bc1Error::EmptyImage`] for a width of zero, [`Bc1Error::TooLarge`] if four rows exceed the address space.
    pub fn new(width: u32, options: impl Into<EncodeOptions>) -> Result<Self, Bc1Error> {
        let layout = Layout::new::<Texel>(width, 4)?;
        Ok(Self { width: layout.width, options: options.into(), texels: Vec::new(), top: 0 })
    }

    /// Takes any number of whole rows without gaps and appends the blocks that are complete, on the calling thread.
    ///
    /// # Errors
    /// [`Bc1Error::TexelCount`] unless the pixels make whole rows, [`Bc1Error::NotOpaque`] as of [`encode_image`].
    pub fn push(&mut self, pixels: Pixels<'_>, blocks: &mut Vec<u8>) -> Result<(), Bc1Error> {
        let rows = pixels.len() / self.width;
        if pixels.len() != rows * self.width {
            return Err(Bc1Error::TexelCount { expected: (rows + 1) * self.width, found: pixels.len() });
        }
        for row in 0..rows {
            pixels.append(row * self.width, self.width, &mut self.texels);
            if self.texels.len() == 4 * self.width {
                self.encode(blocks)?;
            }
        }
        Ok(())
    }

    /// Appends the last row of blocks, where the image's height is no multiple of four.
    ///
    /// # Errors
    /// [`Bc1Error::NotOpaque`] as of [`encode_image`].
    pub fn finish(mut self, blocks: &mut Vec<u8>) -> Result<(), Bc1Error> {
        if self.texels.is_empty() { Ok(()) } else { self.encode(blocks) }
    }

    fn encode(&mut self, blocks: &mut Vec<u8>) -> Result<(), Bc1Error> {
        let last = self.texels.len() / self.width - 1;
        let rows = array::from_fn(|y| &self.texels[y.min(last) * self.width..][..self.width]);
        let start = blocks.len();
        blocks.resize(start + self.width.div_ceil(4) * BLOCK_BYTES, 0);
        encode_strip(rows, self.top, &self.options, blocks[start..].as_chunks_mut().0)?;
        self.texels.clear();
        self.top += 4;
        Ok(())
    }
}

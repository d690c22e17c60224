//! BC1 (DXT1): 4×4 texels in 8 bytes, as texture hardware reads it.
//!
//! A block holds two endpoint colours of 5, 6 and 5 bits, little-endian, the first 16 bits before the second, then
//! sixteen 2-bit indices, row-major from the lowest bit. Where `color0 > color1` as integers, the indices choose
//! among
//!
//! ```text
//! 0: c0    1: c1    2: ⌊(2·c0 + c1) / 3⌋    3: ⌊(c0 + 2·c1) / 3⌋
//! ```
//!
//! with the endpoints widened to 8 bits by bit replication first and the division of integers truncating. Otherwise
//! entry 2 is `⌊(c0 + c1) / 2⌋` and entry 3 transparent black. Format descriptions leave the rounding of the
//! interpolated entries open; software decoders differ there by at most 1/255. The encoder measures its error against
//! the palette above and emits only opaque 4-colour blocks.
//!
//! # Method
//!
//! Sixteen texels are to share a palette of four colours on a line. Three steps make an encoder:
//!
//! 1. **A line.** The principal axis of the texels' colours, by power iteration on their covariance (`axis.rs`); at the
//!    two fastest qualities the diagonal of their bounding box (`quick.rs`).
//! 2. **Endpoints for given palette entries.** If texel `x` takes the entry that has `a` thirds of the first endpoint,
//!    the best endpoints solve a 2×2 linear system per channel. Rounded to 5 or 6 bits each for itself they would lose
//!    much of that, so of the four grid points around the solution the best is taken (`least_squares.rs`).
//! 3. **Entries for given endpoints.** The nearest in colour, by the palette above (`fit.rs`).
//!
//! Steps 2 and 3 alternate (Lloyd, *Least squares quantization in PCM*, 1982) and end in a local optimum that depends on
//! the first assignment. Two things get out of it. A *descent* moves one channel's endpoints by a level while all texels
//! are free to follow (`walk.rs`). *Cluster fit* starts from the best of all ways to cut the texels, ordered along the
//! axis, into four runs (`cluster.rs`): not only from the best cut, but from the best for each set of entries in use,
//! since for near-equal colours the coarse grid matters more than the ideal line. [`Quality`] says how much of that is
//! done. A block of one colour takes its endpoints from a table of the best pair of levels for every value (`solid.rs`).
//!
//! # Speed
//!
//! Eight blocks (AVX2; four or sixteen elsewhere) are searched at once, one per lane, with the same operations for all
//! (`lanes.rs`). The operations are exact or fixed by IEEE 754, and no lane sees another, so the bytes are the same for
//! every instruction set and number of threads.
//!
//! # Options
//!
//! By default errors weigh R, G and B alike, values are taken as they come, sRGB-encoded or not, alpha is ignored, and
//! only opaque 4-colour blocks are written. See [`EncodeOptions`] for channel weights, 3-colour blocks, black and
//! 1-bit alpha.

#![expect(clippy::needless_range_loop, reason = "several arrays are indexed by the same channel or palette entry")]

mod axis;
mod cluster;
mod decode;
mod decode_image;
mod encode;
mod encode_image;
mod fit;
mod lanes;
mod layout;
mod least_squares;
#[cfg(test)]
mod levels;
mod options;
mod palette;
mod quick;
mod search;
mod seeds;
mod solid;
mod three_color;
mod walk;

pub use decode::{decode_block, decode_texel, decode_texel_f32};
pub use decode_image::{decode_image, decode_image_f32, decode_image_f32_into, decode_image_into};
pub use encode::encode_block;
pub use encode_image::{Pixels, StreamEncoder, encode_image, encode_pixels, encode_pixels_into};
pub use options::{Alpha, EncodeOptions, Modes, Quality, Weights};

/// Bytes of one encoded block of 4×4 texels.
pub const BLOCK_BYTES: usize = 8;

/// Red, green, blue and alpha, 8 bits each, in any encoding.
pub type Texel = [u8; 4];

/// Why an image cannot be encoded or decoded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Bc1Error {
    /// The width or the height is zero.
    #[error("the image is {width}×{height} texels; both sides must be at least 1")]
    EmptyImage {
        /// Width in texels.
        width: u32,
        /// Height in texels.
        height: u32,
    },
    /// The slice of texels does not fit the image's size.
    #[error("the image needs {expected} texels, {found} were given")]
    TexelCount {
        /// Width × height.
        expected: usize,
        /// Length of the slice.
        found: usize,
    },
    /// The slice of blocks does not fit the image's size.
    #[error("the image needs {expected} bytes of blocks, {found} were given")]
    BlockBytes {
        /// ⌈width / 4⌉ · ⌈height / 4⌉ · 8.
        expected: usize,
        /// Length of the slice.
        found: usize,
    },
    /// The rows of a buffer would overlap.
    #[error("rows of {width} texels cannot begin every {stride} texels; the stride must be at least the width")]
    Stride {
        /// Texels in a row.
        width: usize,
        /// Texels from the start of one row to the next.
        stride: usize,
    },
    /// The buffer ends before the image's last row does.
    #[error("the image spans {expected} texels of its buffer, {found} were given")]
    BufferTexels {
        /// (height − 1) · stride + width.
        expected: usize,
        /// Length of the buffer.
        found: usize,
    },
    /// A texel is not opaque, and the options refuse that.
    #[error("the texel in column {x} of row {y} has alpha {alpha}, not 255; ignore alpha or give a threshold")]
    NotOpaque {
        /// Column, from the left.
        x: usize,
        /// Row, from the top.
        y: usize,
        /// The texel's alpha.
        alpha: u8,
    },
    /// Weights that are not between 1 and 16 in sum.
    #[error("channel weights {weights:?} must each be at least 1 and sum to at most 16")]
    Weights {
        /// Of red, green and blue.
        weights: [u8; 3],
    },
    /// The image does not fit this machine's address space.
    #[error("an image of {width}×{height} texels does not fit in memory; divide it into parts")]
    TooLarge {
        /// Width in texels.
        width: u32,
        /// Height in texels.
        height: u32,
    },
}

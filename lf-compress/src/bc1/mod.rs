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
//! A block of one colour takes its endpoints from a table of the best pair of levels for every 8-bit value
//! (`solid.rs`). Any other block is fitted: an axis through the mean colour with the endpoints near the outermost
//! projections, every texel to its nearest palette entry (`fit.rs`). [`Quality::Standard`] tries two axes and then
//! solves for the endpoints that are best for the indices found, in the manner of Lloyd's iteration (*Least squares
//! quantization in PCM*, 1982), keeping only what lowers the squared error. Weights are uniform over R, G and B and
//! values are taken as they come, sRGB-encoded or not; alpha is ignored.
//!
//! `cargo bench -p lf-compress` prints speed and PSNR of both qualities. The search is local: it does not visit all
//! orderings of the texels (cluster fit) and does not use 3-colour blocks.

mod block;
mod decode;
mod encode;
mod fit;
mod image;
mod solid;

pub use decode::{decode_block, decode_texel};
pub use encode::encode_block;
pub use image::{decode_image, encode_image};

/// Bytes of one encoded block of 4×4 texels.
pub const BLOCK_BYTES: usize = 8;

/// Red, green, blue and alpha, 8 bits each, in any encoding.
pub type Texel = [u8; 4];

/// How hard the encoder searches; all qualities are deterministic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Quality {
    /// As fast as memory allows.
    Realtime,
    /// One range fit.
    Fast,
    /// The better of two range fits, then least-squares refinement.
    #[default]
    Standard,
    /// Searches further.
    High,
    /// Searches further still.
    Best,
    /// Spares nothing.
    Exhaustive,
}

impl Quality {
    /// All qualities, the fastest first.
    pub const ALL: [Self; 6] = [Self::Realtime, Self::Fast, Self::Standard, Self::High, Self::Best, Self::Exhaustive];
}

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
    /// The image does not fit this machine's address space.
    #[error("an image of {width}×{height} texels does not fit in memory; encode it in parts")]
    TooLarge {
        /// Width in texels.
        width: u32,
        /// Height in texels.
        height: u32,
    },
}

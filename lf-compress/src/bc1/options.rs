//! What a caller can choose.

use std::num::NonZeroU32;

use super::Bc1Error;

/// How hard the encoder searches. Every quality is deterministic; each is slower and better than the one before.
///
/// Speeds and PSNRs beside those of other encoders are measured by `cargo run --release -p lf-bench -- front`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Quality {
    /// The diagonal of the bounding box, in integers: for textures that are encoded anew every frame.
    Realtime,
    /// The same with one least-squares refinement.
    VeryFast,
    /// The principal axis, one least-squares refinement, exact choice of palette entries.
    Fast,
    /// A second refinement. The knee of the curve: what follows gains half as much for ten times the time.
    #[default]
    Standard,
    /// A sweep over the neighbouring endpoint levels.
    High,
    /// Cluster fit over all ordered partitions of the texels, then descent to a local optimum.
    Best,
    /// Descent from every kind of partition: within a few hundredths of a decibel of what the format can hold.
    Exhaustive,
}

impl Quality {
    /// All qualities, the fastest first.
    pub const ALL: [Self; 7] =
        [Self::Realtime, Self::VeryFast, Self::Fast, Self::Standard, Self::High, Self::Best, Self::Exhaustive];

    /// The quality in lower case, for command lines and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Realtime => "realtime",
            Self::VeryFast => "veryfast",
            Self::Fast => "fast",
            Self::Standard => "standard",
            Self::High => "high",
            Self::Best => "best",
            Self::Exhaustive => "exhaustive",
        }
    }
}

/// Weights of red, green and blue in the squared error that the encoder makes small.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Weights([u8; 3]);

impl Weights {
    /// All channels alike: the default, and what PSNR measures.
    pub const UNIFORM: Self = Self([1, 1, 1]);
    /// Close to the luma weights of Rec. 601, 0.299, 0.587 and 0.114. Saves green at the cost of blue; tints gradients.
    pub const PERCEPTUAL: Self = Self([5, 9, 2]);

    /// Weights of one's own.
    ///
    /// # Errors
    /// Each must be at least 1 and their sum at most 16, which keeps all error sums exact.
    pub const fn new(red: u8, green: u8, blue: u8) -> Result<Self, Bc1Error> {
        let sum = red as u16 + green as u16 + blue as u16;
        if red == 0 || green == 0 || blue == 0 || sum > 16 {
            return Err(Bc1Error::Weights { weights: [red, green, blue] });
        }
        Ok(Self([red, green, blue]))
    }

    pub(super) fn to_f32(self) -> [f32; 3] {
        self.0.map(f32::from)
    }
}

impl Default for Weights {
    fn default() -> Self {
        Self::UNIFORM
    }
}

/// The modes that opaque blocks may use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Modes {
    /// 4-colour blocks only. Every decoder and every BC2 or BC3 colour block reads them alike.
    #[default]
    FourColor,
    /// Also 3-colour blocks, without their fourth entry.
    ThreeColor,
    /// Also the fourth entry of 3-colour blocks, as black. Hardware reads it as transparent: only for textures whose
    /// alpha nobody looks at.
    ThreeColorBlack,
}

/// What alpha means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Alpha {
    /// Nothing: all texels are opaque.
    #[default]
    Ignore,
    /// An image with alpha below 255 anywhere, once rounded to 8 bits, is an error.
    Refuse,
    /// Texels with less alpha than this become transparent black, the others opaque. Blocks with transparent texels are
    /// in 3-colour mode; black is then never used for opaque texels.
    Threshold(u8),
}

/// How to encode. `Quality::High.into()` is all that most callers need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct EncodeOptions {
    /// How hard to search.
    pub quality: Quality,
    /// What error to make small.
    pub weights: Weights,
    /// What modes opaque blocks may use.
    pub modes: Modes,
    /// What alpha means.
    pub alpha: Alpha,
    /// The image is a row of pictures of nearly the same, this many blocks apart, such as the cameras of a light field:
    /// from [`Quality::Standard`] on, every block also starts from what was found for its fellow to the left. Below 16
    /// blocks, so many pictures further left that it is at least that far.
    pub repeat_blocks: Option<NonZeroU32>,
}

impl EncodeOptions {
    /// The defaults at a quality: uniform weights, 4-colour blocks, alpha ignored.
    #[must_use]
    pub fn new(quality: Quality) -> Self {
        Self { quality, ..Self::default() }
    }

    /// The same with other weights.
    #[must_use]
    pub fn weights(mut self, weights: Weights) -> Self {
        self.weights = weights;
        self
    }

    /// The same with other modes.
    #[must_use]
    pub fn modes(mut self, modes: Modes) -> Self {
        self.modes = modes;
        self
    }

    /// The same with another meaning of alpha.
    #[must_use]
    pub fn alpha(mut self, alpha: Alpha) -> Self {
        self.alpha = alpha;
        self
    }

    /// The same for a row of nearly equal pictures, each so many blocks wide; 0 for any other image.
    #[must_use]
    pub fn repeat_blocks(mut self, blocks: u32) -> Self {
        self.repeat_blocks = NonZeroU32::new(blocks);
        self
    }

    /// Whether all but the quality is as by default, which is all that the two fastest fits know.
    pub(super) fn is_plain(&self) -> bool {
        *self == Self { repeat_blocks: self.repeat_blocks, ..Self::new(self.quality) }
    }

    pub(super) fn repeat(&self) -> Option<usize> {
        self.repeat_blocks.and_then(|blocks| usize::try_from(blocks.get()).ok())
    }
}

impl From<Quality> for EncodeOptions {
    fn from(quality: Quality) -> Self {
        Self::new(quality)
    }
}

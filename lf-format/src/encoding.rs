//! How texels and chunks are coded.

use crate::geometry::{TRANSFER_LINEAR, TRANSFER_SRGB};

/// How texels are stored in a raw tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum TexelEncoding {
    /// Opaque BC1 (DXT1) blocks, 4×4 texels in 8 bytes, sRGB-encoded (spec §7.3).
    Bc1,
    /// Four bytes a texel: red, green, blue, 255, sRGB-encoded (spec §7.4).
    Rgba8,
    /// Three binary16 numbers a texel, linear: red, green, blue (spec §7.9).
    Rgb16F,
}

impl TexelEncoding {
    const ALL: [Self; 3] = [Self::Bc1, Self::Rgba8, Self::Rgb16F];

    pub(crate) fn id(self) -> u8 {
        match self {
            Self::Bc1 => 1,
            Self::Rgba8 => 2,
            Self::Rgb16F => 3,
        }
    }

    pub(crate) fn from_id(id: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|encoding| encoding.id() == id)
    }

    /// The transfer function that goes with it (spec §5.5).
    pub(crate) fn transfer(self) -> u8 {
        match self {
            Self::Bc1 | Self::Rgba8 => TRANSFER_SRGB,
            Self::Rgb16F => TRANSFER_LINEAR,
        }
    }

    /// Whether tiles of this encoding may be packed so.
    #[must_use]
    pub fn allows(self, packing: Packing) -> bool {
        match packing {
            Packing::None | Packing::Zstd => true,
            Packing::Tile => self == Self::Bc1,
            Packing::Unknown(_) => false,
        }
    }

    /// Bytes of 4×4 texels.
    #[must_use]
    pub fn block_len(self) -> u64 {
        match self {
            Self::Bc1 => 8,
            Self::Rgba8 => 64,
            Self::Rgb16F => 96,
        }
    }
}

/// How the bytes of a chunk are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Packing {
    /// Not at all: stored are the raw bytes.
    None,
    /// One zstd frame (spec §7.5).
    Zstd,
    /// BC1 blocks in the tile codec (spec §7.8). Only tiles of BC1 slabs have it.
    Tile,
    /// In a way that this version does not know, by its number in the file. Only chunks that a reader skips have it,
    /// never a tile.
    Unknown(u8),
}

impl Packing {
    pub(crate) fn id(self) -> u8 {
        match self {
            Self::None => 0,
            Self::Zstd => 1,
            Self::Tile => 2,
            Self::Unknown(id) => id,
        }
    }

    pub(crate) fn from_id(id: u8) -> Self {
        match id {
            0 => Self::None,
            1 => Self::Zstd,
            2 => Self::Tile,
            _ => Self::Unknown(id),
        }
    }
}

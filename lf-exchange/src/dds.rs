//! DirectDraw Surface files with the `DX10` header, as volume textures or as 2D arrays.
//!
//! Sources: Microsoft, *Programming Guide for DDS*, with `DDS_HEADER` and `DDS_HEADER_DXT10`. One mip level. The format
//! is the sRGB one where there is one; see [`Volume`].

use crate::{ExchangeError, Volume, VolumeFormat};

/// `CAPS | HEIGHT | WIDTH | PIXELFORMAT`: what every header has.
const FLAGS: u32 = 0x1007;
const FLAG_PITCH: u32 = 0x8;
const FLAG_LINEAR_SIZE: u32 = 0x8_0000;
const FLAG_DEPTH: u32 = 0x80_0000;
/// `DDSCAPS_TEXTURE | DDSCAPS_COMPLEX`.
const CAPS: u32 = 0x1008;
const CAPS2_VOLUME: u32 = 0x20_0000;
const PIXEL_FORMAT_FOUR_CC: u32 = 0x4;
const ALPHA_STRAIGHT: u32 = 1;
const ALPHA_OPAQUE: u32 = 3;

/// What the slices of a volume become.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A 3D texture, which interpolates between slices.
    Volume,
    /// A 2D array, which does not.
    Array,
}

/// The DDS file of a volume.
///
/// # Errors
/// [`ExchangeError::Unsupported`] if a row, or a slice of blocks, has 4 GiB or more: the header cannot say so.
pub fn encode(volume: &Volume<'_>, shape: Shape) -> Result<Vec<u8>, ExchangeError> {
    let [width, height, depth] = volume.size();
    let (dxgi_format, alpha, pitch_flag, pitch) = match volume.format() {
        VolumeFormat::Bc1 => (72, ALPHA_OPAQUE, FLAG_LINEAR_SIZE, volume.slice_bytes()),
        VolumeFormat::Rgba8 => (29, ALPHA_STRAIGHT, FLAG_PITCH, volume.row_bytes()),
        VolumeFormat::Rgba16Float => (10, ALPHA_STRAIGHT, FLAG_PITCH, volume.row_bytes()),
    };
    let too_large = |_| ExchangeError::unsupported(format!("a slice of {width}×{height} texels is too large for DDS"));
    let pitch = u32::try_from(pitch).map_err(too_large)?;
    let (flags, header_depth, caps2, dimension, layers) = match shape {
        Shape::Volume => (FLAG_DEPTH, depth, CAPS2_VOLUME, 4, 1),
        Shape::Array => (0, 0, 0, 3, depth),
    };
    let mut words = vec![u32::from_le_bytes(*b"DDS "), 124, FLAGS | flags | pitch_flag, height, width, pitch];
    words.extend([header_depth, 1]);
    words.extend([0; 11]);
    words.extend([32, PIXEL_FORMAT_FOUR_CC, u32::from_le_bytes(*b"DX10"), 0, 0, 0, 0, 0]);
    words.extend([CAPS, caps2, 0, 0, 0]);
    words.extend([dxgi_format, dimension, 0, layers, alpha]);
    let mut file: Vec<u8> = words.into_iter().flat_map(u32::to_le_bytes).collect();
    volume.slices().iter().for_each(|slice| file.extend_from_slice(slice));
    Ok(file)
}

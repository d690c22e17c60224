//! A 3D texture, or the layers of a 2D array, as bytes that a GPU takes.

use crate::ExchangeError;

/// How the texels of a [`Volume`] are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum VolumeFormat {
    /// Opaque BC1 blocks of 4×4 texels, 8 bytes each, of sRGB-encoded colours.
    Bc1,
    /// Four bytes a texel: red, green, blue, sRGB-encoded, and alpha.
    Rgba8,
    /// Four little-endian 16-bit floating point numbers a texel: linear Rec. 709 red, green, blue, and alpha.
    Rgba16Float,
}

/// Slices of equal size, one behind the other.
///
/// The colours of [`VolumeFormat::Bc1`] and [`VolumeFormat::Rgba8`] are sRGB-encoded, and files say so: any viewer shows
/// them right. This project interpolates texels *as they are stored* (`spec/conventions.md`); to do the same, a program
/// creates its texture, or a view of it, in the format of the same name without `SRGB` and decodes in the shader. The
/// bytes are the same.
#[derive(Debug, Clone)]
pub struct Volume<'a> {
    size: [u32; 3],
    format: VolumeFormat,
    slices: Vec<&'a [u8]>,
}

impl<'a> Volume<'a> {
    /// A volume of `size` texels (width, height, depth), one slice of bytes for each step of depth: rows of texels, or
    /// of blocks, without padding. A block that sticks out over the edge of a slice is stored whole.
    ///
    /// # Errors
    /// [`ExchangeError::InvalidArgument`] if a size is 0, if there are not as many slices as the volume is deep, or if
    /// one of them has the wrong length.
    pub fn new(size: [u32; 3], format: VolumeFormat, slices: Vec<&'a [u8]>) -> Result<Self, ExchangeError> {
        let [width, height, depth] = size;
        if size.contains(&0) {
            return Err(ExchangeError::argument(format!("a volume of {width}×{height}×{depth} texels is empty")));
        }
        if slices.len() != depth as usize {
            let what = format!("a volume {depth} texels deep needs as many slices, there are {}", slices.len());
            return Err(ExchangeError::argument(what));
        }
        let volume = Self { size, format, slices };
        let wanted = volume.slice_bytes();
        if let Some(index) = volume.slices.iter().position(|slice| slice.len() as u64 != wanted) {
            let len = volume.slices.get(index).map_or(0, |slice| slice.len());
            let what = format!("slice {index} of {width}×{height} texels has {len} bytes, needs {wanted}");
            return Err(ExchangeError::argument(what));
        }
        Ok(volume)
    }

    /// Width, height and depth in texels, each at least 1.
    #[must_use]
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// How texels are stored.
    #[must_use]
    pub fn format(&self) -> VolumeFormat {
        self.format
    }

    /// The bytes of each slice.
    #[must_use]
    pub fn slices(&self) -> &[&'a [u8]] {
        &self.slices
    }

    /// Bytes of a row of texels or blocks. At most 8 · 2³², whatever the size.
    pub(crate) fn row_bytes(&self) -> u64 {
        match self.format {
            VolumeFormat::Bc1 => u64::from(self.size[0].div_ceil(4)) * 8,
            VolumeFormat::Rgba8 => u64::from(self.size[0]) * 4,
            VolumeFormat::Rgba16Float => u64::from(self.size[0]) * 8,
        }
    }

    /// Bytes of a slice; the largest number if it does not fit, which no slice has.
    pub(crate) fn slice_bytes(&self) -> u64 {
        let rows = match self.format {
            VolumeFormat::Bc1 => self.size[1].div_ceil(4),
            VolumeFormat::Rgba8 | VolumeFormat::Rgba16Float => self.size[1],
        };
        self.row_bytes().saturating_mul(rows.into())
    }

    /// Bytes of all slices.
    pub(crate) fn total_bytes(&self) -> u64 {
        self.slice_bytes().saturating_mul(self.size[2].into())
    }
}

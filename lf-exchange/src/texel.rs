//! The two kinds of texels, and how a picture of each is stored.

use std::path::Path;

use exr::meta::attribute::Chromaticities;
use exr::prelude::{
    Blocks, Compression, Encoding, Image as ExrImage, Layer, LayerAttributes, LineOrder, SpecificChannels, Vec2,
    WritableImage as _,
};
use half::f16;
use image::ImageFormat;
use lf_math::{Image, SlabTexels};

use crate::ExchangeError;

/// All texels of one slab, of either kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Texels {
    /// RGBA, 8 bits a channel, sRGB-encoded; alpha is 255.
    Srgb8(SlabTexels),
    /// RGB in linear Rec. 709, 16-bit floating point. Imported ones are as the files have them, be they negative, infinite
    /// or not a number.
    Linear16(SlabTexels<[f16; 3]>),
}

/// A texel that pictures can be written with: `[u8; 4]`, sRGB-encoded RGBA, as PNG, or `[f16; 3]`, linear Rec. 709, as
/// OpenEXR.
pub trait Texel: Copy + sealed::Sealed {
    /// The extension of the picture files, without a dot.
    const EXTENSION: &'static str;

    /// What stands in a picture where the slab has no texel.
    const BLACK: Self;

    /// Writes a picture. Alpha is left out: it carries nothing in a slab.
    ///
    /// # Errors
    /// [`ExchangeError::Picture`] if the encoder or the file system refuses.
    fn write_picture(picture: &Image<Self>, path: &Path) -> Result<(), ExchangeError>;
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for [u8; 4] {}
    impl Sealed for [half::f16; 3] {}
}

impl Texel for [u8; 4] {
    const EXTENSION: &'static str = "png";
    const BLACK: Self = [0, 0, 0, 255];

    fn write_picture(picture: &Image<Self>, path: &Path) -> Result<(), ExchangeError> {
        let bytes: Vec<u8> = picture.texels().iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        let (width, height) = (picture.width(), picture.height());
        image::save_buffer_with_format(path, &bytes, width, height, image::ColorType::Rgb8, ImageFormat::Png)
            .map_err(ExchangeError::writing(path))
    }
}

impl Texel for [f16; 3] {
    const EXTENSION: &'static str = "exr";
    const BLACK: Self = [f16::ZERO; 3];

    fn write_picture(picture: &Image<Self>, path: &Path) -> Result<(), ExchangeError> {
        let pixel = |at: Vec2<usize>| {
            let [r, g, b] = picture.get(at.x() as u32, at.y() as u32);
            (r, g, b)
        };
        let encoding =
            Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
        let size = (picture.width() as usize, picture.height() as usize);
        let layer = Layer::new(size, LayerAttributes::default(), encoding, SpecificChannels::rgb(pixel));
        let mut image = ExrImage::from_layer(layer);
        image.attributes.chromaticities = Some(rec_709());
        image.write().to_file(path).map_err(ExchangeError::writing(path))
    }
}

/// The primaries and white point of Rec. ITU-R BT.709, which are also what OpenEXR assumes without the attribute.
pub(crate) fn rec_709() -> Chromaticities {
    Chromaticities { red: Vec2(0.64, 0.33), green: Vec2(0.3, 0.6), blue: Vec2(0.15, 0.06), white: Vec2(0.3127, 0.329) }
}

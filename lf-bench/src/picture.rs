//! Opaque RGBA8 images whose sides are multiples of 4.

use std::path::Path;

use image::{DynamicImage, Rgb32FImage, RgbaImage};

use crate::error::BenchError;

/// Mean of the brightness that an image of high dynamic range is exposed to before it is cut at 1.
const MIDDLE_GREY: f32 = 0.18;

/// An opaque image of whole blocks: what every encoder is given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    name: String,
    width: u32,
    height: u32,
    /// Row-major R, G, B, 255.
    rgba: Vec<u8>,
}

impl Picture {
    /// An image by its texels, given by column and row; the sides are cut to multiples of 4.
    ///
    /// `None` if that leaves nothing.
    #[must_use]
    pub fn from_fn(name: &str, width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 3]) -> Option<Self> {
        let (width, height) = (width / 4 * 4, height / 4 * 4);
        let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let rgba: Vec<u8> = all
            .flat_map(|(x, y)| {
                let [r, g, b] = texel(x, y);
                [r, g, b, 255]
            })
            .collect();
        (!rgba.is_empty()).then(|| Self { name: name.to_owned(), width, height, rgba })
    }

    /// Reads a PNG, JPEG or Radiance file; alpha is dropped, values of high dynamic range are exposed to middle grey
    /// and sRGB-encoded. `None` for an image of less than one block.
    ///
    /// # Errors
    ///
    /// [`BenchError::Image`] if the file cannot be read or decoded.
    pub fn read(path: &Path) -> Result<Option<Self>, BenchError> {
        let image = image::open(path).map_err(|source| BenchError::Image { path: path.to_owned(), source })?;
        let image = match image {
            DynamicImage::ImageRgb32F(radiance) => exposed(&radiance),
            other => other.into_rgba8(),
        };
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        Ok(Self::from_fn(&name, image.width(), image.height(), |x, y| {
            let [r, g, b, _] = image.get_pixel(x, y).0;
            [r, g, b]
        }))
    }

    /// Name for messages: the file's or that of the synthetic image.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Width in texels, a positive multiple of 4.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in texels, a positive multiple of 4.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Number of texels.
    #[must_use]
    pub fn texels(&self) -> usize {
        self.rgba.len() / 4
    }

    /// Row-major R, G, B and 255.
    #[must_use]
    pub fn rgba(&self) -> &[u8] {
        &self.rgba
    }

    /// Bytes of the image as BC1 blocks.
    #[must_use]
    pub fn block_bytes(&self) -> usize {
        self.texels() / 2
    }
}

/// Linear light to sRGB, with the mean of the clipped image near middle grey.
fn exposed(radiance: &Rgb32FImage) -> RgbaImage {
    // The geometric mean, since a lamp in view would darken everything else under the arithmetic one.
    let luminance = |p: &image::Rgb<f32>| 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
    let logs: f32 = radiance.pixels().map(|p| luminance(p).max(1e-4).ln()).sum();
    let exposure = MIDDLE_GREY / (logs / (radiance.width() * radiance.height()).max(1) as f32).exp();
    let encode = |linear: f32| {
        let c = (linear * exposure).clamp(0.0, 1.0);
        let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    };
    RgbaImage::from_fn(radiance.width(), radiance.height(), |x, y| {
        let [r, g, b] = radiance.get_pixel(x, y).0.map(encode);
        image::Rgba([r, g, b, 255])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_cut_to_whole_blocks() {
        let picture = Picture::from_fn("p", 11, 7, |x, y| [x as u8, y as u8, 9]).unwrap();
        assert_eq!((picture.width(), picture.height(), picture.texels(), picture.block_bytes()), (8, 4, 32, 16));
        assert_eq!(&picture.rgba()[4 * 9..4 * 10], &[1, 1, 9, 255]);
        assert_eq!(Picture::from_fn("p", 3, 8, |_, _| [0; 3]), None);
    }

    #[test]
    fn exposure_puts_even_light_at_middle_grey() {
        let even = Rgb32FImage::from_pixel(4, 4, image::Rgb([7.0; 3]));
        assert_eq!(exposed(&even).get_pixel(1, 1).0, [118, 118, 118, 255]);
    }
}

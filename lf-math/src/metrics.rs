//! Error of one image against another.

use crate::error::GeometryError;
use crate::image::Image;

/// How far an image is from its reference, over a set of pixels, on 8-bit display values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageError {
    /// Number of pixels compared.
    pub pixels: usize,
    /// Mean squared error over all R, G and B values, in steps of 1/255 squared.
    pub mse: f64,
    /// Largest difference of any component, 0 … 255.
    pub max_abs: u8,
}

impl ImageError {
    /// Peak signal-to-noise ratio in dB, 10·log₁₀(255² / MSE); infinite for equal images.
    #[must_use]
    pub fn psnr_db(&self) -> f64 {
        10.0 * libm::log10(255.0 * 255.0 / self.mse)
    }
}

/// Compares the RGB values of two images where `mask` is true; alpha is ignored.
///
/// Sums are exact integers, so the result does not depend on the order of the pixels.
///
/// # Errors
/// The images and the mask must have the same size, and the mask at least one true pixel.
pub fn image_error(
    reference: &Image<[u8; 4]>,
    test: &Image<[u8; 4]>,
    mask: &Image<bool>,
) -> Result<ImageError, GeometryError> {
    let want = [reference.width(), reference.height()];
    for (what, have) in [("test image", [test.width(), test.height()]), ("mask", [mask.width(), mask.height()])] {
        if have != want {
            return Err(GeometryError::Size { what, have, want });
        }
    }
    let (mut pixels, mut sum, mut max_abs) = (0usize, 0u64, 0u8);
    let pairs = reference.texels().iter().zip(test.texels()).zip(mask.texels());
    for ((a, b), _) in pairs.filter(|(_, inside)| **inside) {
        pixels += 1;
        for c in 0..3 {
            let difference = a[c].abs_diff(b[c]);
            max_abs = max_abs.max(difference);
            sum += u64::from(difference) * u64::from(difference);
        }
    }
    if pixels == 0 {
        return Err(GeometryError::ZeroCount { what: "number of compared pixels" });
    }
    Ok(ImageError { pixels, mse: sum as f64 / (3 * pixels) as f64, max_abs })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_only_the_mask_and_ignores_alpha() {
        let reference = Image::new(2, 1, alloc::vec![[10, 20, 30, 255], [0; 4]]).unwrap();
        let test = Image::new(2, 1, alloc::vec![[13, 20, 30, 0], [255; 4]]).unwrap();
        let mask = Image::new(2, 1, alloc::vec![true, false]).unwrap();
        let error = image_error(&reference, &test, &mask).unwrap();
        assert_eq!(error, ImageError { pixels: 1, mse: 3.0, max_abs: 3 });
        assert!((error.psnr_db() - 43.3596).abs() < 1e-3);
        assert!(image_error(&reference, &reference, &mask).unwrap().psnr_db().is_infinite());
    }

    #[test]
    fn refuses_unequal_sizes_and_empty_masks() {
        let image = Image::filled(2, 1, [0u8; 4]);
        let mask = Image::filled(2, 1, true);
        assert!(image_error(&image, &Image::filled(1, 2, [0u8; 4]), &mask).is_err());
        assert!(image_error(&image, &image, &Image::filled(2, 1, false)).is_err());
    }
}

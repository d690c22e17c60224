//! Error of one image against another.

use crate::color::linear_from_srgb;
use crate::error::{GeometryError, same_size};
use crate::flip::flip;
use crate::image::Image;
use crate::ssim::ssim;

/// A difference of more than a tenth of the range, in steps of 1/255.
const TENTH: u8 = 25;
/// Of the squared mean of the reference, what is added to the squared reference where errors are relative: a hundredth, so that black
/// pixels do not decide.
const REL_MSE_FLOOR: f64 = 0.01;

/// How far an image is from its reference, over a set of pixels, on 8-bit display values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageError {
    /// Number of pixels compared.
    pub pixels: usize,
    /// Mean squared error over all R, G and B values, in steps of 1/255 squared.
    pub mse: f64,
    /// Largest difference of any component, 0 … 255.
    pub max_abs: u8,
    /// Number of pixels with a component that is off by more than a tenth of the range.
    pub over_tenth: usize,
    /// Mean of (a − b)²/(b² + ε) over all linear R, G and B values, b being the reference's and ε a hundredth of the square of their mean;
    /// 0 where both are black all over.
    pub rel_mse: f64,
}

impl ImageError {
    /// Peak signal-to-noise ratio in dB, 10·log₁₀(255² / MSE); infinite for equal images.
    #[must_use]
    pub fn psnr_db(&self) -> f64 {
        10.0 * libm::log10(255.0 * 255.0 / self.mse)
    }

    /// Share of the pixels with a component that is off by more than a tenth of the range.
    #[must_use]
    pub fn share_over_tenth(&self) -> f64 {
        self.over_tenth as f64 / self.pixels as f64
    }
}

/// Compares the RGB values of two images where `mask` is true; alpha is ignored.
///
/// Sums are exact integers, but for that of relative errors, and so do not depend on the order of the pixels.
///
/// # Errors
/// The images and the mask must have the same size, and the mask at least one true pixel.
pub fn image_error(
    reference: &Image<[u8; 4]>,
    test: &Image<[u8; 4]>,
    mask: &Image<bool>,
) -> Result<ImageError, GeometryError> {
    same_size("test image", test, reference)?;
    same_size("mask", mask, reference)?;
    let pairs = || {
        let all = reference.texels().iter().zip(test.texels()).zip(mask.texels());
        all.filter(|(_, inside)| **inside).map(|((a, b), _)| ([a[0], a[1], a[2]], [b[0], b[1], b[2]]))
    };
    let linear: [f64; 256] = core::array::from_fn(|i| f64::from(linear_from_srgb(i as f32 / 255.0)));
    let (mut pixels, mut sum, mut max_abs, mut over_tenth, mut light) = (0usize, 0u64, 0, 0, 0.0);
    for (a, b) in pairs() {
        pixels += 1;
        let differences: [u8; 3] = core::array::from_fn(|c| a[c].abs_diff(b[c]));
        let largest = differences.into_iter().fold(0, u8::max);
        max_abs = max_abs.max(largest);
        over_tenth += usize::from(largest > TENTH);
        sum += differences.into_iter().map(|d| u64::from(d) * u64::from(d)).sum::<u64>();
        light += a.into_iter().map(|value| linear[usize::from(value)]).sum::<f64>();
    }
    if pixels == 0 {
        return Err(GeometryError::ZeroCount { what: "number of compared pixels" });
    }
    let values = (3 * pixels) as f64;
    let floor = (REL_MSE_FLOOR * (light / values) * (light / values)).max(f64::MIN_POSITIVE);
    let relative = |(a, b): ([u8; 3], [u8; 3])| -> f64 {
        let channel = |c: usize| {
            let (a, b) = (linear[usize::from(a[c])], linear[usize::from(b[c])]);
            (a - b) * (a - b) / (a * a + floor)
        };
        (0..3).map(channel).sum()
    };
    let rel_mse = if light == 0.0 && sum == 0 { 0.0 } else { pairs().map(relative).sum::<f64>() / values };
    Ok(ImageError { pixels, mse: sum as f64 / values, max_abs, over_tenth, rel_mse })
}

/// How different an image looks from its reference, over a set of pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisibleError {
    /// Mean [`flip`], 0 (the same) … 1.
    pub flip: f64,
    /// Mean [`ssim`], at most 1 (the same).
    pub ssim: f64,
}

/// Compares what is seen of two images where `mask` is true; alpha is ignored. Both are looked at on black: what lies outside the mask does
/// not count, but for the edge towards it, which both have.
///
/// Takes many times as long as [`image_error`].
///
/// # Errors
/// As [`image_error`].
pub fn visible_error(
    reference: &Image<[u8; 4]>,
    test: &Image<[u8; 4]>,
    mask: &Image<bool>,
) -> Result<VisibleError, GeometryError> {
    same_size("test image", test, reference)?;
    same_size("mask", mask, reference)?;
    let pixels = mask.texels().iter().filter(|inside| **inside).count();
    if pixels == 0 {
        return Err(GeometryError::ZeroCount { what: "number of compared pixels" });
    }
    let (reference, test) = (on_black(reference, mask), on_black(test, mask));
    let mean = |measure: &Image<f32>| {
        let inside = measure.texels().iter().zip(mask.texels()).filter(|(_, inside)| **inside);
        inside.map(|(value, _)| f64::from(*value)).sum::<f64>() / pixels as f64
    };
    Ok(VisibleError { flip: mean(&flip(&reference, &test)?), ssim: mean(&ssim(&reference, &test)?) })
}

fn on_black(picture: &Image<[u8; 4]>, mask: &Image<bool>) -> Image<[u8; 4]> {
    let mut picture = picture.clone();
    let outside = picture.texels_mut().iter_mut().zip(mask.texels()).filter(|(_, inside)| !**inside);
    outside.for_each(|(pixel, _)| *pixel = [0, 0, 0, 255]);
    picture
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
        assert_eq!((error.pixels, error.mse, error.max_abs, error.over_tenth), (1, 3.0, 3, 0));
        assert!((error.psnr_db() - 43.3596).abs() < 1e-3);
        assert!(image_error(&reference, &reference, &mask).unwrap().psnr_db().is_infinite());
    }

    /// By hand: white against half of its light, and grey against itself.
    #[test]
    fn relative_errors_are_of_linear_light() {
        let reference = Image::new(2, 1, alloc::vec![[255; 4], [188, 188, 188, 255]]).unwrap();
        let test = Image::new(2, 1, alloc::vec![[188; 4], [188, 188, 188, 255]]).unwrap();
        let error = image_error(&reference, &test, &Image::filled(2, 1, true)).unwrap();
        let half = 0.502_886_5f64;
        let floor = 0.01 * (0.5 * (1.0 + half)).powi(2);
        let expected = 0.5 * (1.0 - half).powi(2) / (1.0 + floor);
        assert!((error.rel_mse - expected).abs() < 1e-6, "{error:?} {expected}");
        assert_eq!((error.over_tenth, error.share_over_tenth()), (1, 0.5));
        let black = Image::filled(2, 1, [0; 4]);
        assert_eq!(image_error(&black, &black, &Image::filled(2, 1, true)).unwrap().rel_mse, 0.0);
    }

    #[test]
    fn what_is_seen_is_of_the_mask_alone() {
        let mask = Image::new(32, 1, (0..32).map(|x| x < 16).collect()).unwrap();
        let reference = Image::filled(32, 1, [90, 120, 60, 255]);
        let mut test = reference.clone();
        test.texels_mut()[16..].fill([255; 4]);
        let same = visible_error(&reference, &test, &mask).unwrap();
        assert_eq!((same.flip, same.ssim as f32), (0.0, 1.0));
        test.texels_mut()[..16].fill([255; 4]);
        let apart = visible_error(&reference, &test, &mask).unwrap();
        assert!(apart.flip > 0.3 && apart.ssim < 0.95, "{apart:?}");
    }

    #[test]
    fn refuses_unequal_sizes_and_empty_masks() {
        let image = Image::filled(2, 1, [0u8; 4]);
        let mask = Image::filled(2, 1, true);
        assert!(image_error(&image, &Image::filled(1, 2, [0u8; 4]), &mask).is_err());
        assert!(image_error(&image, &image, &Image::filled(2, 1, false)).is_err());
        assert!(visible_error(&image, &Image::filled(1, 2, [0u8; 4]), &mask).is_err());
        assert!(visible_error(&image, &image, &Image::filled(2, 2, true)).is_err());
        assert!(visible_error(&image, &image, &Image::filled(2, 1, false)).is_err());
    }
}

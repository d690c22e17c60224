//! Structural similarity: whether a neighbourhood has the same mean, contrast and pattern.
//!
//! Wang, Bovik, Sheikh, Simoncelli: *Image Quality Assessment: From Error Visibility to Structural Similarity*, IEEE TIP 2004: a Gaussian
//! window of 11 × 11 pixels, σ = 1.5, K₁ = 0.01, K₂ = 0.03, on 8-bit display values. The paper takes grey pictures; here each colour
//! channel is one, and a pixel's similarity the mean of three. Windows at the rim go on with the outermost pixels.

use alloc::vec::Vec;

use crate::error::{GeometryError, same_size};
use crate::filter::{filtered, gaussian, kernel, normalized};
use crate::image::Image;

const RADIUS: usize = 5;
const SIGMA: f32 = 1.5;
/// (K₁ · 255)² and (K₂ · 255)², for values of 0 … 1.
const C1: f32 = 0.01 * 0.01;
const C2: f32 = 0.03 * 0.03;

/// The structural similarity of each pixel's neighbourhood, −1 … 1, 1 where they are equal; alpha is ignored.
///
/// # Errors
/// The pictures must have the same size.
pub fn ssim(reference: &Image<[u8; 4]>, test: &Image<[u8; 4]>) -> Result<Image<f32>, GeometryError> {
    same_size("test image", test, reference)?;
    let mut mean = Image::filled(reference.width(), reference.height(), 0.0);
    for channel in 0..3 {
        let plane = |picture: &Image<[u8; 4]>| picture.map(|texel| f32::from(texel[channel]) / 255.0);
        let similarity = of_channel(&plane(reference), &plane(test));
        mean.texels_mut().iter_mut().zip(similarity).for_each(|(sum, value)| *sum += value / 3.0);
    }
    Ok(mean)
}

/// The paper's Eq. 13.
fn of_channel(a: &Image<f32>, b: &Image<f32>) -> Vec<f32> {
    let window = normalized(kernel(RADIUS, |x| gaussian(x, SIGMA)));
    let mean = |plane: &Image<f32>| filtered(plane, &window, &window);
    let mean_of = |f: &dyn Fn(f32, f32) -> f32| {
        let mut products = a.clone();
        products.texels_mut().iter_mut().zip(b.texels()).for_each(|(value, other)| *value = f(*value, *other));
        mean(&products)
    };
    let (mean_a, mean_b) = (mean(a), mean(b));
    // Together, as only their sum is asked for.
    let (squares, products) = (mean_of(&|a, b| a * a + b * b), mean_of(&|a, b| a * b));
    let similarity = |i: usize| {
        let (a, b) = (mean_a.texels()[i], mean_b.texels()[i]);
        let (variances, covariance) = (squares.texels()[i] - a * a - b * b, products.texels()[i] - a * b);
        (2.0 * a * b + C1) * (2.0 * covariance + C2) / ((a * a + b * b + C1) * (variances.max(0.0) + C2))
    };
    (0..a.texels().len()).map(similarity).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(width: u32, height: u32, mut state: u64) -> Image<[u8; 4]> {
        Image::filled(width, height, ()).map(|()| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 32).to_le_bytes()[..4].try_into().unwrap()
        })
    }

    /// The definition, pixel by pixel, in `f64`.
    fn by_definition(a: &Image<[u8; 4]>, b: &Image<[u8; 4]>, at: [i64; 2], channel: usize) -> f64 {
        let value = |picture: &Image<[u8; 4]>, x: i64, y: i64| {
            let (x, y) = (x.clamp(0, i64::from(picture.width()) - 1), y.clamp(0, i64::from(picture.height()) - 1));
            f64::from(picture.get(x as u32, y as u32)[channel])
        };
        let window = || (-5..=5i64).flat_map(|y| (-5..=5i64).map(move |x| (x, y)));
        let weight = |x: i64, y: i64| (-((x * x + y * y) as f64) / (2.0 * 1.5 * 1.5)).exp();
        let total: f64 = window().map(|(x, y)| weight(x, y)).sum();
        let mean = |f: &dyn Fn(f64, f64) -> f64| {
            let one = |(x, y)| weight(x, y) * f(value(a, at[0] + x, at[1] + y), value(b, at[0] + x, at[1] + y));
            window().map(one).sum::<f64>() / total
        };
        let (ma, mb) = (mean(&|a, _| a), mean(&|_, b| b));
        let (va, vb) = (mean(&|a, _| (a - ma).powi(2)), mean(&|_, b| (b - mb).powi(2)));
        let covariance = mean(&|a, b| (a - ma) * (b - mb));
        let (c1, c2) = ((0.01f64 * 255.0).powi(2), (0.03f64 * 255.0).powi(2));
        (2.0 * ma * mb + c1) * (2.0 * covariance + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2))
    }

    #[test]
    fn equals_the_definition() {
        let (a, b) = (noise(17, 13, 1), noise(17, 13, 2));
        // Half alike.
        let mut close = a.clone();
        close
            .texels_mut()
            .iter_mut()
            .zip(b.texels())
            .for_each(|(x, y)| *x = core::array::from_fn(|c| x[c] / 2 + y[c] / 2));
        for test in [&b, &close] {
            let found = ssim(&a, test).unwrap();
            for (x, y) in [(0, 0), (8, 6), (16, 12), (3, 11)] {
                let expected: f64 = (0..3).map(|c| by_definition(&a, test, [x, y], c)).sum::<f64>() / 3.0;
                let found = f64::from(found.get(x as u32, y as u32));
                assert!((found - expected).abs() < 1e-4, "{x}, {y}: {found} {expected}");
            }
        }
    }

    /// Without contrast the means alone are compared, in closed form; a negative of a pattern is anticorrelated.
    #[test]
    fn closed_forms() {
        let even = |value: u8| Image::filled(20, 20, [value; 4]);
        let (a, b) = (100.0f32 / 255.0, 180.0f32 / 255.0);
        let expected = (2.0 * a * b + C1) / (a * a + b * b + C1);
        assert!((ssim(&even(100), &even(180)).unwrap().get(10, 10) - expected).abs() < 1e-3);
        let stripes = |from: u32| {
            let values = (0..400).map(|i| [if (i + from).is_multiple_of(2) { 78 } else { 178 }; 4]);
            Image::new(20, 20, values.collect()).unwrap()
        };
        assert!((ssim(&stripes(0), &stripes(0)).unwrap().get(10, 10) - 1.0).abs() < 1e-5);
        assert!(ssim(&stripes(0), &stripes(1)).unwrap().get(10, 10) < -0.9);
        assert!(ssim(&even(0), &Image::filled(20, 19, [0; 4])).is_err());
    }
}

//! Separable filters on planes of numbers, for the measures that look at neighbourhoods.

use alloc::vec::Vec;

use crate::image::Image;

/// A plane filtered along its rows, then along its columns, by kernels of odd length. Beyond the edges the outermost values go on.
/// Takes one multiplication a weight and value.
pub(crate) fn filtered(plane: &Image<f32>, row_kernel: &[f32], column_kernel: &[f32]) -> Image<f32> {
    down_columns(&along_rows(plane, row_kernel), column_kernel)
}

/// The first half of [`filtered`], for several filters that share it.
pub(crate) fn along_rows(plane: &Image<f32>, kernel: &[f32]) -> Image<f32> {
    let (width, radius) = (plane.width() as usize, kernel.len() / 2);
    let mut result = plane.map(|_| 0.0);
    for (row, sums) in plane.texels().chunks_exact(width).zip(result.texels_mut().chunks_exact_mut(width)) {
        let outer = |value: f32| core::iter::repeat_n(value, radius);
        let padded: Vec<f32> = outer(row[0]).chain(row.iter().copied()).chain(outer(row[width - 1])).collect();
        for (weight, shifted) in kernel.iter().zip(padded.windows(width)) {
            add_scaled(sums, shifted, *weight);
        }
    }
    result
}

/// The second half of [`filtered`].
pub(crate) fn down_columns(plane: &Image<f32>, kernel: &[f32]) -> Image<f32> {
    let (width, height, radius) = (plane.width() as usize, plane.height() as usize, kernel.len() / 2);
    let mut result = plane.map(|_| 0.0);
    for (y, sums) in result.texels_mut().chunks_exact_mut(width).enumerate() {
        for (i, weight) in kernel.iter().enumerate() {
            let from = (y + i).saturating_sub(radius).min(height - 1);
            add_scaled(sums, &plane.texels()[from * width..][..width], *weight);
        }
    }
    result
}

fn add_scaled(sums: &mut [f32], values: &[f32], weight: f32) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

/// `2 · radius + 1` weights: a function of the distance from the middle.
pub(crate) fn kernel(radius: usize, weight: impl Fn(f32) -> f32) -> Vec<f32> {
    (0..=2 * radius).map(|i| weight(i as f32 - radius as f32)).collect()
}

/// The weights divided so that their sum is 1.
pub(crate) fn normalized(mut kernel: Vec<f32>) -> Vec<f32> {
    let sum: f32 = kernel.iter().sum();
    kernel.iter_mut().for_each(|weight| *weight /= sum);
    kernel
}

/// exp(−x² / 2σ²).
pub(crate) fn gaussian(x: f32, sigma: f32) -> f32 {
    libm::expf(-x * x / (2.0 * sigma * sigma))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uneven kernels, so that neither direction nor side can be mixed up; by hand.
    #[test]
    fn edges_go_on_and_kernels_are_not_turned() {
        let plane = Image::new(3, 2, alloc::vec![1.0, 2.0, 3.0, 10.0, 20.0, 30.0]).unwrap();
        assert_eq!(along_rows(&plane, &[1.0, 0.0, 0.0]).texels(), [1.0, 1.0, 2.0, 10.0, 10.0, 20.0]);
        assert_eq!(down_columns(&plane, &[0.0, 0.0, 1.0]).texels(), [10.0, 20.0, 30.0, 10.0, 20.0, 30.0]);
        assert_eq!(filtered(&plane, &[1.0], &[1.0, 1.0, 0.0]).texels(), [2.0, 4.0, 6.0, 11.0, 22.0, 33.0]);
        // A kernel wider than the plane.
        assert_eq!(along_rows(&plane, &[1.0; 9]).texels()[..3], [16.0, 18.0, 20.0]);
    }

    #[test]
    fn kernels_are_even_and_sum_to_one() {
        let kernel = normalized(kernel(3, |x| gaussian(x, 1.5)));
        assert_eq!(kernel.len(), 7);
        assert!((kernel.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        assert!((0..7).all(|i| kernel[i] == kernel[6 - i]));
        assert!((kernel[3] / kernel[0] - 2.0f32.exp()).abs() < 1e-5);
    }
}

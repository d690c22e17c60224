//! How good a block-compressed image is, judged by a decoder that shares no code with any encoder.

use crate::codec::Encoded;
use crate::picture::Picture;

/// An encoder below this was called wrongly: even of pure noise BC1 keeps some 12 dB.
const ABSURD_DB: f64 = 5.0;

/// Squared error over R, G and B, summed over as many images as are added.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SquaredError {
    sum: u64,
    samples: u64,
    transparent: u64,
}

impl SquaredError {
    /// The error of one image's blocks, decoded by `texture2ddecoder`.
    ///
    /// # Errors
    ///
    /// What is wrong with the blocks: their length, or an error so large that the encoder must have been misused.
    pub fn of(blocks: &[u8], picture: &Picture) -> Result<Self, String> {
        if blocks.len() != picture.block_bytes() {
            return Err(format!("{} bytes of blocks instead of {}", blocks.len(), picture.block_bytes()));
        }
        let decoded = reference_rgba(blocks, picture.width(), picture.height())?;
        let error = Self::between(&decoded, picture.rgba());
        if error.psnr_db() < ABSURD_DB {
            return Err(format!("{:.2} dB is no encoding of this image", error.psnr_db()));
        }
        Ok(error)
    }

    /// The error of one RGBA8 image against an opaque one of the same length.
    #[must_use]
    pub fn between(decoded: &[u8], original: &[u8]) -> Self {
        let pairs = decoded.as_chunks::<4>().0.iter().zip(original.as_chunks::<4>().0);
        pairs.fold(Self::default(), |total, (d, o)| {
            let square = |c: usize| u64::from(d[c].abs_diff(o[c])).pow(2);
            total.plus(&Self { sum: (0..3).map(square).sum(), samples: 3, transparent: u64::from(d[3] < 255) })
        })
    }

    /// Both together.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            sum: self.sum + other.sum,
            samples: self.samples + other.samples,
            transparent: self.transparent + other.transparent,
        }
    }

    /// 10·log₁₀(255² / MSE) over all R, G and B samples of all images; infinite without error.
    #[must_use]
    pub fn psnr_db(&self) -> f64 {
        10.0 * (255.0 * 255.0 * self.samples as f64 / self.sum as f64).log10()
    }

    /// Texels of the opaque input that were coded as transparent black.
    #[must_use]
    pub fn transparent_texels(&self) -> u64 {
        self.transparent
    }
}

/// The image as `texture2ddecoder` sees it.
pub(crate) fn reference_rgba(blocks: &[u8], width: u32, height: u32) -> Result<Vec<u8>, String> {
    let mut words = vec![0; 2 * blocks.len()];
    texture2ddecoder::decode_bc1a(blocks, width as usize, height as usize, &mut words).map_err(str::to_owned)?;
    Ok(rgba_of_bgra_words(&words))
}

/// Words with blue in the lowest byte as bytes with red first.
pub(crate) fn rgba_of_bgra_words(words: &[u32]) -> Vec<u8> {
    let rgba = |word: &u32| {
        let [b, g, r, a] = word.to_le_bytes();
        [r, g, b, a]
    };
    words.iter().flat_map(rgba).collect()
}

/// The largest differences between two decoded images.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Difference {
    /// In R, G or B, in steps of 1/255.
    pub color: u8,
    /// In alpha, in steps of 1/255.
    pub alpha: u8,
}

/// Compares two RGBA8 images of the same length.
#[must_use]
pub fn largest_difference(a: &[u8], b: &[u8]) -> Difference {
    let pairs = a.as_chunks::<4>().0.iter().zip(b.as_chunks::<4>().0);
    pairs.fold(Difference::default(), |worst, (a, b)| {
        let step = |c: usize| a[c].abs_diff(b[c]);
        Difference { color: worst.color.max(step(0)).max(step(1)).max(step(2)), alpha: worst.alpha.max(step(3)) }
    })
}

/// Checks a decoder's answer: within 1/255 of the reference in R, G and B, as the two usual roundings are.
pub(crate) fn checked_difference(rgba: &[u8], encoded: &Encoded) -> Result<Difference, String> {
    let difference = largest_difference(rgba, &reference_rgba(&encoded.blocks, encoded.width, encoded.height)?);
    if difference.color > 1 {
        return Err(format!("differs by {}/255 from texture2ddecoder", difference.color));
    }
    Ok(difference)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn psnr_of_known_errors() {
        // One channel of one of two texels off by 255: MSE = 255² / 6.
        let error = SquaredError::between(&[255, 0, 0, 255, 9, 9, 9, 255], &[0, 0, 0, 255, 9, 9, 9, 255]);
        assert!((error.psnr_db() - 10.0 * 6f64.log10()).abs() < 1e-12);
        // Off by 1 everywhere: 48.13 dB; alpha does not count.
        let off_by_one = SquaredError::between(&[1, 2, 3, 0], &[0, 1, 2, 255]);
        assert!((off_by_one.psnr_db() - 48.1308).abs() < 1e-4);
        assert_eq!(off_by_one.transparent_texels(), 1);
        assert_eq!(SquaredError::between(&[7; 8], &[7; 8]).psnr_db(), f64::INFINITY);
    }

    #[test]
    fn errors_pool_by_samples() {
        let a = SquaredError::between(&[2, 0, 0, 255], &[0, 0, 0, 255]);
        let b = SquaredError::between(&[0; 12], &[0; 12]);
        let pooled = a.plus(&b);
        assert!((pooled.psnr_db() - 10.0 * (255.0f64 * 255.0 * 12.0 / 4.0).log10()).abs() < 1e-12);
    }

    #[test]
    fn wrong_lengths_and_absurd_answers_are_refused() {
        let white = Picture::from_fn("white", 8, 4, |_, _| [255; 3]).unwrap();
        assert!(SquaredError::of(&[0; 8], &white).unwrap_err().contains("8 bytes"));
        assert!(SquaredError::of(&[0; 16], &white).unwrap_err().contains("dB is no encoding"));
        assert_eq!(SquaredError::of(&[255, 255, 0, 0, 0, 0, 0, 0].repeat(2), &white).unwrap().psnr_db(), f64::INFINITY);
    }

    #[test]
    fn differences_are_split_into_color_and_alpha() {
        let found = largest_difference(&[1, 2, 3, 0, 9, 9, 9, 9], &[1, 4, 3, 255, 9, 9, 8, 9]);
        assert_eq!(found, Difference { color: 2, alpha: 255 });
    }
}

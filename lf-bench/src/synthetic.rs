//! Images made here, so that something can be measured without any file.

use crate::picture::Picture;

/// Side of both images in texels.
const SIDE: u32 = 512;
/// Seed of the noise.
const SEED: u32 = 0x0511_ab1e;

/// Independent uniform noise in every channel: the worst case, where no line through colour space fits a block.
#[must_use]
pub fn noise() -> Option<Picture> {
    Picture::from_fn("noise", SIDE, SIDE, |x, y| {
        let [r, g, b, _] = mixed(SEED ^ (y * SIDE + x)).to_le_bytes();
        [r, g, b]
    })
}

/// Smooth waves of different period and direction in R, G and B: many hues, and blocks so flat that the endpoints'
/// 5 and 6 bits decide the error.
#[must_use]
pub fn gradient(side: u32) -> Option<Picture> {
    let wave = |phase: f32| ((0.5 + 0.45 * phase.sin()) * 255.0).round() as u8;
    Picture::from_fn("gradient", side, side, |x, y| {
        let (x, y) = (x as f32, y as f32);
        [wave(x / 71.0 + y / 190.0), wave(y / 83.0 - x / 160.0 + 2.0), wave((x + y) / 121.0 + 4.0)]
    })
}

/// A bijection of 32 bits that spreads neighbouring values (the finaliser of MurmurHash3).
fn mixed(mut h: u32) -> u32 {
    h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
    h ^ (h >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_covers_the_range_evenly() {
        let picture = noise().unwrap();
        let mean = |channel: usize| {
            let sum: u64 = picture.rgba().chunks_exact(4).map(|t| u64::from(t[channel])).sum();
            sum as f64 / picture.texels() as f64
        };
        for channel in 0..3 {
            assert!((mean(channel) - 127.5).abs() < 1.0, "{channel}");
        }
        assert_eq!(noise(), noise());
    }

    #[test]
    fn gradient_is_smooth() {
        let picture = gradient(64).unwrap();
        let steps = picture.rgba().chunks_exact(4 * 64).flat_map(|row| row.windows(5).map(|w| w[0].abs_diff(w[4])));
        assert!(steps.max().unwrap() <= 3);
    }
}

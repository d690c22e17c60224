//! Shifting pictures by parts of a pixel.

use half::f16;
use lf_math::Image;

use crate::Texel;

/// Shifts smaller than this, in pixels, are left out: far below what 8 bits can show.
const NEGLIGIBLE_SHIFT: f64 = 1e-3;

/// A texel that can be interpolated, as it is stored.
pub(crate) trait Blend: Texel {
    /// `a` where the weight is 0, `b` where it is 1.
    fn blend(a: Self, b: Self, weight: f32) -> Self;
}

impl Blend for [u8; 4] {
    fn blend(a: Self, b: Self, weight: f32) -> Self {
        let mix = |i: usize| (f32::from(a[i]) + (f32::from(b[i]) - f32::from(a[i])) * weight + 0.5) as u8;
        [mix(0), mix(1), mix(2), mix(3)]
    }
}

impl Blend for [f16; 3] {
    fn blend(a: Self, b: Self, weight: f32) -> Self {
        let mix = |i: usize| f16::from_f32(a[i].to_f32() + (b[i].to_f32() - a[i].to_f32()) * weight);
        [mix(0), mix(1), mix(2)]
    }
}

/// The picture whose pixel (x, y) shows what `picture` has at (x + shift₀, y + shift₁): bilinear, edges repeated.
pub(crate) fn shifted<T: Blend>(picture: Image<T>, shift: [f64; 2]) -> Image<T> {
    if shift.iter().all(|shift| shift.abs() < NEGLIGIBLE_SHIFT) {
        return picture;
    }
    let columns: Vec<Tap> = taps(picture.width(), shift[0]).collect();
    let (picture, columns) = (&picture, &columns);
    let row = |y| columns.iter().map(move |x| T::blend(picture.get(x.first, y), picture.get(x.second, y), x.weight));
    let mut out = Image::filled(picture.width(), picture.height(), T::BLACK);
    let lines = out.texels_mut().chunks_exact_mut(columns.len());
    for (line, tap) in lines.zip(taps(picture.height(), shift[1])) {
        for ((texel, a), b) in line.iter_mut().zip(row(tap.first)).zip(row(tap.second)) {
            *texel = T::blend(a, b, tap.weight);
        }
    }
    out
}

/// Two neighbouring samples and the weight of the second.
struct Tap {
    first: u32,
    second: u32,
    weight: f32,
}

/// For each of `count` samples, where it comes from.
fn taps(count: u32, shift: f64) -> impl Iterator<Item = Tap> {
    let last = count - 1;
    (0..count).map(move |i| {
        let at = (f64::from(i) + shift).clamp(0.0, last.into());
        let first = at.floor() as u32;
        Tap { first, second: (first + 1).min(last), weight: at.fract() as f32 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Image<[u8; 4]> {
        let texel = |i: u8| [10 * (i % 5), 20 * (i / 5), 7, 255];
        Image::new(5, 4, (0..20).map(texel).collect()).unwrap()
    }

    #[test]
    fn whole_shifts_move_texels_and_repeat_edges() {
        let moved = shifted(ramp(), [2.0, -1.0]);
        assert_eq!(moved.get(0, 1), ramp().get(2, 0));
        assert_eq!(moved.get(4, 3), ramp().get(4, 2));
        assert_eq!(moved.get(1, 0), ramp().get(3, 0));
    }

    #[test]
    fn fractions_interpolate_along_both_axes() {
        let moved = shifted(ramp(), [0.5, 0.25]);
        assert_eq!(moved.get(1, 1), [15, 25, 7, 255]);
        let half = shifted(Image::new(2, 1, vec![[f16::ZERO; 3], [f16::ONE; 3]]).unwrap(), [0.25, 0.0]);
        assert_eq!(half.get(0, 0), [f16::from_f32(0.25); 3]);
        assert_eq!(shifted(ramp(), [1e-5, 0.0]), ramp());
    }
}

//! FLIP: how different two pictures look, flipped one onto the other.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: *FLIP: A Difference Evaluator for Alternating Images*, HPG 2020 (the
//! version for 8-bit pictures), with the filters split into rows and columns as in NVIDIA's own code, version 1.2. Colours are blurred as
//! the eye does at its distance and compared in a space where steps look even; edges and points that appear or vanish make a difference
//! larger. A test in this workspace holds it to NVIDIA's code.
//!
//! Some 600 multiplications a pixel, and 50 bytes a pixel of memory at once. Not here: HDR-FLIP.

use alloc::vec::Vec;
use core::f32::consts::{FRAC_1_SQRT_2, PI};

use glam::{Mat3, Vec2, Vec3};

use crate::color::linear_from_srgb;
use crate::error::{GeometryError, same_size};
use crate::filter::{along_rows, down_columns, filtered, gaussian, kernel, normalized};
use crate::image::Image;

/// The viewer that FLIP takes unless told otherwise, 0.7 m from a 4K screen 0.7 m wide. Published values are for this one.
const PIXELS_PER_DEGREE: f32 = 67.0;

/// D65 white, XYZ.
const WHITE: Vec3 = Vec3::new(0.950_428_55, 1.0, 1.088_900_4);
/// XYZ of linear Rec. 709 red, green and blue.
const XYZ_FROM_RGB: Mat3 = Mat3::from_cols(
    Vec3::new(0.412_386_57, 0.212_636_82, 0.019_330_62),
    Vec3::new(0.357_591_49, 0.715_182_98, 0.119_197_16),
    Vec3::new(0.180_450_49, 0.072_180_2, 0.950_372_6),
);
/// Contrast sensitivity (the paper's Table 1), a·√(π/b)·exp(−π²x²/b) with x in degrees: b of the achromatic and the red–green channel, and
/// (a, b) of the two that add up for blue–yellow.
const ACHROMATIC: f32 = 0.0047;
const RED_GREEN: f32 = 0.0053;
const BLUE_YELLOW: [[f32; 2]; 2] = [[34.1, 0.04], [13.5, 0.025]];
/// Width of the edge and point detectors, degrees (section 5.2 of the paper).
const FEATURE_WIDTH: f32 = 0.082;
/// Exponents of colour and feature differences, and the knee of the map of colour differences to 0 … 1 (sections 5.1.3 and 5.3).
const COLOR_EXPONENT: f32 = 0.7;
const FEATURE_EXPONENT: f32 = 0.5;
const KNEE_AT: f32 = 0.4;
const KNEE: f32 = 0.95;

/// The FLIP error of each pixel, 0 (the same) … 1, of 8-bit sRGB pictures seen at 67 pixels per degree; alpha is ignored.
///
/// ```
/// use lf_math::{Image, flip};
/// let (black, white) = (Image::filled(8, 8, [0, 0, 0, 255]), Image::filled(8, 8, [255; 4]));
/// assert!((flip(&black, &white)?.get(4, 4) - 0.967).abs() < 1e-3);
/// # Ok::<(), lf_math::GeometryError>(())
/// ```
///
/// # Errors
/// The pictures must have the same size.
pub fn flip(reference: &Image<[u8; 4]>, test: &Image<[u8; 4]>) -> Result<Image<f32>, GeometryError> {
    flip_at(PIXELS_PER_DEGREE, reference, test)
}

fn flip_at(ppd: f32, reference: &Image<[u8; 4]>, test: &Image<[u8; 4]>) -> Result<Image<f32>, GeometryError> {
    same_size("test image", test, reference)?;
    let (a, b) = (Seen::new(reference, ppd), Seen::new(test, ppd));
    let most = libm::powf(hyab(hunted_lab(Vec3::Y), hunted_lab(Vec3::Z)), COLOR_EXPONENT);
    let error = |i: usize| {
        let color = knee(libm::powf(hyab(a.colors[i], b.colors[i]), COLOR_EXPONENT) / most);
        let apart = (a.features[i] - b.features[i]).abs().max_element();
        libm::powf(color, 1.0 - libm::powf(apart * FRAC_1_SQRT_2, FEATURE_EXPONENT))
    };
    Image::new(reference.width(), reference.height(), (0..a.colors.len()).map(error).collect())
}

/// What the eye makes of each pixel of a picture.
struct Seen {
    /// Blurred, in CIELAB with Hunt's adjustment.
    colors: Vec<Vec3>,
    /// Strength of edges and of points.
    features: Vec<Vec2>,
}

impl Seen {
    fn new(picture: &Image<[u8; 4]>, ppd: f32) -> Self {
        let linear: [f32; 256] = core::array::from_fn(|i| linear_from_srgb(i as f32 / 255.0));
        let opponent = picture.map(|[r, g, b, _]| ycxcz(Vec3::from([r, g, b].map(|value| linear[usize::from(value)]))));
        Self {
            colors: blurred(&opponent, ppd),
            features: features(&opponent.map(|color| (color.x + 16.0) / 116.0), ppd),
        }
    }
}

/// Linearised CIELAB: opponent colours that may be blurred.
fn ycxcz(linear: Vec3) -> Vec3 {
    let Vec3 { x, y, z } = XYZ_FROM_RGB * linear / WHITE;
    Vec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

fn rgb_from_ycxcz(color: Vec3, rgb_from_xyz: &Mat3) -> Vec3 {
    let y = (color.x + 16.0) / 116.0;
    *rgb_from_xyz * (Vec3::new(y + color.y / 500.0, y, y - color.z / 200.0) * WHITE)
}

/// CIELAB, colours weaker where it is dark (Hunt's effect).
fn hunted_lab(linear: Vec3) -> Vec3 {
    const DELTA: f32 = 6.0 / 29.0;
    let root = |t: f32| {
        if t > DELTA * DELTA * DELTA { libm::cbrtf(t) } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let [x, y, z] = (XYZ_FROM_RGB * linear / WHITE).to_array().map(root);
    let lightness = 116.0 * y - 16.0;
    Vec3::new(lightness, 5.0 * lightness * (x - y), 2.0 * lightness * (y - z))
}

/// City block distance of lightness and colour, which is Euclidean in itself (Abasi et al. 2020).
fn hyab(a: Vec3, b: Vec3) -> f32 {
    let apart = a - b;
    apart.x.abs() + Vec2::new(apart.y, apart.z).length()
}

/// Two straight pieces: most of the range for what is seen often.
fn knee(share: f32) -> f32 {
    if share < KNEE_AT { share * KNEE / KNEE_AT } else { KNEE + (share - KNEE_AT) / (1.0 - KNEE_AT) * (1.0 - KNEE) }
}

/// The picture as blurred by contrast sensitivity.
fn blurred(opponent: &Image<Vec3>, ppd: f32) -> Vec<Vec3> {
    let widest = BLUE_YELLOW[0][1];
    let radius = libm::ceilf(3.0 * libm::sqrtf(widest / (2.0 * PI * PI)) * ppd) as usize;
    let bell = |b: f32| kernel(radius, |x| libm::expf(-PI * PI * (x / ppd) * (x / ppd) / b));
    let blur = |plane: &Image<f32>, kernel: &[f32]| filtered(plane, kernel, kernel);
    let [y, cx, cz] = [0, 1, 2].map(|channel| opponent.map(|color| color[channel]));
    let (y, cx) = (blur(&y, &normalized(bell(ACHROMATIC))), blur(&cx, &normalized(bell(RED_GREEN))));
    // Each part of the sum is the square of its own kernel; all weights together sum to 1.
    let parts = BLUE_YELLOW.map(|[a, b]| {
        let height = libm::sqrtf(a * libm::sqrtf(PI / b));
        bell(b).into_iter().map(|weight| height * weight).collect::<Vec<f32>>()
    });
    let sums: [f32; 2] = core::array::from_fn(|i| parts[i].iter().sum());
    let sum = libm::hypotf(sums[0], sums[1]);
    let [first, second] = parts.map(|part| {
        let part: Vec<f32> = part.into_iter().map(|weight| weight / sum).collect();
        blur(&cz, &part)
    });
    let rgb_from_xyz = XYZ_FROM_RGB.inverse();
    let color = |i: usize| {
        let color = Vec3::new(y.texels()[i], cx.texels()[i], first.texels()[i] + second.texels()[i]);
        hunted_lab(rgb_from_ycxcz(color, &rgb_from_xyz).clamp(Vec3::ZERO, Vec3::ONE))
    };
    (0..opponent.texels().len()).map(color).collect()
}

/// Length of the gradient and of the two second derivatives, at the width of features that the eye sees.
fn features(grey: &Image<f32>, ppd: f32) -> Vec<Vec2> {
    let sigma = 0.5 * FEATURE_WIDTH * ppd;
    let radius = libm::ceilf(3.0 * sigma) as usize;
    let smooth = normalized(kernel(radius, |x| gaussian(x, sigma)));
    let slope = balanced(kernel(radius, |x| -x * gaussian(x, sigma)));
    let bend = balanced(kernel(radius, |x| (x * x / (sigma * sigma) - 1.0) * gaussian(x, sigma)));
    let smooth_rows = along_rows(grey, &smooth);
    let [edges, points] = [slope, bend].map(|derivative| {
        let across = down_columns(&along_rows(grey, &derivative), &smooth);
        let down = down_columns(&smooth_rows, &derivative);
        let lengths = across.texels().iter().zip(down.texels()).map(|(x, y)| Vec2::new(*x, *y).length());
        lengths.collect::<Vec<f32>>()
    });
    edges.into_iter().zip(points).map(|(edge, point)| Vec2::new(edge, point)).collect()
}

/// Positive weights that sum to 1, negative ones to −1.
fn balanced(mut kernel: Vec<f32>) -> Vec<f32> {
    let sum = |positive: bool| kernel.iter().filter(|w| (**w > 0.0) == positive).map(|w| w.abs()).sum::<f32>();
    let (up, down) = (sum(true), sum(false));
    kernel.iter_mut().for_each(|weight| *weight /= if *weight > 0.0 { up } else { down });
    kernel
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uniform(color: [u8; 3]) -> Image<[u8; 4]> {
        Image::filled(16, 16, [color[0], color[1], color[2], 255])
    }

    /// Of even pictures neither blur nor features are left: the error follows from published CIELAB values of sRGB's corners.
    #[test]
    fn even_pictures_have_the_error_of_their_colours() {
        let lab = |l: f32, a: f32, b: f32| Vec3::new(l, 0.01 * l * a, 0.01 * l * b);
        let colors = [
            ([0, 0, 0], lab(0.0, 0.0, 0.0)),
            ([255, 255, 255], lab(100.0, 0.0, 0.0)),
            ([255, 0, 0], lab(53.24, 80.09, 67.20)),
            ([0, 255, 0], lab(87.73, -86.18, 83.18)),
            ([0, 0, 255], lab(32.30, 79.19, -107.86)),
            ([255, 255, 0], lab(97.14, -21.55, 94.48)),
            ([255, 0, 255], lab(60.32, 98.23, -60.82)),
            ([0, 255, 255], lab(91.11, -48.09, -14.13)),
            ([119, 119, 119], lab(50.03, 0.0, 0.0)),
        ];
        let most = hyab(colors[3].1, colors[4].1).powf(0.7);
        for (a, lab_a) in colors {
            for (b, lab_b) in colors {
                let share = hyab(lab_a, lab_b).powf(0.7) / most;
                let expected = if share < 0.4 { share * 2.375 } else { 0.95 + (share - 0.4) / 12.0 };
                let found = flip(&uniform(a), &uniform(b)).unwrap();
                assert!((found.get(7, 3) - expected).abs() < 0.001, "{a:?} {b:?}: {} {expected}", found.get(7, 3));
            }
        }
    }

    #[test]
    fn a_vanished_point_is_worse_where_it_is_large_to_the_eye() {
        let reference = uniform([128; 3]);
        let mut test = reference.clone();
        test.texels_mut()[8 * 16 + 8] = [255; 4];
        let at = |ppd: f32| flip_at(ppd, &reference, &test).unwrap().get(8, 8);
        assert!(at(20.0) > at(67.0) && at(67.0) > at(200.0) && at(200.0) > 0.0);
        assert_eq!(flip(&test, &test).unwrap().texels(), [0.0; 256]);
    }

    #[test]
    fn refuses_unequal_sizes() {
        assert!(flip(&uniform([0; 3]), &Image::filled(16, 15, [0; 4])).is_err());
    }
}

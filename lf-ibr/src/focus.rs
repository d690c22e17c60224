//! The focal plane of a slab, found from its images alone.
//!
//! A camera that stands between two others is left out and predicted by each of them: fetched bilinearly where a plane at some depth
//! would have moved to (Eq. 6 of Yu, Yang & McMillan). The plane with the least mean squared error over all cameras that are left out so
//! is the focal plane: a least-squares sweep over disparities, every half texel at first, then in ever smaller steps about the best.
//!
//! The two predict alone, though the renderer blends them. A blend's error would lead astray: a wrong plane blurs it, by the
//! square of the disparity's error, and so does interpolation between texels, by f·(1 − f) at a fraction f; the sum of both is least at
//! whole texels wherever the plane is. Alone, a wrong plane shifts the texture, which weighs far more than the blur.
//!
//! All disparities are tried on the same texels, an eighth of the image away from its edges, evenly spread over cameras and images; which
//! they are depends on nothing but the slab. Time does not grow with the number of cameras.
//!
//! It finds one plane for all texels. Noise without texture leans to half a texel, where interpolation hides it.

use glam::Vec2;
use lf_math::{Slab, SlabTexels};
use rayon::prelude::*;

use crate::slabs::fetch_within;
use crate::texel::Texel;

/// Texels that disparities are swept on: the best half texel needs few, its parts more.
const COARSE_SAMPLES: usize = 1 << 14;
const FINE_SAMPLES: usize = 1 << 17;
/// Samples tried for each of them, if few are far enough from the edges.
const TRIES: usize = 8;
/// Steps of the sweep, texels per camera.
const COARSE_STEP: f32 = 0.5;
const FINE_STEP: f32 = 1.0 / 128.0;
/// Disparities up to this share of an image are tried: more texels would be needed at its edges than are left.
const REACH: f32 = 1.0 / 8.0;
/// Samples that one thread adds up: sums must not depend on how many threads there are.
const CHUNK: usize = 1 << 10;

/// How well a plane predicts cameras that are left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneError {
    /// Of the plane, 1/m from the camera plane: 0 is infinity, negative is what only rectified pictures have.
    pub inverse_depth: f32,
    /// Mean squared error of the predicted R, G and B values, sRGB-encoded, in steps of 1/255 squared.
    pub mse: f64,
}

/// The focal plane that predicts left-out cameras best.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageFocus {
    /// The best plane.
    pub best: PlaneError,
    /// The error without a focal plane, that is with one at infinity.
    pub infinity: PlaneError,
    /// The error of planes in steps of half a texel, the farthest first.
    pub curve: Vec<PlaneError>,
}

impl ImageFocus {
    /// The focal depth to give the slab, metres; `None`, infinity, if the best plane is at infinity or beyond.
    #[must_use]
    pub fn focal_depth(&self) -> Option<f32> {
        Some(self.best.inverse_depth.recip()).filter(|depth| *depth > 0.0 && depth.is_finite())
    }
}

/// Finds the plane that predicts the cameras of a slab best from those beside them.
///
/// `None` if no camera with an image stands between two others, or the images are but two texels wide. Where all planes are as
/// good, as in images of one colour, the farthest is the best: infinity.
#[must_use]
pub fn focus_from_images<T: Texel>(slab: &Slab, texels: &SlabTexels<T>) -> Option<ImageFocus> {
    let sweep = Sweep::new(slab, texels)?;
    let coarse = sweep.samples.len().min(COARSE_SAMPLES);
    let curve: Vec<PlaneError> =
        sweep.disparities().map(|disparity| sweep.error(disparity, &sweep.samples[..coarse])).collect();
    let nearer_infinity = |a: &PlaneError, b: &PlaneError| {
        a.mse.total_cmp(&b.mse).then(a.inverse_depth.abs().total_cmp(&b.inverse_depth.abs()))
    };
    let mut place = curve.iter().copied().min_by(nearer_infinity)?.inverse_depth / sweep.unit;
    let mut best = sweep.error(place, &sweep.samples);
    let mut step = 0.5 * COARSE_STEP;
    while step >= FINE_STEP {
        let beside = [-step, step].map(|offset| sweep.error(place + offset, &sweep.samples));
        best = beside.into_iter().fold(best, |best, other| if other.mse < best.mse { other } else { best });
        place = best.inverse_depth / sweep.unit;
        step *= 0.5;
    }
    Some(ImageFocus { best, infinity: sweep.error(0.0, &sweep.samples), curve })
}

/// A texel of a camera between two others, and the axis on which they stand: 0 for s, 1 for t.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    pub(crate) camera: [u32; 2],
    pub(crate) texel: [u32; 2],
    pub(crate) axis: usize,
}

/// What disparities are tried on. A disparity is here that of the axis along which planes move farthest, texels per camera.
pub(crate) struct Sweep<'a, T> {
    slab: &'a Slab,
    texels: &'a SlabTexels<T>,
    pub(crate) samples: Vec<Sample>,
    /// The largest disparity.
    pub(crate) reach: f32,
    /// Inverse depth of a plane whose disparity is one texel, 1/m.
    pub(crate) unit: f32,
}

impl<'a, T: Texel> Sweep<'a, T> {
    pub(crate) fn new(slab: &'a Slab, texels: &'a SlabTexels<T>) -> Option<Self> {
        texels.check(slab).ok()?;
        let axes: Vec<usize> = (0..2).filter(|&i| slab.cameras()[i] > 2).collect();
        let (per_inverse, resolution) = (slab.disparity_at(1.0), slab.resolution());
        // Both axes are kept to their share of the image.
        let farthest = axes.iter().map(|&i| per_inverse[i]).reduce(f32::max)?;
        let limit = axes.iter().map(|&i| REACH * resolution[i] as f32 / per_inverse[i]).reduce(f32::min)?;
        let mut sweep = Self { slab, texels, samples: Vec::new(), reach: limit * farthest, unit: farthest.recip() };
        let tried = (0..(TRIES * FINE_SAMPLES) as u32).map(|n| Sample::spread(slab, n, &axes));
        let samples = tried.filter(|sample| sweep.is_usable(sample)).take(FINE_SAMPLES).collect();
        sweep.samples = samples;
        (!sweep.samples.is_empty()).then_some(sweep)
    }

    /// What is tried, from the farthest plane to the nearest.
    pub(crate) fn disparities(&self) -> impl Iterator<Item = f32> {
        let steps = (self.reach / COARSE_STEP) as i32;
        (-steps..=steps).map(|i| i as f32 * COARSE_STEP)
    }

    /// Whether all disparities can be tried on a sample.
    pub(crate) fn is_usable(&self, sample: &Sample) -> bool {
        [-self.reach, self.reach].iter().all(|&disparity| self.residual(sample, disparity).is_some())
    }

    /// Mean squared error of the prediction at a disparity.
    fn error(&self, disparity: f32, samples: &[Sample]) -> PlaneError {
        let sum =
            |samples: &[Sample]| samples.iter().filter_map(|sample| self.residual(sample, disparity)).sum::<f64>();
        let sums: Vec<f64> = samples.par_chunks(CHUNK).map(sum).collect();
        let mse = sums.iter().sum::<f64>() / (3 * samples.len()) as f64;
        PlaneError { inverse_depth: disparity * self.unit, mse }
    }

    /// Squared error of a texel, the mean of both predictions, summed over its channels; `None` if one of the three images lacks it.
    pub(crate) fn residual(&self, sample: &Sample, disparity: f32) -> Option<f64> {
        let truth = T::color(self.texels.texel(sample.camera, sample.texel)?.value());
        let per_camera = self.slab.disparity_at(disparity * self.unit)[sample.axis];
        let squared = |side: i32| {
            let (mut camera, mut place) = (sample.camera, Vec2::new(sample.texel[0] as f32, sample.texel[1] as f32));
            camera[sample.axis] = camera[sample.axis].checked_add_signed(side)?;
            place[sample.axis] -= side as f32 * per_camera;
            let predicted = T::color(fetch_within(&self.texels.image(camera)?, place)?);
            Some(f64::from((255.0 * (predicted - truth)).length_squared()))
        };
        Some(0.5 * (squared(-1)? + squared(1)?))
    }
}

impl Sample {
    /// The `n`-th of the samples that are spread evenly, moved between two cameras of one of `axes`.
    fn spread(slab: &Slab, n: u32, axes: &[usize]) -> Self {
        let [camera, texel] = slab.spread_sample(n);
        let axis = axes[n as usize % axes.len()];
        let mut sample = Self { camera, texel, axis };
        sample.camera[axis] = camera[axis].clamp(1, slab.cameras()[axis] - 2);
        sample
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lf_math::{Face, SampledAxis};

    fn slab(cameras: [u32; 2], resolution: [u32; 2]) -> Slab {
        let st = cameras.map(|count| SampledAxis::new(-0.2, 0.1, count).unwrap());
        let uv = resolution.map(|count| SampledAxis::spanning(-0.5, 0.5, count).unwrap());
        Slab::new(Face::NegZ, 0.0, st, uv, None).unwrap()
    }

    /// What a camera sees of a plane with waves on it, one of them `texels` texels long: a closed form, without interpolation.
    fn waves(slab: &Slab, inverse_depth: f32, texels: f32) -> SlabTexels {
        let [s, t] = slab.cameras();
        let [width, height] = slab.resolution();
        let disparity = slab.disparity_at(inverse_depth);
        let wave = |x: f32, y: f32, length: f32| ((x + 0.4 * y) * std::f32::consts::TAU / length).sin();
        let texel = |[s, t, u, v]: [u32; 4]| {
            // Camera s sees at u + disparity · s what camera 0 sees at … (Eq. 6): the place on the plane, in texels of camera 0.
            let (x, y) = (u as f32 + disparity.x * s as f32, v as f32 + disparity.y * t as f32);
            let value = 128.0 + 60.0 * wave(x, y, texels) + 50.0 * wave(y, -x, 2.3 * texels);
            [value.round() as u8, (255.0 - value).round() as u8, 90, 255]
        };
        let all = (0..t).flat_map(move |t| (0..s).map(move |s| [s, t]));
        let all = all.flat_map(move |[s, t]| (0..height).flat_map(move |v| (0..width).map(move |u| [s, t, u, v])));
        SlabTexels::new(slab, all.map(texel).collect()).unwrap()
    }

    /// Planes in front of infinity, at it and beyond it, between texels and on them.
    #[test]
    fn a_plane_is_found_where_it_is() {
        for (cameras, disparities) in [([5, 4], &[0.0, 0.7, 2.0, 3.31, -1.25][..]), ([5, 1], &[0.6]), ([2, 5], &[-0.4])]
        {
            let slab = slab(cameras, [64, 56]);
            for &disparity in disparities {
                let inverse_depth = disparity / slab.disparity_at(1.0).max_element();
                let found = focus_from_images(&slab, &waves(&slab, inverse_depth, 13.0)).unwrap();
                let texels_off =
                    (found.best.inverse_depth - inverse_depth).abs() * slab.disparity_at(1.0).max_element();
                assert!(texels_off < 0.04, "{cameras:?} {disparity}: off by {texels_off}");
                // Rounding to 8 bits, and what bilinear interpolation takes from waves of 13 texels.
                assert!(found.best.mse < 6.0, "{disparity}: {}", found.best.mse);
                assert!(found.best.mse <= found.infinity.mse);
                assert_eq!(found.focal_depth().is_some(), found.best.inverse_depth > 0.0);
            }
        }
    }

    #[test]
    fn the_curve_has_its_least_error_where_the_plane_is() {
        let slab = slab([5, 5], [96, 96]);
        let per_inverse = slab.disparity_at(1.0).max_element();
        let found = focus_from_images(&slab, &waves(&slab, 2.0 / per_inverse, 13.0)).unwrap();
        assert!(found.curve.windows(2).all(|pair| pair[0].inverse_depth < pair[1].inverse_depth));
        let least = found.curve.iter().min_by(|a, b| a.mse.total_cmp(&b.mse)).unwrap();
        assert!((least.inverse_depth * per_inverse - 2.0).abs() < 1e-4);
        // On either side of it the error grows.
        let place = found.curve.iter().position(|point| point == least).unwrap();
        for step in 0..4 {
            assert!(found.curve[place + step].mse < found.curve[place + step + 1].mse);
            assert!(found.curve[place - step].mse < found.curve[place - step - 1].mse);
        }
    }

    #[test]
    fn images_of_one_colour_focus_at_infinity() {
        let slab = slab([4, 4], [32, 32]);
        let texels = SlabTexels::new(&slab, vec![[90, 120, 7, 255]; 16 * 32 * 32]).unwrap();
        let found = focus_from_images(&slab, &texels).unwrap();
        assert_eq!((found.best.inverse_depth, found.best.mse, found.focal_depth()), (0.0, 0.0, None));
    }

    #[test]
    fn without_a_camera_between_two_others_nothing_is_found() {
        for (cameras, resolution) in [([2, 2], [64, 64]), ([1, 1], [64, 64]), ([5, 5], [1, 1])] {
            let slab = slab(cameras, resolution);
            let count = cameras[0] * cameras[1] * resolution[0] * resolution[1];
            let texels = SlabTexels::new(&slab, vec![[0, 0, 0, 255]; count as usize]).unwrap();
            assert_eq!(focus_from_images(&slab, &texels), None);
        }
    }

    /// Missing cameras and cropped images: what is there decides.
    #[test]
    fn a_plane_is_found_from_what_is_there() {
        let slab = slab([7, 5], [96, 96]);
        let inverse_depth = 1.6 / slab.disparity_at(1.0).max_element();
        let coverage = lf_math::Coverage::new(&slab, vec![8..80; 7], vec![0..96, 0..90, 4..96, 0..96, 0..96]).unwrap();
        let kept = (0..35).map(|camera| camera % 11 != 5).collect();
        let texels = waves(&slab, inverse_depth, 13.0).crop(coverage.with_cameras(kept).unwrap()).unwrap();
        let found = focus_from_images(&slab, &texels).unwrap();
        assert!((found.best.inverse_depth / inverse_depth - 1.0).abs() < 0.02, "{found:?}");
    }
}

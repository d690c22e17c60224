//! How much work a ray is worth, and what is known after it.

use glam::{DVec3, Vec3};

/// Which light is traced, and how well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quality {
    /// Which light.
    pub illumination: Illumination,
    /// How often each ray is traced; 0 counts as 1. The error falls with the root of it, and faster in soft light: the samples
    /// of a ray are spread evenly over what they choose among.
    pub samples: u32,
    /// Another seed gives another noise.
    pub seed: u64,
}

/// Which light is traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Illumination {
    /// Light that comes straight from its source, and the ambient term for the rest. Up to 16 mirrors and glass surfaces
    /// in a row are looked through. Where the ambient light is not black it stands for the environment's light on surfaces
    /// too, so that scenes without glowing surfaces need one sample a ray and have no noise.
    Direct,
    /// All light, by path tracing; no ambient term. What counts is scattering, mirrors and glass included: with 0 only what glows by
    /// itself is seen, 1 adds direct light, 2 light by one detour.
    Global {
        /// How often light may be scattered between its source and the ray's origin. (Mitsuba's `max_depth` less 1.)
        max_bounces: u32,
    },
}

impl Default for Quality {
    /// Direct light, one sample.
    fn default() -> Self {
        Self { illumination: Illumination::Direct, samples: 1, seed: 0 }
    }
}

/// A radiance and how well it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Mean radiance of all samples, linear RGB, W/(m²·sr).
    pub radiance: Vec3,
    /// Standard error of that mean, for each channel, as if samples were independent; infinite with one sample, which tells nothing
    /// about its error. Samples of one ray avoid each other, so that it is an upper bound: the true error is about as large
    /// where many scatterings decide, and several times smaller where light of some extent falls on a surface.
    /// With few samples it is uncertain itself, and mostly too small where rare samples are bright: a lamp close to a wall.
    pub standard_error: Vec3,
    /// Ray parameter of the hit; infinite if the ray left the scene.
    pub distance: f32,
    /// How often the ray was traced.
    pub samples: u32,
}

impl Estimate {
    /// Mean and standard error (Welford's sums, in `f64`). Where samples avoid each other their covariance c is negative: the squared standard
    /// error is then too large by −c on average.
    pub(crate) fn of(samples: impl Iterator<Item = Vec3>, distance: f32) -> Self {
        let (mut count, mut mean, mut squares) = (0u32, DVec3::ZERO, DVec3::ZERO);
        for sample in samples.map(Vec3::as_dvec3) {
            count += 1;
            let before = sample - mean;
            mean += before / f64::from(count);
            squares += before * (sample - mean);
        }
        let n = f64::from(count);
        let variance = if count > 1 { squares / (n - 1.0) } else { DVec3::INFINITY };
        let standard_error = (variance / n).map(f64::sqrt).as_vec3();
        Self { radiance: mean.as_vec3(), standard_error, distance, samples: count }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_error_of_few_samples() {
        let samples = [Vec3::new(1.0, 5.0, 0.0), Vec3::new(2.0, 5.0, 1.0), Vec3::new(6.0, 5.0, 0.0)];
        let estimate = Estimate::of(samples.into_iter(), 1.0);
        assert!((estimate.radiance - Vec3::new(3.0, 5.0, 1.0 / 3.0)).length() < 1e-6);
        // Variances 7, 0 and 1/3, over three samples.
        let expected = Vec3::new((7.0f32 / 3.0).sqrt(), 0.0, 1.0 / 3.0);
        assert!((estimate.standard_error - expected).length() < 1e-6, "{estimate:?}");
        assert_eq!(Estimate::of([Vec3::ONE].into_iter(), 1.0).standard_error, Vec3::INFINITY);
    }
}

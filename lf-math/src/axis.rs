//! One regularly sampled axis: camera positions along s or t, or ray slopes along u or v.

use crate::error::{GeometryError, finite, positive};

/// `count` samples at `first + i·step`, `i = 0 … count − 1`.
///
/// This is one row of the paper's Eq. 1, `s′ = s·s₁ + s₀`, in a form that has no special case for a single sample.
/// Sample `i` lies at `i` in *index units*; in texel space its centre is at `i + ½`. There are at most 2²⁴ samples, so
/// that every index is exact in `f32`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampledAxis {
    first: f32,
    step: f32,
    count: u32,
}

impl SampledAxis {
    /// Samples at `first + i·step`.
    ///
    /// # Errors
    /// `first` must be finite, `step` finite and greater than 0, `count` 1 to 2²⁴, and the last sample finite.
    pub fn new(first: f32, step: f32, count: u32) -> Result<Self, GeometryError> {
        check_count(count)?;
        finite("first sample", first)?;
        positive("sample step", step)?;
        let axis = Self { first, step, count };
        finite("last sample", axis.last())?;
        Ok(axis)
    }

    /// `count` samples from `min` to `max` inclusive; a single sample sits in the middle.
    ///
    /// # Errors
    /// As [`Self::new`]; `max` must exceed `min`.
    pub fn spanning(min: f32, max: f32, count: u32) -> Result<Self, GeometryError> {
        check_count(count)?;
        let extent = positive("axis extent", max - min)?;
        match count {
            1 => Self::new(min + 0.5 * extent, extent, 1),
            _ => Self::new(min, extent / (count - 1) as f32, count),
        }
    }

    /// Coordinate of sample 0.
    #[inline]
    #[must_use]
    pub fn first(&self) -> f32 {
        self.first
    }

    /// Distance between neighbouring samples, greater than 0.
    #[inline]
    #[must_use]
    pub fn step(&self) -> f32 {
        self.step
    }

    /// Number of samples, at least 1.
    #[inline]
    #[must_use]
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Coordinate of the last sample.
    #[must_use]
    pub fn last(&self) -> f32 {
        self.coord(self.last_index())
    }

    /// Index of the last sample, `count − 1`.
    #[inline]
    #[must_use]
    pub fn last_index(&self) -> f32 {
        (self.count - 1) as f32
    }

    /// Coordinate of a real-valued sample index.
    #[must_use]
    pub fn coord(&self, index: f32) -> f32 {
        self.first + index * self.step
    }

    /// Real-valued sample index of a coordinate (Eq. 1). Forward error: at most 2 ulp of `|x| + |first|`, in steps.
    #[inline]
    #[must_use]
    pub fn index(&self, coord: f32) -> f32 {
        (coord - self.first) / self.step
    }

    /// Whether a real-valued index lies within the samples, allowing for the rounding of [`Self::index`]: a few ulp of the
    /// coordinates at the ends, in steps.
    #[must_use]
    pub fn contains_index(&self, index: f32) -> bool {
        let reach = (self.first.abs() + self.last().abs()) / self.step;
        let slack = 4.0 * f32::EPSILON * (self.count as f32 + reach);
        index >= -slack && index <= self.last_index() + slack
    }
}

fn check_count(count: u32) -> Result<(), GeometryError> {
    const MAX: u32 = 1 << f32::MANTISSA_DIGITS;
    match count {
        0 => Err(GeometryError::ZeroCount { what: "sample count" }),
        1..=MAX => Ok(()),
        _ => Err(GeometryError::TooMany { what: "sample count", count, max: MAX }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn spanning_hits_both_ends() {
        let axis = SampledAxis::spanning(-1.5, 1.5, 32).unwrap();
        assert_eq!(axis.first(), -1.5);
        assert!((axis.last() - 1.5).abs() <= 2.0 * f32::EPSILON);
        assert!(axis.contains_index(axis.index(1.5)));
        assert!(!axis.contains_index(axis.index(1.5001)));
    }

    #[test]
    fn single_sample_sits_in_the_middle() {
        let axis = SampledAxis::spanning(-1.0, 3.0, 1).unwrap();
        assert_eq!((axis.first(), axis.count()), (1.0, 1));
        assert_eq!(axis.index(1.0), 0.0);
    }

    #[test]
    fn refuses_what_has_no_samples() {
        assert!(SampledAxis::new(0.0, 1.0, 0).is_err());
        assert!(SampledAxis::new(0.0, 0.0, 4).is_err());
        assert!(SampledAxis::new(f32::NAN, 1.0, 4).is_err());
        assert!(SampledAxis::new(0.0, f32::MAX, 4).is_err());
        assert!(SampledAxis::spanning(1.0, 1.0, 2).is_err());
        assert_eq!(SampledAxis::spanning(0.0, 1.0, 0), Err(GeometryError::ZeroCount { what: "sample count" }));
        assert!(matches!(SampledAxis::new(0.0, 1e-9, (1 << 24) + 1), Err(GeometryError::TooMany { .. })));
    }

    #[test]
    fn the_largest_axis_and_far_ones_contain_their_ends() {
        let largest = SampledAxis::new(0.0, 1.0, 1 << 24).unwrap();
        assert_eq!(largest.last_index() as u32, (1 << 24) - 1);
        for axis in [largest, SampledAxis::new(1000.0, 1e-3, 5).unwrap(), SampledAxis::new(-7e8, 64.0, 3).unwrap()] {
            assert!(axis.contains_index(axis.index(axis.last())), "{axis:?}");
            let reach = axis.first().abs() + axis.last().abs();
            let beyond = axis.last() + 2.0 * axis.step() + 1e-5 * reach;
            assert!(!axis.contains_index(axis.index(beyond)), "{axis:?}");
        }
    }

    proptest! {
        #[test]
        fn index_inverts_coord(first in -1e3f32..1e3, step in 1e-3f32..1e3, count in 1u32..4096, t in 0.0f32..1.0) {
            let axis = SampledAxis::new(first, step, count).unwrap();
            let index = t * axis.last_index();
            // Exact oracle in f64: the two f32 roundings may each move the coordinate by half an ulp of its size.
            let coord = axis.coord(index);
            let exact = (f64::from(coord) - f64::from(first)) / f64::from(step);
            let bound = 2.0 * f64::from(f32::EPSILON) * (exact.abs() + f64::from(coord.abs().max(first.abs()) / step));
            prop_assert!((f64::from(axis.index(coord)) - exact).abs() <= bound);
        }
    }
}

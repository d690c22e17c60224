//! Regular grids from irregular evidence: strides in indices, and lines through positions.

use crate::PictureAxis;

/// Indices that run in equal steps, such as 0, 2, 4.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Stride {
    first: u32,
    step: u32,
    pub(crate) count: u32,
}

impl Stride {
    /// The longest stride that meets all of the indices; `None` if there are none.
    ///
    /// A row or column that is missing as a whole thus stays a gap where its neighbours show it.
    pub(crate) fn of(indices: impl Iterator<Item = u32> + Clone) -> Option<Self> {
        let first = indices.clone().min()?;
        let last = indices.clone().max()?;
        let step = indices.map(|index| index - first).fold(0, greatest_common_divisor).max(1);
        Some(Self { first, step, count: (last - first) / step + 1 })
    }

    /// How many steps the index is from the first. It must be one of those that made the stride.
    pub(crate) fn rank(self, index: u32) -> u32 {
        (index - self.first) / self.step
    }

    /// The index of a rank below the count.
    pub(crate) fn index(self, rank: u32) -> u32 {
        self.first + rank * self.step
    }
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// A line through measured positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    /// The position at rank 0.
    pub(crate) first: f64,
    /// What each rank adds; may be negative. `None` if there is one rank only.
    pub(crate) step: Option<f64>,
    /// The largest distance of a position from the line.
    pub(crate) error: f64,
}

impl Line {
    /// The line of least squares through (rank, position); `None` if there are no points.
    pub(crate) fn fit(points: impl Iterator<Item = (u32, f64)> + Clone) -> Option<Self> {
        let n = points.clone().count() as f64;
        if n == 0.0 {
            return None;
        }
        let sums = points.clone().fold([0.0; 2], |[r, p], (rank, position)| [r + f64::from(rank), p + position]);
        let [mean_rank, mean] = sums.map(|sum| sum / n);
        let (mut covariance, mut variance) = (0.0, 0.0);
        for (rank, position) in points.clone() {
            let offset = f64::from(rank) - mean_rank;
            covariance += offset * (position - mean);
            variance += offset * offset;
        }
        let step = (variance > 0.0).then(|| covariance / variance);
        let slope = step.unwrap_or(0.0);
        let first = mean - slope * mean_rank;
        let error = points.map(|(rank, position)| (position - first - f64::from(rank) * slope).abs());
        Some(Self { first, step, error: error.fold(0.0, f64::max) })
    }

    /// The axis of `count` ranks, scaled, in ascending order of coordinates, and whether ranks descend along it.
    /// `spacing` is the step, in scaled units, of a single sample.
    pub(crate) fn axis(self, count: u32, scale: f64, spacing: f64) -> (PictureAxis, bool) {
        let step = self.step.map_or(spacing, |step| step * scale);
        let (first, last) = (self.first * scale, self.first * scale + f64::from(count - 1) * step);
        (PictureAxis { first: first.min(last), step: step.abs(), count }, step < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strides_keep_gaps() {
        let stride = |indices: &[u32]| Stride::of(indices.iter().copied());
        assert_eq!(stride(&[0, 2, 4]), Some(Stride { first: 0, step: 2, count: 3 }));
        assert_eq!(stride(&[7]), Some(Stride { first: 7, step: 1, count: 1 }));
        assert_eq!(stride(&[6, 0, 4]), Some(Stride { first: 0, step: 2, count: 4 }));
        assert_eq!(stride(&[1, 2, 4]), Some(Stride { first: 1, step: 1, count: 4 }));
        assert_eq!(stride(&[]), None);
        assert_eq!(stride(&[0, 2, 4]).unwrap().rank(4), 2);
    }

    #[test]
    fn a_line_is_found_exactly_and_its_error_too() {
        let line = Line::fit([(0, 5.0), (1, 3.0), (3, -1.0)].into_iter()).unwrap();
        assert!((line.first - 5.0).abs() < 1e-12 && (line.step.unwrap() + 2.0).abs() < 1e-12 && line.error < 1e-12);
        // 0, 1, 0 around the mean of 1/3.
        let bent = Line::fit([(0, 0.0), (1, 1.0), (2, 0.0)].into_iter()).unwrap();
        assert!(bent.step.unwrap().abs() < 1e-12 && (bent.error - 2.0 / 3.0).abs() < 1e-12);
        let (axis, reversed) = line.axis(4, 2.0, 1.0);
        assert!(reversed && (axis.first + 2.0).abs() < 1e-12 && (axis.last() - 10.0).abs() < 1e-12);
        assert_eq!(Line::fit([(4, 2.0)].into_iter()).unwrap().step, None);
    }
}

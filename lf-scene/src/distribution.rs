//! Choosing one of many in proportion to weights.

use std::ops::Range;

/// Weights, added up.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Distribution {
    cumulative: Vec<f64>,
}

impl Distribution {
    /// `None` if no weight is positive. Weights must be finite and not negative.
    pub(crate) fn new(weights: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sum = 0.0;
        let add = |weight: f64| {
            sum += weight;
            sum
        };
        let cumulative: Vec<_> = weights.into_iter().map(add).collect();
        (sum > 0.0).then_some(Self { cumulative })
    }

    /// Each `size` indices in a row as one.
    pub(crate) fn grouped(&self, size: usize) -> Self {
        Self { cumulative: self.cumulative.chunks(size).filter_map(|group| group.last().copied()).collect() }
    }

    /// The sum of all weights.
    pub(crate) fn total(&self) -> f64 {
        self.cumulative.last().copied().unwrap_or(0.0)
    }

    /// The index that belongs to a number in 0 … 1, and where between its neighbours the number is, again in 0 … 1. The
    /// index's weight is positive.
    pub(crate) fn choose(&self, uniform: f64) -> (usize, f64) {
        self.choose_among(0..self.cumulative.len(), uniform)
    }

    /// The same among a range of indices, of which one must have a positive weight.
    pub(crate) fn choose_among(&self, range: Range<usize>, uniform: f64) -> (usize, f64) {
        let before = |index: usize| index.checked_sub(1).map_or(0.0, |last| self.cumulative[last]);
        let [first, end] = [range.start, range.end].map(before);
        let position = (first + uniform * (end - first)).min(end.next_down());
        let index = range.start + self.cumulative[range].partition_point(|&sum| sum <= position);
        (index, (position - before(index)) / (before(index + 1) - before(index)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_the_weights() {
        let weights = [0.0, 1.0, 0.0, 3.0, 4.0, 0.0];
        let distribution = Distribution::new(weights).unwrap();
        let mut counts = [0.0; 6];
        for i in 0..800 {
            let (index, rest) = distribution.choose((f64::from(i) + 0.5) / 800.0);
            counts[index] += 0.01;
            // The numbers that choose an index are left spread over 0 … 1.
            let mean = 100.0 * weights[index];
            let before = 100.0 * weights[..index].iter().sum::<f64>();
            assert!((rest - (f64::from(i) + 0.5 - before) / mean).abs() < 1e-9, "{i}: {index} {rest}");
        }
        assert!(counts.iter().zip(weights).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-9), "{counts:?}");
        assert_eq!((distribution.choose(0.0), distribution.choose(1.0).0, distribution.total()), ((1, 0.0), 4, 8.0));
        assert_eq!(Distribution::new([0.0, 0.0]), None);
    }

    #[test]
    fn groups_and_then_their_members() {
        let distribution = Distribution::new([0.0, 1.0, 0.0, 3.0, 4.0, 0.0]).unwrap();
        let pairs = distribution.grouped(2);
        assert_eq!([0.1, 0.3, 0.75].map(|x| pairs.choose(x).0), [0, 1, 2]);
        assert_eq!(
            [0..2, 2..4, 4..6].map(|pair| distribution.choose_among(pair, 0.25)),
            [(1, 0.25), (3, 0.25), (4, 0.25)]
        );
    }
}

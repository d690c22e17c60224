//! Choosing one of many in proportion to weights.

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

    /// The sum of all weights.
    pub(crate) fn total(&self) -> f64 {
        self.cumulative.last().copied().unwrap_or(0.0)
    }

    /// The index that belongs to a number in 0 … 1; its weight is positive.
    pub(crate) fn choose(&self, uniform: f64) -> usize {
        let position = (uniform * self.total()).min(self.total().next_down());
        self.cumulative.partition_point(|&sum| sum <= position)
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
            counts[distribution.choose((f64::from(i) + 0.5) / 800.0)] += 0.01;
        }
        assert!(counts.iter().zip(weights).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-9), "{counts:?}");
        assert_eq!((distribution.choose(0.0), distribution.choose(1.0), distribution.total()), (1, 4, 8.0));
        assert_eq!(Distribution::new([0.0, 0.0]), None);
    }
}

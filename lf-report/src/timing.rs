//! Wall-clock time per frame: measured repeatedly, kept sample by sample, reported as median and spread.

use std::time::Instant;

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

/// Seconds per frame of at least one frame.
///
/// All samples are finite and not negative. The median stands for the time of a method because single frames are
/// disturbed by whatever else the machine does, nearly always upwards: a mean would move with the disturbance.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    /// Ascending, never empty.
    sorted: Vec<f64>,
}

impl Timing {
    /// The timing of some frames, in seconds each, in any order.
    ///
    /// `None` if there are none or one is negative, infinite or not a number.
    #[must_use]
    pub fn from_seconds(mut samples: Vec<f64>) -> Option<Self> {
        if samples.is_empty() || samples.iter().any(|s| !s.is_finite() || *s < 0.0) {
            return None;
        }
        samples.sort_by(f64::total_cmp);
        Some(Self { sorted: samples })
    }

    /// Every sample in seconds, ascending.
    #[must_use]
    pub fn samples(&self) -> &[f64] {
        &self.sorted
    }

    /// Median in seconds.
    #[must_use]
    pub fn median(&self) -> f64 {
        self.quantile(0.5)
    }

    /// Shortest frame in seconds.
    #[must_use]
    pub fn min(&self) -> f64 {
        self.sorted[0]
    }

    /// Longest frame in seconds.
    #[must_use]
    pub fn max(&self) -> f64 {
        self.sorted[self.sorted.len() - 1]
    }

    /// First and third quartile in seconds.
    #[must_use]
    pub fn quartiles(&self) -> (f64, f64) {
        (self.quantile(0.25), self.quantile(0.75))
    }

    /// The value below which a fraction `q` ∈ \[0, 1\] of the samples lies, interpolated linearly between order
    /// statistics (Hyndman & Fan 1996, definition 7: the default of R and NumPy).
    fn quantile(&self, q: f64) -> f64 {
        let position = q * (self.sorted.len() - 1) as f64;
        let (below, above) = (position.floor() as usize, position.ceil() as usize);
        let (a, b) = (self.sorted[below], self.sorted[above]);
        a + (b - a) * position.fract()
    }
}

/// Milliseconds: `median_ms`, `min_ms`, `max_ms`, `q1_ms`, `q3_ms`, and in `samples` the number of frames timed.
impl Serialize for Timing {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (q1, q3) = self.quartiles();
        let mut fields = serializer.serialize_struct("Timing", 6)?;
        fields.serialize_field("median_ms", &(self.median() * 1e3))?;
        fields.serialize_field("min_ms", &(self.min() * 1e3))?;
        fields.serialize_field("max_ms", &(self.max() * 1e3))?;
        fields.serialize_field("q1_ms", &(q1 * 1e3))?;
        fields.serialize_field("q3_ms", &(q3 * 1e3))?;
        fields.serialize_field("samples", &self.sorted.len())?;
        fields.end()
    }
}

/// Calls `frame` `warm_up` times unmeasured, then `repeats` times (at least once), and returns the wall-clock time of
/// each of the latter.
///
/// Warming up fills caches, compiles pipelines and lets the clock frequency settle. `frame` must return only when its
/// work is done: on a GPU, wait for the device inside.
///
/// ```
/// let timing = lf_report::measure(1, 5, || std::thread::sleep(std::time::Duration::from_millis(2)));
/// assert_eq!(timing.samples().len(), 5);
/// assert!(timing.median() >= 0.002);
/// ```
pub fn measure(warm_up: usize, repeats: usize, mut frame: impl FnMut()) -> Timing {
    for _ in 0..warm_up {
        frame();
    }
    let mut timed = || {
        let start = Instant::now();
        frame();
        start.elapsed().as_secs_f64()
    };
    let mut sorted: Vec<f64> = (0..repeats.max(1)).map(|_| timed()).collect();
    sorted.sort_by(f64::total_cmp);
    Timing { sorted }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timing(samples: &[f64]) -> Timing {
        Timing::from_seconds(samples.to_vec()).unwrap()
    }

    #[test]
    fn quantiles_of_known_samples() {
        // (samples, median, first quartile, third quartile), computed by hand.
        let cases: [(&[f64], f64, f64, f64); 5] = [
            (&[7.0], 7.0, 7.0, 7.0),
            (&[2.0, 1.0], 1.5, 1.25, 1.75),
            (&[3.0, 1.0, 2.0], 2.0, 1.5, 2.5),
            (&[4.0, 3.0, 2.0, 1.0], 2.5, 1.75, 3.25),
            (&[5.0, 1.0, 100.0, 3.0, 2.0], 3.0, 2.0, 5.0),
        ];
        for (samples, median, q1, q3) in cases {
            let timing = timing(samples);
            assert_eq!((timing.median(), timing.quartiles()), (median, (q1, q3)), "{samples:?}");
        }
    }

    #[test]
    fn extremes_are_those_of_the_samples() {
        let timing = timing(&[0.5, 0.0, 2.0]);
        assert_eq!((timing.min(), timing.max(), timing.samples()), (0.0, 2.0, &[0.0, 0.5, 2.0][..]));
    }

    #[test]
    fn unusable_samples_are_refused() {
        for samples in [vec![], vec![1.0, f64::NAN], vec![f64::INFINITY], vec![1.0, -1e-9]] {
            assert_eq!(Timing::from_seconds(samples), None);
        }
    }

    #[test]
    fn serialises_in_milliseconds() {
        let json = serde_json::to_value(timing(&[0.001, 0.002, 0.004])).unwrap();
        let expected = serde_json::json!({
            "median_ms": 2.0, "min_ms": 1.0, "max_ms": 4.0, "q1_ms": 1.5, "q3_ms": 3.0, "samples": 3
        });
        assert_eq!(json, expected);
    }

    #[test]
    fn measure_calls_warm_up_and_repeats() {
        for (warm_up, repeats, calls, kept) in [(2, 3, 5, 3), (0, 0, 1, 1)] {
            let mut count = 0;
            let timing = measure(warm_up, repeats, || count += 1);
            assert_eq!((count, timing.samples().len()), (calls, kept));
        }
    }
}

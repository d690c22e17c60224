//! What errors are drawn against: a logarithmic axis of times or of bytes.

use crate::result::MethodResult;
use crate::units;

/// The horizontal axis of a plot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Axis {
    /// Median time per frame, milliseconds.
    Time,
    /// Memory on the device, megabytes.
    Bytes,
}

/// Least value shown: a logarithmic axis has no 0.
const LEAST: f64 = 1e-6;

impl Axis {
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Time => "Error against run time",
            Self::Bytes => "Error against memory",
        }
    }

    pub(crate) fn subtitle(self) -> &'static str {
        match self {
            Self::Time => {
                "Higher and further left is better. Grey lines: Pareto front of each reflector. \
                 Dashed: time of a method without error, such as the reference."
            }
            Self::Bytes => {
                "Higher and further left is better. Grey lines: Pareto front of each reflector. \
                 Dashed: memory of a method without error, such as the reference."
            }
        }
    }

    pub(crate) fn description(self) -> &'static str {
        match self {
            Self::Time => "median time per frame, ms (logarithmic)",
            Self::Bytes => "memory on the device, MB (logarithmic)",
        }
    }

    /// Where a result lies.
    pub(crate) fn value(self, result: &MethodResult) -> f64 {
        match self {
            Self::Time => 1e3 * result.timing.median(),
            Self::Bytes => result.bytes_on_device as f64 / 1e6,
        }
        .max(LEAST)
    }

    /// From where to where it scatters: its quartiles.
    pub(crate) fn spread(self, result: &MethodResult) -> (f64, f64) {
        let (q1, q3) = result.timing.quartiles();
        match self {
            Self::Time => ((1e3 * q1).max(LEAST), (1e3 * q3).max(LEAST)),
            Self::Bytes => (self.value(result), self.value(result)),
        }
    }

    /// What a result costs, for people.
    pub(crate) fn text(self, result: &MethodResult) -> String {
        match self {
            Self::Time => format!("{} ms", units::milliseconds(result.timing.median())),
            Self::Bytes => format!("{} MB", units::significant(result.bytes_on_device as f64 / 1e6)),
        }
    }

    /// The least and the greatest value, widened to steps of 1, 2, 5 so that no marker lies on the edge.
    pub(crate) fn range(self, results: &[MethodResult]) -> (f64, f64) {
        let values = || results.iter().flat_map(|r| [self.spread(r).0, self.value(r), self.spread(r).1]);
        let Some(least) = values().min_by(f64::total_cmp) else { return (1.0, 10.0) };
        let greatest = values().fold(least, f64::max);
        let steps = steps_125(least / 10.0, greatest * 10.0);
        let low = steps.iter().copied().rfind(|step| *step < least / 1.1).unwrap_or(least / 2.0);
        let high = steps.iter().copied().find(|step| *step > greatest * 1.1).unwrap_or(greatest * 2.0);
        (low, high)
    }
}

/// …, 1, 2, 5, 10, 20, 50, … from `low` to `high`, both included up to rounding.
fn steps_125(low: f64, high: f64) -> Vec<f64> {
    let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let steps = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|digit| digit * 10f64.powi(decade)));
    steps.filter(|step| *step >= low * (1.0 - 1e-9) && *step <= high * (1.0 + 1e-9)).collect()
}

/// Ticks at 1, 2, 5 of each decade, at powers of ten only where that would crowd the axis.
pub(crate) fn decade_ticks(range: (f64, f64)) -> Vec<f64> {
    let all = steps_125(range.0, range.1);
    if all.len() <= 13 {
        return all;
    }
    all.into_iter().filter(|step| (step.log10() - step.log10().round()).abs() < 1e-6).collect()
}

/// A tick's value without trailing zeros: 0.05, 2, 500.
pub(crate) fn tick_label(value: f64) -> String {
    let decimals = (-value.log10().floor()).max(0.0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn axes_enclose_the_data_in_steps() {
        let at = |ms: f64| sample::result("a", "m", &[30.0], ms * 1e-3);
        assert_eq!(Axis::Time.range(&[]), (1.0, 10.0));
        assert_eq!(Axis::Time.range(&[at(3.0), at(400.0)]), (2.0, 500.0));
        let large = MethodResult { bytes_on_device: 90_000_000, ..at(1.0) };
        assert_eq!(Axis::Bytes.range(&[at(3.0), large]), (5.0, 100.0));
        assert_eq!(decade_ticks((2.0, 50.0)), [2.0, 5.0, 10.0, 20.0, 50.0]);
        assert_eq!(decade_ticks((1e-3, 1e3)).len(), 7);
        assert_eq!([0.05, 1.0, 500.0].map(tick_label), ["0.05", "1", "500"]);
    }

    #[test]
    fn nothing_is_shown_at_zero() {
        let nothing = MethodResult { bytes_on_device: 0, ..sample::result("a", "m", &[30.0], 0.0) };
        for axis in [Axis::Time, Axis::Bytes] {
            assert_eq!(axis.value(&nothing), LEAST);
            assert!(axis.range(std::slice::from_ref(&nothing)).0 > 0.0);
        }
        assert_eq!(Axis::Bytes.text(&sample::result("a", "m", &[30.0], 0.0)), "6.29 MB");
    }
}

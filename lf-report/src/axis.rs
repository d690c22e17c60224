//! What a plot sets against what: its axes.

use crate::result::MethodResult;
use crate::units;

/// What a plot sets against what. Left is cheaper, higher is better.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plot {
    /// Error against the median time per frame.
    Time,
    /// Error against memory on the device.
    Device,
    /// Error against bytes on disk, of what is stored.
    Disk,
    /// Samples against the time it took to capture them.
    Capture,
}

/// Least value shown: a logarithmic axis has no 0.
const LEAST: f64 = 1e-6;

impl Plot {
    /// All of them, in the order of a page.
    pub const ALL: [Self; 4] = [Self::Time, Self::Device, Self::Disk, Self::Capture];

    /// A word for file names.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Device => "device",
            Self::Disk => "disk",
            Self::Capture => "capture",
        }
    }

    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Time => "Error against run time",
            Self::Device => "Error against memory",
            Self::Disk => "Error against bytes on disk",
            Self::Capture => "Samples against capture time",
        }
    }

    pub(crate) fn subtitle(self) -> &'static str {
        match self {
            Self::Time => {
                "Higher and further left is better. Grey line: Pareto front. \
                 Dashed: time of a method without error, such as the reference."
            }
            Self::Device => {
                "Higher and further left is better. Grey line: Pareto front. \
                 Dashed: memory of a method without error, such as the reference."
            }
            Self::Disk | Self::Capture => "Higher and further left is better. Grey line: Pareto front.",
        }
    }

    pub(crate) fn horizontal(self) -> &'static str {
        match self {
            Self::Time => "median time per frame, ms (logarithmic)",
            Self::Device => "memory on the device, MB (logarithmic)",
            Self::Disk => "file, MB (logarithmic)",
            Self::Capture => "preparation, s (logarithmic)",
        }
    }

    pub(crate) fn vertical(self) -> &'static str {
        match self {
            Self::Capture => "rays traced, millions (logarithmic)",
            _ => "PSNR, dB (mean of the eyes)",
        }
    }

    /// Whether a result has a place on it.
    pub(crate) fn shows(self, result: &MethodResult) -> bool {
        match self {
            Self::Time | Self::Device => true,
            Self::Disk => result.bytes_on_disk.is_some() && !result.is_reference(),
            Self::Capture => result.rays.is_some_and(|rays| rays > 0),
        }
    }

    /// How good a result is; `None` at the upper edge: no error, or none of its own.
    pub(crate) fn height(self, result: &MethodResult) -> Option<f64> {
        match self {
            Self::Capture => result.rays.map(|rays| (rays as f64 / 1e6).log10()),
            _ => result.mean_psnr_db().filter(|psnr| psnr.is_finite()),
        }
    }

    /// A tick of the vertical axis.
    pub(crate) fn height_label(self, height: f64) -> String {
        match self {
            Self::Capture => units::significant(10f64.powf(height)),
            _ => format!("{height:.0}"),
        }
    }

    /// The heights' range, with room below for labels and above for the marks at the upper edge.
    pub(crate) fn heights(self, results: &[&MethodResult]) -> (f64, f64) {
        let all = || results.iter().filter_map(|result| self.height(result));
        let (least, none) = if self == Self::Capture { (0.3, (-1.0, 2.0)) } else { (6.0, (0.0, 50.0)) };
        let Some(low) = all().min_by(f64::total_cmp) else { return none };
        let high = all().fold(low, f64::max);
        let room = 0.15 * (high - low).max(least);
        let (low, high) = (low - room, high + 2.0 * room);
        if self == Self::Capture { (low, high) } else { (low.floor(), high.ceil()) }
    }

    /// Round heights in a range.
    pub(crate) fn height_ticks(self, (low, high): (f64, f64)) -> Vec<f64> {
        if self == Self::Capture {
            return decade_ticks((10f64.powf(low), 10f64.powf(high))).into_iter().map(f64::log10).collect();
        }
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().find(|step| (high - low) / step <= 10.0).unwrap_or(50.0);
        let first = (low / step).ceil();
        (0..=((high / step).floor() - first) as i32).map(|i| step * (first + f64::from(i))).collect()
    }

    /// Whether two results are one point of this plot: what was captured once serves every device and search.
    pub(crate) fn same(self, a: &MethodResult, b: &MethodResult) -> bool {
        self == Self::Capture && a.method == b.method && a.preparation_s == b.preparation_s && a.rays == b.rays
    }

    /// Where a result lies.
    pub(crate) fn cost(self, result: &MethodResult) -> f64 {
        match self {
            Self::Time => 1e3 * result.timing.median(),
            Self::Device => result.bytes_on_device as f64 / 1e6,
            Self::Disk => result.bytes_on_disk.unwrap_or(0) as f64 / 1e6,
            Self::Capture => result.preparation_s,
        }
        .max(LEAST)
    }

    /// From where to where it scatters: its quartiles.
    pub(crate) fn spread(self, result: &MethodResult) -> (f64, f64) {
        let (q1, q3) = result.timing.quartiles();
        match self {
            Self::Time => ((1e3 * q1).max(LEAST), (1e3 * q3).max(LEAST)),
            _ => (self.cost(result), self.cost(result)),
        }
    }

    /// What a result costs, for people.
    pub(crate) fn text(self, result: &MethodResult) -> String {
        match self {
            Self::Time => format!("{} ms", units::milliseconds(result.timing.median())),
            Self::Device | Self::Disk => format!("{} MB", units::significant(self.cost(result))),
            Self::Capture => units::duration(result.preparation_s),
        }
    }

    /// The least and the greatest cost, widened to steps of 1, 2, 5 so that no marker lies on the edge.
    pub(crate) fn costs(self, results: &[&MethodResult]) -> (f64, f64) {
        let values = || results.iter().flat_map(|r| [self.spread(r).0, self.cost(r), self.spread(r).1]);
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
        assert_eq!(Plot::Time.costs(&[]), (1.0, 10.0));
        assert_eq!(Plot::Time.costs(&[&at(3.0), &at(400.0)]), (2.0, 500.0));
        let large = MethodResult { bytes_on_device: 90_000_000, ..at(1.0) };
        assert_eq!(Plot::Device.costs(&[&at(3.0), &large]), (5.0, 100.0));
        assert_eq!(Plot::Disk.costs(&[&at(3.0)]), (1.0, 2.0));
        assert_eq!(decade_ticks((2.0, 50.0)), [2.0, 5.0, 10.0, 20.0, 50.0]);
        assert_eq!(decade_ticks((1e-3, 1e3)).len(), 7);
        assert_eq!([0.05, 1.0, 500.0].map(tick_label), ["0.05", "1", "500"]);
    }

    #[test]
    fn nothing_is_shown_at_zero() {
        let nothing = MethodResult { bytes_on_device: 0, ..sample::result("a", "m", &[30.0], 0.0) };
        for plot in [Plot::Time, Plot::Device] {
            assert_eq!(plot.cost(&nothing), LEAST);
            assert!(plot.costs(&[&nothing]).0 > 0.0);
        }
        assert_eq!(Plot::Device.text(&sample::result("a", "m", &[30.0], 0.0)), "6.29 MB");
    }

    #[test]
    fn samples_are_as_high_as_their_logarithm() {
        let of = |rays: Option<u64>| MethodResult { rays, ..sample::result("a", "m", &[30.0], 1.0) };
        assert_eq!(Plot::Capture.height(&of(Some(100_000_000))), Some(2.0));
        assert_eq!(Plot::Capture.height_label(2.0), "100");
        assert!(!Plot::Capture.shows(&of(None)) && !Plot::Capture.shows(&of(Some(0))));
        assert_eq!(Plot::Capture.height_ticks((-0.1, 1.1)), [1.0f64, 2.0, 5.0, 10.0].map(f64::log10));
        assert_eq!(Plot::Time.height_ticks((12.0, 40.0)), [15.0, 20.0, 25.0, 30.0, 35.0, 40.0]);
        let (low, high) = Plot::Capture.heights(&[&of(Some(1_000_000)), &of(Some(10_000_000))]);
        assert!(low < 0.0 && high > 1.0);
    }

    #[test]
    fn only_what_is_stored_has_bytes_on_disk() {
        let result = sample::result("a", "m", &[30.0], 1.0);
        assert!(Plot::Disk.shows(&result) && !Plot::Disk.shows(&MethodResult { bytes_on_disk: None, ..result }));
    }
}

//! What got worse since an earlier report, by more than the noise.

use std::fmt;

use serde::Deserialize;

use crate::error::ReportError;
use crate::report::SCHEMA;
use crate::units;

/// Frames are computed, not sampled, so that errors repeat; between drivers they differ by a rounding. Decibels of PSNR.
const SAME_DB: f64 = 0.05;
/// The same of FLIP.
const SAME_FLIP: f64 = 1e-3;
/// Medians closer than this ratio are equal, however still the machine was.
const SAME_TIME: f64 = 1.05;

/// A report as read back from its JSON: what a later one is held to.
#[derive(Debug, Clone, Deserialize)]
pub struct Baseline {
    machine: BaseMachine,
    results: Vec<BaseResult>,
}

#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
struct BaseMachine {
    cpu: String,
    threads: usize,
    adapter: Option<String>,
    build_profile: String,
}

#[derive(Debug, Clone, Deserialize)]
struct BaseResult {
    scene: String,
    reflector: String,
    size: [u32; 2],
    method: String,
    parameters: String,
    device: String,
    mean_psnr_db: Option<f64>,
    mean_flip: Option<f64>,
    timing: BaseTiming,
    bytes_on_device: u64,
    bytes_on_disk: Option<u64>,
}

#[derive(Debug, Clone, Deserialize)]
struct BaseTiming {
    median_ms: f64,
    q1_ms: f64,
    q3_ms: f64,
}

/// Something that a report has and another has worse, or not at all.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Change {
    /// Which result: scene, reflector, size, method, parameters and device.
    pub result: String,
    /// What became of it, with both numbers.
    pub change: String,
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.result, self.change)
    }
}

impl Baseline {
    /// Reads the JSON of a report.
    ///
    /// # Errors
    /// [`ReportError::Baseline`] if it is not JSON, not of a report, or of one with another layout.
    pub fn from_json(json: &str) -> Result<Self, ReportError> {
        #[derive(Deserialize)]
        struct Named {
            schema: String,
        }
        let refuse = |error: serde_json::Error| ReportError::Baseline(error.to_string());
        let Named { schema } = serde_json::from_str(json).map_err(refuse)?;
        if schema != SCHEMA {
            return Err(ReportError::Baseline(format!("its layout is {schema:?}, not {SCHEMA:?}")));
        }
        serde_json::from_str(json).map_err(refuse)
    }

    /// Whether times can be compared: same processor, threads, adapter and build.
    #[must_use]
    pub fn same_machine(&self, other: &Self) -> bool {
        self.machine == other.machine
    }

    /// What is worse in a later report. Errors count from a twentieth of a decibel and a thousandth of FLIP on, bytes at once, and times if the
    /// quartiles of both lie apart and the medians by a twentieth: on the same machine only.
    #[must_use]
    pub fn worse_in(&self, later: &Self) -> Vec<Change> {
        let times = self.same_machine(later);
        let changes = |base: &BaseResult| match later.results.iter().find(|result| result.is(base)) {
            Some(result) => result.worse_than(base, times),
            None => vec!["not measured any more".to_owned()],
        };
        let of = |base: &BaseResult| {
            let result = base.name();
            changes(base).into_iter().map(|change| Change { result: result.clone(), change }).collect::<Vec<_>>()
        };
        self.results.iter().flat_map(of).collect()
    }
}

impl BaseResult {
    fn is(&self, other: &Self) -> bool {
        let key = |this: &Self| {
            let words = [&this.scene, &this.reflector, &this.method, &this.parameters, &this.device];
            (words.map(String::clone), this.size)
        };
        key(self) == key(other)
    }

    fn name(&self) -> String {
        let Self { scene, reflector, size: [width, height], method, parameters, device, .. } = self;
        format!("{reflector} in {scene}, {width}×{height}, {method} ({parameters}) on {device}")
    }

    fn worse_than(&self, base: &Self, times: bool) -> Vec<String> {
        let mut changes = vec![];
        let mut note = |worse: bool, what: &str, before: String, now: String| {
            if worse {
                changes.push(format!("{what} {before} → {now}"));
            }
        };
        // Of equal pictures the mean is null, and so it is of the reference; neither gets worse without a number.
        let psnr = |result: &Self| result.mean_psnr_db.unwrap_or(f64::INFINITY);
        let db = |result: &Self| format!("{} dB", units::decibels(psnr(result), 2));
        note(psnr(self) < psnr(base) - SAME_DB, "PSNR", db(base), db(self));
        let flip = |result: &Self| result.mean_flip.unwrap_or(0.0);
        note(flip(self) > flip(base) + SAME_FLIP, "FLIP", format!("{:.4}", flip(base)), format!("{:.4}", flip(self)));
        let (then, now) = (&base.timing, &self.timing);
        let slower = now.q1_ms > then.q3_ms && now.median_ms > SAME_TIME * then.median_ms;
        let ms = |timing: &BaseTiming| format!("{} ms", units::significant(timing.median_ms));
        note(times && slower, "a frame", ms(then), ms(now));
        let bytes = [
            ("on the device", Some(base.bytes_on_device), Some(self.bytes_on_device)),
            ("on disk", base.bytes_on_disk, self.bytes_on_disk),
        ];
        for (place, then, now) in bytes {
            let grew = then.zip(now).is_some_and(|(then, now)| now > then);
            let text = |count: Option<u64>| format!("{} bytes", units::grouped(count.unwrap_or(0)));
            note(grew, place, text(then), text(now));
        }
        changes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Report;
    use crate::{Timing, sample};

    fn read(report: &Report) -> Baseline {
        Baseline::from_json(&report.to_json().unwrap()).unwrap()
    }

    /// What got worse when the museum's slabs on the teapot are changed.
    fn after(change: impl Fn(&mut Report)) -> Vec<String> {
        let (base, mut later) = (sample::report(), sample::report());
        change(&mut later);
        read(&base).worse_in(&read(&later)).iter().map(ToString::to_string).collect()
    }

    fn slower(report: &mut Report, factor: f64) {
        let samples = report.results[5].timing.samples().iter().map(|s| s * factor).collect();
        report.results[5].timing = Timing::from_seconds(samples).unwrap();
    }

    #[test]
    fn the_same_report_is_no_worse() {
        assert!(after(|_| ()).is_empty());
    }

    #[test]
    fn each_number_is_held_to_its_noise() {
        let name = "teapot in museum, 512×512, slabs (16×16 cameras of 64×64) on CPU, 2 threads";
        let worse = |change: fn(&mut Report)| after(change);
        assert!(worse(|later| later.results[5].eyes[0].psnr_db -= 0.09).is_empty());
        assert_eq!(
            worse(|later| later.results[5].eyes[0].psnr_db -= 0.2),
            [format!("{name}: PSNR 28.70 dB → 28.60 dB")]
        );
        assert_eq!(worse(|later| later.results[5].eyes[0].flip += 0.01), [format!("{name}: FLIP 0.0625 → 0.0675")]);
        assert!(worse(|later| slower(later, 1.02)).is_empty());
        assert_eq!(worse(|later| slower(later, 1.2)), [format!("{name}: a frame 12.9 ms → 15.5 ms")]);
        let larger = worse(|later| later.results[5].bytes_on_device += 1);
        assert_eq!(larger.len(), 1, "{larger:?}");
        assert!(worse(|later| later.results[5].bytes_on_disk = Some(9_000_000))[0].contains("on disk"));
        assert_eq!(worse(|later| later.results.truncate(5)), [format!("{name}: not measured any more")]);
    }

    #[test]
    fn better_is_not_worse_and_other_machines_have_other_times() {
        assert!(after(|later| later.results[5].eyes[0].psnr_db = f64::INFINITY).is_empty());
        assert!(after(|later| slower(later, 0.5)).is_empty());
        let elsewhere = |later: &mut Report| {
            slower(later, 3.0);
            later.machine.threads = 64;
        };
        assert!(after(elsewhere).is_empty());
    }

    #[test]
    fn other_files_are_refused() {
        for (json, part) in [("{", "EOF"), ("{\"schema\": \"other/1\"}", "other/1"), ("{}", "schema"), ("7", "7")] {
            let message = Baseline::from_json(json).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
    }
}

//! How far a capture has come: a bar on a terminal, elsewhere a line now and then.

use std::io::{Write, stderr};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use lf_capture::Progress;

/// A tenth of the work is worth a line, but a quick capture needs few.
const LEAST_PAUSE: Duration = Duration::from_secs(10);
/// Of a long capture a tenth takes hours: a log shows sooner that it is alive.
const MOST_PAUSE: Duration = Duration::from_secs(30);

/// Tells percent, rate and time left of one run.
pub(crate) struct CaptureProgress {
    bar: ProgressBar,
    start: Instant,
    /// Of the run, so far.
    rays: AtomicU64,
    /// Where standard error is no terminal.
    lines: Option<Mutex<Lines>>,
}

/// When to write a line.
#[derive(Debug, Default)]
struct Lines {
    latest: Option<Progress>,
    /// When a line was written last, and for which tenth of the work.
    written: Option<(Duration, u64)>,
}

impl CaptureProgress {
    /// The run begins now.
    pub(crate) fn new() -> Self {
        let bar = capture_bar();
        let lines = bar.is_hidden().then(Mutex::default);
        Self { bar, start: Instant::now(), rays: AtomicU64::new(0), lines }
    }

    /// Takes what any thread reports, in any order.
    pub(crate) fn report(&self, progress: Progress) {
        let elapsed = self.start.elapsed();
        let rays = self.rays.fetch_max(progress.rays, Ordering::Relaxed).max(progress.rays);
        self.bar.set_length(progress.all_texels);
        self.bar.set_position(progress.texels);
        self.bar.set_prefix(format!("{:.2}", rate(rays, elapsed)));
        if let Some(lines) = &self.lines
            && held(lines).is_due(progress, elapsed)
        {
            write_line(progress, elapsed);
        }
    }

    /// The run ends: its rays, and how long it took.
    pub(crate) fn finish(self) -> (u64, Duration) {
        let elapsed = self.start.elapsed();
        self.bar.finish_and_clear();
        if let Some(latest) = self.lines.as_ref().and_then(|lines| held(lines).latest) {
            write_line(latest, elapsed);
        }
        (self.rays.into_inner(), elapsed)
    }
}

impl Lines {
    /// Whether a report is worth a line: the first one, and then by time and tenths.
    fn is_due(&mut self, progress: Progress, elapsed: Duration) -> bool {
        // One that another thread has overtaken.
        if self.latest.is_some_and(|latest| progress.texels < latest.texels) {
            return false;
        }
        self.latest = Some(progress);
        let tenth = 10 * progress.texels / progress.all_texels.max(1);
        let due = self.written.is_none_or(|(at, last)| {
            let pause = elapsed.saturating_sub(at);
            pause >= MOST_PAUSE || pause >= LEAST_PAUSE && tenth > last
        });
        if due {
            self.written = Some((elapsed, tenth));
        }
        due
    }
}

/// Million rays a second.
pub(crate) fn rate(rays: u64, elapsed: Duration) -> f64 {
    rays as f64 / 1e6 / elapsed.as_secs_f64().max(1e-9)
}

/// A bar whose prefix is the rate; it shows nothing where standard error is no terminal.
fn capture_bar() -> ProgressBar {
    let template = "capture  {wide_bar} {percent:>3} %, {prefix} million rays/s, {eta} left";
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(0).with_style(style)
}

/// A log that cannot be written to is no reason to end a long capture.
fn write_line(progress: Progress, elapsed: Duration) {
    let _ = writeln!(stderr(), "{}", line(progress, elapsed));
}

fn line(Progress { texels, all_texels, rays }: Progress, elapsed: Duration) -> String {
    let percent = 100 * texels / all_texels.max(1);
    let rest = all_texels.saturating_sub(texels) as f64 / texels.max(1) as f64;
    let left = Duration::try_from_secs_f64(elapsed.as_secs_f64() * rest).unwrap_or(Duration::MAX);
    format!("capture  {percent:>3} %, {:.2} million rays/s, {} left", rate(rays, elapsed), HumanDuration(left))
}

/// What a mutex guards. Nothing under it panics.
fn held(lines: &Mutex<Lines>) -> MutexGuard<'_, Lines> {
    lines.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(texels: u64) -> Progress {
        Progress { texels, all_texels: 1000, rays: 4_000_000 * texels }
    }

    #[test]
    fn lines_come_by_tenths_and_by_time() {
        let mut lines = Lines::default();
        let mut due = |seconds, texels| lines.is_due(at(texels), Duration::from_secs(seconds));
        assert!(due(0, 1), "the first");
        assert!(!due(9, 200), "too soon");
        assert!(due(10, 210), "another tenth");
        assert!(!due(39, 299), "the same tenth");
        assert!(!due(45, 298), "overtaken");
        assert!(due(40, 299), "after half a minute");
        assert!(due(50, 300), "another tenth");
        assert!(!due(51, 1000), "the end has its own line");
    }

    #[test]
    fn a_line_has_percent_rate_and_time_left() {
        let line = |texels, seconds| line(at(texels), Duration::from_secs(seconds));
        assert_eq!(line(250, 100), "capture   25 %, 10.00 million rays/s, 5 minutes left");
        assert_eq!(line(1000, 400), "capture  100 %, 10.00 million rays/s, 0 seconds left");
        assert!(line(0, 1).starts_with("capture    0 %, 0.00"));
    }
}

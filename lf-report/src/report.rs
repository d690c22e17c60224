//! A report: the results of one run with what a reader needs to judge and repeat it.

use serde::{Serialize, Serializer};

use crate::axis::Plot;
use crate::error::ReportError;
use crate::machine::Machine;
use crate::result::{BASELINE_METHOD, Frames, MethodResult};
use crate::{csv, html, markdown, plot, units};

/// Name and version of the JSON layout, its first property.
pub(crate) const SCHEMA: &str = "lfslab-report/3";

/// Every result of one run, and where, how and on what it was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Headline of the page.
    pub title: String,
    /// Program name and version.
    pub generator: String,
    /// The machine that ran it.
    pub machine: Machine,
    /// The command line that measures all of this again.
    pub reproduce: String,
    /// Named facts of the run: geometry, file size, capture time.
    #[serde(serialize_with = "named_values")]
    pub facts: Vec<(String, String)>,
    /// What was measured, in the order of the tables.
    pub results: Vec<MethodResult>,
    /// What else was found out, such as what was left out and what that saved.
    pub tables: Vec<Table>,
    /// Remarks, one paragraph each: known limits, what was left out.
    pub notes: Vec<String>,
}

/// A table of the report beside its results, for people.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Table {
    /// What it shows, in a few words.
    pub title: String,
    /// How to read it; may be empty.
    pub caption: String,
    /// Heads of the columns.
    pub columns: Vec<String>,
    /// Cells, each row as long as the heads.
    pub rows: Vec<Vec<String>>,
}

/// An image of the HTML page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// What is shown, in a few words.
    pub title: String,
    /// How to read it; may be empty.
    pub caption: String,
    /// A whole PNG or JPEG file.
    pub picture: Vec<u8>,
}

/// The best result of a method set against the baseline: same frames, same device.
pub(crate) struct Comparison<'a> {
    best: &'a MethodResult,
    best_db: f64,
    baseline: &'a MethodResult,
    baseline_db: f64,
}

impl Report {
    /// The report as JSON, laid out as `report.schema.json` says.
    ///
    /// # Errors
    /// [`ReportError::InvalidArgument`] if a number of a result is not finite where it has to be.
    pub fn to_json(&self) -> Result<String, ReportError> {
        #[derive(Serialize)]
        struct Document<'a> {
            schema: &'static str,
            #[serde(flatten)]
            report: &'a Report,
        }
        self.validate()?;
        serde_json::to_string_pretty(&Document { schema: SCHEMA, report: self }).map_err(ReportError::Json)
    }

    /// The results as comma-separated values with a header line, a line for each; numbers of eyes are means.
    ///
    /// # Errors
    /// As [`to_json`](Self::to_json).
    pub fn to_csv(&self) -> Result<String, ReportError> {
        self.validate()?;
        csv::csv(&self.results)
    }

    /// One plot of the results on some frames as a standalone SVG image: a marker for each with the quartiles of its time, and the Pareto
    /// front. Results without finite error (the reference) stand at the top edge with a dashed line down to the axis. `None`
    /// where no result has a place on it.
    ///
    /// # Errors
    /// [`ReportError::InvalidArgument`] as for [`to_json`](Self::to_json); [`ReportError::Plot`] if drawing fails.
    pub fn plot(&self, frames: &Frames, plot: Plot) -> Result<Option<String>, ReportError> {
        self.validate()?;
        let results = self.results_of(frames);
        if !results.iter().any(|result| plot.shows(result)) {
            return Ok(None);
        }
        plot::svg(&results, plot, &self.label(frames)).map(Some)
    }

    /// What was drawn, in order of appearance.
    #[must_use]
    pub fn frames(&self) -> Vec<&Frames> {
        let mut all = Vec::new();
        for frames in self.results.iter().map(|result| &result.frames) {
            if !all.contains(&frames) {
                all.push(frames);
            }
        }
        all
    }

    /// The results on some frames, in the order measured.
    #[must_use]
    pub fn results_of(&self, frames: &Frames) -> Vec<&MethodResult> {
        self.results.iter().filter(|result| result.frames == *frames).collect()
    }

    /// Frames by name: the reflector, and of the rest what not all frames share.
    #[must_use]
    pub fn label(&self, frames: &Frames) -> String {
        let all = self.frames();
        let mut label = frames.reflector.clone();
        if all.iter().any(|other| other.scene != frames.scene) {
            label += &format!(" in {}", frames.scene);
        }
        if all.iter().any(|other| other.size != frames.size) {
            label += &format!(", {}×{}", frames.size[0], frames.size[1]);
        }
        label
    }

    /// The report as one HTML page that needs no other file, with `figures` embedded in the order given.
    ///
    /// # Errors
    /// As [`plot`](Self::plot); also if a figure is neither a PNG nor a JPEG file.
    pub fn to_html(&self, figures: &[Figure]) -> Result<String, ReportError> {
        html::page(self, figures)
    }

    /// The results as Markdown, a table for each frames: error, time, bytes, and on which fronts of its device a method lies. Then
    /// the other tables.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        markdown::page(self)
    }

    /// For all frames (and devices), one sentence: how much closer to the reference the best method comes than the
    /// [`BASELINE_METHOD`], and what that costs. Empty if nothing was compared with the baseline.
    #[must_use]
    pub fn headlines(&self) -> Vec<String> {
        let comparisons = self.comparisons();
        let several_devices = comparisons.iter().any(|c| c.best.device != comparisons[0].best.device);
        comparisons.iter().map(|comparison| self.headline(comparison, several_devices)).collect()
    }

    fn headline(&self, comparison: &Comparison<'_>, name_device: bool) -> String {
        let Comparison { best, best_db, baseline, baseline_db } = comparison;
        let gain = best_db - baseline_db;
        let (amount, direction) = (units::decibels(gain.abs(), 1), if gain < 0.0 { "less" } else { "more" });
        let device = if name_device { format!(" on {}", best.device) } else { String::new() };
        let eyes = match best.eyes.len() {
            1 => "one eye".to_owned(),
            n => format!("mean of {n} eyes"),
        };
        let references = self.results.iter().filter(|r| r.is_reference() && r.frames == best.frames);
        let fastest = references.map(|r| r.timing.median()).min_by(f64::total_cmp);
        let reference =
            fastest.map_or_else(String::new, |s| format!("; the reference takes {} ms", units::milliseconds(s)));
        format!(
            "{reflector}{device}: {amount} dB {direction} with {method} than with {BASELINE_METHOD} \
             ({best} against {base} dB PSNR, {eyes}), at {time} ms a frame against {base_time} ms{reference}.",
            reflector = self.label(&best.frames),
            method = best.method,
            best = units::decibels(*best_db, 1),
            base = units::decibels(*baseline_db, 1),
            time = units::milliseconds(best.timing.median()),
            base_time = units::milliseconds(baseline.timing.median()),
        )
    }

    /// The best of all frames and devices against the best baseline there, in order of appearance.
    fn comparisons(&self) -> Vec<Comparison<'_>> {
        let mut groups: Vec<(&Frames, &str)> = Vec::new();
        for group in self.results.iter().map(|r| (&r.frames, r.device.as_str())) {
            if !groups.contains(&group) {
                groups.push(group);
            }
        }
        let best_of = |group: (&Frames, &str), baseline: bool| {
            let members = self.results.iter().filter(move |r| (&r.frames, r.device.as_str()) == group);
            let kind = members.filter(move |r| (r.method == BASELINE_METHOD) == baseline);
            kind.filter_map(|r| Some((r, r.mean_psnr_db()?))).max_by(|a, b| a.1.total_cmp(&b.1))
        };
        let compare = |group| {
            let (best, best_db) = best_of(group, false)?;
            let (baseline, baseline_db) = best_of(group, true).filter(|(_, psnr)| psnr.is_finite())?;
            Some(Comparison { best, best_db, baseline, baseline_db })
        };
        groups.into_iter().filter_map(compare).collect()
    }

    pub(crate) fn validate(&self) -> Result<(), ReportError> {
        self.results.iter().try_for_each(MethodResult::validate)
    }
}

/// Mean PSNR and its range over the eyes; the range is empty where there is no more than one eye.
pub(crate) fn psnr_texts(result: &MethodResult) -> [String; 2] {
    let Some((mean, (low, high))) = result.mean_psnr_db().zip(result.psnr_range_db()) else {
        return ["reference".to_owned(), String::new()];
    };
    let range = format!("{}–{}", units::decibels(low, 2), units::decibels(high, 2));
    [units::decibels(mean, 2), if result.eyes.len() > 1 { range } else { String::new() }]
}

/// Median and quartiles of the time per frame in milliseconds.
pub(crate) fn time_texts(result: &MethodResult) -> [String; 2] {
    let (q1, q3) = result.timing.quartiles();
    [units::milliseconds(result.timing.median()), format!("{}–{}", units::milliseconds(q1), units::milliseconds(q3))]
}

/// Pairs as objects, `{"name": …, "value": …}`: a layout that can grow.
fn named_values<S: Serializer>(pairs: &[(String, String)], serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Named<'a> {
        name: &'a str,
        value: &'a str,
    }
    serializer.collect_seq(pairs.iter().map(|(name, value)| Named { name, value }))
}

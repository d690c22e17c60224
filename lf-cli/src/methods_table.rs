//! The Markdown table of `lfslab methods`.

use std::fmt::Write as _;

use lf_report::{EyeError, MethodResult, Report};

/// A table cell from the eyes of a result; the reference has none.
type Cell = (&'static str, fn(&MethodResult) -> Option<String>);

/// What is said of a method's errors, with the heads of the columns.
const ERRORS: [Cell; 6] = [
    ("PSNR, dB", |result| Some(format!("{:.2}", result.mean_psnr_db()?))),
    ("SSIM", |result| mean(result, 4, |eye| eye.ssim)),
    ("FLIP", |result| mean(result, 4, |eye| eye.flip)),
    ("relMSE", |result| mean(result, 4, |eye| eye.rel_mse)),
    ("off > 0.1", |result| Some(mean(result, 2, |eye| 100.0 * eye.share_over_tenth)? + " %")),
    ("largest", |result| Some(result.eyes.iter().map(|eye| eye.max_abs).max()?.to_string())),
];

fn mean(result: &MethodResult, decimals: usize, number: fn(&EyeError) -> f64) -> Option<String> {
    Some(format!("{:.decimals$}", result.mean(number)?))
}

/// The results of one scene, a line each. The best of each device at its time or less, and at its bytes or less, are marked.
pub(crate) fn table(report: &Report) -> String {
    let heads: Vec<&str> = ERRORS.iter().map(|(head, _)| *head).collect();
    let mut text = format!("## {}\n\n", report.scene);
    let _ = writeln!(text, "| method | parameters | device | MB | ms | {} | front |", heads.join(" | "));
    let _ = writeln!(text, "|---|---|---|--:|--:|{}---|", "--:|".repeat(heads.len()));
    for result in &report.results {
        let (q1, q3) = result.timing.quartiles();
        let errors = ERRORS.map(|(_, cell)| cell(result).unwrap_or_else(|| "–".to_owned()));
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.1} | {:.1} [{:.1}–{:.1}] | {} | {} |",
            result.method,
            result.parameters,
            result.device,
            result.bytes_on_device as f64 / 1e6,
            1e3 * result.timing.median(),
            1e3 * q1,
            1e3 * q3,
            errors.join(" | "),
            front(&report.results, result)
        );
    }
    text
}

/// On which fronts a method is among those of its device: no other is better at its time or less, or at its bytes or less.
fn front(results: &[MethodResult], this: &MethodResult) -> &'static str {
    if this.is_reference() {
        return "";
    }
    let others = || {
        let rivals = results.iter().filter(|other| other.device == this.device);
        rivals.filter(|other| other.mean_psnr_db() > this.mean_psnr_db())
    };
    let time = others().all(|other| other.timing.median() > this.timing.median());
    let bytes = others().all(|other| other.bytes_on_device > this.bytes_on_device);
    match (time, bytes) {
        (true, true) => "time, bytes",
        (true, false) => "time",
        (false, true) => "bytes",
        (false, false) => "",
    }
}

#[cfg(test)]
mod tests {
    use lf_math::{ImageError, VisibleError};
    use lf_report::Timing;

    use super::*;

    fn result(device: &str, psnr_db: Option<f64>, ms: f64, bytes_on_device: u64) -> MethodResult {
        let error = ImageError { pixels: 100, mse: 1.0, max_abs: 77, over_tenth: 5, rel_mse: 0.5 };
        let eye = EyeError::new(0, error, VisibleError { flip: 0.125, ssim: 0.875 });
        MethodResult {
            reflector: "sphere".to_owned(),
            method: "slabs".to_owned(),
            parameters: "some".to_owned(),
            device: device.to_owned(),
            eyes: psnr_db.map(|psnr_db| EyeError { psnr_db, ..eye }).into_iter().collect(),
            timing: Timing::from_seconds(vec![ms * 1e-3]).unwrap(),
            bytes_on_device,
            bytes_on_disk: None,
            preparation_s: 0.0,
        }
    }

    #[test]
    fn fronts_are_of_one_device_and_leave_the_reference_out() {
        let results = [
            result("CPU", Some(30.0), 10.0, 4),
            result("CPU", Some(20.0), 5.0, 4),
            result("CPU", Some(25.0), 20.0, 2),
            result("CPU", Some(19.0), 6.0, 5),
            result("GPU", Some(10.0), 50.0, 9),
            result("CPU", None, 1.0, 1),
        ];
        let fronts = results.each_ref().map(|this| front(&results, this));
        assert_eq!(fronts, ["time, bytes", "time", "bytes", "", "time, bytes", ""]);
    }

    #[test]
    fn a_row_has_every_error_and_the_reference_none() {
        let report = Report {
            title: String::new(),
            generator: String::new(),
            machine: lf_report::Machine::detect(None),
            scene: "museum".to_owned(),
            reproduce: String::new(),
            facts: vec![],
            results: vec![result("CPU", Some(30.0), 10.0, 4_000_000), result("CPU", None, 1.0, 1)],
            notes: vec![],
        };
        let table = table(&report);
        let rows: Vec<&str> = table.lines().skip(4).collect();
        let first = "| slabs | some | CPU | 4.0 | 10.0 [10.0–10.0] | 30.00 | 0.8750 | 0.1250 | 0.5000 | 5.00 % | 77 | time, bytes |";
        assert_eq!(rows[0], first);
        assert!(rows[1].contains("| – | – | – | – | – | – |"), "{}", rows[1]);
        assert!(table.lines().skip(2).all(|line| line.matches('|').count() == 13), "{table}");
    }
}

//! Results as Markdown tables.

use std::fmt::Write as _;

use crate::report::{Report, Table};
use crate::result::{EyeError, Frames, MethodResult};

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

/// All tables of a report.
pub(crate) fn page(report: &Report) -> String {
    let results = report.frames().into_iter().map(|frames| of_frames(report, frames));
    results.chain(report.tables.iter().map(table)).collect::<Vec<_>>().join("\n")
}

/// The results on the same frames, a line each. The best of each device at its time or less, and at its bytes or less, are marked.
fn of_frames(report: &Report, frames: &Frames) -> String {
    let heads: Vec<&str> = ERRORS.iter().map(|(head, _)| *head).collect();
    let results = report.results_of(frames);
    let mut text = format!("## {}\n\n", report.label(frames));
    let _ = writeln!(text, "| method | parameters | device | MB | ms | {} | front |", heads.join(" | "));
    let _ = writeln!(text, "|---|---|---|--:|--:|{}---|", "--:|".repeat(heads.len()));
    for result in &results {
        let (q1, q3) = result.timing.quartiles();
        let errors = ERRORS.map(|(_, cell)| cell(result).unwrap_or_else(|| "–".to_owned()));
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.1} | {:.1} [{:.1}–{:.1}] | {} | {} |",
            escaped(&result.method),
            escaped(&result.parameters),
            escaped(&result.device),
            result.bytes_on_device as f64 / 1e6,
            1e3 * result.timing.median(),
            1e3 * q1,
            1e3 * q3,
            errors.join(" | "),
            front(&results, result)
        );
    }
    text
}

/// A table of texts.
fn table(Table { title, caption, columns, rows }: &Table) -> String {
    let line =
        |cells: &[String]| format!("| {} |\n", cells.iter().map(|cell| escaped(cell)).collect::<Vec<_>>().join(" | "));
    let caption = if caption.is_empty() { String::new() } else { format!("{caption}\n\n") };
    let rows: String = rows.iter().map(|row| line(row)).collect();
    format!("## {title}\n\n{caption}{}|{}\n{rows}", line(columns), "---|".repeat(columns.len()))
}

fn escaped(cell: &str) -> String {
    cell.replace('|', "\\|").replace(['\n', '\r'], " ")
}

/// On which fronts a method is among those of its device: no other is better at its time or less, or at its bytes or less.
fn front(results: &[&MethodResult], this: &MethodResult) -> &'static str {
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
    use super::*;
    use crate::sample;

    fn result(device: &str, psnr_db: &[f64], ms: f64, bytes_on_device: u64) -> MethodResult {
        MethodResult {
            device: device.to_owned(),
            bytes_on_device,
            ..sample::result("a|b", "slabs", psnr_db, ms * 1e-3)
        }
    }

    #[test]
    fn fronts_are_of_one_device_and_leave_the_reference_out() {
        let results = [
            result("CPU", &[30.0], 10.0, 4),
            result("CPU", &[20.0], 5.0, 4),
            result("CPU", &[25.0], 20.0, 2),
            result("CPU", &[19.0], 6.0, 5),
            result("GPU", &[10.0], 50.0, 9),
            result("CPU", &[], 1.0, 1),
        ];
        let all: Vec<&MethodResult> = results.iter().collect();
        let fronts = results.each_ref().map(|this| front(&all, this));
        assert_eq!(fronts, ["time, bytes", "time", "bytes", "", "time, bytes", ""]);
    }

    #[test]
    fn a_row_has_every_error_and_the_reference_none() {
        let mut report = sample::report();
        report.results = vec![result("CPU|x", &[30.0], 10.0, 4_000_000), result("CPU\n", &[], 1.0, 1)];
        let text = page(&report);
        let rows: Vec<&str> = text.lines().skip(4).collect();
        let first = "| slabs | 16×16 cameras of 64×64 | CPU\\|x | 4.0 | 10.0 [10.0–10.2] | 30.00 | 0.7500 | 0.0625 | 0.0100 | 1.76 % \
                     | 130 | time, bytes |";
        assert_eq!(rows[0], first);
        assert!(rows[1].contains("| – | – | – | – | – | – |"), "{}", rows[1]);
        let cells = |line: &str| line.replace("\\|", "").matches('|').count();
        assert!(text.lines().skip(2).take(4).all(|line| cells(line) == 13), "{text}");
    }

    #[test]
    fn each_frames_and_each_table_has_its_own() {
        let text = page(&sample::report());
        for part in
            ["## sphere\n", "## teapot\n", "## Left out\n\nIn bytes.\n\n| what | saves |\n|---|---|\n| a\\|b | 3 |\n"]
        {
            assert!(text.contains(part), "{part}\n{text}");
        }
    }
}

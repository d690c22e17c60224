//! Holds the specification and the library together: its worked example and its table of limits.

use std::io::Write;
use std::path::Path;

use lf_format::Limits;

use crate::assemble::{parse, smallest_writer};

/// The text of the specification; `None` where the crate stands alone, as in a download of the package.
fn specification() -> Option<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec");
    if !folder.exists() {
        // Straight to standard error, past the capture of the test harness.
        let _ =
            writeln!(std::io::stderr(), "NOT TESTED: the crate stands alone, there is no folder {}", folder.display());
        return None;
    }
    let path = folder.join("lfslab-1.0.md");
    Some(std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())))
}

fn dump(bytes: &[u8]) -> String {
    let line = |(i, row): (usize, &[u8])| {
        let hex: Vec<String> = row.iter().map(|byte| format!("{byte:02X}")).collect();
        format!("{:04X}  {}\n", 16 * i, hex.join(" "))
    };
    bytes.chunks(16).enumerate().map(line).collect()
}

/// The default limits as the specification writes them: sizes in binary units, counts by thousands.
fn limits_table() -> String {
    let size = |bytes: u64| match bytes.trailing_zeros() {
        30.. => format!("{} GiB", bytes >> 30),
        _ => format!("{} MiB", bytes >> 20),
    };
    let count = |count: u32| format!("{},{:03}", count / 1000, count % 1000);
    let limits = Limits::default();
    let rows = [
        ("file length", size(limits.max_file_bytes)),
        ("directory entries", count(limits.max_entries)),
        ("length of `META`", size(limits.max_metadata_bytes)),
        ("raw length of all tiles together", size(limits.max_raw_bytes)),
        ("samples along an axis, cameras per tile along an axis", count(limits.max_axis_count)),
    ];
    rows.map(|(what, limit)| format!("| {what} | {limit} |\n")).concat()
}

#[test]
fn the_hex_dump_is_what_the_writer_makes() {
    let Some(text) = specification() else { return };
    let bytes = smallest_writer().to_bytes().unwrap();
    parse(&bytes).unwrap();
    let fenced = text.split("```hexdump\n").nth(1).and_then(|rest| rest.split("```").next());
    assert!(fenced == Some(&dump(&bytes)), "the specification's hex dump should be:\n{}", dump(&bytes));
}

#[test]
fn the_table_of_limits_is_that_of_the_defaults() {
    let Some(text) = specification() else { return };
    let table = text.split("| what | at most |\n|---|---|\n").nth(1).and_then(|rest| rest.split("\n\n").next());
    assert_eq!(table.map(|rows| format!("{rows}\n")), Some(limits_table()));
}

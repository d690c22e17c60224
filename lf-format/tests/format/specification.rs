//! Holds the worked example of the specification and the writer together.

use std::path::Path;

use crate::assemble::{parse, smallest_writer};

fn dump(bytes: &[u8]) -> String {
    let line = |(i, row): (usize, &[u8])| {
        let hex: Vec<String> = row.iter().map(|byte| format!("{byte:02X}")).collect();
        format!("{:04X}  {}\n", 16 * i, hex.join(" "))
    };
    bytes.chunks(16).enumerate().map(line).collect()
}

#[test]
fn the_hex_dump_is_what_the_writer_makes() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec/lfslab-1.0.md");
    let Ok(text) = std::fs::read_to_string(&path) else {
        eprintln!("skipped: the crate stands alone, there is no specification at {}", path.display());
        return;
    };
    let bytes = smallest_writer().to_bytes().unwrap();
    parse(&bytes).unwrap();
    let fenced = text.split("```hexdump\n").nth(1).and_then(|rest| rest.split("```").next());
    assert!(fenced == Some(&dump(&bytes)), "the specification's hex dump should be:\n{}", dump(&bytes));
}

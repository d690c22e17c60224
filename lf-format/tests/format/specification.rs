//! Holds the specification and the library together: its worked example, its clauses, and the numbers of the registry.

use std::io::Write;
use std::path::Path;

use lf_format::{Packing, Rule, Tag};

use crate::layout::{Field, RED, Slab, smallest};
use crate::readers::sound;
use crate::writer::smallest_writer;

/// A text of the specification; `None` where the crate stands alone, as in a download of the package.
fn text(name: &str) -> Option<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec");
    if !folder.exists() {
        // Straight to standard error, past the capture of the test harness.
        let _ =
            writeln!(std::io::stderr(), "NOT TESTED: the crate stands alone, there is no folder {}", folder.display());
        return None;
    }
    let path = folder.join(name);
    Some(std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())))
}

fn dump(bytes: &[u8]) -> String {
    let line = |(i, row): (usize, &[u8])| {
        let hex: Vec<String> = row.iter().map(|byte| format!("{byte:02X}")).collect();
        format!("{:04X}  {}\n", 16 * i, hex.join(" "))
    };
    bytes.chunks(16).enumerate().map(line).collect()
}

#[test]
fn the_hex_dump_is_what_the_writer_makes() {
    let Some(text) = text("lfslab-1.0.md") else { return };
    let mut writer = smallest_writer();
    writer.tile(Packing::None, &RED).unwrap();
    let bytes = writer.finish().unwrap().into_inner();
    assert_eq!(bytes, smallest().to_bytes());
    let fenced = text.split("```hexdump\n").nth(1).and_then(|rest| rest.split("```").next());
    assert!(fenced == Some(&dump(&bytes)), "the specification's hex dump should be:\n{}", dump(&bytes));
}

#[test]
fn every_rule_has_its_clause() {
    let Some(text) = text("lfslab-1.0.md") else { return };
    for rule in Rule::ALL {
        let clause = rule.clause().trim_start_matches('§');
        let heading = if clause.contains('.') { format!("\n### {clause} ") } else { format!("\n## {clause} ") };
        assert!(text.contains(&heading), "{} has {}", rule.id(), rule.clause());
    }
}

#[test]
fn message_ids_are_names_and_none_is_there_twice() {
    let ids: std::collections::BTreeSet<&str> = Rule::ALL.iter().map(|rule| rule.id()).collect();
    assert_eq!(ids.len(), Rule::ALL.len());
    let plain = |id: &&str| id.bytes().all(|byte| byte.is_ascii_lowercase() || b".-".contains(&byte));
    assert!(ids.iter().all(plain));
}

/// The rows of the first table under a heading, cell by cell, without the marks of code.
fn rows(text: &str, heading: &str) -> Vec<Vec<String>> {
    let section = text.split(&format!("\n## {heading}")).nth(1).and_then(|rest| rest.split("\n## ").next()).unwrap();
    let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().replace('`', "")).collect();
    section.lines().filter(|line| line.starts_with("| ")).skip(1).map(cells).collect()
}

#[test]
fn the_tags_of_the_registry_are_those_of_the_library() {
    let Some(text) = text("registry.md") else { return };
    let known = [Tag::GEOM, Tag::META, Tag::CROP, Tag::MASK, Tag::TILE];
    let listed: Vec<String> = rows(&text, "Chunk tags").into_iter().map(|row| row[0].clone()).collect();
    assert_eq!(listed, known.map(|tag| tag.to_string()));
    assert!(known.iter().all(|tag| tag.is_known()));
}

#[test]
fn the_packings_of_the_registry_are_those_of_the_library() {
    let Some(text) = text("registry.md") else { return };
    let known = [("none", Packing::None), ("zstd", Packing::Zstd), ("tile codec", Packing::Tile)];
    for (row, (name, packing)) in rows(&text, "Packings").iter().zip(known) {
        let bytes = Field::new(vec![Slab::smallest()]).file(|_, _| (row[0].parse().unwrap(), RED.to_vec())).to_bytes();
        assert_eq!((row[1].as_str(), sound(&bytes).tile(0, 0).unwrap().packing), (name, packing));
    }
}

#[test]
fn the_encodings_of_the_registry_are_those_of_the_library() {
    let Some(text) = text("registry.md") else { return };
    let mut known = 0;
    for row in rows(&text, "Texel encodings").iter().filter(|row| row.get(4).is_some_and(|clause| !clause.is_empty())) {
        let [encoding, block_len, transfer] = [&row[0], &row[2], &row[3]].map(|cell| cell.parse::<u8>().unwrap());
        let slab = Slab { encoding, ..Slab::smallest() };
        let file = Field::new(vec![slab]).file(|_, _| (0, vec![0; block_len.into()]));
        assert_eq!(file.chunks[0].payload[42], transfer);
        let bytes = file.to_bytes();
        assert_eq!(sound(&bytes).tilings()[0].encoding().block_len(), u64::from(block_len));
        known += 1;
    }
    assert_eq!(known, 3);
}

#[test]
fn the_metadata_keys_of_the_registry_are_those_of_the_specification() {
    let (Some(registry), Some(specification)) = (text("registry.md"), text("lfslab-1.0.md")) else { return };
    let clause = specification.split("\n### 8.5 ").nth(1).and_then(|rest| rest.split("\n## ").next()).unwrap();
    let rows = rows(&registry, "Metadata keys");
    assert_eq!(rows.len(), clause.lines().filter(|line| line.starts_with("| `")).count());
    for row in rows {
        assert!(clause.contains(&format!("| `{}` |", row[0])), "{}", row[0]);
    }
}

//! What the program does with files: findings, structure, crop, and other people's formats.

mod schema;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

fn lfslab(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lfslab")).args(arguments).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[track_caller]
fn succeeds(arguments: &[&str]) -> String {
    let output = lfslab(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

#[track_caller]
fn fails(arguments: &[&str], words: &str) {
    let output = lfslab(arguments);
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("error: ") && stderr.contains(words) && !stderr.contains("panicked"), "{stderr}");
}

fn path(folder: &TempDir, name: &str) -> String {
    folder.path().join(name).to_string_lossy().into_owned()
}

/// A light field of the museum with the camera planes on the cell's faces, whole.
fn whole(folder: &TempDir) -> String {
    let file = path(folder, "whole.lfslab");
    succeeds(&["capture", "--planes", "faces", "--cameras", "6", "--resolution", "24", "--whole", "--out", &file]);
    file
}

/// The test vectors of the specification, by whether they are valid.
fn vectors() -> Option<Value> {
    let index = Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec/vectors/index.json");
    Some(serde_json::from_slice(&fs::read(index).ok()?).expect("is JSON"))
}

#[test]
fn findings_are_written_as_the_schema_says() {
    let schema = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec/validate.schema.json"));
    let (Ok(schema), Some(index)) = (schema, vectors()) else {
        eprintln!("NOT TESTED: the crate stands alone, there is no folder spec");
        return;
    };
    let schema: Value = serde_json::from_slice(&schema).unwrap();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec/vectors");
    let files = index["files"].as_array().or(index.as_array()).expect("a list of files");
    let (mut valid, mut invalid) = (0, 0);
    for file in files {
        let expected = file["valid"].as_bool().unwrap();
        let kind = if expected { "valid" } else { "invalid" };
        let name = file["name"].as_str().unwrap().trim_end_matches(".lfslab");
        let found = folder.join(kind).join(format!("{name}.lfslab"));
        // Half a gibibyte of addresses is all that a hostile file gets.
        let line = format!(
            "ulimit -v 600000; exec '{}' validate --format json --max-memory 64 '{}'",
            env!("CARGO_BIN_EXE_lfslab"),
            found.display()
        );
        let output = Command::new("sh").args(["-c", &line]).output().unwrap();
        assert_eq!(output.status.code(), Some(i32::from(!expected)), "{name}: {}", text(&output.stderr));
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(schema::conforms(&report, &schema), "{name}: {report:#}");
        assert_eq!(report["valid"], expected, "{name}");
        if expected {
            valid += 1;
        } else {
            let ids: Vec<&str> =
                report["findings"].as_array().unwrap().iter().filter_map(|f| f["id"].as_str()).collect();
            assert!(ids.contains(&file["id"].as_str().unwrap()), "{name}: {ids:?} without {}", file["id"]);
            invalid += 1;
        }
    }
    assert!(valid >= 20 && invalid >= 60, "{valid} {invalid}");
}

#[test]
fn every_finding_is_listed() {
    let folder = TempDir::new().unwrap();
    let file = whole(&folder);
    let structure: Value = serde_json::from_str(&succeeds(&["info", "--json", &file])).unwrap();
    let tiles = structure["chunks"].as_array().unwrap().iter().filter(|chunk| chunk["tag"] == "TILE");
    let mut bytes = fs::read(&file).unwrap();
    for tile in tiles.clone() {
        bytes[tile["offset"].as_u64().unwrap() as usize] ^= 1;
    }
    let bad = path(&folder, "bad.lfslab");
    fs::write(&bad, bytes).unwrap();
    let report: Value = serde_json::from_slice(&lfslab(&["validate", "--format", "json", &bad]).stdout).unwrap();
    let checksums =
        report["findings"].as_array().unwrap().iter().filter(|finding| finding["id"] == "entry.checksum").count();
    assert_eq!(checksums, tiles.count());
}

#[test]
fn a_crop_is_smaller_and_reflects_the_same() {
    let folder = TempDir::new().unwrap();
    let file = whole(&folder);
    let cropped = path(&folder, "cropped.lfslab");
    succeeds(&["crop", &file, "--out", &cropped]);
    let len = |file: &str| fs::metadata(file).unwrap().len();
    assert!(len(&cropped) < len(&file));
    assert!(succeeds(&["info", &cropped]).contains("% of the texels"));
    assert!(succeeds(&["validate", &cropped]).contains("valid"));
    let picture = |file: &str, name: &str| {
        let out = path(&folder, name);
        succeeds(&["render", file, "--cpu", "--size", "64", "--out", &out]);
        fs::read(out).unwrap()
    };
    assert!(picture(&file, "a.png") == picture(&cropped, "b.png"));
    // A reflector that stays in a quarter of the edge needs less still, and no camera at the rim.
    let part = path(&folder, "part.lfslab");
    succeeds(&["crop", &file, "--box", "0.1,1.3,0,0.25", "--out", &part]);
    assert!(len(&part) < len(&cropped));
    assert!(succeeds(&["validate", &part]).contains("valid"));
    assert!(succeeds(&["info", &part]).contains("coverage: rays from the box"));
    fails(&["crop", &file, "--box", "9,9,9,0.1", "--out", &part], "--box");
    // Cropping what is cropped changes nothing.
    let again = path(&folder, "again.lfslab");
    succeeds(&["crop", &cropped, "--out", &again]);
    assert!(fs::read(&again).unwrap() == fs::read(&cropped).unwrap());
}

#[test]
fn memory_is_held_to_the_budget() {
    let folder = TempDir::new().unwrap();
    let file = path(&folder, "plain.lfslab");
    succeeds(&["capture", "--cameras", "12", "--resolution", "32", "--encoding", "rgba8", "--out", &file]);
    fails(&["render", &file, "--cpu", "--max-memory", "1", "--out", &path(&folder, "x.png")], "budget");
}

#[test]
fn light_fields_go_out_and_come_back() {
    let folder = TempDir::new().unwrap();
    let file = path(&folder, "plain.lfslab");
    let plain = ["capture", "--cameras", "4", "--resolution", "16", "--encoding", "rgba8", "--out", &file];
    succeeds(&plain);
    for format in ["ktx2", "dds", "dds-array"] {
        let out = path(&folder, format);
        succeeds(&["export", &file, "--to", format, "--out", &out]);
        let magic: &[u8] = if format == "ktx2" { b"\xABKTX 20\xBB" } else { b"DDS " };
        assert!(fs::read(out).unwrap().starts_with(magic), "{format}");
    }
    let transforms = path(&folder, "transforms");
    succeeds(&["export", &file, "--to", "transforms", "--out", &transforms]);
    let json: Value =
        serde_json::from_slice(&fs::read(Path::new(&transforms).join("transforms.json")).unwrap()).unwrap();
    assert_eq!(json["frames"].as_array().unwrap().len(), 6 * 16);
    // One slab of pictures, and the texels of that slab again.
    let grid = path(&folder, "grid");
    succeeds(&["export", &file, "--to", "grid", "--out", &grid]);
    let (slab, back) = (Path::new(&grid).join("posx").to_string_lossy().into_owned(), path(&folder, "back.lfslab"));
    let cell = ["--cell", "0,1.4,0,1"];
    let lens = ["--face", "+x", "--focal-length", "7.5", "--encoding", "rgba8", "--license", "CC0-1.0"];
    succeeds(&[&["import", &slab, "--out", &back][..], &cell, &lens].concat());
    let info: Value = serde_json::from_str(&succeeds(&["info", "--json", &back])).unwrap();
    assert_eq!(info["metadata"]["license"], "CC0-1.0");
    assert_eq!(info["slabs"][0]["face"], "+X");
    assert_eq!(info["slabs"][0]["s"]["count"], 4);
    // A missing picture is a camera that is not stored.
    let first = fs::read_dir(&slab).unwrap().next().unwrap().unwrap().path();
    fs::remove_file(first).unwrap();
    succeeds(&[&["import", &slab, "--out", &back][..], &cell, &lens].concat());
    let info: Value = serde_json::from_str(&succeeds(&["info", "--json", &back])).unwrap();
    assert!(info["chunks"].as_array().unwrap().iter().any(|chunk| chunk["tag"] == "MASK"));
    assert!(succeeds(&["validate", &back]).contains("valid"));
    for format in ["hci", "quilt"] {
        fails(&["export", &file, "--to", format, "--out", &path(&folder, format)], "--face");
        let one = ["export", &back, "--to", format, "--out", &path(&folder, format), "--depth-range", "1,inf"];
        succeeds(&one);
    }
    fails(&["import", &path(&folder, "nothing"), "--out", &back], "nothing");
    fails(&["export", &back, "--to", "ktx2", "--out", &path(&folder, "no/such/folder.ktx2")], "folder");
}

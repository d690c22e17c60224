//! `lfslab methods` on the command line.

use std::fs;
use std::process::{Command, Output};

use tempfile::TempDir;

fn lfslab(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lfslab")).args(arguments).output().expect("the program starts")
}

/// The PSNR of the first row of the table that begins with a method's name and has the parameters.
fn psnr(table: &str, method: &str, parameters: &str) -> f64 {
    let row = table.lines().find(|line| line.starts_with(&format!("| {method} |")) && line.contains(parameters));
    let cells: Vec<&str> = row.unwrap_or_else(|| panic!("no {method} in\n{table}")).split('|').map(str::trim).collect();
    cells[6].parse().expect("a number of decibels")
}

#[test]
fn methods_are_compared_on_the_same_frames() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("methods");
    let output = lfslab(&[
        "methods",
        "museum",
        "--eyes",
        "7",
        "--size",
        "48",
        "--budget",
        "0.8",
        "--cpu",
        "--out",
        &out.to_string_lossy(),
    ]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = fs::read_to_string(out.join("methods.md")).unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), table.trim());
    let order = [
        psnr(&table, "environment map", "BC1"),
        psnr(&table, "sphere-projected map", "BC1"),
        psnr(&table, "box-projected map", "BC1"),
        psnr(&table, "distance cube", "fixed point"),
        psnr(&table, "distance cube", "halvings"),
        psnr(&table, "8 distance cubes", "64 steps"),
        psnr(&table, "guided cubes (ours)", "guide"),
    ];
    // Each knows more than the one before it.
    assert!(order.windows(2).all(|pair| pair[0] < pair[1]), "{order:?}\n{table}");
    // Ours has one per cent of the slabs' bytes in the paper, and is on both fronts.
    let ours = table.lines().find(|line| line.contains("ours")).unwrap();
    assert!(ours.contains("bytes"), "{ours}");
    assert!(table.lines().any(|line| line.starts_with("| ray tracing |") && line.contains("| – |")), "{table}");
    assert!(table.contains("Mirror sphere, 7 eyes, 48×48 pixels"), "{table}");
    // The slabs of all presets need more than was allowed.
    assert!(!table.contains("| slabs |"));
    let json: serde_json::Value = serde_json::from_slice(&fs::read(out.join("museum.json")).unwrap()).unwrap();
    assert_eq!(json["results"].as_array().map(Vec::len), Some(9));
    // Four beside each other, in two rows: traced, three maps, one distance cube, eight, ours.
    let picture = image::open(out.join("museum.jpg")).unwrap();
    assert_eq!((picture.width(), picture.height()), (4 * 52 + 4, 2 * (40 + 2 * 52) + 4));
    for plot in ["museum-time.svg", "museum-bytes.svg"] {
        assert!(fs::read_to_string(out.join(plot)).unwrap().starts_with("<svg"), "{plot}");
    }
}

#[test]
fn bad_arguments_are_one_clear_error() {
    for (arguments, part) in [
        (["methods", "nowhere", "--cpu"].as_slice(), "there is neither a scene nor a file"),
        (&["methods", "--budget", "0"], "0.5 to 4000"),
        (&["methods", "--budget", "NaN"], "0.5 to 4000"),
        (&["methods", "--size", "1"], "16..=4096"),
        (&["methods", "--eyes", "0"], "1..=64"),
        (&["methods", "museum@1,2,3"], "NAME|FILE[@X,Y,Z,SIZE]"),
    ] {
        let folder = TempDir::new().unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_lfslab")).args(arguments).current_dir(&folder).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && message.contains(part), "{arguments:?}: {message}");
    }
}

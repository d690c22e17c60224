//! `lfslab report` on the command line.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

fn lfslab(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lfslab")).args(arguments).current_dir(folder).output().expect("the program starts")
}

fn measure(folder: &Path, arguments: &[&str]) -> String {
    let output = lfslab(&[&["report", "--cpu"], arguments].concat(), folder);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
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
    let arguments = ["--preset", "methods", "--scene", "museum", "--eyes", "7", "--size", "48", "--budget", "0.8"];
    let printed = measure(folder.path(), &arguments);
    let out = folder.path().join("lfslab-report");
    let table = fs::read_to_string(out.join("report.md")).unwrap();
    assert!(printed.starts_with(table.trim_end()), "{printed}");
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
    assert!(table.contains("sphere in museum, 20480 triangles, 7 eyes, 48×48 pixels"), "{table}");
    // The slabs of all sizes need more than was allowed.
    assert!(!table.contains("| slabs |"));
    let json: Value = serde_json::from_slice(&fs::read(out.join("report.json")).unwrap()).unwrap();
    assert_eq!(json["results"].as_array().map(Vec::len), Some(9));
    assert_eq!(fs::read_to_string(out.join("report.csv")).unwrap().lines().count(), 10);
    // Four beside each other, in two rows: traced, three maps, one distance cube, eight, ours.
    let picture = image::open(out.join("museum-sphere-48.jpg")).unwrap();
    assert_eq!((picture.width(), picture.height()), (4 * 52 + 4, 2 * (40 + 2 * 52) + 4));
    for plot in ["time", "device", "capture"] {
        let file = out.join(format!("museum-sphere-48-{plot}.svg"));
        assert!(fs::read_to_string(&file).unwrap().starts_with("<svg"), "{}", file.display());
    }
    // Nothing of this is stored in a file.
    assert!(!out.join("museum-sphere-48-disk.svg").exists());
    let html = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(html.contains("data:image/jpeg;base64,") && html.contains("What each method holds, and takes"));
}

const SPEC: &str = r#"
title = "Small"
scenes = ["corridor"]
reflectors = ["sphere:3", "teapot:4@0.1,0,0,0.3"]
sizes = [24, 32]
eyes = 2
repeats = 1
budget = 5.0

[[methods]]
kind = "cube"
texels = [16, 32]
answers = ["direction"]

[[methods]]
kind = "slabs"
cameras = [8]
texels = [32]
planes = ["faces"]
focus = ["none", "median"]
crop = [true, false]
codec = ["rgba8", "bc1-fast"]
rays = 1
"#;

#[test]
fn a_specification_is_swept_and_what_is_left_out_is_lossless() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("small.toml"), SPEC).unwrap();
    measure(folder.path(), &["small.toml", "--out", "out"]);
    let out = folder.path().join("out");
    let json: Value = serde_json::from_slice(&fs::read(out.join("report.json")).unwrap()).unwrap();
    let results = json["results"].as_array().unwrap();
    // Two reflectors in two sizes; two maps, eight slabs, the reference.
    assert_eq!(results.len(), 2 * 2 * (2 + 2 * 2 * 2 + 1));
    let text = |result: &Value, key: &str| result[key].as_str().unwrap().to_owned();
    let at = |result: &Value| (text(result, "reflector"), result["size"].clone(), text(result, "parameters"));
    for cropped in results.iter().filter(|result| text(result, "parameters").contains("cropped")) {
        let (reflector, size, parameters) = at(cropped);
        let parameters = parameters.replace("cropped", "whole");
        let whole = results.iter().find(|r| at(r) == (reflector.clone(), size.clone(), parameters.clone())).unwrap();
        assert!(cropped["bytes_on_device"].as_u64() < whole["bytes_on_device"].as_u64(), "{cropped}");
        // Decoded texels are the same; blocks of cropped images are others, as they begin elsewhere.
        if parameters.contains("RGBA8") {
            assert_eq!(cropped["eyes"], whole["eyes"], "{parameters}");
        }
    }
    let tables = json["tables"].as_array().unwrap();
    let left_out = tables.iter().find(|table| text(table, "title") == "Left out in corridor").unwrap();
    for row in left_out["rows"].as_array().unwrap() {
        let number = |i: usize| row[i].as_str().unwrap().parse::<u64>().unwrap();
        assert!(number(1) >= number(2), "{row}");
        // All of it is lossless.
        assert_eq!(number(5), 0, "{row}");
    }
    assert!(tables.iter().any(|table| text(table, "title") == "Slabs beside the environment map"));
    assert!(out.join("corridor-teapot-4-0.1-0-0-0.3-24-disk.svg").exists());
    // What was captured on the way is not left behind.
    assert!(fs::read_dir(&out).unwrap().all(|entry| !entry.unwrap().file_name().to_string_lossy().contains("lfslab")));
}

#[test]
fn every_result_has_a_name_of_its_own() {
    let folder = TempDir::new().unwrap();
    // Two codecs, two numbers of rays, and one case that is asked for twice; on the GPU too, where there is one.
    let slabs = |codec: &str, rays: &str| {
        let slabs = SPEC.split("[[methods]]").nth(2).unwrap().replace("[\"rgba8\", \"bc1-fast\"]", codec);
        format!("[[methods]]{}", slabs.replace("rays = 1", rays).replace("[\"none\", \"median\"]", "[\"none\"]"))
    };
    let head = SPEC.split("[[methods]]").next().unwrap().replace("[24, 32]", "[24]");
    let head = head.replace("[\"sphere:3\", \"teapot:4@0.1,0,0,0.3\"]", "[\"sphere:3\"]");
    let both = slabs("[\"bc1-fast\", \"bc1-best\"]", "rays = 1") + &slabs("[\"bc1-best\"]", "rays = 1");
    let spec = head + &both + &slabs("[\"bc1-best\"]", "rays = 2");
    fs::write(folder.path().join("slabs.toml"), spec).unwrap();
    let output = lfslab(&["report", "slabs.toml", "--out", "out"], folder.path());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json: Value = serde_json::from_slice(&fs::read(folder.path().join("out/report.json")).unwrap()).unwrap();
    let results = json["results"].as_array().unwrap();
    let mut names: Vec<_> =
        results.iter().map(|r| format!("{} {} {}", r["method"], r["parameters"], r["device"])).collect();
    names.sort();
    // Cropped and whole, of three kinds, and the reference.
    let on_cpu = names.iter().filter(|name| name.ends_with("\"CPU\"")).count();
    assert_eq!(on_cpu, 2 * 3 + 1, "{names:#?}");
    assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:#?}");
}

#[test]
fn a_later_report_is_held_to_an_earlier_one() {
    let folder = TempDir::new().unwrap();
    let spec = SPEC
        .replace("sizes = [24, 32]", "sizes = [24]")
        .replace("[\"sphere:3\", \"teapot:4@0.1,0,0,0.3\"]", "[\"sphere:3\"]");
    fs::write(
        folder.path().join("small.toml"),
        spec.split("[[methods]]").take(2).collect::<Vec<_>>().join("[[methods]]"),
    )
    .unwrap();
    measure(folder.path(), &["small.toml", "--out", "base"]);
    let base = fs::read_to_string(folder.path().join("base/report.json")).unwrap();
    let check = |earlier: &str| {
        fs::write(folder.path().join("earlier.json"), earlier).unwrap();
        let output = lfslab(&["report", "base/report.json", "--check", "earlier.json"], folder.path());
        (output.status.success(), String::from_utf8_lossy(&output.stdout).into_owned())
    };
    assert_eq!(check(&base), (true, "nothing got worse by more than the noise\n".to_owned()));
    let mut better: Value = serde_json::from_str(&base).unwrap();
    better["results"][0]["mean_psnr_db"] = 99.0.into();
    let (success, said) = check(&better.to_string());
    assert!(
        !success
            && said
                .starts_with("worse: sphere:3 in corridor, 24×24, environment map (16², BC1) on CPU: PSNR 99.00 dB →"),
        "{said}"
    );
}

#[test]
fn bad_arguments_are_one_clear_error() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("odd.toml"), "title = 7").unwrap();
    fs::write(folder.path().join("odd.json"), "{\"schema\": \"lfslab-report/1\"}").unwrap();
    for (arguments, part) in [
        (["--scene", "nowhere", "--cpu"].as_slice(), "there is neither a scene nor a file"),
        (&["--budget", "0"], "0.5…4000"),
        (&["--budget", "NaN"], "0.5…4000"),
        (&["--size", "1"], "16…4096"),
        (&["--eyes", "0"], "1…64"),
        (&["--scene", "museum@1,2,3"], "NAME|FILE[@X,Y,Z,SIZE]"),
        (&["odd.toml"], "odd.toml is no report to measure"),
        (&["missing.toml"], "cannot read missing.toml"),
        (&["odd.json"], "name another by --check"),
        (&["--check", "odd.json"], "lfslab-report/1"),
        (&["odd.toml", "--preset", "quick"], "cannot be used with"),
    ] {
        let output = lfslab(&[&["report"], arguments].concat(), folder.path());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && message.contains(part), "{arguments:?}: {message}");
    }
}

#[test]
fn presets_can_be_written_out_and_measured_as_files() {
    let folder = TempDir::new().unwrap();
    let output = lfslab(&["report", "--preset", "paper", "--print"], folder.path());
    assert!(output.status.success() && String::from_utf8_lossy(&output.stdout).contains("[[methods]]"));
}

//! From pictures of a camera grid to focal planes and left-out views, on pictures made here.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};

use image::{Rgb, RgbImage};
use tempfile::TempDir;

fn lfslab(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lfslab")).args(arguments).output().expect("the program starts")
}

/// Standard output and standard error.
#[track_caller]
fn succeeds(arguments: &[&str]) -> [String; 2] {
    let output = lfslab(arguments);
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    assert!(output.status.success(), "{arguments:?}: {err}");
    [out, err]
}

#[track_caller]
fn fails(arguments: &[&str], words: &str) {
    let output = lfslab(arguments);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("error: ") && stderr.contains(words) && !stderr.contains("panicked"), "{stderr}");
}

/// A light field of 5×5 cameras, 0.1 m apart, with a focal length of 64 pixels, before a wall with waves on it that moves so many pixels
/// from one picture to the next: to the left from one column to the next, up from one row to the next, if it is more than 0.
fn wall(folder: &TempDir, pixels: f32, options: &[&str]) -> String {
    let pictures = folder.path().join(format!("pictures {pixels}"));
    fs::create_dir_all(&pictures).unwrap();
    for (row, column) in (0..5).flat_map(|row| (0..5).map(move |column| (row, column))) {
        let picture = RgbImage::from_fn(64, 64, |x, y| {
            let (x, y) = (x as f32 + pixels * column as f32, y as f32 + pixels * row as f32);
            let value = 128.0 + 60.0 * ((x + 0.3 * y) * 0.5).sin() + 40.0 * ((y - 0.2 * x) * 0.25).cos();
            Rgb([value as u8, 255 - value as u8, 100])
        });
        picture.save(pictures.join(format!("{row:02}_{column:02}.png"))).unwrap();
    }
    let file = folder.path().join(format!("wall {pixels}.lfslab")).to_string_lossy().into_owned();
    let fixed = ["import", pictures.to_str().unwrap(), "--out", &file, "--focal-length", "64", "--spacing", "0.1"];
    succeeds(&[&fixed[..], &["--encoding", "rgba8"], options].concat());
    file
}

fn path(folder: &TempDir, name: &str) -> String {
    folder.path().join(name).to_string_lossy().into_owned()
}

/// The number after `words`.
#[track_caller]
fn number_after(text: &str, words: &str) -> f64 {
    let rest = text.split(words).nth(1).unwrap_or_else(|| panic!("no '{words}' in {text}"));
    rest.split([' ', ',']).next().unwrap().parse().unwrap_or_else(|_| panic!("no number after '{words}' in {text}"))
}

/// 64 pixels · 0.1 m / 2 pixels.
const WALL: f64 = 3.2;

#[test]
fn focal_planes_are_found_and_set_without_touching_the_images() {
    let folder = tempfile::tempdir().unwrap();
    let (file, focused) = (wall(&folder, 2.0, &[]), path(&folder, "focused.lfslab"));
    let [_, told] = succeeds(&["refocus", &file, "--out", &focused]);
    let depth = number_after(&told, "focal plane at ");
    assert!((depth / WALL - 1.0).abs() < 0.01, "{told}");
    let export = |file: &str, name: &str| {
        let out = path(&folder, name);
        succeeds(&["export", file, "--to", "plain-grid", "--out", &out]);
        let find = |folder: &Path| fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect::<Vec<_>>();
        let mut files = find(out.as_ref());
        if files[0].is_dir() {
            files = find(&files[0]);
        }
        files.sort();
        files.iter().map(|path| fs::read(path).unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(export(&file, "before"), export(&focused, "after"));
    succeeds(&["validate", &focused]);
    // By hand, and back to infinity.
    let [_, told] = succeeds(&["refocus", &file, "--disparity", "2"]);
    assert!((number_after(&told, "focal plane at ") / WALL - 1.0).abs() < 1e-3, "{told}");
    let [_, told] = succeeds(&["refocus", &focused, "--disparity", "none"]);
    assert!(told.contains("focal plane at infinity"), "{told}");
    fails(&["refocus", &file, "--out", &file], "is there twice");
}

/// Pictures that agree on a plane in front of the wall: what lies behind it moves the other way.
#[test]
fn rectified_pictures_are_recognised_and_can_be_imported() {
    let folder = tempfile::tempdir().unwrap();
    let file = wall(&folder, -2.0, &[]);
    let [_, told] = succeeds(&["refocus", &file]);
    assert!(told.contains("beyond infinity") && told.contains("focal plane at infinity"), "{told}");
    assert!((number_after(&told, "nearer than ") / WALL - 1.0).abs() < 0.01, "{told}");
    // On a plane at 1.6 m things move 4 pixels, on the wall 2 less.
    let file = wall(&folder, -2.0, &["--focal-plane", "1.6"]);
    let [_, told] = succeeds(&["refocus", &file]);
    assert!((number_after(&told, "focal plane at ") / WALL - 1.0).abs() < 0.02, "{told}");
}

#[test]
fn left_out_views_are_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let (file, sheet) = (wall(&folder, 2.0, &[]), path(&folder, "sheet.png"));
    let [table, told] = succeeds(&["holdout", &file, "--planes", "3", "--sheet", &sheet]);
    assert!(told.contains("3×3 of 5×5 cameras are kept, 16 between them left out"), "{told}");
    let [nearest, plain, focused] = psnr(&table, ["nearest camera", "no focal plane", "least squares"]);
    // 4 texels from one kept camera to the next; only the edges, which one of the cameras does not see, are guessed.
    assert!(focused > plain + 6.0 && focused > nearest + 6.0, "{table}");
    assert!((number_after(&table, "least squares: ") - 4.0).abs() < 0.05, "{table}");
    let sheet = image::open(&sheet).unwrap();
    assert!(sheet.width() > 3 * 64 && sheet.height() > 3 * 64);
    fails(&["holdout", &file, "--every", "5"], "give another --every");
    fails(&["holdout", &file, "--face", "+x"], "choose a slab by --face: -Z");
}

/// A light field from the world outside, imported; a line says so if it is not beside this checkout.
fn real(folder: &TempDir, name: &str, options: &[&str]) -> Option<String> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/lightfields").join(name);
    if !source.exists() {
        // Straight to standard error, past the capture of the test harness.
        let _ = writeln!(std::io::stderr(), "NOT TESTED: there is no {name} beside this checkout");
        return None;
    }
    let file = path(folder, "real.lfslab");
    succeeds(&[&["import", source.to_str()?, "--out", &file, "--encoding", "rgba8"][..], options].concat());
    Some(file)
}

/// Mean PSNR of the methods whose names hold these words.
fn psnr<const N: usize>(table: &str, methods: [&str; N]) -> [f64; N] {
    methods.map(|method| {
        let row = table.lines().find(|line| line.contains(method)).unwrap_or_else(|| panic!("no {method} in {table}"));
        row.split('|').nth(2).unwrap().split_whitespace().next().unwrap().parse().unwrap()
    })
}

#[test]
fn a_focal_plane_from_the_flowers_beats_none() {
    let folder = tempfile::tempdir().unwrap();
    let Some(file) = real(&folder, "lytro-flowers-1-10x10", &[]) else { return };
    let [table, _] = succeeds(&["holdout", &file, "--planes", "0", "--views", "8"]);
    let [nearest, plain, focused] = psnr(&table, ["nearest camera", "no focal plane", "least squares"]);
    assert!(plain > nearest && focused > plain + 2.0, "{table}");
}

#[test]
fn a_quilt_of_one_row_has_a_focal_plane_too() {
    let folder = tempfile::tempdir().unwrap();
    let Some(file) = real(&folder, "quilt-4x8-primitives.png", &["--quilt", "4x8"]) else { return };
    let [table, _] = succeeds(&["holdout", &file, "--planes", "8", "--views", "4"]);
    let [nearest, plain, focused, planes] =
        psnr(&table, ["nearest camera", "no focal plane", "least squares", "best of 8"]);
    assert!(plain > nearest && focused > plain && planes > focused + 1.0, "{table}");
}

//! Scenes, environments and cameras on the command line.

use std::fs;
use std::process::{Command, Output};

use image::{ImageFormat, Rgb, Rgb32FImage};
use tempfile::TempDir;

fn lfslab(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lfslab")).args(arguments).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn embedded_scenes_are_described_and_drawn() {
    let folder = TempDir::new().unwrap();
    for (scene, part) in [
        ("museum", "2 point"),
        ("corridor", "12 point"),
        ("mirror-box", "7 mirrors"),
        ("forest", "1 sun"),
        ("beside", "20504"),
    ] {
        let out = folder.path().join(format!("{scene}.png"));
        let output = lfslab(&["view", scene, "--size", "24x16", "--out", &out.to_string_lossy()]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(text(&output.stdout).contains(part), "{}", text(&output.stdout));
        let picture = image::open(&out).unwrap().to_rgb8();
        assert_eq!(picture.dimensions(), (24, 16));
        let first = *picture.get_pixel(0, 0);
        assert!(picture.pixels().any(|pixel| *pixel != first), "{scene} is empty");
    }
}

#[test]
fn an_environment_is_scaled_and_lights_the_scene() {
    let folder = TempDir::new().unwrap();
    let sky = folder.path().join("sky.hdr");
    Rgb32FImage::from_pixel(8, 4, Rgb([0.25, 0.5, 1.0])).save_with_format(&sky, ImageFormat::Hdr).unwrap();
    let (sky, out) = (sky.to_string_lossy(), folder.path().join("up.png"));
    let arguments = [
        "view",
        "forest",
        "--size",
        "2x2",
        "--eye",
        "0,1.5,0",
        "--target",
        "0.3,9,0",
        "--environment",
        &sky,
        "--environment-scale",
        "0.5",
        "--environment-turn",
        "-90",
        "--light",
        "global",
        "--samples",
        "2",
        "--out",
        &out.to_string_lossy(),
    ];
    let output = lfslab(&arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("environment: panorama"));
    let expected = lf_math::srgb8_from_linear(glam::Vec3::new(0.125, 0.25, 0.5));
    assert_eq!(image::open(&out).unwrap().to_rgb8().get_pixel(0, 0).0, expected);
}

#[test]
fn wrong_names_say_which_there_are() {
    let folder = TempDir::new().unwrap();
    let not_glb = folder.path().join("bad.glb");
    fs::write(&not_glb, b"glTF").unwrap();
    let not_glb = not_glb.to_string_lossy();
    let cases: [(&[&str], &[&str]); 5] = [
        (&["view", "louvre"], &["louvre", "museum", "mirror-box"]),
        (&["view", "museum", "--camera", "left"], &["no camera \"left\"", "none"]),
        (&["view", "museum", "--environment", "missing.hdr"], &["missing.hdr", "cannot read"]),
        (&["view", &not_glb], &["bad.glb", "cut off"]),
        (&["view", "museum", "--out", "picture.tiff"], &[".png or .exr"]),
    ];
    for (arguments, words) in cases {
        let output = lfslab(arguments);
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {stderr}");
        assert!(words.iter().all(|word| stderr.contains(word)), "{arguments:?}: {stderr}");
        assert!(!stderr.contains("panicked"), "{stderr}");
    }
    assert_eq!(lfslab(&["view", "museum", "--size", "0x4"]).status.code(), Some(2));
}

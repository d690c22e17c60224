//! The program as a stranger runs it: good runs, bad input, exit codes, no leftovers.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

fn lfslab(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lfslab")).args(arguments).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Asserts exit code 1 and one line of error that holds all the given words.
fn fails_saying(output: &Output, words: &[&str]) {
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    let errors: Vec<_> = stderr.lines().filter(|line| line.starts_with("error: ") && !line.contains("XDG_")).collect();
    assert_eq!(errors.len(), 1, "{stderr}");
    for word in words {
        assert!(errors[0].contains(word), "{:?} lacks {word:?}", errors[0]);
    }
    assert!(!stderr.contains("panicked"), "{stderr}");
}

/// A small light field of the museum.
fn small_file(folder: &Path) -> String {
    let path = folder.join("small.lfslab").to_string_lossy().into_owned();
    let output = lfslab(&["capture", "--cameras", "3", "--resolution", "10", "--out", &path]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    path
}

#[test]
fn every_command_has_help() {
    for command in [
        "demo", "view", "capture", "merge", "cubemap", "render", "info", "validate", "crop", "export", "plan", "import",
    ] {
        let output = lfslab(&[command, "--help"]);
        assert!(output.status.success());
        assert!(text(&output.stdout).contains("Usage: lfslab"), "{command}");
    }
    assert_eq!(lfslab(&["nonsense"]).status.code(), Some(2));
}

#[test]
fn a_captured_file_is_shown_checked_and_rendered() {
    let folder = TempDir::new().unwrap();
    let file = small_file(folder.path());
    let info = text(&lfslab(&["info", &file]).stdout);
    for part in ["lfslab 1.0", "scene: museum", "3×3 cameras", "10×10 texels", "slab 5: -Z"] {
        assert!(info.contains(part), "{info}");
    }
    assert!(text(&lfslab(&["validate", &file]).stdout).contains("valid (6 slabs, 8 chunks)"));
    for (name, device) in [("cpu.png", &["--cpu"][..]), ("any.png", &[])] {
        let picture = folder.path().join(name).to_string_lossy().into_owned();
        let output = lfslab(&[&["render", &file, "--out", &picture, "--size", "64"], device].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(text(&output.stderr).contains("device"), "says which device drew");
        let decoded = image::open(&picture).unwrap().to_rgb8();
        assert_eq!(decoded.dimensions(), (64, 64));
        // The corner is background, the middle is the mirror.
        assert_eq!(decoded.get_pixel(0, 0).0, [40, 40, 44]);
        assert_ne!(decoded.get_pixel(32, 32).0, [40, 40, 44]);
    }
}

/// Named driver files are the only ones that the Vulkan loader takes.
#[test]
#[cfg(target_os = "linux")]
fn without_an_adapter_the_cpu_draws_and_says_so() {
    let folder = TempDir::new().unwrap();
    let file = small_file(folder.path());
    let picture = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let render = |name: &str, device: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lfslab"));
        command.args(["render", &file, "--size", "48", "--out", &picture(name)]).args(device);
        command.env("VK_DRIVER_FILES", "nowhere.json").env("VK_ICD_FILENAMES", "nowhere.json");
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stderr)
    };
    let said = render("without.png", &[]);
    assert!(said.contains("device   CPU: no GPU adapter found") && said.contains("mesa-vulkan-drivers"), "{said}");
    render("asked.png", &["--cpu"]);
    assert_eq!(fs::read(picture("without.png")).unwrap(), fs::read(picture("asked.png")).unwrap());
}

/// Several reflectors, tints, views and a background; what does not go together is refused.
#[test]
fn frames_are_drawn_as_asked() {
    let folder = TempDir::new().unwrap();
    let file = small_file(folder.path());
    let picture = folder.path().join("frame.png").to_string_lossy().into_owned();
    let from = |eye: &str, rest: &[&str]| {
        lfslab(&[&["render", &file, "--cpu", "--size", "64", "--out", &picture, "--eye", eye], rest].concat())
    };
    let run = |rest: &[&str]| from("0,0,1.6", rest);
    let render = |rest: &[&str]| {
        let output = run(rest);
        assert!(output.status.success(), "{}", text(&output.stderr));
        (text(&output.stdout), image::open(&picture).unwrap().to_rgb8())
    };
    let two = ["--reflector", "sphere@-0.25,0,0,0.2", "--reflector", "sphere@0.25,0,0,0.2"];
    let (_, plain) = render(&two);
    let grey = [40, 40, 44];
    assert_eq!(plain.get_pixel(32, 32).0, grey);
    assert!(plain.get_pixel(22, 32).0 != grey && plain.get_pixel(42, 32).0 != grey);
    let (_, red) = render(&[&two[..], &["--tint", "1,0,0"]].concat());
    assert_eq!(red.get_pixel(22, 32).0[1..], [0, 0]);
    let (_, glass) = render(&[&two[..], &["--fresnel", "0.04"]].concat());
    let sum = |picture: &image::RgbImage| picture.get_pixel(22, 32).0.iter().map(|c| u32::from(*c)).sum::<u32>();
    assert!(sum(&glass) < sum(&plain) / 2);
    assert!(from("0,0,0.49", &[&two[..], &["--background", "slabs"]].concat()).status.success());
    assert_ne!(image::open(&picture).unwrap().to_rgb8().get_pixel(32, 2).0, grey);
    let (said, _) = render(&[&two[..], &["--view", "range"]].concat());
    assert!(said.contains(": 0 of "), "{said}");
    for view in ["slabs", "stuv"] {
        assert_ne!(render(&[&two[..], &["--view", view]].concat()).1, plain);
    }
    for wrong in [&["--tint", "2,0,0"][..], &["--fresnel", "-1"], &["--view", "slabs", "--against", "museum"]] {
        assert!(!run(wrong).status.success(), "{wrong:?}");
    }
    assert!(!run(&[&two[..], &["--against", "museum"]].concat()).status.success());
}

/// Its triangles are there where nothing else would be, and hide a reflector behind them.
#[test]
fn a_scene_stands_around_its_reflectors() {
    let folder = TempDir::new().unwrap();
    let file = small_file(folder.path());
    let picture = folder.path().join("scene.png").to_string_lossy().into_owned();
    let run = |rest: &[&str]| {
        let arguments = ["render", &file, "--cpu", "--size", "64", "--out", &picture, "--reflector", "sphere"];
        lfslab(&[&arguments, rest].concat())
    };
    let scene = ["--background", "scene", "--scene", "museum", "--scene-edge", "0.5"];
    // A column stands between this eye and the sphere.
    for (eye, tint) in [("2.956,0,1.225", "1,0,0"), ("2.956,0,1.225", "0,1,0")] {
        let output = run(&[&scene[..], &["--eye", eye, "--tint", tint]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(text(&output.stderr).contains("corners traced"));
        let drawn = image::open(&picture).unwrap().to_rgb8();
        assert!(drawn.pixels().all(|pixel| pixel.0 != [40, 40, 44]), "the room is closed");
        let [r, g, b] = drawn.get_pixel(32, 32).0;
        assert!(r > 2 * g && g > 0 && b > 0, "the red column hides the sphere: {r} {g} {b}");
    }
    for (wrong, why) in [
        (&["--background", "scene"][..], "--scene <NAME|FILE>"),
        (&["--scene", "museum"], "--background scene"),
        (&["--background", "slabs", "--scene", "museum"], "--background scene"),
        (&["--background", "scene", "--scene", "museum", "--scene-edge", "0.001"], "longer edges"),
        (&["--background", "scene", "--scene", "nowhere"], "nowhere"),
        (&["--background", "scene", "--scene", "museum", "--against", "museum"], "--against"),
    ] {
        let output = run(wrong);
        assert!(!output.status.success() && text(&output.stderr).contains(why), "{wrong:?}: {}", text(&output.stderr));
    }
}

/// The error against the scene that was captured is the smaller one; with noise it is said how much.
#[test]
fn a_picture_is_held_against_a_scene() {
    let folder = TempDir::new().unwrap();
    let file = small_file(folder.path());
    let picture = folder.path().join("against.png").to_string_lossy().into_owned();
    let render = |rest: &[&str]| {
        let arguments = ["render", &file, "--cpu", "--reflector", "sphere", "--size", "48", "--out", &picture];
        let output = lfslab(&[&arguments, rest].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let decibels = |scene: &str| {
        let said = render(&["--against", scene]);
        let number = said.split_whitespace().skip_while(|word| !word.ends_with(':')).nth(1);
        number.and_then(|word| word.parse::<f64>().ok()).unwrap_or_else(|| panic!("{said}"))
    };
    let (own, other) = (decibels("museum"), decibels("corridor"));
    assert!(own > other + 1.0, "{own} {other}");
    let noisy = render(&["--against", "museum", "--light", "global", "--samples", "2"]);
    assert!(noisy.contains("standard error is "), "{noisy}");
    let drawn = image::open(&picture).unwrap();
    assert_eq!(drawn.width(), 3 * (48 + 4) + 4);
}

#[test]
fn the_same_scene_gives_the_same_file() {
    let folders = [TempDir::new().unwrap(), TempDir::new().unwrap()];
    let [a, b] = folders.each_ref().map(|folder| fs::read(small_file(folder.path())).unwrap());
    assert!(a == b, "two captures differ");
}

#[test]
fn bad_files_are_named_with_what_is_wrong() {
    let folder = TempDir::new().unwrap();
    let file = small_file(folder.path());
    let good = fs::read(&file).unwrap();
    let bad = folder.path().join("bad.lfslab").to_string_lossy().into_owned();
    let mut flipped = good.clone();
    let last = flipped.len() - 100;
    flipped[last] ^= 1;
    for (bytes, words) in [
        (vec![], &["bad.lfslab"][..]),
        (b"\x89PNG\r\n\x1a\n and so on".to_vec(), &["bad.lfslab", "not"]),
        (good[..good.len() / 2].to_vec(), &["bad.lfslab"]),
        (flipped, &["bad.lfslab", "checksum"]),
    ] {
        fs::write(&bad, bytes).unwrap();
        let picture = folder.path().join("never.png").to_string_lossy().into_owned();
        fails_saying(&lfslab(&["validate", &bad]), &["bad.lfslab", "not valid"]);
        let findings = text(&lfslab(&["validate", &bad]).stdout);
        assert!(words.iter().skip(1).all(|word| findings.contains(word)), "{findings}");
        fails_saying(&lfslab(&["render", &bad, "--cpu", "--out", &picture]), words);
        assert!(!Path::new(&picture).exists());
    }
    fails_saying(&lfslab(&["info", "no-such-file.lfslab"]), &["no-such-file.lfslab"]);
    fails_saying(&lfslab(&["info", &folder.path().to_string_lossy()]), &["could not read"]);
}

#[test]
fn bad_scenes_and_reflectors_are_named() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out").to_string_lossy().into_owned();
    let path = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path.to_string_lossy().into_owned()
    };
    let scene = path("broken.glb", b"glTF\x02\0\0\0 nothing that follows");
    fails_saying(&lfslab(&["demo", "--out", &out, "--scene", &scene]), &["broken.glb"]);
    let mesh = path("broken.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    fails_saying(&lfslab(&["demo", "--out", &out, "--reflector", &mesh]), &["broken.obj"]);
    let empty = path("empty.obj", b"# nothing\n");
    fails_saying(&lfslab(&["demo", "--out", &out, "--reflector", &empty]), &["empty.obj"]);
    assert_eq!(lfslab(&["demo", "--cell", "1,2,3"]).status.code(), Some(2));
    let under_a_file = format!("{mesh}/out");
    fails_saying(&lfslab(&["demo", "--out", &under_a_file]), &["cannot make the folder"]);
}

#[test]
fn the_demo_leaves_all_its_files_and_nothing_else() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    // What a demo was killed over, and a capture that somebody will go on with.
    fs::create_dir(&out).unwrap();
    fs::write(out.join("museum.lfslab.demo.part"), "rubbish").unwrap();
    fs::write(out.join("museum.lfslab.part"), "hours of work").unwrap();
    let output = lfslab(&["demo", "--out", &out.to_string_lossy(), "--size", "64", "--cpu"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(fs::read(out.join("museum.lfslab.part")).unwrap(), b"hours of work");
    fs::remove_file(out.join("museum.lfslab.part")).unwrap();
    assert!(text(&output.stderr).contains("CPU, as asked"));
    let mut names: Vec<_> =
        fs::read_dir(&out).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    let mut expected: Vec<String> =
        ["museum.lfslab", "parallax.png", "report.html", "report.json"].map(String::from).into();
    for reflector in ["sphere", "teapot"] {
        expected.extend((0..8).map(|eye| format!("{reflector}-eye-{eye}.png")));
        expected.extend([
            format!("{reflector}-error-time.svg"),
            format!("{reflector}-orbit.png"),
            format!("{reflector}-eye-0-reference.exr"),
        ]);
    }
    expected.sort();
    assert_eq!(names, expected);
    assert!(lfslab(&["validate", &out.join("museum.lfslab").to_string_lossy()]).status.success());

    // The bar of the method: at least 6 dB over the environment map, mean of eight eyes, on both reflectors.
    let json: serde_json::Value = serde_json::from_slice(&fs::read(out.join("report.json")).unwrap()).unwrap();
    let results = json["results"].as_array().unwrap();
    for reflector in ["sphere", "teapot"] {
        let mean = |method: &str| {
            let found = results.iter().find(|r| r["reflector"] == reflector && r["method"] == method).unwrap();
            assert_eq!(found["eyes"].as_array().unwrap().len(), 8);
            found["mean_psnr_db"].as_f64().unwrap()
        };
        let gain = mean("slabs") - mean("environment map");
        assert!(gain >= 6.0, "{reflector}: {gain} dB");
    }
}

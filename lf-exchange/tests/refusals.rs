//! Damaged and foreign inputs are refused with an error, never a panic.

use std::fs;
use std::path::Path;

use lf_exchange::{ExchangeError, ImportOptions, Lens, QuiltLayout, import_grid, import_hci, import_quilt};
use tempfile::TempDir;

fn picture(folder: &Path, name: &str, [width, height]: [u32; 2]) {
    image::RgbImage::from_pixel(width, height, image::Rgb([1, 2, 3])).save(folder.join(name)).unwrap();
}

fn folder(names: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    names.iter().for_each(|name| picture(folder.path(), name, [4, 4]));
    folder
}

fn refusal(names: &[&str], change: impl Fn(&mut ImportOptions)) -> ExchangeError {
    let mut options = ImportOptions::default();
    change(&mut options);
    import_grid(folder(names).path(), &options).unwrap_err()
}

#[test]
fn folders_without_a_grid() {
    assert!(matches!(
        import_grid(Path::new("no such folder"), &ImportOptions::default()),
        Err(ExchangeError::Io { .. })
    ));
    assert!(refusal(&[], |_| ()).to_string().contains("out_00_00.png"));
    assert!(refusal(&["a.png", "cover_1.png"], |_| ()).to_string().contains("out_00_00.png"));
    let several = ["view_00_00.png", "view_00_01.png", "depth_00_00.png"];
    assert!(refusal(&several, |_| ()).to_string().contains("depth, view"));
    assert!(refusal(&["a_0_0.png", "a_00_00.png"], |_| ()).to_string().contains("two pictures"));
    assert!(refusal(&["a_0_0_1.0_2.0.png", "a_0_1.png"], |_| ()).to_string().contains("some names"));
    let chosen = folder(&several);
    let mut options = ImportOptions::default();
    options.series = Some("view".into());
    assert_eq!(import_grid(chosen.path(), &options).unwrap().geometry.slabs()[0].cameras(), [2, 1]);
}

#[test]
fn positions_that_are_no_grid() {
    let same = ["a_0_0_0.0_1.0.png", "a_0_1_0.0_1.0.png"];
    assert!(refusal(&same, |_| ()).to_string().contains("same X"));
    let bent = ["a_0_0_0.0_0.0.png", "a_0_1_0.0_10.0.png", "a_0_2_0.0_0.5.png", "a_0_3_0.0_30.0.png"];
    assert!(refusal(&bent, |_| ()).to_string().contains("regular grid"));
    let wavy = folder(&["a_0_0_0.0_0.0.png", "a_0_1_0.0_10.0.png", "a_0_2_0.0_19.0.png", "a_0_3_0.0_30.0.png"]);
    assert!(import_grid(wavy.path(), &ImportOptions::default()).unwrap().notes.iter().any(|n| n.contains("grid in X")));
}

#[test]
fn grids_over_the_budget_are_refused_before_they_are_decoded() {
    let huge = ["a_0_0.png", "a_1_1.png", "a_999999999_0.png"];
    assert!(matches!(refusal(&huge, |_| ()), ExchangeError::LimitExceeded { .. }));
    let small = ["a_0_0.png", "a_1_1.png"];
    assert!(matches!(refusal(&small, |o| o.max_bytes = 500), ExchangeError::LimitExceeded { .. }));
    let folder = tempfile::tempdir().unwrap();
    picture(folder.path(), "a_0_0.png", [4, 4]);
    // A header that promises 2¹⁷ pixels along each edge, and nothing behind it.
    let mut bytes = fs::read(folder.path().join("a_0_0.png")).unwrap();
    bytes[16..24].copy_from_slice(&[0, 2, 0, 0, 0, 2, 0, 0]);
    let checksum = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
    fs::write(folder.path().join("a_0_0.png"), bytes).unwrap();
    let result = import_grid(folder.path(), &ImportOptions::default());
    assert!(matches!(result, Err(ExchangeError::LimitExceeded { bytes, .. }) if bytes > 20 << 34), "{result:?}");
}

/// PNG, annex D.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| (0..8).fold(crc ^ u32::from(*byte), |c, _| (c >> 1) ^ (0xEDB8_8320 * (c & 1)));
    !bytes.iter().fold(u32::MAX, step)
}

#[test]
fn pictures_that_do_not_belong_together() {
    let mixed = folder(&["a_0_0.png"]);
    picture(mixed.path(), "a_0_1.png", [5, 4]);
    assert!(import_grid(mixed.path(), &ImportOptions::default()).unwrap_err().to_string().contains("5×4"));
    let foreign = folder(&["a_0_0.png"]);
    fs::write(foreign.path().join("a_0_1.png"), b"GIF89a, or so it says").unwrap();
    assert!(import_grid(foreign.path(), &ImportOptions::default()).is_err());
    fs::write(foreign.path().join("a_0_1.exr"), b"no").unwrap();
    assert!(import_grid(foreign.path(), &ImportOptions::default()).is_err());
}

#[test]
fn every_cut_and_many_flips_of_a_picture_are_survived() {
    for extension in ["png", "exr", "jpg"] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(format!("a_0_0.{extension}"));
        sound_picture(&path);
        let sound = fs::read(&path).unwrap();
        assert!(import_grid(folder.path(), &ImportOptions::default()).is_ok(), "{extension}");
        for len in (0..sound.len()).step_by(3) {
            fs::write(&path, &sound[..len]).unwrap();
            let _ = import_grid(folder.path(), &ImportOptions::default());
        }
        for at in (0..sound.len().min(900)).step_by(2) {
            let mut flipped = sound.clone();
            flipped[at] ^= 1 << (at / 2 % 8);
            fs::write(&path, flipped).unwrap();
            let mut options = ImportOptions::default();
            options.max_bytes = 1 << 24;
            let _ = import_grid(folder.path(), &options);
        }
    }
}

fn sound_picture(path: &Path) {
    use lf_exchange::Texel as _;
    if path.extension().is_some_and(|extension| extension == "exr") {
        let value = |i: u32| [half::f16::from_f32(i as f32); 3];
        let picture = lf_math::Image::new(9, 7, (0..63).map(value).collect()).unwrap();
        return <[half::f16; 3]>::write_picture(&picture, path).unwrap();
    }
    image::RgbImage::from_fn(9, 7, |x, y| image::Rgb([(9 * x) as u8, (9 * y) as u8, 3])).save(path).unwrap();
}

#[test]
fn options_that_cannot_be() {
    let one = ["a_0_0.png"];
    let bad = |change: fn(&mut ImportOptions)| matches!(refusal(&one, change), ExchangeError::InvalidArgument { .. });
    assert!(bad(|o| o.lens = Some(Lens::FieldOfView(0.0))));
    assert!(bad(|o| o.lens = Some(Lens::FieldOfView(3.2))));
    assert!(bad(|o| o.lens = Some(Lens::FocalLength(f64::NAN))));
    assert!(bad(|o| o.spacing = Some(-1.0)));
    assert!(bad(|o| o.focal_plane = Some(0.0)));
    assert!(matches!(refusal(&one, |o| o.plane = Some(f64::INFINITY)), ExchangeError::Geometry(_)));
}

#[test]
fn benchmark_scenes_with_wrong_parameters() {
    let scene = |text: &str| {
        let folder = folder(&["input_Cam000.png"]);
        fs::write(folder.path().join("parameters.cfg"), text).unwrap();
        import_hci(folder.path(), &ImportOptions::default())
    };
    let good = "focal_length_mm = 50\nsensor_size_mm = 35\nbaseline_mm = 10\nnum_cams_x = 1\nnum_cams_y = 1\n";
    let imported = scene(good).unwrap();
    assert_eq!(imported.geometry.slabs()[0].face(), lf_math::Face::NegZ);
    assert_eq!(imported.notes.len(), 1);
    for key in ["focal_length_mm", "sensor_size_mm", "baseline_mm", "num_cams_x", "num_cams_y"] {
        for value in ["", "-1", "nan", "0", "1e400", "zehn"] {
            let text: Vec<String> = good
                .lines()
                .map(|line| if line.starts_with(key) { format!("{key} = {value}") } else { line.to_owned() })
                .collect();
            let error = scene(&text.join("\n")).unwrap_err();
            assert!(error.to_string().contains(key), "{error}");
        }
    }
    assert!(scene(&good.replace("num_cams_x = 1", "num_cams_x = 1.5")).is_err());
    assert!(matches!(scene(&good.replace("= 1\n", "= 4294967295\n")), Err(ExchangeError::LimitExceeded { .. })));
    assert!(import_hci(folder(&[]).path(), &ImportOptions::default()).is_err());
}

#[test]
fn quilts_without_a_layout() {
    let folder = folder(&["q.png", "q_qs0x3a1.png", "q_qs9x9a1.png", "q_qs65536x65536a1.png"]);
    let import = |name: &str, layout| {
        let mut options = ImportOptions::default();
        options.quilt = layout;
        import_quilt(&folder.path().join(name), &options)
    };
    for name in ["q.png", "q_qs0x3a1.png", "q_qs9x9a1.png", "q_qs65536x65536a1.png", "none_qs1x1.png"] {
        assert!(import(name, None).is_err(), "{name}");
    }
    assert!(import("q.png", Some(QuiltLayout { columns: 2, rows: 2 })).is_ok());
}

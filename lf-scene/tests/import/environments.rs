//! Panoramas.

use std::fs;
use std::io::Write;
use std::path::Path;

use exr::meta::attribute::Chromaticities;
use exr::prelude::{SpecificChannels, Vec2, WritableImage};
use glam::Vec3;
use image::{DynamicImage, ImageFormat, Rgb, Rgb32FImage};
use lf_scene::{Environment, import_environment};

use crate::files::{encoded, folder};

/// 4×2 texels, each of another colour.
fn panorama() -> Rgb32FImage {
    Rgb32FImage::from_fn(4, 2, |x, y| Rgb([x as f32, y as f32 * 100.0, 0.5]))
}

fn write_exr(path: &Path, texel: impl Fn(usize, usize) -> (f32, f32, f32) + Sync) {
    exr::prelude::write_rgb_file(path, 4, 2, texel).unwrap();
}

#[test]
fn both_formats_give_the_same_radiance() {
    let folder = folder("environments");
    let (hdr, exr) = (folder.join("a.hdr"), folder.join("a.exr"));
    fs::write(&hdr, encoded(&DynamicImage::ImageRgb32F(panorama()), ImageFormat::Hdr)).unwrap();
    write_exr(&exr, |x, y| (x as f32, y as f32 * 100.0, 0.5));
    for path in [&hdr, &exr] {
        let imported = import_environment(path, 2.0, 0.0).unwrap();
        assert!(imported.warnings.is_empty(), "{:?}", imported.warnings);
        let map = Environment::Map(imported.map.into());
        // Columns begin at +Z and go by −X, −Z, +X; the centre of the first is between +Z and −X.
        let seen = map.towards(Vec3::new(-1.0, 1.0, 1.0).normalize());
        assert!((seen - Vec3::new(0.0, 0.0, 1.0)).abs().max_element() < 80.0 / 256.0 * 2.0 * 100.0, "{seen}");
        let down = map.towards(Vec3::NEG_Y);
        assert!((down.y - 200.0).abs() < 2.0, "{down}");
    }
}

#[test]
fn broken_values_are_mended_and_counted() {
    let path = folder("environments").join("broken-values.exr");
    write_exr(&path, |x, y| match (x, y) {
        (0, 0) => (f32::NAN, -1.0, 1.0),
        (1, 0) => (f32::INFINITY, 1.0, 1.0),
        _ => (1.0, 1.0, 1.0),
    });
    let imported = import_environment(&path, 1.0, 0.0).unwrap();
    assert_eq!(imported.warnings.len(), 2, "{:?}", imported.warnings);
    assert!(imported.warnings.iter().any(|w| w.contains("taken for 0 (2)")));
    for (scale, turn) in [(-1.0, 0.0), (f32::NAN, 0.0), (1.0, f32::INFINITY)] {
        assert!(import_environment(&path, scale, turn).is_err());
    }
}

/// A Radiance picture of 2×1 texels of radiance 1 with more lines in its header.
fn radiance(lines: &str) -> Vec<u8> {
    let texel = [128, 128, 128, 129];
    let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n{lines}\n-Y 1 +X 2\n");
    [header.as_bytes(), &texel, &texel].concat()
}

#[test]
fn exposures_are_undone() {
    let path = folder("environments").join("exposed.hdr");
    let seen = |lines: &str| {
        fs::write(&path, radiance(lines)).unwrap();
        let imported = import_environment(&path, 1.0, 0.0).unwrap();
        (Environment::Map(imported.map.into()).towards(Vec3::Y), imported.warnings)
    };
    assert_eq!(seen(""), (Vec3::ONE, vec![]));
    assert_eq!(seen("EXPOSURE=4\nEXPOSURE= 0.5\n"), (Vec3::splat(0.5), vec![]));
    assert_eq!(seen("COLORCORR=1 2 4\nEXPOSURE=0.5\n"), (Vec3::new(2.0, 1.0, 0.5), vec![]));
    for broken in ["EXPOSURE=0\n", "EXPOSURE=-1\n", "EXPOSURE=nan\n", "COLORCORR=1 0 1\n"] {
        let (radiance, warnings) = seen(broken);
        assert_eq!(radiance, Vec3::ONE);
        assert_eq!(warnings, ["exposures of the environment are not positive numbers and not used (1)"]);
    }
    let (radiance, warnings) = seen("EXPOSURE=1e-39\n");
    assert_eq!(radiance, Vec3::splat(1e9));
    assert_eq!(warnings, ["values of the environment are too bright to calculate with and taken for 1e9 (6)"]);
}

#[test]
fn values_that_are_too_bright_are_capped_and_counted() {
    let path = folder("environments").join("bright.exr");
    write_exr(&path, |x, y| if (x, y) == (1, 0) { (f32::MAX, 1e38, 1.0) } else { (1.0, 1.0, 1.0) });
    let imported = import_environment(&path, 1e3, 0.0).unwrap();
    assert_eq!(imported.warnings, ["values of the environment are too bright to calculate with and taken for 1e9 (2)"]);
    let map = Environment::Map(imported.map.into());
    assert!(map.towards(Vec3::Y).is_finite());
}

#[test]
fn other_primaries_are_noted() {
    let path = folder("environments").join("primaries.exr");
    let write = |blue: f32| {
        let channels = SpecificChannels::rgb(|_| (1.0f32, 1.0f32, 1.0f32));
        let mut picture = exr::prelude::Image::from_channels((4, 2), channels);
        picture.attributes.chromaticities = Some(Chromaticities {
            red: Vec2(0.64, 0.33),
            green: Vec2(0.3, 0.6),
            blue: Vec2(blue, 0.06),
            white: Vec2(0.3127, 0.329),
        });
        picture.write().to_file(&path).unwrap();
        import_environment(&path, 1.0, 0.0).unwrap().warnings
    };
    assert!(write(0.15).is_empty());
    assert_eq!(write(0.13), ["environments have other primaries than Rec. 709, whose they are taken for (1)"]);
}

#[test]
fn absurd_sizes_are_one_clear_error() {
    let folder = folder("environments");
    let path = folder.join("size.exr");
    write_exr(&path, |_, _| (1.0, 2.0, 3.0));
    let whole = fs::read(&path).unwrap();
    let window = b"dataWindow\0box2i\0";
    let place = whole.windows(window.len()).position(|bytes| bytes == window).unwrap() + window.len() + 4;
    for (last, said) in [([999_999, 999_999], "bytes of memory"), ([i32::MAX, i32::MAX], "OpenEXR picture: ")] {
        let mut absurd = whole.clone();
        // Left, top, right, bottom, inclusive.
        absurd[place + 8..place + 16].copy_from_slice(last.map(i32::to_le_bytes).as_flattened());
        fs::write(&path, &absurd).unwrap();
        let error = import_environment(&path, 1.0, 0.0).unwrap_err();
        let source = std::error::Error::source(&error).unwrap().to_string();
        assert!(source.contains(said), "{last:?}: {source}");
    }
}

#[test]
fn broken_files_are_errors() {
    let folder = folder("environments");
    let path = folder.join("whole.exr");
    write_exr(&path, |_, _| (1.0, 2.0, 3.0));
    let exr = fs::read(&path).unwrap();
    let hdr = encoded(&DynamicImage::ImageRgb32F(panorama()), ImageFormat::Hdr);
    let cut = folder.join("cut");
    for whole in [exr, hdr] {
        for length in 0..whole.len() {
            fs::write(&cut, &whole[..length]).unwrap();
            assert!(import_environment(&cut, 1.0, 0.0).is_err(), "{length} of {}", whole.len());
        }
    }
    fs::write(&cut, b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 1000000\n").unwrap();
    let error = import_environment(&cut, 1.0, 0.0).unwrap_err();
    assert!(std::error::Error::source(&error).unwrap().to_string().contains("bytes of memory"), "{error:?}");
    assert!(import_environment(Path::new("no such file.hdr"), 1.0, 0.0).is_err());
}

#[test]
fn real_panoramas_arrive() {
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/hdri"));
    for (name, brightest) in [("potsdamer_platz_1k", 5.0..1300.0), ("st_fagans_interior_1k", 5.0..1300.0)] {
        let path = data.join(format!("{name}.hdr"));
        if !path.exists() {
            let _ = writeln!(std::io::stderr(), "NOT TESTED: {} is not on this machine", path.display());
            continue;
        }
        let imported = import_environment(&path, 1.0, 0.0).unwrap();
        assert!(imported.warnings.is_empty());
        let map = Environment::Map(imported.map.into());
        let directions = (0..200_000u32).map(|i| {
            let y = 1.0 - (2.0 * i as f32 + 1.0) / 200_000.0;
            let (sin, cos) = (2.399_963_2 * i as f32).sin_cos();
            let r = (1.0 - y * y).sqrt();
            Vec3::new(r * cos, y, r * sin)
        });
        let most = directions.map(|d| map.towards(d).max_element()).fold(0.0, f32::max);
        assert!(brightest.contains(&most), "{name}: {most}");
    }
}

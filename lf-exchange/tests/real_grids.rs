//! Light fields from the world outside, where a checkout has them beside it; they are not part of the repository.

use std::fs;
use std::path::{Path, PathBuf};

use lf_exchange::{ImportOptions, Imported, QuiltLayout, Texels, import, import_grid};
use lf_math::SlabTexels;

/// The path of a light field, or a line that says that the test is skipped.
fn light_field(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/lightfields").join(name);
    if !path.exists() {
        eprintln!("SKIPPED: there is no {name} beside this checkout");
    }
    path.exists().then_some(path)
}

fn texels(imported: &Imported) -> &SlabTexels {
    let Texels::Srgb8(texels) = &imported.texels else { panic!("not sRGB") };
    texels
}

/// Mean difference between the pictures of two cameras, the second one's read `shift` texels away.
fn difference(texels: &SlabTexels, cameras: [[u32; 2]; 2], shift: [i64; 2]) -> f64 {
    let [width, height] = texels.resolution().map(i64::from);
    let (mut sum, mut count) = (0.0, 0.0);
    for (u, v) in (40..width - 40).step_by(3).flat_map(|u| (40..height - 40).step_by(3).map(move |v| (u, v))) {
        let a = texels.texel(cameras[0], [u as u32, v as u32]).unwrap();
        let b = texels.texel(cameras[1], [(u + shift[0]) as u32, (v + shift[1]) as u32]).unwrap();
        sum += (0..3).map(|i| f64::from(a[i].abs_diff(b[i]))).sum::<f64>();
        count += 3.0;
    }
    sum / count
}

/// Nine pictures of the junk shop, most of which is about 7.8 m away.
#[test]
fn the_junk_shop_moves_against_its_cameras() {
    let Some(path) = light_field("junkshop-14x14") else { return };
    let folder = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(path).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if ["_12_", "_14_", "_16_"].iter().any(|index| name.contains(&format!("Camera{index}")))
            && ["_12_", "_14_", "_16_"].iter().any(|index| name.get(18..22) == Some(*index))
        {
            fs::copy(entry.path(), folder.path().join(name)).unwrap();
        }
    }
    let imported = import_grid(folder.path(), &ImportOptions::default()).unwrap();
    let slab = imported.geometry.slabs()[0];
    assert_eq!((slab.cameras(), slab.resolution()), ([3, 3], [960, 640]));
    assert!(imported.notes.is_empty() && imported.missing_count() == 0, "{:?}", imported.notes);
    // 30 mm on 36 mm of sensor and 960 pixels; every other camera of a grid of 800/26 mm.
    assert!((slab.uv()[0].step() - 1.0 / 800.0).abs() < 1e-8);
    assert!((slab.st()[0].step() - 0.8 / 13.0).abs() < 1e-6 && (slab.st()[1].step() - 0.8 / 13.0).abs() < 1e-6);
    // A step to +s or +t moves what is 7.8 m away by 6.3 texels towards −u or −v.
    let shift = slab.with_focal_depth(Some(7.8)).unwrap().disparity().round();
    assert_eq!([shift.x, shift.y], [6.0, 6.0]);
    for (next, along) in [([2, 1], [1, 0]), ([1, 2], [0, 1])] {
        let at = |sign: i64| difference(texels(&imported), [[1, 1], next], along.map(|i: i64| i * 6 * sign));
        assert!(at(-1) < 0.7 * at(0) && at(-1) < 0.7 * at(1), "{along:?}: {} {} {}", at(-1), at(0), at(1));
    }
}

#[test]
fn the_lytro_flowers_are_a_grid_without_positions() {
    let Some(path) = light_field("lytro-flowers-1-10x10") else { return };
    let mut options = ImportOptions::default();
    options.spacing = Some(1e-3);
    let imported = import_grid(&path, &options).unwrap();
    let slab = imported.geometry.slabs()[0];
    assert_eq!((slab.cameras(), slab.resolution()), ([10, 10], [256, 256]));
    assert_eq!(imported.notes.len(), 1, "only the field of view is assumed: {:?}", imported.notes);
    // Row 0 of the names is the highest camera, t = 9; texel rows run upwards.
    let first = image::open(path.join("view_00_00.png")).unwrap().into_rgb8();
    let [r, g, b, _] = texels(&imported).texel([0, 9], [7, 255]).unwrap();
    assert_eq!(first.get_pixel(7, 0).0, [r, g, b]);
}

#[test]
fn the_quilt_of_primitives_has_thirty_two_views() {
    let Some(path) = light_field("quilt-4x8-primitives.png") else { return };
    let mut options = ImportOptions::default();
    options.quilt = Some(QuiltLayout { columns: 4, rows: 8 });
    let imported = import(&path, &options).unwrap();
    let slab = imported.geometry.slabs()[0];
    assert_eq!((slab.cameras(), slab.resolution()), ([32, 1], [512, 256]));
    // Neighbouring views are alike, the first and the last are not: the order is that of the cameras.
    let between = |a, b| difference(texels(&imported), [[a, 0], [b, 0]], [0, 0]);
    let steps: Vec<f64> = (0..31).map(|view| between(view, view + 1)).collect();
    let largest = steps.iter().copied().fold(0.0, f64::max);
    assert!(between(0, 31) > 4.0 * largest, "{} {largest}", between(0, 31));
}

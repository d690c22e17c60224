//! What is exported and imported again, and what is imported from pictures of a known scene.

use std::fs;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};
use half::f16;
use lf_exchange::{
    GridNaming, HciScene, ImportOptions, Imported, Lens, LightField, QuiltLayout, SlabPictures, Texel, Texels, import,
    import_grid, transforms, write_hci, write_quilt, write_slab_grid,
};
use lf_math::{Cell, Coverage, Face, LightFieldGeometry, SampledAxis, Slab, SlabTexels};
use proptest::prelude::*;

/// Smooth and different in every direction, so that each mirrored or transposed picture shows.
fn radiance(direction: Vec3) -> [f32; 3] {
    let d = direction.normalize();
    [0.5 + 0.4 * d.x, 0.5 + 0.4 * d.y, 0.5 + 0.4 * d.z]
}

/// A slab of a sky that is infinitely far away, plus one colour for each camera.
fn slab_texels<T: Texel>(slab: &Slab, encode: impl Fn([f32; 3]) -> T) -> SlabTexels<T> {
    let ([cs, ct], [cu, cv]) = (slab.cameras(), slab.resolution());
    let mut texels = Vec::new();
    for (t, s) in (0..ct).flat_map(|t| (0..cs).map(move |s| (t, s))) {
        for (v, u) in (0..cv).flat_map(|v| (0..cu).map(move |u| (v, u))) {
            let ray = slab.sample_ray(Vec2::new(s as f32, t as f32), Vec2::new(u as f32, v as f32));
            let [r, g, b] = radiance(ray.direction);
            texels.push(encode([r, g + 0.01 * s as f32, b + 0.01 * t as f32]));
        }
    }
    SlabTexels::new(slab, texels).unwrap()
}

fn encode8([r, g, b]: [f32; 3]) -> [u8; 4] {
    [(r * 255.0) as u8, (g * 255.0) as u8, (b * 255.0) as u8, 255]
}

fn encode16(rgb: [f32; 3]) -> [f16; 3] {
    rgb.map(|x| f16::from_f32(10.0 * x))
}

/// Square pixels and an axis in the middle, as the imports assume.
fn field(face: Face) -> LightFieldGeometry {
    let cell = Cell::new(DVec3::new(0.5, -1.25, 2.0), Vec3::new(0.5, 0.25, 0.75)).unwrap();
    let st = [SampledAxis::new(-0.25, 0.125, 4).unwrap(), SampledAxis::new(-0.375, 0.125, 3).unwrap()];
    let uv = [SampledAxis::spanning(-0.875, 0.875, 8).unwrap(), SampledAxis::spanning(-0.625, 0.625, 6).unwrap()];
    LightFieldGeometry::new(cell, vec![Slab::new(face, 0.25, st, uv, Some(3.0)).unwrap()]).unwrap()
}

fn focal<T: Texel>(pictures: &SlabPictures<'_, T>) -> Lens {
    Lens::FocalLength(pictures.intrinsics().focal[0])
}

/// The slabs agree to a few units of the last place of numbers around 1.
fn assert_same_geometry(imported: &Imported, expected: &LightFieldGeometry, focal_depth: bool) {
    let (a, b) = (imported.geometry.slabs()[0], expected.slabs()[0]);
    assert_eq!((a.face(), a.cameras(), a.resolution()), (b.face(), b.cameras(), b.resolution()));
    let numbers = |slab: Slab, cell: &Cell| {
        let axes = slab.st().into_iter().chain(slab.uv()).flat_map(|axis| [axis.first(), axis.step()]);
        axes.chain([slab.plane()]).chain(cell.center().as_vec3().to_array()).collect::<Vec<f32>>()
    };
    for (x, y) in numbers(a, imported.geometry.cell()).into_iter().zip(numbers(b, expected.cell())) {
        assert!((x - y).abs() < 2e-6, "{a:?}\n{b:?}");
    }
    if focal_depth {
        assert_eq!(a.focal_depth(), b.focal_depth());
    }
}

fn assert_same_texels(imported: &Imported, expected: &SlabTexels) {
    let Texels::Srgb8(texels) = &imported.texels else { panic!("not sRGB") };
    assert_eq!(texels, expected);
    assert_eq!(imported.missing_count(), 0);
}

#[test]
fn stanford_grids_come_back_to_the_bit() {
    for face in Face::ALL {
        let (folder, geometry) = (tempfile::tempdir().unwrap(), field(face));
        let texels = [slab_texels(&geometry.slabs()[0], encode8)];
        let pictures = LightField::new(&geometry, &texels).unwrap().pictures(0).unwrap();
        write_slab_grid(folder.path(), &pictures, GridNaming::Stanford).unwrap();
        let mut options = ImportOptions::default();
        options.face = Some(face);
        options.lens = Some(focal(&pictures));
        options.cell = Some(*geometry.cell());
        options.plane = Some(geometry.cell().center()[face.axis()] + 0.25);
        let imported = import_grid(folder.path(), &options).unwrap();
        assert_same_geometry(&imported, &geometry, false);
        assert_same_texels(&imported, &texels[0]);
        assert!(imported.notes.is_empty(), "{:?}", imported.notes);
    }
}

#[test]
fn linear_grids_come_back_to_the_bit_too() {
    let (folder, geometry) = (tempfile::tempdir().unwrap(), field(Face::PosX));
    let texels = [slab_texels(&geometry.slabs()[0], encode16)];
    let pictures = LightField::new(&geometry, &texels).unwrap().pictures(0).unwrap();
    write_slab_grid(folder.path(), &pictures, GridNaming::RowColumn).unwrap();
    let mut options = ImportOptions::default();
    options.face = Some(Face::PosX);
    let imported = import_grid(folder.path(), &options).unwrap();
    assert_eq!(imported.texels, Texels::Linear16(texels[0].clone()));
    assert_eq!(imported.notes.len(), 2, "{:?}", imported.notes);
}

#[test]
fn benchmark_scenes_keep_their_pose() {
    for face in Face::ALL {
        let (folder, geometry) = (tempfile::tempdir().unwrap(), field(face));
        let texels = [slab_texels(&geometry.slabs()[0], encode8)];
        let pictures = LightField::new(&geometry, &texels).unwrap().pictures(0).unwrap();
        write_hci(folder.path(), &pictures, &HciScene { name: "a\nb".into(), depth_range: None }).unwrap();
        let mut options = ImportOptions::default();
        options.cell = Some(*geometry.cell());
        let imported = import(folder.path(), &options).unwrap();
        assert_same_geometry(&imported, &geometry, false);
        assert_same_texels(&imported, &texels[0]);
        assert!(imported.notes.is_empty(), "{:?}", imported.notes);
        let path = folder.path().join("parameters.cfg");
        let near = fs::read_to_string(&path).unwrap().replace("focus_distance_m = 1000000", "focus_distance_m = 2.5");
        fs::write(&path, near).unwrap();
        assert_eq!(import(folder.path(), &options).unwrap().geometry.slabs()[0].focal_depth(), Some(2.5));
    }
}

#[test]
fn benchmark_parameters_are_the_slab_s() {
    let (folder, geometry) = (tempfile::tempdir().unwrap(), field(Face::NegZ));
    let texels = [slab_texels(&geometry.slabs()[0], encode8)];
    let pictures = LightField::new(&geometry, &texels).unwrap().pictures(0).unwrap();
    let scene = HciScene { name: "sky".into(), depth_range: Some([2.0, f64::INFINITY]) };
    write_hci(folder.path(), &pictures, &scene).unwrap();
    let text = fs::read_to_string(folder.path().join("parameters.cfg")).unwrap();
    let value = |key: &str| {
        let line = text.lines().find(|line| line.starts_with(&format!("{key} = "))).unwrap();
        line.split_once(" = ").unwrap().1.parse::<f64>().unwrap()
    };
    // Slopes of ±1 at the edges of 8 pixels, 4 pixels from the middle.
    assert!((value("focal_length_mm") / value("sensor_size_mm") - 0.5).abs() < 1e-6);
    assert_eq!((value("num_cams_x"), value("num_cams_y")), (4.0, 3.0));
    assert!((value("baseline_mm") - 125.0).abs() < 1e-9);
    // Depth by the benchmark's own formula, from the disparity of a point 2 m away.
    let (b, f, d, s, n) = (125.0, value("focal_length_mm"), value("focus_distance_m"), value("sensor_size_mm"), 8.0);
    let depth = (b * f * d * n) / (value("disp_max") * d * s * 1000.0 + b * f * n);
    assert!((depth - 2.0).abs() < 1e-6, "{depth}");
    // Blender's camera looks down with no rotation, and horizontally with a quarter turn about X.
    assert!((value("center_cam_rx_rad") - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    assert!(value("center_cam_ry_rad").abs() < 1e-6 && value("center_cam_rz_rad").abs() < 1e-6);
    // The middle camera's world position (x, y, z) = (0.5 − 0.0625, −1.25 − 0.25, 2.25), with Z up.
    let eye = ["x", "y", "z"].map(|axis| value(&format!("center_cam_{axis}_m")));
    for (a, b) in eye.into_iter().zip([0.4375, -2.25, -1.5]) {
        assert!((a - b).abs() < 1e-6, "{eye:?}");
    }
}

#[test]
fn quilts_come_back_to_the_bit() {
    let (folder, geometry) = (tempfile::tempdir().unwrap(), field(Face::PosZ));
    let texels = [slab_texels(&geometry.slabs()[0], encode8)];
    let pictures = LightField::new(&geometry, &texels).unwrap().pictures(0).unwrap();
    let file = write_quilt(folder.path(), "sky", &pictures, 1, QuiltLayout { columns: 2, rows: 2 }).unwrap();
    assert_eq!(file.file_name().unwrap(), "sky_qs2x2a1.33333.png");
    let mut options = ImportOptions::default();
    options.face = Some(Face::PosZ);
    options.lens = Some(focal(&pictures));
    options.spacing = Some(0.125);
    let imported = import(&file, &options).unwrap();
    let slab = imported.geometry.slabs()[0];
    assert_eq!((slab.cameras(), slab.resolution()), ([4, 1], [8, 6]));
    let Texels::Srgb8(back) = &imported.texels else { panic!("not sRGB") };
    // Row 1 of 3 from the top is t = 1.
    for s in 0..4 {
        for (u, v) in (0..8).flat_map(|u| (0..6).map(move |v| (u, v))) {
            assert_eq!(back.texel([s, 0], [u, v]), texels[0].texel([s, 1], [u, v]));
        }
    }
    // A view shown twice as wide as high, in tiles of 8×6: pixels are oblong.
    let squeezed = folder.path().join("sky_qs2x2a2.png");
    fs::copy(&file, &squeezed).unwrap();
    let [u, v] = import(&squeezed, &options).unwrap().geometry.slabs()[0].uv();
    assert!((8.0 * u.step() / (6.0 * v.step()) - 2.0).abs() < 1e-6);
    let wrong = write_quilt(folder.path(), "sky", &pictures, 1, QuiltLayout { columns: 3, rows: 2 });
    assert!(wrong.is_err());
}

/// A picture of a fronto-parallel wall that has the colour of the wall's coordinates, by a camera at (x, y).
fn wall_picture(path: &Path, [x, y]: [f64; 2], sheared: bool, [width, height]: [u32; 2], focal: f64, depth: f64) {
    let pixel = |i: u32, j: u32| {
        let slope = [f64::from(i) + 0.5 - 0.5 * f64::from(width), f64::from(j) + 0.5 - 0.5 * f64::from(height)];
        let eye = if sheared { [0.0; 2] } else { [x, y] };
        let at = [eye[0] + depth * slope[0] / focal, eye[1] + depth * slope[1] / focal];
        image::Rgb([(128.0 + 40.0 * at[0]).round() as u8, (128.0 + 40.0 * at[1]).round() as u8, 9])
    };
    image::RgbImage::from_fn(width, height, pixel).save(path).unwrap();
}

#[test]
fn rectified_pictures_become_those_of_parallel_cameras() {
    let (rectified, parallel) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (size, focal, depth) = ([40, 30], 30.0, 2.0);
    for (row, column) in (0..3).flat_map(|row| (0..5).map(move |column| (row, column))) {
        // Columns of the names run to the left, as in some of the Stanford archive's; positions tell.
        let [x, y] = [-0.07 * (f64::from(column) - 2.0), 0.05 * (f64::from(row) - 1.0)];
        let name = format!("out_{row:02}_{column:02}_{:.6}_{:.6}_.png", 1e3 * y, 1e3 * x);
        wall_picture(&rectified.path().join(&name), [x, y], true, size, focal, depth);
        wall_picture(&parallel.path().join(&name), [x, y], false, size, focal, depth);
    }
    let mut options = ImportOptions::default();
    options.lens = Some(Lens::FocalLength(focal));
    let straight = import_grid(parallel.path(), &options).unwrap();
    options.focal_plane = Some(depth);
    let unsheared = import_grid(rectified.path(), &options).unwrap();
    assert_eq!(unsheared.geometry.slabs()[0].focal_depth(), Some(2.0));
    assert_eq!(unsheared.geometry.slabs()[0].st(), straight.geometry.slabs()[0].st());
    assert!((straight.geometry.slabs()[0].st()[0].step() - 0.07).abs() < 1e-6);
    let (Texels::Srgb8(a), Texels::Srgb8(b)) = (&unsheared.texels, &straight.texels) else { panic!("not sRGB") };
    for (s, t) in (0..5).flat_map(|s| (0..3).map(move |t| [s, t])).map(|[s, t]| (s, t)) {
        // Three pixels at the edges may be repeated ones.
        for (u, v) in (3..37).flat_map(|u| (3..27).map(move |v| (u, v))) {
            let (a, b) = (a.texel([s, t], [u, v]).unwrap(), b.texel([s, t], [u, v]).unwrap());
            assert!(a.into_iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 1), "{s} {t} {u} {v}: {a:?} {b:?}");
        }
    }
    // The wall's point straight ahead of the leftmost, topmost camera: s = 0, t = 2.
    let ahead = b.texel([0, 2], [20, 15]).unwrap();
    assert_eq!(
        ahead[..2],
        [
            (128.0f64 + 40.0 * (-0.14 + 0.5 / 15.0)).round() as u8,
            (128.0f64 + 40.0 * (-0.05 - 0.5 / 15.0)).round() as u8
        ]
    );
}

#[test]
fn missing_pictures_are_black_and_told() {
    let (folder, geometry) = (tempfile::tempdir().unwrap(), field(Face::NegZ));
    let texels = [slab_texels(&geometry.slabs()[0], encode8)];
    let pictures = LightField::new(&geometry, &texels).unwrap().pictures(0).unwrap();
    write_slab_grid(folder.path(), &pictures, GridNaming::RowColumn).unwrap();
    // The topmost, leftmost camera is s = 0, t = 2; the row below it goes altogether.
    for name in ["00_00", "01_00", "01_01", "01_02", "01_03"] {
        fs::remove_file(folder.path().join(format!("{name}.png"))).unwrap();
    }
    fs::copy(folder.path().join("00_01.png"), folder.path().join("03_00.png")).unwrap();
    let imported = import_grid(folder.path(), &ImportOptions::default()).unwrap();
    assert_eq!(imported.geometry.slabs()[0].cameras(), [4, 4]);
    let missing: Vec<usize> = (0..16).filter(|&i| imported.missing[i]).collect();
    assert_eq!(missing, [1, 2, 3, 8, 9, 10, 11, 12]);
    let Texels::Srgb8(texels) = &imported.texels else { panic!("not sRGB") };
    assert_eq!(texels.texel([0, 3], [5, 5]), Some([0, 0, 0, 255]));
}

#[test]
fn cameras_without_texels_are_not_exported() {
    let (folder, geometry) = (tempfile::tempdir().unwrap(), field(Face::NegZ));
    let slab = &geometry.slabs()[0];
    let kept: Vec<bool> = (0..12).map(|camera| camera != 5).collect();
    let texels = slab_texels(slab, encode8).crop(Coverage::whole(slab).with_cameras(kept.clone()).unwrap()).unwrap();
    let texels = [texels];
    let field = LightField::new(&geometry, &texels).unwrap();
    write_slab_grid(folder.path(), &field.pictures(0).unwrap(), GridNaming::RowColumn).unwrap();
    assert_eq!(transforms(&field)["frames"].as_array().unwrap().len(), 11);
    let imported = import(folder.path(), &ImportOptions::default()).unwrap();
    assert!(imported.missing.iter().zip(kept).all(|(&missing, kept)| missing != kept));
}

#[test]
fn transforms_look_along_the_stored_rays() {
    let mut slabs = Vec::new();
    for face in Face::ALL {
        slabs.extend_from_slice(field(face).slabs());
    }
    let geometry = LightFieldGeometry::new(*field(Face::PosX).cell(), slabs).unwrap();
    let texels: Vec<SlabTexels> = geometry.slabs().iter().map(|slab| slab_texels(slab, encode8)).collect();
    let light_field = LightField::new(&geometry, &texels).unwrap();
    let json = transforms(&light_field);
    let frames = json["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 6 * 12);
    assert!(json.get("fl_x").is_none(), "pictures of ±X are upright, the others lie down");
    for (i, frame) in frames.iter().enumerate() {
        let pictures = light_field.pictures(i / 12).unwrap();
        let grid = pictures.grid();
        let picture = pictures.picture(i as u32 % 12 % grid[0], i as u32 % 12 / grid[0]).unwrap();
        let number = |key: &str| frame[key].as_f64().unwrap();
        let m = |row: usize, column: usize| frame["transform_matrix"][row][column].as_f64().unwrap();
        assert_eq!((number("w"), number("h")), (picture.width().into(), picture.height().into()));
        assert!((number("camera_angle_x") - 2.0 * (number("w") / 2.0 / number("fl_x")).atan()).abs() < 1e-9);
        for (x, y) in [(0, 0), (picture.width() - 1, 0), (2, picture.height() - 2)] {
            // As OpenGL has it: x right, y up, looking along −z.
            let seen = [
                (f64::from(x) + 0.5 - number("cx")) / number("fl_x"),
                -(f64::from(y) + 0.5 - number("cy")) / number("fl_y"),
                -1.0,
            ];
            let world = [0, 1, 2].map(|row| (0..3).map(|k| m(row, k) * seen[k]).sum::<f64>() as f32);
            let expected = encode8(radiance(Vec3::from(world)));
            let texel = picture.get(x, y);
            assert!(expected[0].abs_diff(texel[0]) <= 1, "frame {i}: {expected:?} {texel:?}");
            assert!((0..13).contains(&(i16::from(texel[1]) - i16::from(expected[1]) + 1)), "{expected:?} {texel:?}");
        }
        // Cameras to the right and above are those that the matrix' own axes lead to.
        if i % 12 + 1 < 12 && !(i as u32 % 12 + 1).is_multiple_of(grid[0]) {
            let step: f64 =
                (0..3).map(|k| (frames[i + 1]["transform_matrix"][k][3].as_f64().unwrap() - m(k, 3)) * m(k, 0)).sum();
            assert!((step - 0.125).abs() < 1e-6, "frame {i}: {step}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Positions with noise of up to a percent of the spacing give the grid that they were made from.
    #[test]
    fn axes_are_fitted(columns in 1u32..5, rows in 1u32..4, dx in 1.0f64..80.0, dy in -80.0f64..-1.0, x in -500.0f64..500.0) {
        let folder = tempfile::tempdir().unwrap();
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let wobble = 0.01 * f64::from((row * 7 + column * 3) % 5) / 5.0 - 0.005;
            let (px, py) = (x + dx * (f64::from(column) + wobble), dy * (f64::from(row) - wobble));
            let name = format!("s_{:02}_{:02}_{py:.6}_{px:.6}.png", 2 * row, 2 * column);
            image::RgbImage::from_pixel(4, 3, image::Rgb([row as u8, column as u8, 0])).save(folder.path().join(name)).unwrap();
        }
        let imported = import_grid(folder.path(), &ImportOptions::default()).unwrap();
        let slab = imported.geometry.slabs()[0];
        prop_assert_eq!(slab.cameras(), [columns, rows]);
        if columns > 1 {
            prop_assert!((f64::from(slab.st()[0].step()) - 1e-3 * dx).abs() < 1.1e-5 * dx);
        }
        if rows > 1 {
            prop_assert!((f64::from(slab.st()[1].step()) + 1e-3 * dy).abs() < 1.1e-5 * -dy);
        }
        let Texels::Srgb8(texels) = &imported.texels else { panic!("not sRGB") };
        for (s, t) in (0..columns).flat_map(|s| (0..rows).map(move |t| (s, t))) {
            // Y points down and falls with the rows, so that row 0 is the lowest.
            prop_assert_eq!(texels.texel([s, t], [0, 0]), Some([t as u8, s as u8, 0, 255]));
        }
    }
}

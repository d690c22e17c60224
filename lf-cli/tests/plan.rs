//! `lfslab plan` and `lfslab import` of its pictures, rendered by a renderer of one line that knows nothing but `plan.json`.

mod schema;

use std::fs;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use glam::{DVec3, Vec2, Vec3};
use lf_compress::PackedLightField;
use lf_format::{FileReader, Limits, TexelEncoding};
use lf_ibr::{Environment, SlabField};
use lf_math::{Ray, linear_from_srgb};
use serde_json::Value;
use tempfile::TempDir;

const CELL: [f64; 4] = [3.0, -2.0, 5.5, 0.5];
const CAMERAS: u32 = 3;
const RESOLUTION: u32 = 12;

fn lfslab(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lfslab")).args(arguments).output().expect("the program starts")
}

#[track_caller]
fn succeeds(arguments: &[&str]) -> String {
    let output = lfslab(arguments);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments:?}: {stderr}");
    stderr
}

/// The error of an import of a folder.
#[track_caller]
fn refused(folder: &Path) -> String {
    let output = lfslab(&["import", &text(folder), "--out", &text(&folder.join("x.lfslab"))]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.starts_with("error: ") && stderr.trim_end().lines().count() == 1, "{stderr}");
    stderr
}

fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

fn plan(folder: &Path, more: &[&str]) -> Value {
    let cell = CELL.map(|x| x.to_string()).join(",");
    let (cameras, resolution, out) = (CAMERAS.to_string(), RESOLUTION.to_string(), text(folder));
    let common = ["plan", "--cell", &cell, "--cameras", &cameras, "--resolution", &resolution, "--out", &out];
    succeeds(&[&common, more].concat());
    serde_json::from_slice(&fs::read(folder.join("plan.json")).unwrap()).unwrap()
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|i| value[i].as_f64().unwrap()))
}

/// What a ray sees, 0 … 1, sRGB-encoded: smooth, without any symmetry, and the same for all points of a line.
fn color(origin: DVec3, direction: DVec3) -> DVec3 {
    let unit = direction.normalize();
    let moment = (origin - DVec3::new(CELL[0], CELL[1], CELL[2])).cross(unit);
    let phase = DVec3::new(
        unit.dot(DVec3::new(1.1, 0.3, -0.7)) + moment.dot(DVec3::new(0.2, 1.0, 0.5)),
        unit.dot(DVec3::new(-0.4, 0.9, 0.5)) + moment.dot(DVec3::new(0.9, -0.3, 0.6)),
        unit.dot(DVec3::new(0.5, -0.6, 0.8)) + moment.dot(DVec3::new(-0.5, 0.4, 1.1)),
    );
    0.5 + 0.4 * DVec3::from_array(phase.to_array().map(f64::sin))
}

/// The picture of a camera, row after row from the top, as the plan's README says: the direction of pixel (i, j).
fn render(plan: &Value, camera: &Value) -> Vec<DVec3> {
    let (image, slab) = (&plan["image"], &plan["slabs"][camera["slab"].as_u64().unwrap() as usize]);
    let slope = |i: u64| image["first_slope"].as_f64().unwrap() + i as f64 * image["slope_step"].as_f64().unwrap();
    let (right, up, forward) = (vector(&slab["right"]), vector(&slab["up"]), vector(&slab["forward"]));
    let (width, height) = (image["width"].as_u64().unwrap(), image["height"].as_u64().unwrap());
    let pixels = (0..height).flat_map(|j| (0..width).map(move |i| (i, j)));
    let origin = vector(&camera["position"]);
    pixels.map(|(i, j)| color(origin, forward + slope(i) * right - slope(j) * up)).collect()
}

fn write_png(path: &Path, pixels: &[DVec3]) {
    let bits = |x: f64| (65535.0 * x).round() as u16;
    let values = pixels.iter().flat_map(|pixel| pixel.to_array().map(bits)).collect();
    image::ImageBuffer::<image::Rgb<u16>, _>::from_vec(RESOLUTION, RESOLUTION, values).unwrap().save(path).unwrap();
}

fn write_exr(path: &Path, pixels: &[DVec3]) {
    let pixel = |x: usize, y: usize| {
        let [r, g, b] = pixels[y * RESOLUTION as usize + x].to_array().map(|x| linear_from_srgb(x as f32));
        (r, g, b)
    };
    exr::prelude::write_rgb_file(path, RESOLUTION as usize, RESOLUTION as usize, pixel).unwrap();
}

/// Renders all pictures, named as POV-Ray names those of `patio.pov`.
fn render_all(folder: &Path, plan: &Value, extension: &str) -> Vec<PathBuf> {
    let render_one = |camera: &Value| {
        let path = folder.join("pictures").join(format!("patio{:02}.{extension}", camera["frame"].as_u64().unwrap()));
        let write = if extension == "png" { write_png } else { write_exr };
        write(&path, &render(plan, camera));
        path
    };
    plan["cameras"].as_array().unwrap().iter().map(render_one).collect()
}

fn open(file: &Path) -> PackedLightField {
    let mut reader = FileReader::open(File::open(file).unwrap(), &Limits::default()).unwrap();
    PackedLightField::read_file(&mut reader).unwrap()
}

fn environment(field: &PackedLightField) -> Box<dyn Environment> {
    let geometry = field.geometry().clone();
    match field.tilings()[0].encoding() {
        TexelEncoding::Rgb16F => Box::new(SlabField::new(geometry, field.decode_linear(1 << 30).unwrap()).unwrap()),
        _ => Box::new(SlabField::new(geometry, field.decode(1 << 30).unwrap()).unwrap()),
    }
}

/// Numbers from 0 on, below `end`; the generator of Knuth's MMIX.
struct Random(u64);

impl Random {
    fn below(&mut self, end: u32) -> u32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) % u64::from(end)) as u32
    }
}

/// Looks up 10⁴ rays through the cell that are stored as texels: each has the colour that its line has in the world of the plan.
fn check_rays(file: &Path, world: ToWorld, tolerance: f64) {
    let field = open(file);
    let (geometry, environment) = (field.geometry(), environment(&field));
    let center = world(geometry.cell().center());
    assert_eq!(center.to_array(), [CELL[0], CELL[1], CELL[2]]);
    let (mut random, mut compared) = (Random(1), 0);
    while compared < 10_000 {
        let slab = random.below(geometry.slabs().len() as u32) as usize;
        let mut pair = |end| Vec2::new(random.below(end) as f32, random.below(end) as f32);
        let (camera, texel) = (pair(CAMERAS), pair(RESOLUTION));
        let ray = geometry.capture_ray(slab, camera, texel);
        let inside = Ray { origin: ray.at(-1e-3), direction: ray.direction };
        // Rays that pass the cell by are not stored, and at 45° several slabs would answer.
        let diagonal = ray.direction.abs().to_array().iter().filter(|&&x| x > 0.999).count() > 1;
        if diagonal || !geometry.cell().contains(inside.origin) {
            continue;
        }
        let found: Vec3 = environment.look_up(&inside).unwrap();
        let expected = color(center + world(ray.origin.as_dvec3()), world(ray.direction.as_dvec3()));
        let error = (found.as_dvec3() - expected).abs().max_element();
        assert!(error < tolerance, "slab {slab} {camera} {texel}: {found} for {expected}");
        compared += 1;
    }
}

/// This project's coordinates in those of another world.
type ToWorld = fn(DVec3) -> DVec3;

/// That of each world, written out by hand.
const WORLDS: [(&str, ToWorld); 3] =
    [("gltf", |p| p), ("povray", |p| DVec3::new(p.x, p.y, -p.z)), ("blender", |p| DVec3::new(p.x, -p.z, p.y))];

#[test]
fn rendered_rays_come_back() {
    for (i, (name, world)) in WORLDS.into_iter().enumerate() {
        for planes in ["faces", "center"] {
            let folder = TempDir::new().unwrap();
            let plan = plan(folder.path(), &["--world", name, "--planes", planes]);
            let extension = ["png", "exr", "png"][i];
            render_all(folder.path(), &plan, extension);
            let out = folder.path().join("out.lfslab");
            let log = succeeds(&["import", &text(folder.path()), "--encoding", "rgba8", "--out", &text(&out)]);
            assert!(!log.contains("no picture"), "{log}");
            // Half a step of 8 bits, of half floats less; and what f32 indices leave of a neighbour.
            check_rays(&out, world, if extension == "png" { 0.6 / 255.0 } else { 5e-4 });
        }
    }
}

#[test]
fn a_plan_is_as_its_schema_says() {
    let Ok(schema) = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec/plan.schema.json")) else {
        eprintln!("NOT TESTED: the crate stands alone, there is no folder spec");
        return;
    };
    let schema = serde_json::from_slice(&schema).unwrap();
    let folder = TempDir::new().unwrap();
    let mut plan = plan(folder.path(), &["--world", "povray"]);
    assert!(schema::conforms(&plan, &schema));
    plan["slabs"][2]["up"][1] = "1".into();
    assert!(!schema::conforms(&plan, &schema));
    // The same cameras in the form of NeRF tools, in a right-handed world.
    let text = fs::read(folder.path().join("transforms.json")).unwrap();
    let transforms: Value = serde_json::from_slice(&text).unwrap();
    let frames = transforms["frames"].as_array().unwrap();
    for (frame, camera) in frames.iter().zip(plan["cameras"].as_array().unwrap()) {
        let column = |i: usize| DVec3::from_array([0, 1, 2].map(|j| frame["transform_matrix"][j][i].as_f64().unwrap()));
        let slab = &plan["slabs"][camera["slab"].as_u64().unwrap() as usize];
        assert_eq!(column(3), WORLDS[1].1(vector(&camera["position"])));
        assert_eq!(column(0), WORLDS[1].1(vector(&slab["right"])));
        assert_eq!(column(2), -WORLDS[1].1(vector(&slab["forward"])));
        assert_eq!(column(0).cross(column(1)), column(2));
    }
    assert_eq!((frames.len(), &frames[8]["file_path"]), (54, &"pictures/lfslab09.png".into()));
}

#[test]
fn cameras_beyond_the_faces_are_warned_of() {
    let folder = TempDir::new().unwrap();
    let planned = |planes: &str| {
        let out = text(folder.path());
        let log = succeeds(&["plan", "--cell", "0,0,0,0.6", "--cameras", "2", "--planes", planes, "--out", &out]);
        (log, fs::read_to_string(folder.path().join("README.md")).unwrap())
    };
    for within in ["faces", "center", "0.3"] {
        let (log, readme) = planned(within);
        assert!(!log.contains("warning") && readme.contains("it is that of the cell's face;"), "{within}: {log}");
    }
    let (log, readme) = planned("0.8");
    assert!(log.contains("warning: the cameras stand 0.5 m outside the cell's faces"), "{log}");
    assert!(readme.contains("up to 0.5 outside") && !readme.contains("it is that of the cell's face;"), "{readme}");
}

#[test]
fn some_faces_only() {
    let folder = TempDir::new().unwrap();
    // Up is +Z in Blender and +Y here.
    let plan = plan(folder.path(), &["--world", "blender", "--faces", "+z,-x"]);
    let faces: Vec<&str> = plan["slabs"].as_array().unwrap().iter().filter_map(|slab| slab["face"].as_str()).collect();
    assert_eq!(faces, ["-X", "+Y"]);
    assert_eq!(plan["cameras"].as_array().unwrap().len(), 18);
    let forward: Vec<DVec3> = plan["slabs"].as_array().unwrap().iter().map(|slab| vector(&slab["forward"])).collect();
    assert_eq!(forward, [DVec3::NEG_X, DVec3::Z]);
    render_all(folder.path(), &plan, "png");
    let out = folder.path().join("out.lfslab");
    succeeds(&["import", &text(folder.path()), "--encoding", "rgba8", "--out", &text(&out)]);
    check_rays(&out, WORLDS[2].1, 0.6 / 255.0);
}

#[test]
fn missing_pictures_are_missing_cameras() {
    let folder = TempDir::new().unwrap();
    let plan = plan(folder.path(), &[]);
    let pictures = render_all(folder.path(), &plan, "png");
    // Two cameras of the first slab, and all of the last.
    let gone = [1, 4].into_iter().chain(45..54);
    gone.for_each(|i| fs::remove_file(&pictures[i]).unwrap());
    // Pictures elsewhere, as a render farm has them.
    let elsewhere = folder.path().join("elsewhere");
    fs::rename(folder.path().join("pictures"), &elsewhere).unwrap();
    let (plan_file, out) = (text(&folder.path().join("plan.json")), folder.path().join("out.lfslab"));
    let depth = ["--focal-plane", "2.5", "--encoding", "rgba8", "--out", &text(&out)];
    let log = succeeds(&[&["import", &text(&elsewhere), "--plan", &plan_file][..], &depth].concat());
    assert!(log.contains("11 of 54 cameras have no picture") && log.contains("slab -Z has no picture"), "{log}");
    succeeds(&["validate", &text(&out)]);
    let field = open(&out);
    assert_eq!(field.geometry().slabs().len(), 5);
    assert!(field.geometry().slabs().iter().all(|slab| slab.focal_depth() == Some(2.5)));
    let coverage = field.tilings()[0].coverage();
    let stored: Vec<bool> = coverage.cameras().map(|camera| coverage.window(camera).is_some()).collect();
    assert_eq!(stored, [true, false, true, true, false, true, true, true, true]);
}

#[test]
fn linear_pictures_become_srgb_if_asked() {
    let folder = TempDir::new().unwrap();
    let plan = plan(folder.path(), &[]);
    render_all(folder.path(), &plan, "exr");
    let out = folder.path().join("out.lfslab");
    let import = ["import", &text(folder.path()), "--out", &text(&out)];
    succeeds(&[&import[..], &["--srgb", "--encoding", "rgba8"]].concat());
    check_rays(&out, WORLDS[0].1, 0.6 / 255.0);
    succeeds(&[&import[..], &["--srgb"]].concat());
    assert_eq!(open(&out).tilings()[0].encoding(), TexelEncoding::Bc1);
    // Two stops are four times the light; 16 leave nothing below white.
    succeeds(&[&import[..], &["--srgb", "--exposure", "16", "--encoding", "rgba8"]].concat());
    assert!(open(&out).decode(1 << 30).unwrap()[0].texels().iter().all(|texel| *texel == [255; 4]));
    let refused = lfslab(&[&import[..], &["--exposure", "1"]].concat());
    assert_eq!(refused.status.code(), Some(2));
    let refused = lfslab(&[&import[..], &["--fov", "90"]].concat());
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--fov is for pictures without a plan"));
}

#[test]
fn pictures_of_another_plan_are_not_taken_over() {
    let folder = TempDir::new().unwrap();
    plan(folder.path(), &[]);
    fs::write(folder.path().join("pictures/lfslab01.png"), "").unwrap();
    plan(folder.path(), &[]);
    let out = text(folder.path());
    let other = lfslab(&["plan", "--cell", "0,0,0,1", "--out", &out]);
    assert!(String::from_utf8_lossy(&other.stderr).contains("pictures of another plan"));
    fs::remove_file(folder.path().join("pictures/lfslab01.png")).unwrap();
    succeeds(&["plan", "--cell", "0,0,0,1", "--out", &out]);
}

#[test]
fn foreign_pictures_are_named() {
    let folder = TempDir::new().unwrap();
    plan(folder.path(), &[]);
    let pictures = folder.path().join("pictures");
    let picture = |name: &str, size: u32| image::RgbImage::new(size, size).save(pictures.join(name)).unwrap();
    assert!(refused(folder.path()).contains("no picture; expected lfslab01.png to lfslab54.png"));
    picture("lfslab01.png", RESOLUTION);
    for (name, size, words) in [
        ("cover.png", RESOLUTION, "does not end in the number of a frame"),
        ("room02.png", RESOLUTION, "does not begin as that of"),
        ("lfslab55.png", RESOLUTION, "no frame 55"),
        ("lfslab0.png", RESOLUTION, "no frame 0"),
        ("lfslab99999999999.png", RESOLUTION, "number of a frame"),
        ("lfslab1.png", RESOLUTION, "is of the same frame"),
        ("lfslab02.png", 13, "13×13 pixels, expected are 12×12"),
        ("lfslab02.exr", 0, "not of the kind"),
        ("lfslab02.png", 0, "cannot read the picture"),
    ] {
        if size > 0 {
            picture(name, size);
        } else {
            fs::write(pictures.join(name), [1; 100]).unwrap();
        }
        let error = refused(folder.path());
        assert!(error.contains(words) && error.contains(name), "{error}");
        fs::remove_file(pictures.join(name)).unwrap();
    }
    fs::write(folder.path().join("plan.json"), "{}").unwrap();
    assert!(refused(folder.path()).contains("plan.json cannot be used: it is no plan"));
}

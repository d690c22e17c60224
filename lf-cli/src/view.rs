//! `lfslab view`: what a scene holds, and how it looks.

use std::ffi::OsStr;
use std::path::Path;

use anyhow::{Result, bail};
use glam::Vec3;
use lf_math::Pinhole;
use lf_scene::{Environment, Estimate, Light, Material, Scattering, Scene, SceneCamera, Surface, view};

use crate::output::{check_writable, megabytes, png, print, progress_bar, write, write_exr_channels};
use crate::pictures::{display, noise};
use crate::scene_args::ViewArgs;
use crate::sources::{Loaded, find_camera};

/// Vertical field of view where no camera of the scene is used, radians (50°).
const FOV_Y: f32 = 0.872_664_6;

pub(crate) fn run(args: &ViewArgs) -> Result<()> {
    if let Some(out) = &args.out {
        check_writable(out)?;
        is_exr(out)?;
    }
    let loaded = Loaded::open(&args.scene, &args.light)?;
    let camera = camera(args, &loaded)?;
    print(&describe(&loaded).join("\n"))?;
    let Some(out) = &args.out else { return Ok(()) };
    let is_exr = is_exr(out)?;
    let tracer = args.light.tracer(loaded.scene);
    let bar = progress_bar(args.size.height.into(), "view", "rows");
    let picture = view(&tracer, &camera, &|done| bar.set_position(done));
    bar.finish_and_clear();
    match noise(picture.texels().iter().map(|estimate| (&estimate.radiance, &estimate.standard_error))) {
        Some(share) => {
            eprintln!("noise    standard error at most {:.2} % of the radiance, mean of all pixels", 100.0 * share);
        }
        None => eprintln!("noise    not known from one sample a pixel"),
    }
    if is_exr {
        let channels = ["R", "G", "B", "error.R", "error.G", "error.B", "Z"];
        return write_exr_channels(out, channels, &picture.map(values));
    }
    write(out, &png(&display(&picture.map(|estimate| estimate.radiance)))?)
}

/// Radiance, its standard error and distance.
fn values(Estimate { radiance: l, standard_error: e, distance, .. }: Estimate) -> [f32; 7] {
    [l.x, l.y, l.z, e.x, e.y, e.z, distance]
}

/// Whether a picture is OpenEXR, else PNG, by its name.
fn is_exr(out: &Path) -> Result<bool> {
    match out.extension().map(OsStr::to_ascii_lowercase) {
        Some(extension) if extension == "exr" => Ok(true),
        Some(extension) if extension == "png" => Ok(false),
        _ => bail!("cannot write {}: the picture's name must end in .png or .exr", out.display()),
    }
}

/// The camera that was asked for; else the scene's first; else one in the cell or the scene's middle, looking along −Z.
fn camera(args: &ViewArgs, loaded: &Loaded) -> Result<Pinhole> {
    let (width, height) = (args.size.width, args.size.height);
    if let (Some(eye), Some(target)) = (args.eye, args.target) {
        return Ok(Pinhole::look_at(eye.0, target.0, FOV_Y, width, height)?);
    }
    if let Some(camera) = find_camera(&loaded.cameras, args.camera.as_deref())? {
        return Ok(camera.pinhole(width, height)?);
    }
    let (min, max) = loaded.scene.bounds();
    let eye = loaded.cell.map_or(0.5 * (min + max), |cell| cell.center().as_vec3());
    Ok(Pinhole::looking(eye, Vec3::NEG_Z, Vec3::Y, FOV_Y, width, height)?)
}

fn describe(loaded: &Loaded) -> Vec<String> {
    let scene = &loaded.scene;
    let (min, max) = scene.bounds();
    let mut lines = vec![
        format!("{}: {} triangles", scene.name().escape_debug(), scene.triangles().len()),
        format!("bounds: {min} to {max} m"),
        format!("materials: {}", materials(scene)),
        format!("lights: {}", lights(scene)),
        format!("environment: {}", environment(&scene.lighting().environment)),
    ];
    lines.extend((0..).zip(&loaded.cameras).map(|(number, camera): (u32, _)| describe_camera(number, camera)));
    lines.push(format!("memory: {}", megabytes(scene.memory_bytes() as u64)));
    // Escaped, so that a file cannot pose as this program or steer the terminal.
    lines.extend(loaded.license.as_ref().map(|license| format!("licence: {}", license.escape_debug())));
    lines
}

fn describe_camera(number: u32, camera: &SceneCamera) -> String {
    let name = camera.name.as_ref().map_or(String::new(), |name| format!(" \"{}\"", name.escape_debug()));
    let fov = camera.fov_y.to_degrees();
    format!("camera {number}{name}: at {:.3} m, looks along {:.3}, {fov:.1}° high", camera.position, camera.forward)
}

fn environment(environment: &Environment) -> String {
    match environment {
        Environment::Sky(zenith) if *zenith == Vec3::ZERO => "none".to_owned(),
        Environment::Sky(zenith) => format!("sky, radiance {zenith} at the zenith"),
        Environment::Map(_) => "panorama".to_owned(),
    }
}

/// How many things there are of each kind; kinds without any are left out.
fn tally(kinds: &[(&str, usize)]) -> String {
    let there: Vec<String> =
        kinds.iter().filter(|(_, count)| *count > 0).map(|(kind, count)| format!("{count} {kind}")).collect();
    if there.is_empty() { "none".to_owned() } else { there.join(", ") }
}

fn lights(scene: &Scene) -> String {
    let count = |is: fn(&Light) -> bool| scene.lighting().lights.iter().filter(|light| is(light)).count();
    let glowing: Vec<bool> = scene.materials().iter().map(glows).collect();
    let triangles = scene.triangles().iter().filter(|(_, material)| glowing[*material as usize]).count();
    tally(&[
        ("point", count(|light| matches!(light, Light::Point { .. }))),
        ("spot", count(|light| matches!(light, Light::Spot { .. }))),
        ("sun", count(|light| matches!(light, Light::Sun { .. }))),
        ("glowing triangles", triangles),
    ])
}

fn materials(scene: &Scene) -> String {
    let count = |is: fn(&Material) -> bool| scene.materials().iter().filter(|material| is(material)).count();
    let textured = |material: &Material| matches!(material.base, Surface::Textured(..));
    tally(&[
        ("diffuse", count(|m| m.scattering == Scattering::Diffuse)),
        ("metallic-roughness", count(|m| matches!(m.scattering, Scattering::MetallicRoughness { .. }))),
        ("mirrors", count(|m| m.scattering == Scattering::Mirror)),
        ("glass", count(|m| matches!(m.scattering, Scattering::Glass { .. }))),
        ("with textures", count(textured)),
        ("with alpha", count(|m| m.alpha_cutoff.is_some())),
        ("glowing", count(glows)),
    ])
}

fn glows(material: &Material) -> bool {
    material.emission != Surface::Uniform(Vec3::ZERO)
}

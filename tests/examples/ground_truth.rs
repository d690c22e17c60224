//! Our side of the comparison with Mitsuba 3: writes a scene, rays through its cell, and what our tracer says of them.
//!
//! `cargo run --release -p lf-tests --example ground_truth -- OUT --scene museum --bounces 1 --samples 1000`, then
//! `python tests/third_party/mitsuba/compare.py OUT`.

#![forbid(unsafe_code)]

use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;
use std::{fs, thread};

use clap::Parser;
use glam::{DVec3, Vec3};
use lf_math::{Cell, GeometryError};
use lf_scene::{
    EMBEDDED, Illumination, ImportOptions, Material, Quality, Scene, SceneBuilder, Tracer, find_free_space,
    import_environment, import_gltf,
};
use lf_tests::mitsuba::{write_floats, write_scene};
use lf_tests::rays_in_cell;
use rayon::prelude::*;
use serde_json::json;

#[derive(Parser)]
struct Arguments {
    /// The folder to write; made if it is not there
    out: PathBuf,
    /// An embedded scene's name, or a glTF file
    #[arg(long, default_value = "museum")]
    scene: String,
    /// Light from a panorama (.hdr, .exr) instead of the file's sun and sky
    #[arg(long)]
    environment: Option<PathBuf>,
    /// Rays, spread at random over the cell
    #[arg(long, default_value_t = 4096)]
    rays: usize,
    /// Paths a ray
    #[arg(long, default_value_t = 256)]
    samples: u32,
    /// Longest path in scatterings: 1 is direct light only
    #[arg(long, default_value_t = 1)]
    bounces: u32,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let (scene, cell) = load(&arguments)?;
    fs::create_dir_all(&arguments.out)?;
    write_scene(&scene, &arguments.out)?;
    let name = scene.name().to_owned();
    let illumination = Illumination::Global { max_bounces: arguments.bounces };
    let triangles = scene.triangles().len();
    let tracer = Tracer::new(scene).with_quality(Quality { illumination, samples: arguments.samples, seed: 1 });
    let cell = cell.map_or_else(|| free_cell(&tracer), Ok)?;
    let rays: Vec<(Vec3, Vec3)> = rays_in_cell(&cell, arguments.rays).collect();
    let distance = |&(o, d): &(Vec3, Vec3)| tracer.distance(o, d).unwrap_or(f32::INFINITY);
    let distances: Vec<f32> = rays.par_iter().map(distance).collect();
    // A million rays, so that starting threads does not count.
    let repeats = (1 << 20) / rays.len().max(1) + 1;
    let start = Instant::now();
    let sum: f32 = (0..repeats).into_par_iter().map(|_| rays.iter().map(distance).sum::<f32>()).sum();
    let hit_seconds = start.elapsed().as_secs_f64() / repeats as f64;
    std::hint::black_box(sum);
    let start = Instant::now();
    let estimates: Vec<_> = rays.par_iter().map(|&(o, d)| tracer.estimate(o, d)).collect();
    let seconds = start.elapsed().as_secs_f64();
    let flat: Vec<f32> = rays.iter().flat_map(|(o, d)| [o.to_array(), d.to_array()].concat()).collect();
    write_floats(&arguments.out.join("rays.f32"), &flat)?;
    let answers = estimates.iter().zip(&distances);
    let answers =
        answers.flat_map(|(e, t)| [e.radiance.to_array().as_slice(), &e.standard_error.to_array(), &[*t]].concat());
    write_floats(&arguments.out.join("ours.f32"), &answers.collect::<Vec<f32>>())?;
    let threads = thread::available_parallelism()?.get();
    let summary = json!({
        "scene": name, "triangles": triangles, "rays": rays.len(), "samples": arguments.samples, "bounces": arguments.bounces,
        "seconds": seconds, "nearest_hit_seconds": hit_seconds, "threads": threads,
    });
    fs::write(arguments.out.join("ours.json"), summary.to_string())?;
    println!("{summary}");
    Ok(())
}

/// The scene and, if it is an embedded one, its cell.
fn load(arguments: &Arguments) -> Result<(Scene, Option<Cell>), Box<dyn Error>> {
    if let Some(embedded) = EMBEDDED.iter().find(|embedded| embedded.name == arguments.scene) {
        return Ok(((embedded.scene)(), Some((embedded.cell)())));
    }
    let environment = arguments.environment.as_ref().map(|path| import_environment(path, 1.0, 0.0)).transpose()?;
    let options = ImportOptions { environment: environment.map(|imported| imported.map), ..ImportOptions::default() };
    let imported = import_gltf(arguments.scene.as_ref(), &options)?;
    for warning in &imported.warnings {
        eprintln!("warning: {warning}");
    }
    Ok((without_holes(&imported.scene)?, None))
}

/// The scene with all its surfaces whole: Mitsuba's path tracer counts a hole as a bounce, and its shadow rays end there.
fn without_holes(scene: &Scene) -> Result<Scene, GeometryError> {
    let mut builder = SceneBuilder::default();
    for material in scene.materials() {
        builder.material(Material { alpha_cutoff: None, ..material.clone() });
    }
    for (corners, material) in scene.triangles() {
        builder.triangle(*corners, *material);
    }
    builder.build(scene.name(), scene.lighting().clone())
}

/// A cell in the room that the scene's middle has.
fn free_cell(tracer: &Tracer) -> Result<Cell, Box<dyn Error>> {
    let (min, max) = tracer.scene().bounds();
    let space = find_free_space(tracer, 0.5 * (min + max), None).ok_or("no free space in the middle of the scene")?;
    Ok(Cell::cube(DVec3::from(space.center), space.radius)?)
}

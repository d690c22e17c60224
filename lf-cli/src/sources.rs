//! Scenes, cells and reflectors from the command line.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use glam::Vec3;
use lf_math::{Cell, TriangleMesh};
use lf_scene::{Scene, Tracer, find_free_space, import_gltf, import_obj, is_free, museum, reflectors};

use crate::args::SceneArgs;

/// The eye's distance from the cell's centre in edge lengths. A cell found in free space leaves room for it.
pub(crate) const EYE_DISTANCE: f32 = 1.6;
/// A reflector's radius in edge lengths of the cell: it stays inside with a little air.
const REFLECTOR_RADIUS: f32 = 0.48;

/// A scene ready to be traced, with its cell.
pub(crate) struct Source {
    pub(crate) tracer: Tracer,
    pub(crate) cell: Cell,
    /// The file's licence line, or our own.
    pub(crate) license: Option<String>,
    /// How long building the tracer's hierarchy took.
    pub(crate) build_time: Duration,
}

impl Source {
    pub(crate) fn load(args: &SceneArgs) -> Result<Self> {
        let (scene, camera, license) = match &args.scene {
            None => (museum::scene(), None, Some("CC0 1.0 (made by this program)".to_owned())),
            Some(path) => import(path)?,
        };
        let start = Instant::now();
        let tracer = Tracer::new(scene);
        let build_time = start.elapsed();
        let cell = match args.cell {
            Some(arg) => Cell::cube(arg.center, arg.size).context("--cell")?,
            None if args.scene.is_none() => museum::cell(),
            None => free_cell(&tracer, camera)?,
        };
        if !is_free(&tracer, &cell) {
            eprintln!("warning: something stands inside the cell; reflections will not show it");
        }
        let (at, size) = (cell.center(), 2.0 * cell.half_extent().x);
        let (name, count) = (tracer.scene().name(), tracer.scene().triangles().len());
        eprintln!("scene    {name}: {count} triangles; cell of {size:.3} m at {:.3}, {:.3}, {:.3}", at.x, at.y, at.z);
        Ok(Self { tracer, cell, license, build_time })
    }

    pub(crate) fn name(&self) -> &str {
        self.tracer.scene().name()
    }
}

/// A scene, where its camera stands and looks, and its licence line.
type ImportedScene = (Scene, Option<(Vec3, Vec3)>, Option<String>);

fn import(path: &Path) -> Result<ImportedScene> {
    let imported = import_gltf(path)?;
    for warning in &imported.warnings {
        eprintln!("warning: {}: {warning}", path.display());
    }
    Ok((imported.scene, imported.camera, imported.copyright))
}

/// The largest cube with room for the eyes around it, near the camera or in the scene's middle.
fn free_cell(tracer: &Tracer, camera: Option<(Vec3, Vec3)>) -> Result<Cell> {
    let (min, max) = tracer.scene().bounds();
    let eye = camera.map_or(0.5 * (min + max), |(eye, _)| eye);
    let space = find_free_space(tracer, eye, camera.map(|(_, forward)| forward));
    let space = space.context("found no free space near the scene's camera; give a cell by --cell x,y,z,size")?;
    Ok(Cell::cube(space.center.as_dvec3(), space.radius / (1.1 * EYE_DISTANCE))?)
}

/// A reflector that this program carries.
pub(crate) fn builtin(name: &str, cell: &Cell) -> Result<(String, TriangleMesh)> {
    let mesh = if name == "sphere" { reflectors::sphere(5) } else { reflectors::teapot(10) };
    fitted(name.to_owned(), &mesh, cell)
}

/// A reflector from an OBJ file, labelled by the file's stem.
pub(crate) fn from_file(path: &Path, cell: &Cell) -> Result<(String, TriangleMesh)> {
    let mesh = import_obj(path)?;
    let stem = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy();
    // Not to be mixed up with the one that is always drawn.
    let label = if stem == "sphere" { "sphere mesh".to_owned() } else { stem.into_owned() };
    fitted(label, &mesh, cell).with_context(|| path.display().to_string())
}

/// A mesh in cell space that stays inside the cell.
fn fitted(label: String, mesh: &TriangleMesh, cell: &Cell) -> Result<(String, TriangleMesh)> {
    let radius = REFLECTOR_RADIUS * 2.0 * cell.half_extent().min_element();
    let mesh = mesh.fitted(Vec3::ZERO, radius).context("the mesh does not fit into the cell")?;
    Ok((label, mesh))
}

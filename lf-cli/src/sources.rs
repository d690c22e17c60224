//! Scenes, cells and reflectors from the command line.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use glam::{Quat, Vec3};
use lf_math::{Cell, Placement, TriangleMesh};
use lf_scene::{
    EMBEDDED, Environment, EnvironmentMap, ImportOptions, Imported, Lighting, Scene, SceneCamera, Tracer,
    find_free_space, import_environment, import_gltf, import_obj, is_free, reflectors,
};

use crate::args::ReflectorArg;
use crate::scene_args::{LightArgs, SceneArgs};

/// The eye's distance from the cell's centre in edge lengths. A cell found in free space leaves room for it.
pub(crate) const EYE_DISTANCE: f32 = 1.6;
/// A reflector's radius in edge lengths of the cell: it stays inside with a little air.
pub(crate) const REFLECTOR_RADIUS: f32 = 0.48;

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
        let Loaded { scene, cameras, license, cell: embedded } = Loaded::open(&args.scene, &args.light)?;
        let camera = find_camera(&cameras, args.camera.as_deref())?;
        let start = Instant::now();
        let tracer = args.light.tracer(scene);
        let build_time = start.elapsed();
        let cell = match (args.cell, embedded) {
            (Some(arg), _) => Cell::cube(arg.center, arg.size).context("--cell")?,
            (None, Some(cell)) => cell,
            (None, None) => free_cell(&tracer, camera)?,
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

/// A scene as it was asked for.
pub(crate) struct Loaded {
    pub(crate) scene: Scene,
    pub(crate) cameras: Vec<SceneCamera>,
    /// The file's licence line, or our own.
    pub(crate) license: Option<String>,
    /// The cell of an embedded scene.
    pub(crate) cell: Option<Cell>,
}

impl Loaded {
    /// An embedded scene by name, else a file. Warnings go to standard error.
    pub(crate) fn open(scene: &str, light: &LightArgs) -> Result<Self> {
        let environment = environment(light)?;
        if let Some(embedded) = EMBEDDED.iter().find(|embedded| embedded.name == scene) {
            let license = Some("CC0 1.0 (made by this program)".to_owned());
            let scene = under((embedded.scene)(), environment);
            return Ok(Self { scene, cameras: vec![], license, cell: Some((embedded.cell)()) });
        }
        let path = Path::new(scene);
        if path.extension().is_none() && !path.exists() {
            let names: Vec<&str> = EMBEDDED.iter().map(|embedded| embedded.name).collect();
            bail!("there is neither a scene nor a file {scene:?}; embedded scenes are {}", names.join(", "));
        }
        let imported = import_gltf(path, &ImportOptions { environment, ..ImportOptions::default() })?;
        warn(path, &imported.warnings);
        let Imported { scene, cameras, copyright, .. } = imported;
        Ok(Self { scene, cameras, license: copyright, cell: None })
    }
}

/// The panorama that was asked for.
fn environment(light: &LightArgs) -> Result<Option<EnvironmentMap>> {
    let Some(path) = &light.environment else { return Ok(None) };
    let imported = import_environment(path, light.environment_scale, light.environment_turn.to_radians())?;
    warn(path, &imported.warnings);
    Ok(Some(imported.map))
}

/// Names in files are kept from steering the terminal.
fn warn(path: &Path, warnings: &[String]) {
    for warning in warnings {
        eprintln!("warning: {}: {}", path.display(), warning.escape_debug());
    }
}

/// An embedded scene in a panorama, whose light takes the place of the ambient term.
fn under(scene: Scene, environment: Option<EnvironmentMap>) -> Scene {
    let Some(map) = environment else { return scene };
    let lighting =
        Lighting { ambient: Vec3::ZERO, environment: Environment::Map(map.into()), ..scene.lighting().clone() };
    scene.with_lighting(lighting)
}

/// The camera of a number or name; without one the first, if there is any.
pub(crate) fn find_camera<'a>(cameras: &'a [SceneCamera], asked: Option<&str>) -> Result<Option<&'a SceneCamera>> {
    let Some(asked) = asked else { return Ok(cameras.first()) };
    let named = || cameras.iter().find(|camera| camera.name.as_deref() == Some(asked));
    let numbered = asked.parse::<usize>().ok().and_then(|number| cameras.get(number));
    let found = numbered.or_else(named);
    if found.is_none() {
        let names = cameras.iter().enumerate().map(|(i, camera)| match &camera.name {
            Some(name) => format!("{i} {name:?}"),
            None => i.to_string(),
        });
        let there = if cameras.is_empty() { "none".to_owned() } else { names.collect::<Vec<_>>().join(", ") };
        bail!("the scene has no camera {asked:?}; it has {there}");
    }
    Ok(found)
}

/// The largest cube with room for the eyes around it, near the camera or in the scene's middle.
fn free_cell(tracer: &Tracer, camera: Option<&SceneCamera>) -> Result<Cell> {
    let (min, max) = tracer.scene().bounds();
    let eye = camera.map_or(0.5 * (min + max), |camera| camera.position);
    let space = find_free_space(tracer, eye, camera.map(|camera| camera.forward));
    let space = space.context("found no free space near the scene's camera; give a cell by --cell x,y,z,size")?;
    Ok(Cell::cube(space.center.as_dvec3(), space.radius / (1.1 * EYE_DISTANCE))?)
}

/// A reflector that this program carries.
pub(crate) fn builtin(name: &str, cell: &Cell) -> Result<(String, TriangleMesh)> {
    let mesh = embedded(name).with_context(|| format!("there is no reflector {name:?}"))?;
    fitted(name.to_owned(), &mesh, cell)
}

/// `sphere` and `teapot`, or `sphere:N` of 20·4ᴺ and `teapot:N` of 64·N² triangles.
fn embedded(name: &str) -> Option<TriangleMesh> {
    let (shape, count) = name.split_once(':').unwrap_or((name, ""));
    let number = |usual: u32, most: u32| {
        let number = if count.is_empty() { Some(usual) } else { count.parse().ok() };
        number.filter(|number| (1..=most).contains(number))
    };
    match shape {
        "sphere" => number(5, 9).map(reflectors::sphere),
        "teapot" => number(10, 256).map(reflectors::teapot),
        _ => None,
    }
}

/// The mesh of a reflector, and where it stands.
pub(crate) fn placed(arg: &ReflectorArg, cell: &Cell) -> Result<(TriangleMesh, Placement)> {
    let (_, mesh) = match embedded(&arg.mesh) {
        Some(mesh) => fitted(arg.mesh.clone(), &mesh, cell)?,
        None => from_file(Path::new(&arg.mesh), cell)?,
    };
    let edge = 2.0 * cell.half_extent().min_element();
    let placement = Placement::new(arg.radius / REFLECTOR_RADIUS, Quat::IDENTITY, arg.place * edge)?;
    Ok((mesh, placement))
}

/// A reflector from an OBJ file, labelled by the file's stem.
pub(crate) fn from_file(path: &Path, cell: &Cell) -> Result<(String, TriangleMesh)> {
    let imported = import_obj(path)?;
    warn(path, &imported.warnings);
    let stem = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy();
    // Not to be mixed up with the one that is always drawn.
    let label = if stem == "sphere" { "sphere mesh".to_owned() } else { stem.into_owned() };
    fitted(label, &imported.mesh, cell).with_context(|| path.display().to_string())
}

/// A mesh in cell space that stays inside the cell.
fn fitted(label: String, mesh: &TriangleMesh, cell: &Cell) -> Result<(String, TriangleMesh)> {
    let radius = REFLECTOR_RADIUS * 2.0 * cell.half_extent().min_element();
    let mesh = mesh.fitted(Vec3::ZERO, radius).context("the mesh does not fit into the cell")?;
    Ok((label, mesh))
}

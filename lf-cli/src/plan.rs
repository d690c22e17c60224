//! `lfslab plan`, and `lfslab import` of a plan's pictures.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use glam::{DVec3, Vec2};
use lf_compress::PackedLightField;
use lf_exchange::{ImportedPlan, Plan, PlanImportOptions, PlanTexels, World, import_plan};
use lf_math::{Cell, Face, LightFieldGeometry};

use crate::exchange::metadata;
use crate::exchange_args::ImportArgs;
use crate::output::{megabytes, print};
use crate::plan_args::PlanArgs;

/// The file in a folder that says what its pictures are.
const PLAN_FILE: &str = "plan.json";

pub(crate) fn run(args: &PlanArgs) -> Result<()> {
    let lfslab_from_world = args.world.world_from_lfslab().transpose();
    let cell = Cell::cube(lfslab_from_world * args.cell.center, args.cell.size).context("--cell")?;
    let geometry = LightFieldGeometry::around(cell, args.planes.0, args.cameras, args.resolution)?;
    let wanted: Vec<Face> = args.faces.iter().filter_map(|&face| in_lfslab(face, args.world)).collect();
    let slabs = geometry.slabs().iter().filter(|slab| wanted.is_empty() || wanted.contains(&slab.face())).copied();
    let plan = Plan::new(args.world, LightFieldGeometry::new(cell, slabs.collect())?)?;
    refuse_other_pictures(&plan, &args.out)?;
    warn_beyond_faces(&plan);
    plan.write(&args.out)?;
    let count = plan.camera_count();
    let [pictures, readme] = [Plan::PICTURES, "README.md"].map(|name| args.out.join(name).display().to_string());
    let (first, last) = (plan.picture_name(1, "png"), plan.picture_name(count, "png"));
    eprintln!(
        "plan     {} slabs, {count} pictures of {res}×{res} pixels",
        plan.geometry().slabs().len(),
        res = args.resolution
    );
    eprintln!("         {first} to {last} (or .exr) go to {pictures}; {readme} says how");
    print(&args.out.display().to_string())
}

/// Pictures of another plan would be taken for this one's, and left out by scripts that go on where they were stopped.
fn refuse_other_pictures(plan: &Plan, folder: &Path) -> Result<()> {
    let (old, pictures) = (folder.join(PLAN_FILE), folder.join(Plan::PICTURES));
    let any = || fs::read_dir(&pictures).is_ok_and(|mut entries| entries.next().is_some());
    if old.is_file() && any() && Plan::read(&old).ok().as_ref() != Some(plan) {
        bail!("{} holds pictures of another plan; remove them or choose another folder", pictures.display());
    }
    Ok(())
}

/// Cameras outside the cell do not see what lies between it and them, which a reflection would show.
fn warn_beyond_faces(plan: &Plan) {
    let beyond = plan.beyond_face();
    if beyond > 0.0 {
        eprintln!(
            "warning: the cameras stand {beyond} m outside the cell's faces; what lies between is missed (--planes faces, or less \
             than half the edge)"
        );
    }
}

/// The face of this project's world that a face of another world is.
fn in_lfslab(face: Face, world: World) -> Option<Face> {
    let outwards: DVec3 = face.vector(Vec2::ZERO, face.sign()).as_dvec3();
    Face::dominant((world.world_from_lfslab().transpose() * outwards).as_vec3())
}

/// The plan that an import goes by, if it does: the one that is given, or one that lies in the folder.
pub(crate) fn plan_file(args: &ImportArgs) -> Option<PathBuf> {
    let in_folder = || Some(args.path.join(PLAN_FILE)).filter(|path| path.is_file());
    args.from_plan.plan.clone().or_else(in_folder)
}

/// Imports the pictures of a plan.
pub(crate) fn import(args: &ImportArgs, plan_file: &Path) -> Result<()> {
    refuse_what_the_plan_says(args)?;
    let plan = Plan::read(plan_file)?;
    let mut options = PlanImportOptions::default();
    options.focal_depth = args.focal_plane.map(|depth| depth as f32);
    options.srgb_exposure = args.from_plan.srgb.then_some(args.from_plan.exposure);
    options.max_bytes = args.max_memory.saturating_mul(1 << 20);
    let imported = import_plan(&plan, &picture_folder(&args.path), &options)?;
    for note in &imported.notes {
        eprintln!("note: {note}");
    }
    let count = plan.camera_count();
    if imported.missing > 0 {
        eprintln!("note: {} of {count} cameras have no picture", imported.missing);
    }
    let slabs: Vec<&str> = imported.geometry.slabs().iter().map(|slab| slab.face().name()).collect();
    eprintln!("import   {} pictures, slabs {}", count - imported.missing, slabs.join(" "));
    let bytes = encode(args, imported)?.save(&args.out, metadata(args)?)?;
    print(&format!("{}: {}", args.out.display(), megabytes(bytes)))
}

/// A plan's own folder has a folder for the pictures.
fn picture_folder(path: &Path) -> PathBuf {
    let inside = path.join(Plan::PICTURES);
    if path.join(PLAN_FILE).is_file() && inside.is_dir() { inside } else { path.to_owned() }
}

fn refuse_what_the_plan_says(args: &ImportArgs) -> Result<()> {
    let given = [
        ("--face", args.face.is_some()),
        ("--fov", args.fov.is_some()),
        ("--focal-length", args.focal_length.is_some()),
        ("--aspect", args.aspect.is_some()),
        ("--spacing", args.spacing.is_some()),
        ("--plane", args.plane.is_some()),
        ("--cell", args.cell.is_some()),
        ("--quilt", args.quilt.is_some()),
        ("--series", args.series.is_some()),
        ("--rows-upwards", args.rows_upwards),
        ("--columns-leftwards", args.columns_leftwards),
    ];
    match given.into_iter().find(|(_, given)| *given) {
        Some((name, _)) => bail!("{name} is for pictures without a plan; the plan says it already"),
        None => Ok(()),
    }
}

fn encode(args: &ImportArgs, imported: ImportedPlan) -> Result<PackedLightField> {
    match &imported.texels {
        PlanTexels::Srgb8(texels) => {
            let (encoding, options) = args.encoding.options();
            Ok(PackedLightField::encode_with(imported.geometry, texels, encoding, &options)?)
        }
        PlanTexels::Linear16(texels) => {
            eprintln!("note: the pictures are linear; they are stored as half floats (--srgb for 8 bits)");
            Ok(PackedLightField::encode_linear(imported.geometry, texels)?)
        }
    }
}

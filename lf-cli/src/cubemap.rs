//! `lfslab cubemap`: what is seen from points of a scene, as pictures with distance.

use std::path::Path;

use anyhow::{Context, Result};
use glam::DVec3;
use lf_math::{Face, Image};
use lf_scene::{Traced, trace_cube};

use crate::capture_args::CubemapArgs;
use crate::output::{print, write_exr_channels};
use crate::sources::Source;

pub(crate) fn run(args: &CubemapArgs) -> Result<()> {
    let source = Source::load(&args.scene)?;
    std::fs::create_dir_all(&args.out).with_context(|| format!("cannot make the folder {}", args.out.display()))?;
    let points: Vec<DVec3> = match args.at.as_slice() {
        [] => vec![source.cell.center()],
        given => given.iter().map(|point| DVec3::from_array(point.0)).collect(),
    };
    for (number, point) in points.iter().enumerate() {
        let faces = trace_cube(&source.tracer, point.as_vec3(), args.size, args.supersample)?;
        for (face, picture) in Face::ALL.into_iter().zip(&faces) {
            write_face(&args.out.join(format!("{number}-{}.exr", file_name(face))), picture)?;
        }
        print(&format!("{}: {number} at {:.3}, {:.3}, {:.3}", args.out.display(), point.x, point.y, point.z))?;
    }
    Ok(())
}

fn file_name(face: Face) -> String {
    face.name().to_lowercase().replace('+', "pos").replace('-', "neg")
}

/// One OpenEXR picture: radiance, and distance as Z.
fn write_face(path: &Path, picture: &Image<Traced>) -> Result<()> {
    let texels = picture.map(|Traced { radiance, distance }| [radiance.x, radiance.y, radiance.z, distance]);
    write_exr_channels(path, ["R", "G", "B", "Z"], &texels)
}

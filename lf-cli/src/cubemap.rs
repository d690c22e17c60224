//! `lfslab cubemap`: what is seen from points of a scene, as pictures with distance.

use std::io::Cursor;
use std::path::Path;

use anyhow::{Context, Result, anyhow};
use exr::prelude::{SpecificChannels, WritableImage};
use glam::DVec3;
use lf_math::{Face, Image};
use lf_scene::{Traced, trace_cube};

use crate::capture_args::CubemapArgs;
use crate::output::{print, write};
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

/// One OpenEXR picture: R, G, B and Z.
fn write_face(path: &Path, picture: &Image<Traced>) -> Result<()> {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let texel = |at: exr::math::Vec2<usize>| {
        let Traced { radiance, distance } = picture.texels()[at.y() * width + at.x()];
        (radiance.x, radiance.y, radiance.z, distance)
    };
    let channels = SpecificChannels::build()
        .with_channel("R")
        .with_channel("G")
        .with_channel("B")
        .with_channel("Z")
        .with_pixel_fn(texel);
    let mut bytes = Cursor::new(Vec::new());
    exr::image::Image::from_channels((width, height), channels)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|e| anyhow!("cannot encode {}: {e}", path.display()))?;
    write(path, bytes.get_ref())
}

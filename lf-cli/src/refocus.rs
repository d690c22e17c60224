//! `lfslab refocus`: focal planes from images.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use lf_compress::PackedLightField;
use lf_format::{Contents, TexelEncoding, Writer};
use lf_ibr::{ImageFocus, Texel, focus_from_images};
use lf_math::{GeometryError, LightFieldGeometry, Slab, SlabTexels};

use crate::input::{Input, MAX_DECODED_BYTES, open};
use crate::output::{check_distinct, check_writable, megabytes, print};
use crate::refocus_args::{DisparityArg, RefocusArgs};

pub(crate) fn run(args: &RefocusArgs) -> Result<()> {
    if let Some(out) = &args.out {
        check_writable(out)?;
        check_distinct(&[("the light field".to_owned(), &args.input.file), ("--out".to_owned(), out)])?;
    }
    let mut input = open(&args.input)?;
    let slabs = match args.disparity {
        DisparityArg::Auto => found(&PackedLightField::read_file(&mut input)?),
        DisparityArg::Texels(texels) => {
            let slabs = input.geometry().slabs().iter();
            Ok(slabs.map(|slab| slab.with_focal_depth(depth_at(slab, texels))).collect::<Result<_, _>>()?)
        }
    };
    let slabs = slabs.with_context(|| args.input.file.display().to_string())?;
    for slab in &slabs {
        eprintln!("refocus  {}", plane(slab));
    }
    match &args.out {
        Some(out) => copy(&mut input, slabs, out),
        None => Ok(()),
    }
}

/// The slabs with the focal planes that their images ask for.
fn found(field: &PackedLightField) -> Result<Vec<Slab>> {
    let slabs = field.geometry().slabs();
    Ok(if is_linear(field) {
        focused(slabs, &field.decode_linear(MAX_DECODED_BYTES)?)?
    } else {
        focused(slabs, &field.decode(MAX_DECODED_BYTES)?)?
    })
}

pub(crate) fn is_linear(field: &PackedLightField) -> bool {
    field.tilings().iter().all(|tiling| tiling.encoding() == TexelEncoding::Rgb16F)
}

fn focused<T: Texel>(slabs: &[Slab], texels: &[SlabTexels<T>]) -> Result<Vec<Slab>, GeometryError> {
    let focus = |(slab, texels): (&Slab, &SlabTexels<T>)| {
        let (start, name) = (Instant::now(), slab.face().name());
        let Some(found) = focus_from_images(slab, texels) else {
            eprintln!("note: {name}: no camera stands between two others; its focal plane stays");
            return Ok(*slab);
        };
        eprintln!("         {name}: {}, found in {:.1} s", told(slab, &found), start.elapsed().as_secs_f64());
        slab.with_focal_depth(found.focal_depth())
    };
    slabs.iter().zip(texels).map(focus).collect()
}

/// What was found, and what to do if the format cannot say it.
pub(crate) fn told(slab: &Slab, found: &ImageFocus) -> String {
    let texels = slab.disparity_at(found.best.inverse_depth);
    let psnr = |mse: f64| 10.0 * (255.0 * 255.0 / mse).log10();
    let behind = match found.best.inverse_depth {
        behind if behind < 0.0 => format!(
            "; that is beyond infinity, as of rectified pictures, to be imported with a --focal-plane nearer than {:.4} m",
            -behind.recip()
        ),
        _ => String::new(),
    };
    format!(
        "left-out cameras are predicted best where planes move {:.2} by {:.2} texels a camera, at {:.2} dB, and at {:.2} dB without \
         a focal plane{behind}",
        texels.x,
        texels.y,
        psnr(found.best.mse),
        psnr(found.infinity.mse)
    )
}

/// The depth of the plane that moves so many texels a camera, along the axis where it moves more; infinity for 0.
fn depth_at(slab: &Slab, texels: f32) -> Option<f32> {
    (texels > 0.0).then(|| slab.disparity_at(1.0).max_element() / texels)
}

fn plane(slab: &Slab) -> String {
    let depth = slab.focal_depth().map_or("infinity".to_owned(), |depth| format!("{depth:.4} m"));
    let disparity = slab.disparity();
    format!("{}: focal plane at {depth}, {:.2} by {:.2} texels a camera", slab.face().name(), disparity.x, disparity.y)
}

/// The same file with other focal planes: tiles are copied as they are stored.
fn copy(input: &mut Input, slabs: Vec<Slab>, out: &Path) -> Result<()> {
    let geometry = LightFieldGeometry::new(*input.geometry().cell(), slabs)?;
    if input
        .tilings()
        .iter()
        .any(|tiling| !tiling.coverage().columns().is_whole() || !tiling.coverage().rows().is_whole())
    {
        eprintln!(
            "note: the images were cropped for the old focal planes; rays that now ask for more get the nearest texel"
        );
    }
    let mut contents = Contents::new(geometry, input.tilings().to_vec(), input.metadata().clone());
    contents.extra = input.copyable_chunks()?;
    let mut writer = Writer::create(out, contents)?;
    let mut buffer = Vec::new();
    while let Some((slab, tile)) = writer.next_tile() {
        let stored = input.tile(slab, tile, &mut buffer)?;
        writer.tile(stored.packing, stored.bytes)?;
    }
    let bytes = writer.save()?;
    print(&format!("{}: {}", out.display(), megabytes(bytes)))
}

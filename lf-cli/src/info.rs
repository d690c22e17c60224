//! `lfslab info` and `lfslab validate`.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use anyhow::{Context, Result, bail};
use lf_compress::PackedLightField;
use lf_format::{Container, Limits};
use lf_math::{SampledAxis, Slab};

use crate::capture::megabytes;

/// The bytes of a file, refused before reading if larger than the limits allow.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>> {
    let context = || format!("cannot read {}", path.display());
    let file = File::open(path).with_context(context)?;
    let limit = Limits::default().max_file_bytes;
    let mut bytes = Vec::new();
    // One byte more than allowed tells a file that is too large, also where its length is not known beforehand.
    file.take(limit.saturating_add(1)).read_to_end(&mut bytes).with_context(context)?;
    if bytes.len() as u64 > limit {
        bail!("{} is larger than {limit} bytes", path.display());
    }
    Ok(bytes)
}

/// Reads and unpacks a light field.
pub(crate) fn load(path: &Path) -> Result<PackedLightField> {
    let bytes = read_file(path)?;
    let container = Container::parse(&bytes, &Limits::default()).with_context(|| path.display().to_string())?;
    PackedLightField::read(&container).with_context(|| path.display().to_string())
}

/// Checks header, directory, checksums, geometry and every tile's packed bytes.
pub(crate) fn validate(path: &Path) -> Result<()> {
    let field = load(path)?;
    let tiles: usize = (0..field.tilings().len()).map(|slab| field.tiles(slab).len()).sum();
    println!("{}: valid ({} slabs, {tiles} tiles)", path.display(), field.tilings().len());
    Ok(())
}

/// Prints the structure of a file.
pub(crate) fn info(path: &Path) -> Result<()> {
    let bytes = read_file(path)?;
    let container = Container::parse(&bytes, &Limits::default()).with_context(|| path.display().to_string())?;
    let (major, minor) = container.version();
    println!("{}: lfslab {major}.{minor}, {}", path.display(), megabytes(bytes.len() as u64));
    for (key, value) in container.metadata().iter() {
        println!("{key}: {value}");
    }
    let cell = container.geometry().cell();
    println!("cell: centre {} m, edges {} m", cell.center(), 2.0 * cell.half_extent());
    for (number, (slab, tiling)) in container.geometry().slabs().iter().zip(container.tilings()).enumerate() {
        let chunks =
            || container.chunks().filter(|chunk| chunk.slab as usize == number && chunk.tag == lf_format::Tag::TILE);
        let stored: u64 = chunks().map(|chunk| chunk.stored_len).sum();
        let raw: u64 = chunks().map(|chunk| chunk.raw_len).sum();
        println!("slab {number}: {}", describe(slab));
        let ([gs, gt], tiles) = (tiling.cameras_per_tile(), tiling.tile_count());
        let share = 100.0 * stored as f64 / raw as f64;
        println!(
            "  {:?}, {tiles} tiles of {gs}×{gt} cameras, {stored} bytes packed of {raw} ({share:.1} %)",
            tiling.encoding()
        );
    }
    Ok(())
}

fn describe(slab: &Slab) -> String {
    let range =
        |[a, b]: [SampledAxis; 2]| format!("{:.4} … {:.4} × {:.4} … {:.4}", a.first(), a.last(), b.first(), b.last());
    let ([cameras_s, cameras_t], [width, height]) = (slab.cameras(), slab.resolution());
    let focus = slab.focal_depth().map_or("infinity".to_owned(), |depth| format!("{depth:.4} m"));
    format!(
        "{}, plane at {:.4} m, {cameras_s}×{cameras_t} cameras over {} m, {width}×{height} texels over slopes {}, focus {focus}",
        slab.face().name(),
        slab.plane(),
        range(slab.st()),
        range(slab.uv()),
    )
}

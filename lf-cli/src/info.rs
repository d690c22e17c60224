//! `lfslab info` and `lfslab validate`.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use anyhow::{Context, Result, bail};
use lf_compress::PackedLightField;
use lf_format::{Container, Limits};
use lf_math::{SampledAxis, Slab};

use crate::output::{megabytes, print};

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
    print(&format!("{}: valid ({} slabs, {tiles} tiles)", path.display(), field.tilings().len()))
}

/// Prints the structure of a file.
pub(crate) fn info(path: &Path) -> Result<()> {
    let bytes = read_file(path)?;
    let container = Container::parse(&bytes, &Limits::default()).with_context(|| path.display().to_string())?;
    let (major, minor) = container.version();
    let mut lines = vec![format!("{}: lfslab {major}.{minor}, {}", path.display(), megabytes(bytes.len() as u64))];
    // Escaped, so that a file cannot pose as this program or steer the terminal.
    lines.extend(container.metadata().iter().map(|(key, value)| format!("{key}: {}", value.escape_debug())));
    let cell = container.geometry().cell();
    lines.push(format!("cell: centre {} m, edges {} m", cell.center(), 2.0 * cell.half_extent()));
    for (number, slab) in container.geometry().slabs().iter().enumerate() {
        lines.push(format!("slab {number}: {}", describe(slab)));
        lines.push(storage(&container, number));
    }
    print(&lines.join("\n"))
}

/// How a slab is stored.
fn storage(container: &Container<'_>, slab: usize) -> String {
    let tiling = container.tilings()[slab];
    let ([per_s, per_t], count) = (tiling.cameras_per_tile(), tiling.tile_count());
    let tiles = (0..count).filter_map(|tile| container.tile(slab, tile));
    let (stored, raw) =
        tiles.fold((0, 0), |(stored, raw), tile| (stored + tile.bytes.len() as u64, raw + tile.raw_len));
    let share = 100.0 * stored as f64 / raw as f64;
    let encoding = format!("{:?}", tiling.encoding()).to_uppercase();
    format!("  {encoding}, {count} tiles of {per_s}×{per_t} cameras, {stored} of {raw} bytes ({share:.1} %)")
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

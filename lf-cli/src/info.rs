//! `lfslab info`: what a file holds.

use std::collections::BTreeMap;

use anyhow::Result;
use lf_format::{ChunkEntry, SlabTiling, Structure, Tag};
use lf_math::{SampledAxis, Slab};
use serde_json::{Value, json};

use crate::args::InfoArgs;
use crate::input::open;
use crate::output::{megabytes, print};

pub(crate) fn run(args: &InfoArgs) -> Result<()> {
    let file = open(&args.input)?;
    if args.json {
        return print(&format!("{:#}", to_json(&file)));
    }
    let (major, minor) = file.version();
    let path = args.input.file.display();
    let mut lines = vec![format!("{path}: lfslab {major}.{minor}, {}", megabytes(file.file_len()))];
    // Escaped, so that a file cannot pose as this program or steer the terminal.
    lines.extend(file.metadata().iter().map(|(key, value)| format!("{key}: {}", value.escape_debug())));
    let cell = file.geometry().cell();
    lines.push(format!("cell: centre {} m, edges {} m", cell.center(), 2.0 * cell.half_extent()));
    for (number, slab) in file.geometry().slabs().iter().enumerate() {
        lines.push(format!("slab {number}: {}", describe(slab)));
        lines.push(storage(&file, number));
    }
    let unknown = file.chunks().iter().filter(|entry| !entry.tag.is_known());
    lines.extend(unknown.map(|entry| format!("{entry}: not known, {} bytes", entry.stored_len)));
    print(&lines.join("\n"))
}

fn tiles_of(file: &Structure, slab: usize) -> impl Iterator<Item = &ChunkEntry> {
    file.chunks().iter().filter(move |entry| entry.tag == Tag::TILE && entry.slab as usize == slab)
}

/// Share of a slab's texels that is stored, percent.
fn stored_share(tiling: &SlabTiling) -> f64 {
    let all: f64 = tiling.cameras().into_iter().chain(tiling.resolution()).map(f64::from).product();
    100.0 * tiling.coverage().texels() as f64 / all
}

/// How a slab is stored.
fn storage(file: &Structure, slab: usize) -> String {
    let tiling = &file.tilings()[slab];
    let [per_s, per_t] = tiling.cameras_per_tile();
    let (mut stored, mut raw, mut packings) = (0, 0, BTreeMap::new());
    for entry in tiles_of(file, slab) {
        stored += entry.stored_len;
        raw += entry.raw_len;
        *packings.entry(format!("{:?}", entry.packing).to_lowercase()).or_insert(0) += 1;
    }
    let packings: Vec<String> = packings.into_iter().map(|(packing, tiles)| format!("{tiles} {packing}")).collect();
    let kept = stored_share(tiling);
    let encoding = format!("{:?}", tiling.encoding()).to_uppercase();
    let share = 100.0 * stored as f64 / raw as f64;
    let cut = if kept < 100.0 { format!("{kept:.1} % of the texels, ") } else { String::new() };
    format!(
        "  {encoding}, {cut}tiles of {per_s}×{per_t} cameras ({}), {stored} of {raw} bytes ({share:.1} %)",
        packings.join(", ")
    )
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

/// The structure, but for checksums.
fn to_json(file: &Structure) -> Value {
    let cell = file.geometry().cell();
    let slabs: Vec<Value> = (0..file.tilings().len()).map(|slab| slab_json(file, slab)).collect();
    let metadata: BTreeMap<&str, &str> = file.metadata().iter().collect();
    let chunk = |entry: &ChunkEntry| {
        json!({
            "tag": entry.tag.to_string(),
            "critical": entry.critical,
            "safe_to_copy": entry.safe_to_copy,
            "packing": format!("{:?}", entry.packing).to_lowercase(),
            "slab": entry.slab,
            "tile": entry.tile,
            "offset": entry.offset,
            "stored_bytes": entry.stored_len,
            "raw_bytes": entry.raw_len,
        })
    };
    json!({
        "version": format!("{}.{}", file.version().0, file.version().1),
        "file_bytes": file.file_len(),
        "metadata": metadata,
        "cell": { "center_m": cell.center().to_array(), "half_extent_m": cell.half_extent().to_array() },
        "slabs": slabs,
        "chunks": file.chunks().iter().map(chunk).collect::<Vec<_>>(),
    })
}

fn slab_json(file: &Structure, number: usize) -> Value {
    let (slab, tiling) = (&file.geometry().slabs()[number], &file.tilings()[number]);
    let axis = |axis: SampledAxis| json!({ "first": axis.first(), "step": axis.step(), "count": axis.count() });
    let ([s, t], [u, v]) = (slab.st().map(axis), slab.uv().map(axis));
    json!({
        "face": slab.face().name(),
        "plane_m": slab.plane(),
        "s": s,
        "t": t,
        "u": u,
        "v": v,
        "focal_depth_m": slab.focal_depth(),
        "encoding": format!("{:?}", tiling.encoding()).to_uppercase(),
        "cameras_per_tile": tiling.cameras_per_tile(),
        "tiles": tiling.tiles(),
        "stored_percent": stored_share(tiling),
    })
}

//! `lfslab capture`: scene in, file out.

use std::time::{Duration, Instant};

use anyhow::{Result, bail};
use lf_compress::{PackOptions, PackedLightField};
use lf_format::{Metadata, TexelEncoding};
use lf_math::{Coverage, Image, LightFieldGeometry, PlanePlacement, SlabTexels};
use lf_scene::{Capture, capture_slabs};

use crate::args::{CaptureArgs, Planes, Sampling};
use crate::output::{check_writable, megabytes, print, progress_bar};
use crate::sources::Source;

/// Edge of the blocks that windows are rounded out to, texels.
const BLOCK: u32 = 4;

pub(crate) fn run(args: &CaptureArgs) -> Result<()> {
    check_writable(&args.out)?;
    let source = Source::load(&args.scene)?;
    let preset = args.scene.preset.sampling();
    let placement = match args.planes {
        None => preset.placement,
        Some(Planes::Faces) => PlanePlacement::CellFaces,
        Some(Planes::Center) => PlanePlacement::CellCenter,
    };
    let cameras = args.cameras.unwrap_or(preset.cameras);
    let resolution = args.resolution.unwrap_or(preset.resolution);
    let (mut captured, _) = capture(&source, &Sampling { cameras, resolution, placement, grid: preset.grid })?;
    if !args.whole {
        crop(&mut captured)?;
    }
    let (encoding, options) = args.encoding.options();
    let packed = encode(&captured, encoding, &options)?.0;
    let bytes = packed.save(&args.out, metadata(&source)?)?;
    print(&format!("{}: {}", args.out.display(), megabytes(bytes)))
}

/// Captures the slabs with a progress bar; also how long it took.
pub(crate) fn capture(source: &Source, sampling: &Sampling) -> Result<(Capture, Duration)> {
    let &Sampling { cameras, resolution, placement, grid } = sampling;
    let geometry = LightFieldGeometry::around(source.cell, placement, cameras, resolution)?;
    let images = u64::from(cameras).pow(2) * geometry.slabs().len() as u64;
    let bytes = 4 * images * u64::from(resolution).pow(2);
    if bytes > MAX_DECODED_BYTES {
        bail!(
            "{} of texels are more than the {} this program holds in memory",
            megabytes(bytes),
            megabytes(MAX_DECODED_BYTES)
        );
    }
    eprintln!(
        "capture  6 slabs of {cameras}×{cameras} cameras × {resolution}×{resolution} texels, {grid}×{grid} rays each"
    );
    let bar = progress_bar(images, "capture", "camera images");
    let start = Instant::now();
    let captured = capture_slabs(&source.tracer, &geometry, grid, &|done| bar.set_position(done))?;
    bar.finish_and_clear();
    let elapsed = start.elapsed();
    let rate = captured.rays as f64 / elapsed.as_secs_f64() / 1e6;
    eprintln!(
        "         {:.1} s, {:.1} million rays, {rate:.2} million a second",
        elapsed.as_secs_f64(),
        captured.rays as f64 / 1e6
    );
    Ok((captured, elapsed))
}

/// Leaves out the texels that no ray through the cell asks for.
pub(crate) fn crop(capture: &mut Capture) -> Result<()> {
    let count = |capture: &Capture| capture.texels.iter().map(|slab| slab.texels().len() as f64).sum::<f64>();
    let all = count(capture);
    for (slab, texels) in capture.geometry.slabs().iter().zip(&mut capture.texels) {
        let needed = Coverage::of_cell(slab, capture.geometry.cell()).aligned(BLOCK);
        if !needed.is_whole() {
            *texels = texels.crop(needed)?;
        }
    }
    eprintln!("crop     {:.1} % of the texels are needed", 100.0 * count(capture) / all);
    Ok(())
}

/// Encodes a capture and says what it cost; also the encoding time and the PSNR of the stored texels.
pub(crate) fn encode(
    capture: &Capture,
    encoding: TexelEncoding,
    options: &PackOptions,
) -> Result<(PackedLightField, Duration, f64)> {
    let start = Instant::now();
    let packed = PackedLightField::encode_with(capture.geometry.clone(), &capture.texels, encoding, options)?;
    let elapsed = start.elapsed();
    let psnr = stored_psnr(capture, &packed)?;
    let quality = if psnr.is_finite() { format!("{psnr:.2} dB") } else { "lossless".to_owned() };
    eprintln!("encode   {:.1} s, {quality}", elapsed.as_secs_f64());
    Ok((packed, elapsed, psnr))
}

/// Decoded texels may take this much memory.
pub(crate) const MAX_DECODED_BYTES: u64 = 8 << 30;

/// PSNR of all decoded texels against the captured ones.
fn stored_psnr(capture: &Capture, packed: &PackedLightField) -> Result<f64> {
    let (mut squares, mut values) = (0.0, 0.0);
    for (before, after) in capture.texels.iter().zip(packed.decode(MAX_DECODED_BYTES)?) {
        let (before, after) = (row(before)?, row(&after)?);
        let all = Image::filled(before.width(), 1, true);
        let error = lf_math::image_error(&before, &after, &all)?;
        squares += error.mse * error.pixels as f64;
        values += error.pixels as f64;
    }
    Ok(10.0 * (255.0 * 255.0 * values / squares).log10())
}

/// All texels of a slab as a picture of one row.
fn row(texels: &SlabTexels) -> Result<Image<[u8; 4]>> {
    Ok(Image::new(u32::try_from(texels.texels().len())?, 1, texels.texels().to_vec())?)
}

/// Who made the file from what.
pub(crate) fn metadata(source: &Source) -> Result<Metadata> {
    let mut metadata = Metadata::new();
    metadata.insert("generator", concat!("lfslab ", env!("CARGO_PKG_VERSION")))?;
    metadata.insert("scene", source.name())?;
    if let Some(license) = &source.license {
        // A line of a file that we did not write: kept short and without control characters, whatever it holds.
        let line: String = license.chars().filter(|c| !c.is_control()).take(1000).collect();
        metadata.insert("license", line)?;
    }
    Ok(metadata)
}

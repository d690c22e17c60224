//! Files, lines and progress.

use std::io::{Cursor, ErrorKind, Write, stdout};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use glam::Vec3;
use image::ImageEncoder;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use indicatif::{ProgressBar, ProgressStyle};
use lf_format::write_atomic;
use lf_math::Image;

/// Of 100: no blocks are seen, at a sixth of a PNG's bytes.
const JPEG_QUALITY: u8 = 88;

/// Prints lines to standard output. A reader that has gone away is no error.
pub(crate) fn print(lines: &str) -> Result<()> {
    let mut out = stdout().lock();
    match writeln!(out, "{lines}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error).context("cannot write to standard output"),
        _ => Ok(()),
    }
}

/// Refuses an output path before long work: its folder must exist and it must not be a folder.
pub(crate) fn check_writable(path: &Path) -> Result<()> {
    let folder = folder_of(path);
    if !folder.is_dir() {
        bail!("cannot write {}: the folder {} does not exist", path.display(), folder.display());
    }
    if path.is_dir() {
        bail!("cannot write {}: it is a folder", path.display());
    }
    Ok(())
}

/// Refuses to use one file for two purposes, each given by its name and path, however the path is spelled.
pub(crate) fn check_distinct(files: &[(String, &Path)]) -> Result<()> {
    let found: Vec<PathBuf> = files.iter().map(|(_, path)| canonical(path)).collect();
    for (i, (name, path)) in files.iter().enumerate() {
        if let Some(other) = found[..i].iter().position(|other| *other == found[i]) {
            let (first, path) = (&files[other].0, path.display());
            bail!("{path} is there twice, as {first} and as {name}: each must be a file of its own");
        }
    }
    Ok(())
}

/// The one spelling of a path, of a file that may not be there yet.
fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| {
        let folder = folder_of(path);
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        folder.join(path.file_name().unwrap_or_default())
    })
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

/// Writes a file whole or not at all.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    write_atomic(path, |file| file.write_all(bytes)).with_context(|| format!("cannot write {}", path.display()))
}

/// An 8-bit RGBA picture as the bytes of a PNG file.
pub(crate) fn png(picture: &Image<[u8; 4]>) -> Result<Vec<u8>> {
    // Opaque pictures are smaller without their alpha.
    let rgb: Vec<u8> = picture.texels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    let mut bytes = Vec::new();
    let color = image::ExtendedColorType::Rgb8;
    PngEncoder::new(&mut bytes).write_image(&rgb, picture.width(), picture.height(), color)?;
    Ok(bytes)
}

/// An 8-bit RGBA picture as the bytes of a JPEG file.
pub(crate) fn jpeg(picture: &Image<[u8; 4]>) -> Result<Vec<u8>> {
    let rgb: Vec<u8> = picture.texels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    let mut bytes = Vec::new();
    let color = image::ExtendedColorType::Rgb8;
    JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY).write_image(
        &rgb,
        picture.width(),
        picture.height(),
        color,
    )?;
    Ok(bytes)
}

/// Writes a linear picture as OpenEXR, 32-bit float RGB.
pub(crate) fn write_exr(path: &Path, picture: &Image<Vec3>) -> Result<()> {
    write_exr_channels(path, ["R", "G", "B"], &picture.map(|color| color.to_array()))
}

/// Writes a picture of named channels as OpenEXR, 32-bit floats.
pub(crate) fn write_exr_channels<const N: usize>(
    path: &Path,
    names: [&str; N],
    picture: &Image<[f32; N]>,
) -> Result<()> {
    use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, WritableImage};
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let samples = |i: usize| FlatSamples::F32(picture.texels().iter().map(|texel| texel[i]).collect());
    let channels = AnyChannels::sort((0..N).map(|i| AnyChannel::new(names[i], samples(i))).collect());
    let mut bytes = Cursor::new(Vec::new());
    exr::image::Image::from_channels((width, height), channels)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|e| anyhow!("cannot encode {}: {e}", path.display()))?;
    write(path, bytes.get_ref())
}

/// A bar on the terminal with rate and time left; nothing where standard error is no terminal.
pub(crate) fn progress_bar(length: u64, what: &str, unit: &str) -> ProgressBar {
    let template = format!("{{msg:8}} {{wide_bar}} {{pos}}/{{len}} {unit}, {{per_sec}}, {{eta}} left");
    let style = ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style).with_message(what.to_owned())
}

/// A size in MiB for people.
pub(crate) fn megabytes(bytes: u64) -> String {
    format!("{:.2} MiB ({bytes} bytes)", bytes as f64 / f64::from(1 << 20))
}

//! Environments from Radiance (`.hdr`) and OpenEXR (`.exr`) panoramas in equirectangular projection.

use std::io::Cursor;
use std::path::Path;

use exr::meta::MetaData;
use exr::meta::attribute::Chromaticities;
use exr::prelude::{ReadChannels, ReadLayers, read};
use glam::Vec3;
use image::codecs::hdr::{HdrDecoder, HdrMetadata};
use image::{DynamicImage, ImageDecoder};
use lf_math::Image;

use super::MEMORY_BYTES;
use super::budget::Budget;
use super::notes::Notes;
use crate::light::MAX_RADIANCE;
use crate::{EnvironmentMap, ImportError, SceneError};

/// An environment from a file.
#[derive(Debug)]
pub struct ImportedEnvironment {
    /// The panorama.
    pub map: EnvironmentMap,
    /// What had to be changed: one sentence each, with a count.
    pub warnings: Vec<String>,
}

/// The largest half-float stands for infinity.
const BRIGHTEST: f32 = 65504.0;

/// Reads a panorama. Its values, times `scale`, are radiance in W/(m²·sr), linear Rec. 709; `turn` radians turn it about +Y, as
/// [`EnvironmentMap`] says.
///
/// Negative values and NaN are taken for 0, infinity for 65 504, and radiance above 10⁹ for 10⁹; the warnings count them.
/// Radiance's `EXPOSURE` and `COLORCORR` are undone. Other primaries than Rec. 709's are
/// not converted; the warnings name those of an OpenEXR file.
///
/// # Errors
/// [`SceneError::Import`] if the file is neither Radiance nor OpenEXR, is broken, or needs more than 4 GiB of memory, or if
/// the scale is negative, or scale or turn are not finite.
pub fn import_environment(path: &Path, scale: f32, turn: f32) -> Result<ImportedEnvironment, SceneError> {
    import(path, scale, turn).map_err(|source| SceneError::Import { path: path.to_owned(), source })
}

fn import(path: &Path, scale: f32, turn: f32) -> Result<ImportedEnvironment, ImportError> {
    if !(scale.is_finite() && scale >= 0.0) {
        return Err(ImportError::malformed("scale of the environment", format!("{scale} is not a number from 0 on")));
    }
    let mut budget = Budget::new(MEMORY_BYTES);
    let bytes = budget.read(path)?;
    let mut notes = Notes::default();
    let mut radiance = decode(&bytes, &mut budget, &mut notes)?;
    for texel in radiance.texels_mut() {
        *texel = Vec3::from(texel.to_array().map(|value| capped(mended(value, &mut notes) * scale, &mut notes)));
    }
    Ok(ImportedEnvironment { map: EnvironmentMap::new(radiance, turn)?, warnings: notes.into_warnings() })
}

fn mended(value: f32, notes: &mut Notes) -> f32 {
    if value.is_nan() || value < 0.0 {
        notes.add("values of the environment are negative or not numbers and taken for 0");
        0.0
    } else if value.is_infinite() {
        notes.add("values of the environment are infinite and taken for 65504");
        BRIGHTEST
    } else {
        value
    }
}

fn capped(radiance: f32, notes: &mut Notes) -> f32 {
    let bright = radiance > MAX_RADIANCE;
    notes.count("values of the environment are too bright to calculate with and taken for 1e9", usize::from(bright));
    radiance.min(MAX_RADIANCE)
}

/// Tells the format by the first bytes, whatever the file is called.
fn decode(bytes: &[u8], budget: &mut Budget, notes: &mut Notes) -> Result<Image<Vec3>, ImportError> {
    match bytes {
        [b'#', b'?', ..] => radiance(bytes, budget, notes),
        [0x76, 0x2f, 0x31, 0x01, ..] => open_exr(bytes, budget, notes),
        _ => Err(ImportError::malformed("environment", "it is neither a Radiance nor an OpenEXR picture")),
    }
}

fn radiance(bytes: &[u8], budget: &mut Budget, notes: &mut Notes) -> Result<Image<Vec3>, ImportError> {
    let broken = |error| ImportError::malformed("Radiance picture", error);
    let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let exposure = exposure(&decoder.metadata(), notes);
    // As decoded, and as an image.
    budget.take("the texels of the environment", u64::from(width) * u64::from(height), 24)?;
    let picture = DynamicImage::from_decoder(decoder).map_err(broken)?.into_rgb32f();
    let (texels, _) = picture.as_chunks::<3>();
    // What overflows is too bright, not infinite.
    let texel = |stored: &[f32; 3]| (Vec3::from(*stored) / exposure).min(Vec3::MAX);
    Ok(Image::new(width, height, texels.iter().map(texel).collect())?)
}

/// What stored values are divided by to give radiance: the products of the header's `EXPOSURE` and `COLORCORR`.
fn exposure(header: &HdrMetadata, notes: &mut Notes) -> Vec3 {
    let exposure = Vec3::from(header.color_correction.unwrap_or((1.0, 1.0, 1.0))) * header.exposure.unwrap_or(1.0);
    if exposure.is_finite() && exposure.min_element() > 0.0 {
        return exposure;
    }
    notes.add("exposures of the environment are not positive numbers and not used");
    Vec3::ONE
}

fn open_exr(bytes: &[u8], budget: &mut Budget, notes: &mut Notes) -> Result<Image<Vec3>, ImportError> {
    let broken = |error: exr::error::Error| ImportError::malformed("OpenEXR picture", error);
    // The size may be anything: it is paid for before the decoder allocates.
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(broken)?;
    for header in &meta.headers {
        let texels = (header.layer_size.x() as u64).saturating_mul(header.layer_size.y() as u64);
        budget.take("the texels of the environment", texels, 12 + 4 * header.channels.list.len() as u64)?;
    }
    let colors = meta.headers.first().and_then(|header| header.shared_attributes.chromaticities);
    let other = colors.is_some_and(|colors| !is_rec709(&colors));
    notes.count("environments have other primaries than Rec. 709, whose they are taken for", usize::from(other));
    let picture = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, _| (size.x(), vec![Vec3::ZERO; size.area()]),
            |(width, texels): &mut (usize, Vec<Vec3>), at, (r, g, b, _): (f32, f32, f32, f32)| {
                if let Some(texel) = texels.get_mut(at.y() * *width + at.x()) {
                    *texel = Vec3::new(r, g, b);
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(broken)?;
    let size = picture.layer_data.size;
    let (_, texels) = picture.layer_data.channel_data.pixels;
    Ok(Image::new(size.x() as u32, size.y() as u32, texels)?)
}

/// Whether colours are those of Rec. 709; files round them differently.
fn is_rec709(colors: &Chromaticities) -> bool {
    let Chromaticities { red, green, blue, white } = colors;
    let near = |value: f32, exact: f32| (value - exact).abs() < 2e-3;
    let pairs = [(red, 0.64, 0.33), (green, 0.30, 0.60), (blue, 0.15, 0.06), (white, 0.3127, 0.3290)];
    pairs.into_iter().all(|(place, x, y)| near(place.x(), x) && near(place.y(), y))
}

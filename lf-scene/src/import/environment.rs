//! Environments from Radiance (`.hdr`) and OpenEXR (`.exr`) panoramas in equirectangular projection.

use std::io::Cursor;
use std::path::Path;

use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers, read};
use glam::Vec3;
use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageDecoder};
use lf_math::Image;

use super::MEMORY_BYTES;
use super::budget::Budget;
use super::notes::Notes;
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
/// Negative values and NaN are taken for 0, infinity for 65 504; the warnings count them.
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
    let mut radiance = decode(&bytes, &mut budget)?;
    let mut notes = Notes::default();
    for texel in radiance.texels_mut() {
        *texel = Vec3::from(texel.to_array().map(|value| (mended(value, &mut notes) * scale).min(f32::MAX)));
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

/// Tells the format by the first bytes, whatever the file is called.
fn decode(bytes: &[u8], budget: &mut Budget) -> Result<Image<Vec3>, ImportError> {
    match bytes {
        [b'#', b'?', ..] => radiance(bytes, budget),
        [0x76, 0x2f, 0x31, 0x01, ..] => open_exr(bytes, budget),
        _ => Err(ImportError::malformed("environment", "it is neither a Radiance nor an OpenEXR picture")),
    }
}

fn radiance(bytes: &[u8], budget: &mut Budget) -> Result<Image<Vec3>, ImportError> {
    let broken = |error| ImportError::malformed("Radiance picture", error);
    let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(broken)?;
    let (width, height) = decoder.dimensions();
    // As decoded, and as an image.
    budget.take("the texels of the environment", u64::from(width) * u64::from(height), 24)?;
    let picture = DynamicImage::from_decoder(decoder).map_err(broken)?.into_rgb32f();
    let (texels, _) = picture.as_chunks::<3>();
    Ok(Image::new(width, height, texels.iter().copied().map(Vec3::from).collect())?)
}

fn open_exr(bytes: &[u8], budget: &mut Budget) -> Result<Image<Vec3>, ImportError> {
    let broken = |error: exr::error::Error| ImportError::malformed("OpenEXR picture", error);
    // The size may be anything: it is paid for before the decoder allocates.
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(broken)?;
    for header in &meta.headers {
        let texels = (header.layer_size.x() as u64).saturating_mul(header.layer_size.y() as u64);
        budget.take("the texels of the environment", texels, 12 + 4 * header.channels.list.len() as u64)?;
    }
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

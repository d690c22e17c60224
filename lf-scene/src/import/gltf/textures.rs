//! Pictures of a glTF file, PNG and JPEG.

use std::collections::HashMap;
use std::io::Cursor;
use std::sync::Arc;

use gltf::texture::{Info, MagFilter, WrappingMode};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use lf_math::Image;

use super::super::budget::Budget;
use super::super::notes::Notes;
use super::container::Container;
use super::uri;
use crate::ImportError;
use crate::material::{ColorEncoding, Texture};

/// The textures of a file; each is decoded once.
pub(super) struct Textures<'a> {
    pub(super) container: &'a Container<'a>,
    pub(super) decoded: HashMap<(usize, ColorEncoding), Arc<Texture>>,
}

impl Textures<'_> {
    /// A texture; `None` if its picture is in a format of an extension.
    pub(super) fn get(
        &mut self,
        info: &Info<'_>,
        encoding: ColorEncoding,
        notes: &mut Notes,
        budget: &mut Budget,
    ) -> Result<Option<Arc<Texture>>, ImportError> {
        let sampler = info.texture().sampler();
        notes.count(
            "textures ask for texels without interpolation",
            usize::from(sampler.mag_filter() == Some(MagFilter::Nearest)),
        );
        let Some(source) = info.texture().source() else {
            notes.add("textures have neither a PNG nor a JPEG picture and are left out");
            return Ok(None);
        };
        let key = (source.index(), encoding);
        if let Some(found) = self.decoded.get(&key) {
            return Ok(Some(Arc::clone(found)));
        }
        let image = self.picture(&source, budget)?;
        let texture = Arc::new(Texture { image, encoding });
        self.decoded.insert(key, Arc::clone(&texture));
        Ok(Some(texture))
    }

    fn picture(&self, source: &gltf::Image<'_>, budget: &mut Budget) -> Result<Image<[u8; 4]>, ImportError> {
        let place = format!("image {}", source.index());
        let document = &self.container.document;
        // `source.source()` of the `gltf` crate panics where the file gives neither or no type.
        let json = document.as_json().images.get(source.index());
        if let Some(uri) = json.and_then(|json| json.uri.as_ref()) {
            return decode(&place, &uri::load(&place, uri, self.container.folder, budget)?, budget);
        }
        match json.and_then(|json| document.views().nth(json.buffer_view?.value())) {
            Some(view) => decode(&place, self.container.view(&view)?, budget),
            None => Err(ImportError::malformed(place, "it names neither a file nor a buffer view")),
        }
    }
}

/// Whether a texture repeats in both directions, as [`Texture`] does.
pub(super) fn repeats(info: &Info<'_>) -> bool {
    let sampler = info.texture().sampler();
    [sampler.wrap_s(), sampler.wrap_t()] == [WrappingMode::Repeat; 2]
}

/// Decodes a picture whose format is told by its first bytes, whatever it is called. 16-bit values are rounded to 8 bits.
fn decode(place: &str, bytes: &[u8], budget: &mut Budget) -> Result<Image<[u8; 4]>, ImportError> {
    let broken = |error: image::ImageError| ImportError::malformed(place, error);
    let format = image::guess_format(bytes).ok().filter(|f| matches!(f, ImageFormat::Png | ImageFormat::Jpeg));
    let format = format
        .ok_or_else(|| ImportError::malformed(place, format!("its {} bytes are neither PNG nor JPEG", bytes.len())))?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_alloc = Some(budget.left());
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(broken)?;
    let (width, height) = decoder.dimensions();
    // The decoded picture, and as RGBA.
    budget.take("the pictures", u64::from(width) * u64::from(height), 4)?;
    budget.take("the pictures", decoder.total_bytes(), 1)?;
    let picture = DynamicImage::from_decoder(decoder).map_err(broken)?.into_rgba8();
    let (texels, _) = picture.as_chunks::<4>();
    Ok(Image::new(width, height, texels.to_vec())?)
}

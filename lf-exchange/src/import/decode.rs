//! Picture files, bounded before they are decoded.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use exr::meta::MetaData;
use exr::meta::attribute::Chromaticities;
use exr::meta::header::Header;
use exr::prelude::read_first_rgba_layer_from_file;
use half::f16;
use image::{ImageError, ImageFormat, ImageReader, Limits};
use lf_math::{Image, SlabTexels};

use crate::import::resample::Blend;
use crate::texel::rec_709;
use crate::{ExchangeError, Texels};

/// The extensions of files that are taken for pictures, in lower case.
pub(crate) const EXTENSIONS: [&str; 4] = ["png", "jpg", "jpeg", "exr"];

/// A texel that pictures can be decoded to.
pub(crate) trait Decode: Blend {
    /// Decodes a picture, which must have this size.
    fn decode(path: &Path, size: [u32; 2]) -> Result<Image<Self>, ExchangeError>;

    /// Says which kind of texels these are.
    fn texels(texels: SlabTexels<Self>) -> Texels;
}

/// Whether the file, by its extension, holds linear colours.
pub(crate) fn is_exr(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"))
}

/// Width and height of a picture, without decoding it, though a row of it may be allocated.
pub(crate) fn size(path: &Path, max_bytes: u64) -> Result<[u32; 2], ExchangeError> {
    if is_exr(path) {
        let metadata = MetaData::read_from_file(path, false).map_err(ExchangeError::reading(path))?;
        let header = metadata.headers.first().ok_or_else(|| ExchangeError::malformed(path, "it holds no layer"))?;
        let size = (u32::try_from(header.layer_size.x()), u32::try_from(header.layer_size.y()));
        return match size {
            (Ok(width @ 1..), Ok(height @ 1..)) => Ok([width, height]),
            _ => Err(ExchangeError::malformed(path, "its size is out of range")),
        };
    }
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(max_bytes);
    let mut reader = reader(path)?;
    reader.limits(limits);
    let (width, height) = reader.into_dimensions().map_err(|error| refused(path, error, max_bytes))?;
    Ok([width, height])
}

/// Whether an OpenEXR picture names primaries that are not those of Rec. 709.
pub(crate) fn has_other_primaries(path: &Path) -> Result<bool, ExchangeError> {
    /// Tables of primaries have three or four digits.
    const TOLERANCE: f32 = 2e-3;
    let metadata = MetaData::read_from_file(path, false).map_err(ExchangeError::reading(path))?;
    let named = metadata.headers.first().and_then(|header| header.shared_attributes.chromaticities);
    let points = |c: Chromaticities| [c.red, c.green, c.blue, c.white].into_iter().flat_map(|p| [p.x(), p.y()]);
    let far = |(a, b): (f32, f32)| (a - b).abs() > TOLERANCE;
    Ok(named.is_some_and(|named| points(named).zip(points(rec_709())).any(far)))
}

/// Tells a picture that is too large from one that is damaged.
fn refused(path: &Path, error: ImageError, limit: u64) -> ExchangeError {
    match error {
        ImageError::Limits(_) => {
            ExchangeError::LimitExceeded { what: format!("the picture {}", path.display()), bytes: u64::MAX, limit }
        }
        error => ExchangeError::reading(path)(error),
    }
}

fn reader(path: &Path) -> Result<ImageReader<BufReader<File>>, ExchangeError> {
    let opened = ImageReader::open(path).map_err(ExchangeError::io(path))?;
    let reader = opened.with_guessed_format().map_err(ExchangeError::io(path))?;
    match reader.format() {
        Some(ImageFormat::Png | ImageFormat::Jpeg) => Ok(reader),
        _ => Err(ExchangeError::unsupported(format!("{} is neither PNG nor JPEG nor OpenEXR", path.display()))),
    }
}

fn wrong_size(path: &Path, have: [usize; 2], want: [u32; 2]) -> ExchangeError {
    let what = format!("it has {}×{} pixels, expected are {}×{}", have[0], have[1], want[0], want[1]);
    ExchangeError::malformed(path, what)
}

impl Decode for [u8; 4] {
    fn decode(path: &Path, size: [u32; 2]) -> Result<Image<Self>, ExchangeError> {
        let mut limits = Limits::no_limits();
        // 16 bits a channel, twice: the size was held to the caller's limit, this guards against what the decoder does of
        // its own accord.
        limits.max_alloc = Some(16 * u64::from(size[0]) * u64::from(size[1]) + (1 << 20));
        let mut reader = reader(path)?;
        reader.limits(limits);
        let picture = reader.decode().map_err(ExchangeError::reading(path))?;
        if [picture.width(), picture.height()] != size {
            return Err(wrong_size(path, [picture.width(), picture.height()].map(|n| n as usize), size));
        }
        let picture = picture.into_rgb8();
        let texels = picture.pixels().map(|&image::Rgb([r, g, b])| [r, g, b, 255]).collect();
        Ok(Image::new(size[0], size[1], texels)?)
    }

    fn texels(texels: SlabTexels<Self>) -> Texels {
        Texels::Srgb8(texels)
    }
}

impl Decode for [f16; 3] {
    fn decode(path: &Path, size: [u32; 2]) -> Result<Image<Self>, ExchangeError> {
        let metadata = MetaData::read_from_file(path, false).map_err(ExchangeError::reading(path))?;
        metadata.headers.iter().try_for_each(|header| check_layer(path, header, size))?;
        let [width, height] = size.map(|n| n as usize);
        let picture = read_first_rgba_layer_from_file(
            path,
            move |_, _| vec![[f16::ZERO; 3]; width * height],
            move |texels, at, (r, g, b, _): (f16, f16, f16, f16)| {
                if let Some(texel) = texels.get_mut(at.y() * width + at.x()) {
                    *texel = [r, g, b];
                }
            },
        );
        let picture = picture.map_err(ExchangeError::reading(path))?;
        Ok(Image::new(size[0], size[1], picture.layer_data.channel_data.pixels)?)
    }

    fn texels(texels: SlabTexels<Self>) -> Texels {
        Texels::Linear16(texels)
    }
}

/// Makes sure that a layer is a whole picture of this size, and has no more channels than a picture needs.
fn check_layer(path: &Path, header: &Header, size: [u32; 2]) -> Result<(), ExchangeError> {
    /// Beauty passes bring normals, depths and the like; a file with more than this is no picture.
    const MAX_CHANNELS: usize = 64;
    let have = [header.layer_size.x(), header.layer_size.y()];
    if have != size.map(|n| n as usize) {
        return Err(wrong_size(path, have, size));
    }
    let window = header.shared_attributes.display_window;
    if window.size != header.layer_size || window.position != header.own_attributes.layer_position {
        return Err(ExchangeError::unsupported(format!("{} holds a part of its picture only", path.display())));
    }
    match header.channels.list.len() {
        0..=MAX_CHANNELS => Ok(()),
        count => Err(ExchangeError::unsupported(format!("{} has {count} channels", path.display()))),
    }
}

//! The encoders: one entry for each setting that its crate offers for BC1.
//!
//! All weights are uniform over R, G and B where a crate has a choice, since PSNR is. Options objects and copies of the
//! image into a crate's own texel type are made while preparing and are not timed.

use std::fmt::Display;

use block_compression::CompressionVariant;
use directxtex::{CP_FLAGS, DXGI_FORMAT, ScratchImage, TEX_COMPRESS_FLAGS};

use crate::codec::{Codec, Job, job_into, job_of, job_returning};
use crate::ours;
use crate::picture::Picture;

/// The encoder whose speed is the unit of all ratios.
pub const UNIT_ENCODER: &str = "intel_tex_2";

type Prepared<'a> = Result<Box<dyn Job + 'a>, String>;

/// Every encoder that is measured: the unit first, then the peers, then ours from the fastest to the best.
///
/// `repeat_blocks` is for ours: how far apart, in blocks, nearly equal pictures lie side by side; 0 where there are none.
#[must_use]
pub fn encoders(repeat_blocks: u32) -> Vec<Codec<Picture>> {
    let mut all = vec![
        Codec::peer(UNIT_ENCODER, "intel_tex_2", intel_tex),
        Codec::peer("etcpak", "ctt-etcpak", etcpak),
        Codec::peer("block_compression", "block_compression", block_compression),
        Codec::peer("tbc", "tbc", tbc),
        Codec::peer("directxtex", "directxtex", directxtex),
    ];
    all.extend(texpresso());
    all.extend(compressonator());
    all.extend(dds());
    all.extend(ours::encoders(repeat_blocks));
    all
}

/// Whatever error a peer has, in its own words.
fn told(error: impl Display) -> String {
    error.to_string()
}

fn intel_tex(picture: &Picture) -> Prepared<'_> {
    let (width, height) = (picture.width(), picture.height());
    let surface = intel_tex_2::RgbaSurface { data: picture.rgba(), width, height, stride: 4 * width };
    Ok(job_into(picture.block_bytes(), move |blocks| {
        intel_tex_2::bc1::compress_blocks_into(&surface, blocks);
        Ok(())
    }))
}

fn etcpak(picture: &Picture) -> Prepared<'_> {
    let surface = ctt_etcpak::Surface::new(picture.rgba(), picture.width(), picture.height());
    Ok(job_into(picture.block_bytes(), move |blocks| {
        ctt_etcpak::bc1::compress_blocks_into(&surface, blocks);
        Ok(())
    }))
}

fn block_compression(picture: &Picture) -> Prepared<'_> {
    let (width, height) = (picture.width(), picture.height());
    Ok(job_into(picture.block_bytes(), move |blocks| {
        let variant = CompressionVariant::BC1;
        block_compression::encode::compress_rgba8(variant, picture.rgba(), blocks, width, height, 4 * width);
        Ok(())
    }))
}

fn tbc(picture: &Picture) -> Prepared<'_> {
    use tbc::color::Rgba8;
    // Not its `Rgb8`: where both endpoints are equal that picks index 3, which every decoder reads as black.
    let texel = |&[r, g, b, a]: &[u8; 4]| Rgba8::new(r, g, b, a);
    let texels: Vec<Rgba8> = picture.rgba().as_chunks().0.iter().map(texel).collect();
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    Ok(job_returning(move || Ok(tbc::encode_image_bc1_conv_u8(&texels, width, height))))
}

fn directxtex(picture: &Picture) -> Prepared<'_> {
    let mut source = ScratchImage::default();
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let format = DXGI_FORMAT::DXGI_FORMAT_R8G8B8A8_UNORM;
    source.initialize_2d(format, width, height, 1, 1, CP_FLAGS::CP_FLAGS_NONE).map_err(told)?;
    if source.pixels().len() != picture.rgba().len() {
        return Err("its rows are padded".to_owned());
    }
    source.pixels_mut().copy_from_slice(picture.rgba());
    let run = move |out: &mut ScratchImage| {
        let (format, flags) = (DXGI_FORMAT::DXGI_FORMAT_BC1_UNORM, TEX_COMPRESS_FLAGS::TEX_COMPRESS_UNIFORM);
        *out = source.compress(format, flags, directxtex::TEX_THRESHOLD_DEFAULT).map_err(told)?;
        Ok(())
    };
    Ok(job_of(ScratchImage::default(), run, |out| out.pixels().to_vec()))
}

fn texpresso() -> [Codec<Picture>; 3] {
    use texpresso::Algorithm::{ClusterFit, IterativeClusterFit, RangeFit};
    let at = |name, algorithm| {
        Codec::peer(name, "texpresso", move |picture: &Picture| -> Prepared<'_> {
            let weights = texpresso::COLOUR_WEIGHTS_UNIFORM;
            let params = texpresso::Params { algorithm, weights, weigh_colour_by_alpha: false };
            let (width, height) = (picture.width() as usize, picture.height() as usize);
            Ok(job_into(picture.block_bytes(), move |blocks| {
                texpresso::Format::Bc1.compress(picture.rgba(), width, height, params, blocks);
                Ok(())
            }))
        })
    };
    [
        at("texpresso-range", RangeFit),
        at("texpresso-cluster", ClusterFit),
        at("texpresso-iterative", IterativeClusterFit),
    ]
}

/// Three of its four steps, which begin at 0, 0.25, 0.5 and above 0.75: in the last it codes every block as black.
fn compressonator() -> [Codec<Picture>; 3] {
    use ctt_compressonator::bc1::{Options, compress_blocks_into};
    let at = |name, quality: f32| {
        Codec::peer(name, "ctt-compressonator", move |picture: &Picture| -> Prepared<'_> {
            let mut options = Options::new().map_err(told)?;
            options.set_quality(quality).map_err(told)?;
            options.set_channel_weights(1.0, 1.0, 1.0).map_err(told)?;
            let (width, height) = (picture.width(), picture.height());
            Ok(job_into(picture.block_bytes(), move |blocks| {
                compress_blocks_into(picture.rgba(), width, height, &options, blocks).map_err(told)
            }))
        })
    };
    [at("compressonator-0.05", 0.05), at("compressonator-0.3", 0.3), at("compressonator-0.5", 0.5)]
}

fn dds() -> [Codec<Picture>; 4] {
    use dds::CompressionQuality::{Fast, High, Normal, Unreasonable};
    let at = |name, quality| {
        Codec::peer(name, "dds", move |picture: &Picture| -> Prepared<'_> {
            let mut options = dds::EncodeOptions::default();
            options.quality = quality;
            options.parallel = false;
            let size = dds::Size::new(picture.width(), picture.height());
            let view = dds::ImageView::new(picture.rgba(), size, dds::ColorFormat::RGBA_U8)
                .ok_or_else(|| "the view does not fit".to_owned())?;
            Ok(job_into(picture.block_bytes(), move |mut blocks| {
                dds::encode(&mut blocks, view, dds::Format::BC1_UNORM, None, &options).map_err(told)
            }))
        })
    };
    [at("dds-fast", Fast), at("dds-normal", Normal), at("dds-high", High), at("dds-unreasonable", Unreasonable)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::SquaredError;
    use crate::synthetic::gradient;

    #[test]
    fn every_encoder_is_called_rightly() {
        let picture = gradient(64).unwrap();
        for encoder in encoders(0) {
            let blocks = encoder.encode(&picture).unwrap();
            let error = SquaredError::of(&blocks, &picture).unwrap();
            assert!(error.psnr_db() > 25.0, "{}: {:.2} dB", encoder.name(), error.psnr_db());
        }
    }

    #[test]
    fn names_are_unique_and_the_unit_is_first() {
        let mut names: Vec<String> = encoders(0).iter().map(|e| e.name().to_owned()).collect();
        assert_eq!(names[0], UNIT_ENCODER);
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}

//! The codec of `lf-compress`: the one place here that names its functions.
//!
//! Both directions run on the calling thread alone and write into memory that was there before.

use lf_compress::bc1::{self, EncodeOptions, Modes, Pixels, Quality, Texel};

use crate::codec::{Codec, Encoded, Job, job_into, job_of};
use crate::picture::Picture;

/// An encoder for each quality, the fastest first, and the best two with 3-colour blocks and black; where pictures repeat
/// every so many blocks, those that make use of it too.
pub(crate) fn encoders(repeat_blocks: u32) -> Vec<Codec<Picture>> {
    let mut all: Vec<_> = Quality::ALL.map(|quality| encoder("", EncodeOptions::new(quality))).into();
    let best = [Quality::Best, Quality::Exhaustive];
    all.extend(best.map(|quality| encoder("+3c+blk", EncodeOptions::new(quality).modes(Modes::ThreeColorBlack))));
    if repeat_blocks > 0 {
        let seeded = [Quality::Standard, Quality::High, Quality::Best];
        all.extend(seeded.map(|quality| encoder("+repeat", EncodeOptions::new(quality).repeat_blocks(repeat_blocks))));
    }
    all
}

fn encoder(suffix: &str, options: EncodeOptions) -> Codec<Picture> {
    let name = format!("lf-{}{suffix}", options.quality.name());
    Codec::ours(&name, move |picture: &Picture| -> Result<Box<dyn Job + '_>, String> {
        let (pixels, width, height) = (Pixels::Rgba8(picture.rgba()), picture.width(), picture.height());
        let encode =
            move |blocks: &mut [u8]| bc1::encode_pixels_into(width, height, pixels, width as usize, options, blocks);
        Ok(job_into(picture.block_bytes(), move |blocks| encode(blocks).map_err(|error| error.to_string())))
    })
}

/// The decoder.
pub(crate) fn decoder() -> Codec<Encoded> {
    Codec::ours("lf-compress", |encoded: &Encoded| -> Result<Box<dyn Job + '_>, String> {
        let (width, height) = (encoded.width, encoded.height);
        let run = move |texels: &mut Vec<Texel>| {
            bc1::decode_image_into(width, height, &encoded.blocks, texels, width as usize).map_err(|e| e.to_string())
        };
        Ok(job_of(vec![[0; 4]; encoded.texels()], run, |texels| texels.as_flattened().to_vec()))
    })
}

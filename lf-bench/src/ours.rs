//! The codec of `lf-compress`: the one place here that names its functions.
//!
//! Both directions run on the calling thread alone and write into memory that was there before.

use lf_compress::bc1::{self, Pixels, Quality, Texel};

use crate::codec::{Codec, Encoded, Job, job_into, job_of};
use crate::picture::Picture;

/// An encoder for each quality, the fastest first.
pub(crate) fn encoders() -> impl Iterator<Item = Codec<Picture>> {
    Quality::ALL.into_iter().map(|quality| {
        let name = format!("lf-{}", format!("{quality:?}").to_lowercase());
        Codec::ours(&name, move |picture: &Picture| -> Result<Box<dyn Job + '_>, String> {
            let (pixels, width, height) = (Pixels::Rgba8(picture.rgba()), picture.width(), picture.height());
            let encode = move |blocks: &mut [u8]| {
                bc1::encode_pixels_into(width, height, pixels, width as usize, quality, blocks)
            };
            Ok(job_into(picture.block_bytes(), move |blocks| encode(blocks).map_err(|error| error.to_string())))
        })
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

//! The decoders, and the copying of their output for scale.
//!
//! `ctt-etcpak` 0.6.1 is not among them: its `decode_bc1` writes only the first of each block's four rows.

use std::fmt::Display;

use block_compression::CompressionVariant;
use directxtex::{CP_FLAGS, DXGI_FORMAT, ScratchImage};

use crate::codec::{Codec, Encoded, Job, job_into, job_of, job_returning};
use crate::ours;
use crate::quality::rgba_of_bgra_words;

/// The decoder that all others are compared with.
pub const REFERENCE_DECODER: &str = "texture2ddecoder";

type Prepared<'a> = Result<Box<dyn Job + 'a>, String>;

/// Every decoder that is measured: the reference first, ours last.
#[must_use]
pub fn decoders() -> Vec<Codec<Encoded>> {
    vec![
        Codec::peer(REFERENCE_DECODER, "texture2ddecoder", texture2d),
        Codec::peer("bcdec_rs", "bcdec_rs", bcdec_rs),
        Codec::peer("dds", "dds", dds),
        Codec::peer("block_compression", "block_compression", block_compression),
        Codec::peer("texpresso", "texpresso", texpresso),
        Codec::peer("image_dds", "image_dds", image_dds),
        Codec::peer("bcndecode", "bcndecode", bcndecode),
        Codec::peer("directxtex", "directxtex", directxtex),
        Codec::peer("compressonator", "ctt-compressonator", compressonator),
        ours::decoder(),
    ]
}

fn told(error: impl Display) -> String {
    error.to_string()
}

fn sides(encoded: &Encoded) -> (usize, usize) {
    (encoded.width as usize, encoded.height as usize)
}

fn texture2d(encoded: &Encoded) -> Prepared<'_> {
    let (width, height) = sides(encoded);
    let run = move |words: &mut Vec<u32>| {
        texture2ddecoder::decode_bc1a(&encoded.blocks, width, height, words).map_err(str::to_owned)
    };
    Ok(job_of(vec![0; encoded.texels()], run, |words| rgba_of_bgra_words(words)))
}

/// Block by block, as the crate wants it.
fn bcdec_rs(encoded: &Encoded) -> Prepared<'_> {
    let pitch = 4 * encoded.width as usize;
    Ok(job_into(4 * encoded.texels(), move |rgba| {
        for (rows, blocks) in rgba.chunks_exact_mut(4 * pitch).zip(encoded.blocks.chunks_exact(2 * pitch / 4)) {
            for (x, block) in blocks.chunks_exact(8).enumerate() {
                bcdec_rs::bc1(block, &mut rows[16 * x..], pitch);
            }
        }
        Ok(())
    }))
}

fn dds(encoded: &Encoded) -> Prepared<'_> {
    let size = dds::Size::new(encoded.width, encoded.height);
    let options = dds::DecodeOptions::default();
    Ok(job_into(4 * encoded.texels(), move |rgba| {
        let view = dds::ImageViewMut::new(rgba, size, dds::ColorFormat::RGBA_U8)
            .ok_or_else(|| "the view does not fit".to_owned())?;
        dds::decode(&mut encoded.blocks.as_slice(), view, dds::Format::BC1_UNORM, &options).map_err(told)
    }))
}

fn block_compression(encoded: &Encoded) -> Prepared<'_> {
    Ok(job_into(4 * encoded.texels(), |rgba| {
        let (width, height) = (encoded.width, encoded.height);
        let variant = CompressionVariant::BC1;
        block_compression::decode::decompress_blocks_as_rgba8(variant, width, height, &encoded.blocks, rgba);
        Ok(())
    }))
}

fn texpresso(encoded: &Encoded) -> Prepared<'_> {
    let (width, height) = sides(encoded);
    Ok(job_into(4 * encoded.texels(), move |rgba| {
        texpresso::Format::Bc1.decompress(&encoded.blocks, width, height, rgba);
        Ok(())
    }))
}

fn image_dds(encoded: &Encoded) -> Prepared<'_> {
    let surface = image_dds::Surface {
        width: encoded.width,
        height: encoded.height,
        depth: 1,
        layers: 1,
        mipmaps: 1,
        image_format: image_dds::ImageFormat::BC1RgbaUnorm,
        data: encoded.blocks.as_slice(),
    };
    Ok(job_returning(move || Ok(surface.decode_rgba8().map_err(told)?.data)))
}

fn bcndecode(encoded: &Encoded) -> Prepared<'_> {
    use bcndecode::{BcnDecoderFormat, BcnEncoding};
    let (width, height) = sides(encoded);
    Ok(job_returning(move || {
        bcndecode::decode(&encoded.blocks, width, height, BcnEncoding::Bc1, BcnDecoderFormat::RGBA).map_err(told)
    }))
}

fn directxtex(encoded: &Encoded) -> Prepared<'_> {
    let mut source = ScratchImage::default();
    let (width, height) = sides(encoded);
    let format = DXGI_FORMAT::DXGI_FORMAT_BC1_UNORM;
    source.initialize_2d(format, width, height, 1, 1, CP_FLAGS::CP_FLAGS_NONE).map_err(told)?;
    source.pixels_mut().copy_from_slice(&encoded.blocks);
    let run = move |out: &mut ScratchImage| {
        *out = source.decompress(DXGI_FORMAT::DXGI_FORMAT_R8G8B8A8_UNORM).map_err(told)?;
        Ok(())
    };
    Ok(job_of(ScratchImage::default(), run, |out| out.pixels().to_vec()))
}

/// Block by block, as the crate wants it.
fn compressonator(encoded: &Encoded) -> Prepared<'_> {
    let pitch = 4 * encoded.width as usize;
    Ok(job_into(4 * encoded.texels(), move |rgba| {
        for (rows, blocks) in rgba.chunks_exact_mut(4 * pitch).zip(encoded.blocks.chunks_exact(2 * pitch / 4)) {
            for (x, block) in blocks.as_chunks::<8>().0.iter().enumerate() {
                let texels = ctt_compressonator::bc1::decompress_block(block).map_err(told)?;
                for (row, source) in rows.chunks_exact_mut(pitch).zip(texels.as_chunks::<16>().0) {
                    row[16 * x..16 * x + 16].copy_from_slice(source);
                }
            }
        }
        Ok(())
    }))
}

/// Copies as many bytes as a decoder of the same blocks writes: a bound that memory sets.
pub(crate) fn copying(encoded: &Encoded) -> Box<dyn Job> {
    let source = vec![0x5a; 4 * encoded.texels()];
    job_into(source.len(), move |copy| {
        copy.copy_from_slice(std::hint::black_box(&source));
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::{Difference, largest_difference};

    /// Blocks of pseudo-random bytes: both block modes, all indices.
    fn random_blocks() -> Encoded {
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        let blocks = (0..8 * 16 * 8).map(|_| next()).collect();
        Encoded { name: "random".to_owned(), width: 64, height: 32, blocks }
    }

    #[test]
    fn all_decoders_agree_within_one_step() {
        let encoded = random_blocks();
        let all = decoders();
        let reference = all[0].decode(&encoded).unwrap();
        for decoder in &all[1..] {
            let rgba = decoder.decode(&encoded).unwrap();
            let Difference { color, .. } = largest_difference(&rgba, &reference);
            assert!(color <= 1, "{} differs by {color}", decoder.name());
        }
    }
}

//! KTX 2.0 files of 3D textures.
//!
//! Section numbers are not given in the KTX File Format Specification 2.0 (revision 4); names in quotes are its
//! headings. One mip level, no array, no faces. A file is: identifier, header, index and level index (104 bytes), the
//! Data Format Descriptor (Khronos Data Format Specification 1.4), sorted key/value data, and the level.
//!
//! `vkFormat` is the sRGB variant where there is one, with the sRGB transfer function in the descriptor, as
//! "Restrictions" demands; see [`Volume`] for how to interpolate texels as they are stored. With zstd the descriptor
//! stays that of the texels, `bytesPlane0` included, as "DFD for Supercompressed Data" has it since revision 4.

use std::io::Write as _;

use crate::{ExchangeError, Volume, VolumeFormat};

const IDENTIFIER: [u8; 12] = *b"\xABKTX 20\xBB\r\n\x1A\n";
/// Identifier, header, index and a level index of one entry.
const HEADER_BYTES: usize = 80 + 24;
/// Transfer functions and primaries of `khr_df.h`.
const TRANSFER_LINEAR: u8 = 1;
const TRANSFER_SRGB: u8 = 2;
const PRIMARIES_BT709: u8 = 1;
/// Of a sample's channel type: the value is linear, signed, floating point.
const LINEAR: u8 = 0x10;
const SIGNED_FLOAT: u8 = 0xC0;

/// Whether the level is stored as it is or supercompressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Supercompression {
    /// Scheme 0: the level is stored as it is, aligned for upload.
    #[default]
    None,
    /// Scheme 2: the level is one zstd frame of this level, 1 to 22.
    Zstd(i32),
}

/// What the descriptor says about one channel of a texel block.
struct Sample {
    offset: u16,
    bits: u8,
    channel: u8,
    lower: u32,
    upper: u32,
}

/// What KTX2 says about a format.
struct FormatInfo {
    vk_format: u32,
    type_size: u32,
    color_model: u8,
    transfer: u8,
    /// Edge of a texel block, less 1.
    block_edge: u8,
    block_bytes: u8,
    samples: Vec<Sample>,
}

/// The KTX2 file of a volume, as one 3D texture.
///
/// # Errors
/// [`ExchangeError::InvalidArgument`] if zstd refuses the level.
pub fn encode(volume: &Volume<'_>, supercompression: Supercompression) -> Result<Vec<u8>, ExchangeError> {
    let info = format_info(volume.format());
    let (descriptor, metadata) = (descriptor(&info), key_values());
    let (dfd_offset, kvd_offset) = (HEADER_BYTES, HEADER_BYTES + descriptor.len());
    // Without supercompression the level begins at a multiple of lcm(block, 4); every block here has 4 or 8 bytes.
    let (scheme, frame, alignment) = match supercompression {
        Supercompression::None => (0u32, None, usize::from(info.block_bytes)),
        Supercompression::Zstd(level) => (2, Some(zstd_frame(volume, level)?), 1),
    };
    let level_offset = (kvd_offset + metadata.len()).next_multiple_of(alignment);
    let level_bytes = frame.as_ref().map_or(volume.total_bytes(), |frame| frame.len() as u64);
    let mut file = Vec::new();
    file.extend(IDENTIFIER);
    let [width, height, depth] = volume.size();
    let (layers, faces, levels) = (0, 1, 1);
    words(&mut file, &[info.vk_format, info.type_size, width, height, depth, layers, faces, levels, scheme]);
    // Nothing here comes near 4 GiB but the level.
    words(&mut file, &[dfd_offset as u32, descriptor.len() as u32, kvd_offset as u32, metadata.len() as u32]);
    let no_global_data = [0u64; 2];
    let index = [level_offset as u64, level_bytes, volume.total_bytes()];
    file.extend(no_global_data.into_iter().chain(index).flat_map(u64::to_le_bytes));
    file.extend(descriptor);
    file.extend(metadata);
    file.resize(level_offset, 0);
    match frame {
        Some(frame) => file.extend_from_slice(&frame),
        None => volume.slices().iter().for_each(|slice| file.extend_from_slice(slice)),
    }
    Ok(file)
}

fn zstd_frame(volume: &Volume<'_>, level: i32) -> Result<Vec<u8>, ExchangeError> {
    let frame = || {
        let mut encoder = zstd::Encoder::new(Vec::new(), level)?;
        encoder.set_pledged_src_size(Some(volume.total_bytes()))?;
        encoder.include_contentsize(true)?;
        volume.slices().iter().try_for_each(|slice| encoder.write_all(slice))?;
        encoder.finish()
    };
    frame().map_err(|error: std::io::Error| ExchangeError::argument(format!("zstd cannot pack the volume: {error}")))
}

fn words(file: &mut Vec<u8>, words: &[u32]) {
    file.extend(words.iter().flat_map(|word| word.to_le_bytes()));
}

fn format_info(format: VolumeFormat) -> FormatInfo {
    let rgba = |bits: u8, qualifiers: u8, alpha: u8, lower, upper| -> Vec<Sample> {
        let channels = [0, 1, 2, 15 | alpha].into_iter().zip(0u16..);
        channels
            .map(|(channel, i)| Sample {
                offset: i * u16::from(bits),
                bits,
                channel: channel | qualifiers,
                lower,
                upper,
            })
            .collect()
    };
    match format {
        VolumeFormat::Bc1 => FormatInfo {
            vk_format: 132, // VK_FORMAT_BC1_RGB_SRGB_BLOCK
            type_size: 1,
            color_model: 128, // KHR_DF_MODEL_BC1A
            transfer: TRANSFER_SRGB,
            block_edge: 3,
            block_bytes: 8,
            samples: vec![Sample { offset: 0, bits: 64, channel: 0, lower: 0, upper: u32::MAX }],
        },
        VolumeFormat::Rgba8 => FormatInfo {
            vk_format: 43, // VK_FORMAT_R8G8B8A8_SRGB
            type_size: 1,
            color_model: 1, // KHR_DF_MODEL_RGBSDA
            transfer: TRANSFER_SRGB,
            block_edge: 0,
            block_bytes: 4,
            samples: rgba(8, 0, LINEAR, 0, 255),
        },
        VolumeFormat::Rgba16Float => FormatInfo {
            vk_format: 97, // VK_FORMAT_R16G16B16A16_SFLOAT
            type_size: 2,
            color_model: 1,
            transfer: TRANSFER_LINEAR,
            block_edge: 0,
            block_bytes: 8,
            samples: rgba(16, SIGNED_FLOAT, 0, (-1.0f32).to_bits(), 1.0f32.to_bits()),
        },
    }
}

/// The Data Format Descriptor: its total size and one basic descriptor block.
fn descriptor(info: &FormatInfo) -> Vec<u8> {
    // Version 1.3 and, not renumbered, 1.4 of the Data Format Specification.
    const VERSION: u32 = 2;
    let block_bytes = 24 + 16 * info.samples.len() as u32;
    let mut out = Vec::new();
    words(&mut out, &[block_bytes + 4, 0, VERSION | block_bytes << 16]);
    out.extend([info.color_model, PRIMARIES_BT709, info.transfer, 0]);
    out.extend([info.block_edge, info.block_edge, 0, 0]);
    out.extend([info.block_bytes, 0, 0, 0, 0, 0, 0, 0]);
    for sample in &info.samples {
        let position = u32::from(sample.offset) | u32::from(sample.bits - 1) << 16 | u32::from(sample.channel) << 24;
        words(&mut out, &[position, 0, sample.lower, sample.upper]);
    }
    out
}

/// Key/value data, sorted by key: texels lie to the right, rows downwards, slices inwards.
fn key_values() -> Vec<u8> {
    let writer = concat!("lf-exchange ", env!("CARGO_PKG_VERSION"), "\0");
    let mut out = Vec::new();
    for (key, value) in [("KTXorientation\0", "rdi\0"), ("KTXwriter\0", writer)] {
        words(&mut out, &[(key.len() + value.len()) as u32]);
        out.extend(key.bytes().chain(value.bytes()));
        out.resize(out.len().next_multiple_of(4), 0);
    }
    out
}

//! KTX2 and DDS files as other crates read them; DDS headers by the numbers of the documentation; refusals.

use lf_exchange::{ExchangeError, Volume, VolumeFormat, dds, ktx2};

const FORMATS: [(VolumeFormat, usize, ::ktx2::Format); 3] = [
    (VolumeFormat::Bc1, 8 * 3 * 2, ::ktx2::Format::BC1_RGB_SRGB_BLOCK),
    (VolumeFormat::Rgba8, 4 * 12 * 8, ::ktx2::Format::R8G8B8A8_SRGB),
    (VolumeFormat::Rgba16Float, 8 * 12 * 8, ::ktx2::Format::R16G16B16A16_SFLOAT),
];

fn bytes(len: usize) -> Vec<u8> {
    (0..len).map(|i| (i * i / 7 + i) as u8).collect()
}

fn volume(format: VolumeFormat, slice: usize, bytes: &[u8]) -> Volume<'_> {
    Volume::new([12, 8, 5], format, bytes.chunks_exact(slice).collect()).unwrap()
}

#[test]
fn ktx2_files_are_read_back_by_another_crate() {
    for (format, slice, vk_format) in FORMATS {
        let bytes = bytes(5 * slice);
        for zstd in [false, true] {
            let packing = if zstd { ktx2::Supercompression::Zstd(3) } else { ktx2::Supercompression::None };
            let file = ktx2::encode(&volume(format, slice, &bytes), packing).unwrap();
            let reader = ::ktx2::Reader::new(&file[..]).unwrap();
            let header = reader.header();
            assert_eq!(header.format, Some(vk_format));
            assert_eq!((header.pixel_width, header.pixel_height, header.pixel_depth), (12, 8, 5));
            assert_eq!((header.layer_count, header.face_count, header.level_count), (0, 1, 1));
            assert_eq!(header.type_size, if format == VolumeFormat::Rgba16Float { 2 } else { 1 });
            assert_eq!(header.supercompression_scheme.is_some(), zstd);
            let keys: Vec<&str> = reader.key_value_data().map(|(key, _)| key).collect();
            assert_eq!(keys, ["KTXorientation", "KTXwriter"]);
            let level = reader.levels().next().unwrap();
            assert_eq!(level.uncompressed_byte_length, bytes.len() as u64);
            let data = if zstd { zstd::bulk::decompress(level.data, 1 << 20).unwrap() } else { level.data.to_vec() };
            assert_eq!(data, bytes, "{format:?}");
            let offset = header.index.kvd_byte_offset as usize + header.index.kvd_byte_length as usize;
            let begin = file.len() - level.data.len();
            let alignment = if format == VolumeFormat::Rgba8 { 4 } else { 8 };
            assert_eq!(begin, if zstd { offset } else { offset.next_multiple_of(alignment) });
            assert!(file[offset..begin].iter().all(|&byte| byte == 0));
        }
    }
}

#[test]
fn the_descriptor_keeps_the_block_size_under_supercompression() {
    for (format, slice, _) in FORMATS {
        let bytes = bytes(5 * slice);
        let descriptor = |packing| {
            let file = ktx2::encode(&volume(format, slice, &bytes), packing).unwrap();
            let reader = ::ktx2::Reader::new(&file[..]).unwrap();
            let index = reader.header().index;
            file[index.dfd_byte_offset as usize..][..index.dfd_byte_length as usize].to_vec()
        };
        let plain = descriptor(ktx2::Supercompression::None);
        assert_eq!(plain, descriptor(ktx2::Supercompression::Zstd(3)));
        // Total size, vendor, version and block size, then model, primaries, transfer, flags, block edges, bytes.
        assert_eq!(plain[..4], (plain.len() as u32).to_le_bytes());
        assert_eq!(plain[20], if format == VolumeFormat::Rgba8 { 4 } else { 8 });
        assert_eq!(plain[14], if format == VolumeFormat::Rgba16Float { 1 } else { 2 });
    }
}

#[test]
fn partial_blocks_are_stored_whole() {
    let bytes = bytes(8 * 2 * 2 * 3);
    let volume = Volume::new([5, 7, 3], VolumeFormat::Bc1, bytes.chunks_exact(32).collect()).unwrap();
    let file = ktx2::encode(&volume, ktx2::Supercompression::None).unwrap();
    assert_eq!(::ktx2::Reader::new(&file[..]).unwrap().levels().next().unwrap().data, bytes);
}

#[test]
fn dds_headers_say_what_follows() {
    for (format, slice, _) in FORMATS {
        let bytes = bytes(5 * slice);
        for shape in [dds::Shape::Volume, dds::Shape::Array] {
            let file = dds::encode(&volume(format, slice, &bytes), shape).unwrap();
            let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap());
            assert_eq!(&file[148..], bytes);
            assert_eq!((&file[..4], word(4), word(76), &file[84..88]), (&b"DDS "[..], 124, 32, &b"DX10"[..]));
            assert_eq!([word(16), word(12)], [12, 8]);
            let is_volume = shape == dds::Shape::Volume;
            assert_eq!((word(8) & 0x80_0000 != 0, word(24)), (is_volume, if is_volume { 5 } else { 0 }));
            assert_eq!((word(132), word(140)), if is_volume { (4, 1) } else { (3, 5) });
        }
    }
}

/// BC1 as Direct3D's documentation has it, opaque blocks only, without rounding.
fn decode_bc1(block: &[u8], texel: usize) -> [f32; 3] {
    let ends = [u16::from_le_bytes([block[0], block[1]]), u16::from_le_bytes([block[2], block[3]])];
    let [a, b] = ends.map(|c| [f32::from(c >> 11) / 31.0, f32::from(c >> 5 & 63) / 63.0, f32::from(c & 31) / 31.0]);
    let index = block[4 + texel / 4] >> (texel % 4 * 2) & 3;
    let weight = [0.0, 1.0, 1.0 / 3.0, 2.0 / 3.0][usize::from(index)];
    [0, 1, 2].map(|i| 255.0 * (a[i] * (1.0 - weight) + b[i] * weight))
}

#[test]
fn dds_slices_and_layers_are_read_back_by_another_crate() {
    let mut blocks = bytes(5 * 48);
    // color0 above color1: four opaque colours.
    blocks.chunks_exact_mut(8).for_each(|block| (block[1], block[3]) = (block[1] | 0x80, block[3] & 0x7F));
    for (format, slice, _) in FORMATS {
        let bytes = if format == VolumeFormat::Bc1 { blocks.clone() } else { bytes(5 * slice) };
        for shape in [dds::Shape::Volume, dds::Shape::Array] {
            let file = dds::encode(&volume(format, slice, &bytes), shape).unwrap();
            let mut decoder = ::dds::Decoder::new(&file[..]).unwrap();
            assert_eq!(decoder.layout().volume().is_some(), shape == dds::Shape::Volume);
            for expected in bytes.chunks_exact(slice) {
                check_surface(&mut decoder, format, expected);
            }
            assert!(decoder.is_done());
        }
    }
}

fn check_surface(decoder: &mut ::dds::Decoder<&[u8]>, format: VolumeFormat, expected: &[u8]) {
    let color =
        if format == VolumeFormat::Rgba16Float { ::dds::ColorFormat::RGBA_F32 } else { ::dds::ColorFormat::RGBA_U8 };
    let mut seen = vec![0; 12 * 8 * usize::from(color.bytes_per_pixel())];
    decoder.read_surface(::dds::ImageViewMut::new(&mut seen, ::dds::Size::new(12, 8), color).unwrap()).unwrap();
    match format {
        VolumeFormat::Rgba8 => assert_eq!(seen, expected),
        VolumeFormat::Rgba16Float => {
            let half = expected.chunks_exact(2).map(|b| half::f16::from_le_bytes([b[0], b[1]]).to_f32());
            let float = seen.chunks_exact(4).map(|b| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]));
            assert!(half.zip(float).all(|(a, b)| a == b || a.is_nan() && b.is_nan()));
        }
        _ => {
            for (i, texel) in seen.chunks_exact(4).enumerate() {
                let (x, y) = (i % 12, i / 12);
                let block = &expected[(y / 4 * 3 + x / 4) * 8..][..8];
                let exact = decode_bc1(block, y % 4 * 4 + x % 4);
                assert!(exact.into_iter().zip(texel).all(|(a, &b)| (a - f32::from(b)).abs() <= 1.01), "{x} {y}");
            }
        }
    }
}

#[test]
fn volumes_hold_what_they_say() {
    let slice = [0u8; 8];
    let refused = |size, slices: Vec<&[u8]>| {
        let result = Volume::new(size, VolumeFormat::Bc1, slices);
        assert!(matches!(result, Err(ExchangeError::InvalidArgument { .. })), "{size:?}");
    };
    refused([0, 4, 1], vec![&slice]);
    refused([4, 4, 2], vec![&slice]);
    refused([4, 5, 1], vec![&slice]);
    refused([u32::MAX, u32::MAX, 1], vec![&slice]);
    assert!(Volume::new([1, 4, 1], VolumeFormat::Bc1, vec![&slice]).is_ok());
}

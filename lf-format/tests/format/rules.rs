//! One test for each rule of the specification that checksums do not cover.

use lf_format::{Container, FormatError, Limits, Metadata, Packing, SlabTiling, TexelEncoding, Writer};

use crate::assemble::{Chunk, File, assert_breaks, parse, refusal, reseal, smallest_writer};

/// Where the entries of the directory are.
const FIRST_ENTRY: usize = 64;
const SECOND_ENTRY: usize = 112;
const THIRD_ENTRY: usize = 160;
/// Where the payload of `GEOM` is in a file of two chunks.
const GEOM: usize = 192;
/// Where the payload of the second of three chunks is.
const SECOND_OF_THREE: usize = 384;

#[track_caller]
fn assert_unsupported(bytes: &[u8], expected: &str, at: usize) {
    match refusal(bytes) {
        FormatError::Unsupported { clause, offset, .. } if (clause, offset) == (expected, at as u64) => {}
        other => panic!("expected something unsupported by {expected} at byte {at}, got: {other}"),
    }
}

/// The smallest file with one of its bytes changed, and right checksums of header and directory.
fn with_byte(at: usize, value: u8) -> Vec<u8> {
    let mut file = File::smallest().to_bytes();
    file[at] = value;
    reseal(&mut file);
    file
}

/// The smallest file with a change to its geometry chunk, and right checksums.
fn with_geometry(at: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = File::smallest();
    file.chunks[0].payload[at..at + bytes.len()].copy_from_slice(bytes);
    file.to_bytes()
}

#[test]
fn versions() {
    let version = |major, minor| File { version: (major, minor), ..File::smallest() }.to_bytes();
    assert_eq!(parse(&version(1, 9)).unwrap().version(), (1, 9));
    for (major, minor) in [(2, 0), (0, 1)] {
        let file = version(major, minor);
        assert_unsupported(&file, "§3.2", 12);
        let message = refusal(&file).to_string();
        assert!(message.contains(&format!("of version {major}.{minor}, this reader knows version 1")), "{message}");
    }
}

#[test]
fn header_fields() {
    assert_breaks(&with_byte(24, 128), "§3.4", 24);
    assert_breaks(&with_byte(32, 7), "§3.5", 32);
    assert_breaks(&with_byte(36, 1), "§3.6", 36);
    assert_breaks(&with_byte(55, 1), "§3.6", 55);
    let mut file = File::smallest().to_bytes();
    file[70] ^= 1;
    assert_breaks(&file, "§3.7", 40);
    file[60] ^= 1;
    assert_breaks(&file, "§3.8", 56);
}

#[test]
fn unknown_chunks() {
    assert_unsupported(&File::with(Chunk::new(b"NEWC", 1, vec![1])).to_bytes(), "§4.2", SECOND_ENTRY + 4);
    for flags in [0, 2] {
        let bytes = File::with(Chunk { slab: 9, tile: 9, ..Chunk::new(b"note", flags, vec![1, 2, 3]) }).to_bytes();
        let file = parse(&bytes).unwrap();
        let chunk = file.chunks().nth(1).unwrap();
        assert_eq!((chunk.tag.to_string().as_str(), chunk.slab, chunk.stored_len), ("note", 9, 3));
        assert_eq!((chunk.critical, chunk.safe_to_copy), (false, flags == 2));
        assert!(file.tile(0, 0).is_some());
    }
}

#[test]
fn unknown_packings() {
    // Skipped with the chunk if its kind is not known either; nothing ties its lengths together.
    for flags in [0, 2] {
        let bytes = File::with(Chunk { packing: 9, raw_len: 100, ..Chunk::new(b"NEWC", flags, vec![1]) }).to_bytes();
        let file = parse(&bytes).unwrap();
        let chunk = file.chunks().nth(1).unwrap();
        assert_eq!((chunk.packing, chunk.stored_len, chunk.raw_len), (Packing::Unknown(9), 1, 100));
    }
    let critical = Chunk { packing: 9, ..Chunk::new(b"NEWC", 1, vec![1]) };
    assert_unsupported(&File::with(critical).to_bytes(), "§4.2", SECOND_ENTRY + 4);
    for (tag, flags) in [(b"TILE", 1), (b"META", 2), (b"GEOM", 1)] {
        let chunk = Chunk { packing: 3, ..Chunk::new(tag, flags, vec![1]) };
        assert_unsupported(&File::with(chunk).to_bytes(), "§4.3", SECOND_ENTRY + 6);
    }
}

#[test]
fn the_tile_codec_is_for_bc1_only() {
    let mut file = File::smallest();
    file.chunks[1] = Chunk { packing: 2, raw_len: 8, ..Chunk::new(b"TILE", 1, vec![1, 2, 3]) };
    let bytes = file.to_bytes();
    let tile = parse(&bytes).unwrap().tile(0, 0).unwrap();
    assert_eq!((tile.packing, tile.bytes), (Packing::Tile, &[1u8, 2, 3][..]));
    // Texel encoding 2 is RGBA8, of which the smallest tile has 64 bytes.
    file.chunks[0].payload[41] = 2;
    file.chunks[1].raw_len = 64;
    assert_breaks(&file.to_bytes(), "§4.3", SECOND_ENTRY + 6);
}

#[test]
fn directory_fields() {
    let payload = vec![1, 2, 3];
    let refused = |chunk: Chunk, clause, at| assert_breaks(&File::with(chunk).to_bytes(), clause, SECOND_ENTRY + at);
    refused(Chunk::new(b"a b ", 0, payload.clone()), "§4.1", 0);
    refused(Chunk::new(b"note", 3, payload.clone()), "§4.2", 4);
    refused(Chunk::new(b"note", 4, payload.clone()), "§4.2", 4);
    refused(Chunk::new(b"META", 1, payload.clone()), "§4.2", 4);
    refused(Chunk { packing: 1, ..Chunk::new(b"META", 2, payload.clone()) }, "§4.4", 6);
    refused(Chunk { slab: 1, ..Chunk::new(b"META", 2, payload.clone()) }, "§4.4", 8);
    refused(Chunk { tile: 1, ..Chunk::new(b"META", 2, payload.clone()) }, "§4.4", 12);
    refused(Chunk::new(b"note", 0, vec![]), "§4.6", 24);
    refused(Chunk { raw_len: 4, ..Chunk::new(b"note", 0, payload.clone()) }, "§4.7", 32);
    refused(Chunk { tile: 1, ..Chunk::new(b"TILE", 1, payload) }, "§4.10", 0);
    assert_breaks(&with_byte(FIRST_ENTRY + 7, 1), "§4.9", FIRST_ENTRY + 7);
}

#[test]
fn duplicates() {
    let mut file = File::with(Chunk::new(b"note", 0, vec![1]));
    file.chunks.push(Chunk::new(b"note", 0, vec![2]));
    assert_breaks(&file.to_bytes(), "§4.4", 208);
    let second_tile = File::with(Chunk::new(b"TILE", 1, vec![1, 2, 3]));
    assert_breaks(&second_tile.to_bytes(), "§4.4", THIRD_ENTRY);
}

#[test]
fn placement() {
    // The second chunk's offset, one alignment too far.
    assert_breaks(&with_byte(SECOND_ENTRY + 16, 128), "§4.5", SECOND_ENTRY + 16);
    // A hole is not zero.
    assert_breaks(&with_byte(319, 1), "§4.5", 319);
    // A declared chunk reaches past the end of the file.
    let mut file = File::smallest().to_bytes();
    file[SECOND_ENTRY + 24] = 9;
    file[SECOND_ENTRY + 32] = 9;
    reseal(&mut file);
    assert_breaks(&file, "§4.6", SECOND_ENTRY + 24);
    // Padding after the last chunk.
    let mut file = File::smallest().to_bytes();
    file.resize(384, 0);
    file[16..24].copy_from_slice(&384u64.to_le_bytes());
    reseal(&mut file);
    assert_breaks(&file, "§4.5", 328);
}

#[test]
fn order_and_presence() {
    let mut file = File::smallest();
    file.chunks.swap(0, 1);
    assert_breaks(&file.to_bytes(), "§4.10", FIRST_ENTRY);
    let no_chunks = File { chunks: vec![], ..File::smallest() };
    assert_breaks(&no_chunks.to_bytes(), "§4.10", FIRST_ENTRY);
    let mut no_tile = File::smallest();
    no_tile.chunks.pop();
    assert_breaks(&no_tile.to_bytes(), "§4.10", SECOND_ENTRY);
    let mut one_more = File::smallest();
    one_more.chunks.push(Chunk { tile: 1, ..one_more.chunks[1].clone() });
    assert_breaks(&one_more.to_bytes(), "§4.10", THIRD_ENTRY);
}

#[test]
fn raw_length_follows_from_the_geometry() {
    let mut file = File::smallest();
    file.chunks[1] = Chunk { packing: 1, raw_len: 16, ..Chunk::new(b"TILE", 1, vec![1, 2, 3]) };
    assert_breaks(&file.to_bytes(), "§4.7", SECOND_ENTRY + 32);
    file.chunks[1].raw_len = 8;
    let bytes = file.to_bytes();
    let tile = parse(&bytes).unwrap().tile(0, 0).unwrap();
    assert_eq!((tile.packing, tile.bytes, tile.raw_len), (Packing::Zstd, &[1u8, 2, 3][..], 8));
}

#[test]
fn geometry_fields() {
    let nan = f32::NAN.to_le_bytes();
    let negative_zero = (-0.0f32).to_le_bytes();
    let refused = |at, bytes: &[u8], clause| assert_breaks(&with_geometry(at, bytes), clause, GEOM + at);
    assert_breaks(&with_geometry(16, &f64::INFINITY.to_le_bytes()), "§5.1", GEOM);
    assert_breaks(&with_geometry(24, &negative_zero), "§5.1", GEOM);
    refused(36, &[0], "§5.2");
    refused(36, &[7], "§5.2");
    assert_breaks(&with_geometry(36, &[2]), "§5", GEOM + 108);
    refused(40, &[6], "§5.3");
    assert_unsupported(&with_geometry(41, &[0]), "§5.4", GEOM + 41);
    assert_unsupported(&with_geometry(42, &[1]), "§5.5", GEOM + 42);
    refused(43, &[1], "§5.10");
    refused(44, &nan, "§5.6");
    for axis in [48, 60, 72, 84] {
        let refused = |at, bytes: &[u8]| assert_breaks(&with_geometry(axis + at, bytes), "§5.7", GEOM + axis);
        refused(0, &nan);
        refused(4, &negative_zero);
        refused(8, &[0; 4]);
        refused(8, &((1u32 << 24) + 1).to_le_bytes());
    }
    refused(96, &negative_zero, "§5.8");
    refused(96, &(-1.0f32).to_le_bytes(), "§5.8");
    refused(100, &[0; 4], "§5.9");
    assert_breaks(&with_geometry(104, &[0xFF; 4]), "§5.9", GEOM + 100);
    let mut long = File::smallest();
    long.chunks[0] = Chunk::new(b"GEOM", 1, [&long.chunks[0].payload[..], &[0]].concat());
    assert_breaks(&long.to_bytes(), "§5", GEOM + 108);
}

/// Limits that no geometry exceeds.
fn no_limits() -> Limits {
    let mut limits = Limits::default();
    limits.max_axis_count = u32::MAX;
    limits.max_raw_bytes = u64::MAX;
    limits
}

#[test]
fn axes_have_at_most_two_to_the_24_samples() {
    let with_u_count = |count: u32| {
        let mut file = File::smallest();
        file.chunks[0].payload[80..84].copy_from_slice(&count.to_le_bytes());
        file.chunks[1] = Chunk { packing: 1, raw_len: u64::from(count.div_ceil(4)) * 8, ..file.chunks[1].clone() };
        file.to_bytes()
    };
    let most = with_u_count(1 << 24);
    let read = Container::parse(&most, &no_limits()).unwrap();
    assert_eq!(read.tilings()[0].resolution(), [1 << 24, 4]);
    assert_breaks(&with_u_count((1 << 24) + 1), "§5.7", GEOM + 72);
}

/// §5.7: first + (count − 1)·step, the product rounded before the sum.
#[test]
fn the_last_sample_is_finite_in_binary32() {
    let with_axis = |first: f32, step: f32, count: u32| {
        let mut file = File::smallest();
        let axis = [first.to_le_bytes(), step.to_le_bytes(), count.to_le_bytes()].concat();
        file.chunks[0].payload[72..84].copy_from_slice(&axis);
        file.to_bytes()
    };
    parse(&with_axis(0.0, 1e38, 4)).unwrap();
    assert_breaks(&with_axis(0.0, 1e38, 5), "§5.7", GEOM + 72);
    assert_breaks(&with_axis(3e38, 1e38, 2), "§5.7", GEOM + 72);
    // The exact sum is 1e38, but the product overflows.
    assert_breaks(&with_axis(-3e38, 1e38, 5), "§5.7", GEOM + 72);
}

#[test]
fn a_focal_plane_so_near_that_the_disparity_overflows_is_refused() {
    // Steps are 1 along s and t, 0.5 along u and v.
    parse(&with_geometry(96, &1e-38f32.to_le_bytes())).unwrap();
    for depth in [4e-39, f32::from_bits(1)] {
        assert_breaks(&with_geometry(96, &depth.to_le_bytes()), "§5.8", GEOM + 96);
    }
}

#[test]
fn slabs_are_in_the_order_of_their_faces() {
    for faces in [[4, 4], [4, 1]] {
        let mut geometry = File::smallest().chunks[0].payload.clone();
        let slab = geometry[40..].to_vec();
        geometry.extend(slab);
        geometry[36] = 2;
        (geometry[40], geometry[108]) = (faces[0], faces[1]);
        let mut file = File::smallest();
        file.chunks[0] = Chunk::new(b"GEOM", 1, geometry);
        assert_breaks(&file.to_bytes(), "§5.3", GEOM + 108);
    }
}

#[test]
fn a_focal_depth_of_zero_is_none() {
    let bytes = with_geometry(96, &2.5f32.to_le_bytes());
    assert_eq!(parse(&bytes).unwrap().geometry().slabs()[0].focal_depth(), Some(2.5));
    let bytes = File::smallest().to_bytes();
    assert_eq!(parse(&bytes).unwrap().geometry().slabs()[0].focal_depth(), None);
}

/// A metadata chunk of raw keys and values.
fn metadata(pairs: &[(&[u8], &[u8])]) -> Vec<u8> {
    let mut payload = (pairs.len() as u32).to_le_bytes().to_vec();
    for (key, value) in pairs {
        payload.extend((key.len() as u16).to_le_bytes());
        payload.extend((value.len() as u32).to_le_bytes());
        payload.extend(*key);
        payload.extend(*value);
    }
    File::with(Chunk::new(b"META", 2, payload)).to_bytes()
}

#[test]
fn metadata_fields() {
    let bytes = metadata(&[(b"a", b""), (b"b", "§".as_bytes())]);
    assert_eq!(parse(&bytes).unwrap().metadata().get("b"), Some("§"));
    assert_breaks(&metadata(&[]), "§6.1", SECOND_OF_THREE);
    let (key_at, value_at) = (SECOND_OF_THREE + 10, SECOND_OF_THREE + 11);
    assert_breaks(&metadata(&[(b"b", b""), (b"a", b"")]), "§6.2", value_at);
    assert_breaks(&metadata(&[(b"a", b""), (b"a", b"")]), "§6.2", value_at);
    for key in [&b""[..], b"A", b"a b", &[b'a'; 65], b"\xFF"] {
        assert_breaks(&metadata(&[(key, b"")]), "§6.3", key_at);
    }
    for value in [&b"\xFF"[..], &[b'x'; (64 << 10) + 1]] {
        assert_breaks(&metadata(&[(b"a", value)]), "§6.4", value_at);
    }
    for count in [2u32, u32::MAX] {
        let payload = [&count.to_le_bytes()[..], &[1, 0, 0, 0, 0, 0, b'a']].concat();
        assert_breaks(&File::with(Chunk::new(b"META", 2, payload)).to_bytes(), "§6", value_at);
    }
    let overlong = [&1u32.to_le_bytes()[..], &[1, 0, 0xFF, 0xFF, 0xFF, 0xFF, b'a']].concat();
    assert_breaks(&File::with(Chunk::new(b"META", 2, overlong)).to_bytes(), "§6", value_at);
}

#[test]
fn metadata_values_have_no_control_characters_but_tab_and_line_feed() {
    for byte in 0..=0x7F {
        let value = format!("a{}", char::from(byte));
        let (bytes, inserted) = (metadata(&[(b"a", value.as_bytes())]), Metadata::new().insert("a", value.as_str()));
        if matches!(byte, b'\t' | b'\n' | b' '..=b'~') {
            assert_eq!(parse(&bytes).unwrap().metadata().get("a"), Some(value.as_str()));
            inserted.unwrap();
        } else {
            assert_breaks(&bytes, "§6.4", SECOND_OF_THREE + 11);
            assert_argument(&inserted);
        }
    }
}

#[track_caller]
fn assert_argument<T>(result: &Result<T, FormatError>) {
    assert!(matches!(result, Err(FormatError::InvalidArgument { .. })));
}

#[test]
fn the_writer_refuses_what_a_reader_would() {
    let bytes = File::smallest().to_bytes();
    let file = parse(&bytes).unwrap();
    let (geometry, slab) = (file.geometry(), file.geometry().slabs()[0]);
    let tiling = file.tilings()[0];
    assert_argument(&SlabTiling::new(&slab, TexelEncoding::Bc1, [0, 1]));
    assert_argument(&SlabTiling::new(&slab, TexelEncoding::Bc1, [u32::MAX, 1]));
    assert_argument(&Writer::new(geometry.clone(), vec![], Metadata::new()));
    let wider = lf_math::SampledAxis::new(0.0, 1.0, 9).unwrap();
    let other = lf_math::Slab::new(slab.face(), 0.5, slab.st(), [wider; 2], None).unwrap();
    let wrong = SlabTiling::new(&other, TexelEncoding::Bc1, [1, 1]).unwrap();
    assert_argument(&Writer::new(geometry.clone(), vec![wrong], Metadata::new()));
    // One tile of the same size, but of four cameras where there is one.
    let two = lf_math::SampledAxis::new(0.0, 1.0, 2).unwrap();
    let other = lf_math::Slab::new(slab.face(), 0.5, [two; 2], slab.uv(), None).unwrap();
    let wrong = SlabTiling::new(&other, TexelEncoding::Bc1, [2, 2]).unwrap();
    assert_argument(&Writer::new(geometry.clone(), vec![wrong], Metadata::new()));

    let mut writer = Writer::new(geometry.clone(), vec![tiling], Metadata::new()).unwrap();
    assert_argument(&writer.to_bytes());
    assert_argument(&writer.add_tile(1, 0, Packing::None, vec![0; 8]));
    assert_argument(&writer.add_tile(0, 1, Packing::None, vec![0; 8]));
    assert_argument(&writer.add_tile(0, 0, Packing::None, vec![0; 7]));
    assert_argument(&writer.add_tile(0, 0, Packing::Zstd, vec![]));
    for id in [0, 1, 2] {
        assert_argument(&writer.add_tile(0, 0, Packing::Unknown(id), vec![0; 8]));
    }
    assert_argument(&smallest_writer().add_tile(0, 0, Packing::None, vec![0; 8]));
    assert_argument(&Metadata::new().insert("Key", "value"));
    assert_argument(&Metadata::new().insert("key", "a\0b"));
}

#[test]
fn the_writer_keeps_to_the_default_limits() {
    let bytes = File::smallest().to_bytes();
    let geometry = parse(&bytes).unwrap().geometry().clone();
    let huge = SlabTiling::new(&geometry.slabs()[0], TexelEncoding::Rgba8, [1 << 15, 1 << 15]).unwrap();
    let error = Writer::new(geometry, vec![huge], Metadata::new()).unwrap_err();
    assert!(matches!(error, FormatError::LimitExceeded { .. }), "{error}");
}

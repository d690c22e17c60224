//! Damaged, foreign and hostile files.

use lf_format::{ChunkEntry, Container, FormatError, Limits, Metadata, Packing, SlabTiling, TexelEncoding, Writer};
use lf_math::{Cell, LightFieldGeometry, PlanePlacement};
use proptest::prelude::*;

use crate::assemble::{Chunk, File, assert_breaks, parse, refusal, reseal};

/// A file with every kind of chunk and of padding, one of a kind that no reader knows among them, a few kilobytes long.
fn small_file() -> Vec<u8> {
    let bytes = written_file();
    let read = parse(&bytes).unwrap();
    let mut chunks: Vec<Chunk> = read.chunks().map(|entry| chunk(&bytes, entry)).collect();
    chunks.insert(2, Chunk { packing: 9, slab: 5, raw_len: 4, ..Chunk::new(b"note", 2, vec![1; 70]) });
    File { version: read.version(), chunks }.to_bytes()
}

/// A chunk of a file as the assembler wants it.
fn chunk(file: &[u8], entry: &ChunkEntry) -> Chunk {
    let payload = file[entry.offset as usize..][..entry.stored_len as usize].to_vec();
    let flags = u16::from(entry.critical) + 2 * u16::from(entry.safe_to_copy);
    let packing = u8::from(entry.packing == Packing::Zstd);
    let (slab, tile, raw_len) = (entry.slab, entry.tile, entry.raw_len);
    Chunk { packing, slab, tile, raw_len, ..Chunk::new(&entry.tag.bytes(), flags, payload) }
}

/// Two slabs in both encodings, raw and packed tiles, and metadata.
fn written_file() -> Vec<u8> {
    let cell = Cell::cube(glam::DVec3::new(1.0, 2.0, 3.0), 1.0).unwrap();
    let field = LightFieldGeometry::around(cell, PlanePlacement::CellFaces, 2, 3).unwrap();
    let field = LightFieldGeometry::new(cell, field.slabs()[2..4].to_vec()).unwrap();
    let tilings = [TexelEncoding::Bc1, TexelEncoding::Rgba8];
    let tilings = field.slabs().iter().zip(tilings).map(|(slab, e)| SlabTiling::new(slab, e, [2, 1]).unwrap());
    let tilings: Vec<_> = tilings.collect();
    let mut metadata = Metadata::new();
    metadata.insert("scene", "two slabs").unwrap();
    let mut writer = Writer::new(field, tilings.clone(), metadata).unwrap();
    for (slab, tiling) in tilings.iter().enumerate() {
        writer.add_tile(slab, 0, Packing::None, vec![7; tiling.raw_len() as usize]).unwrap();
        writer.add_tile(slab, 1, Packing::Zstd, vec![1, 2, 3]).unwrap();
    }
    writer.to_bytes().unwrap()
}

#[test]
fn every_truncation_is_refused() {
    let file = small_file();
    parse(&file).unwrap();
    for len in 0..file.len() {
        let message = refusal(&file[..len]).to_string();
        if len >= 64 {
            assert!(message.contains(&format!("it has {len} bytes, should have {}", file.len())), "{message}");
        }
    }
}

#[test]
fn every_flipped_bit_is_refused() {
    let mut file = small_file();
    for bit in 0..8 * file.len() {
        file[bit / 8] ^= 1 << (bit % 8);
        assert!(parse(&file).is_err(), "bit {} of byte {}", bit % 8, bit / 8);
        file[bit / 8] ^= 1 << (bit % 8);
    }
}

#[test]
fn bytes_after_the_end_are_refused() {
    let mut file = small_file();
    file.push(0);
    assert_breaks(&file, "§3.3", file.len() - 1);
}

#[test]
fn foreign_files_are_named() {
    let files: [&[u8]; 5] = [
        b"",
        b"\x89PNG\r\n\x1A\n\0\0\0\rIHDR",
        b"Some text, longer than a magic.",
        b"\x89LFP\r\n\x1A\n\0\0\0\x01",
        &[0; 4096],
    ];
    for file in files {
        let error = refusal(file);
        assert!(matches!(error, FormatError::NotLfslab { .. }), "{error}");
        assert!(error.to_string().starts_with("not an .lfslab file"), "{error}");
    }
}

#[test]
fn text_mode_damage_is_recognised() {
    let good = File::smallest().to_bytes();
    let rest = &good[12..];
    let starts: [&[u8]; 6] = [
        b"\x8ALFSLAB\0\n\x1A\n",           // CR LF became LF
        b"\x8ALFSLAB\0\r\r\n\x1A\r\n",     // LF became CR LF
        b"\x8ALFSLAB\0\r\r\x1A\r",         // LF became CR
        b"\x0ALFSLAB\0\r\n\x1A\n",         // the eighth bit was cleared
        b"\xC2\x8ALFSLAB\0\r\n\x1A\n",     // taken for Latin-1, became UTF-8
        b"\xEF\xBF\xBDLFSLAB\0\r\n\x1A\n", // taken for broken UTF-8
    ];
    for start in starts {
        let file = [start, rest].concat();
        assert_breaks(&file, "§3.1", 0);
        assert!(refusal(&file).to_string().contains("text mode"));
    }
    // Cut off at the end-of-file character.
    assert_breaks(&good[..10], "§3.3", 10);
}

#[test]
fn a_checksum_error_names_the_chunk_and_its_bytes() {
    let mut file = File::smallest().to_bytes();
    let last = file.len() - 1;
    file[last] ^= 1;
    let message = refusal(&file).to_string();
    assert!(message.contains("chunk TILE (slab 0, tile 0) bytes 320..328") && message.contains("§4.8"), "{message}");
}

/// Numbers at which sums and products overflow.
const EXTREMES: [u64; 9] =
    [0, u32::MAX as u64, 1 << 32, (1 << 63) - 1, 1 << 63, u64::MAX - 64, u64::MAX - 63, u64::MAX - 1, u64::MAX];

/// Sets `len` bytes at `at` to a number, with right checksums.
fn patched(at: usize, len: usize, value: u64) -> Vec<u8> {
    let mut file = File::smallest().to_bytes();
    file[at..at + len].copy_from_slice(&value.to_le_bytes()[..len]);
    reseal(&mut file);
    file
}

#[test]
fn extreme_lengths_in_header_and_directory_are_refused() {
    for value in EXTREMES {
        for at in [16, 24] {
            refusal(&patched(at, 8, value));
        }
        refusal(&patched(32, 4, value));
        for entry in [64, 112] {
            for field in [16, 24, 32] {
                refusal(&patched(entry + field, 8, value));
            }
        }
    }
}

#[test]
fn extreme_counts_in_the_geometry_are_refused() {
    let counts = [0, 5, 1 << 16, 1 << 30, u32::MAX - 3, u32::MAX - 1, u32::MAX];
    for value in counts {
        // Slab count, s, t, u, v counts, cameras per tile.
        for at in [36, 56, 68, 80, 92, 100, 104] {
            let mut file = File::smallest();
            file.chunks[0].payload[at..at + 4].copy_from_slice(&value.to_le_bytes());
            refusal(&file.to_bytes());
        }
    }
}

/// A value is accepted at its limit, and refused with its name and size above it.
#[track_caller]
fn assert_limit(file: &[u8], name: &str, value: u64, set: impl Fn(&mut Limits, u64)) {
    let parse_with = |limit| {
        let mut limits = Limits::default();
        set(&mut limits, limit);
        Container::parse(file, &limits)
    };
    parse_with(value).unwrap();
    match parse_with(value - 1).unwrap_err() {
        FormatError::LimitExceeded { what, value: found, limit } => {
            assert_eq!((what, found, limit), (name, value, value - 1));
        }
        other => panic!("expected the limit on the {name}, got: {other}"),
    }
}

#[test]
fn limits_are_kept() {
    let file = small_file();
    assert_limit(&file, "file length", file.len() as u64, |limits, n| limits.max_file_bytes = n);
    assert_limit(&file, "number of chunks", 7, |limits, n| limits.max_entries = n as u32);
    // The number of entries, two lengths, `scene` and `two slabs`.
    assert_limit(&file, "length of the metadata", 4 + 6 + 5 + 9, |limits, n| limits.max_metadata_bytes = n);
    // Two tiles of 8×4 texels in BC1, two in RGBA8.
    let raw = 2 * 16 + 2 * 128;
    assert_limit(&file, "unpacked length of all tiles", raw, |limits, n| limits.max_raw_bytes = n);
    assert_limit(&file, "number of samples along an axis", 3, |limits, n| limits.max_axis_count = n as u32);
}

#[test]
fn the_limit_on_axes_holds_for_cameras_of_a_tile() {
    for at in [100, 104] {
        let mut file = File::smallest();
        file.chunks[0].payload[at] = 5;
        file.chunks[1] = Chunk::new(b"TILE", 1, vec![0; 5 * 8]);
        let name = "number of cameras along a tile";
        assert_limit(&file.to_bytes(), name, 5, |limits, n| limits.max_axis_count = n as u32);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Any change of the geometry chunk is either refused or gives a geometry that writes the same bytes again.
    #[test]
    fn resealed_geometry_is_refused_or_sound(at in 0usize..108, byte in any::<u8>()) {
        let mut file = File::smallest();
        file.chunks[0].payload[at] = byte;
        let bytes = file.to_bytes();
        if let Ok(read) = parse(&bytes) {
            let mut writer = Writer::new(read.geometry().clone(), read.tilings().to_vec(), Metadata::new()).unwrap();
            writer.add_tile(0, 0, Packing::None, read.tile(0, 0).unwrap().bytes.to_vec()).unwrap();
            prop_assert_eq!(writer.to_bytes().unwrap(), bytes);
        }
    }

    /// Several random changes with right checksums, anywhere in header or directory, never panic.
    #[test]
    fn resealed_noise_never_panics(changes in proptest::collection::vec((12usize..160, any::<u8>()), 1..6)) {
        let mut file = File::smallest().to_bytes();
        for (at, byte) in changes {
            file[at] = byte;
        }
        reseal(&mut file);
        let _ = parse(&file);
    }

    #[test]
    fn noise_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(parse(&bytes).is_err());
    }
}

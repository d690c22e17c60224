//! The rules of clause 4.

use lf_format::{Packing, Rule};

use crate::assemble::{Chunk, File, entry_at, patched, reseal};
use crate::layout::{Field, RED, Slab, smallest};
use crate::readers::{assert_breaks, assert_damaged, assert_unsupported, parse, sound};

/// Where the padding between the two payloads of the smallest file begins and ends.
const PADDING: [usize; 2] = [300, 320];

/// The smallest file with a chunk of a kind that no reader knows at its end.
fn with_unknown(chunk: Chunk) -> Vec<u8> {
    smallest().with(2, chunk).to_bytes()
}

/// The smallest file with a chunk after `GEOM`.
fn with_second(chunk: Chunk) -> Vec<u8> {
    smallest().with(1, chunk).to_bytes()
}

#[test]
fn unknown_chunks() {
    assert_unsupported(&with_unknown(Chunk::new(b"zzzz", 1, vec![1])), Rule::Critical, entry_at(2) + 4);
    for flags in [0, 2] {
        let bytes = with_unknown(Chunk { slab: 9, tile: 9, ..Chunk::new(b"note", flags, vec![1, 2, 3]) });
        let file = sound(&bytes);
        let chunk = &file.chunks()[2];
        assert_eq!((chunk.tag.to_string().as_str(), chunk.slab, chunk.stored_len), ("note", 9, 3));
        assert_eq!((chunk.critical, chunk.safe_to_copy), (false, flags == 2));
        assert_eq!(file.tile(0, 0).unwrap().bytes, RED);
    }
}

#[test]
fn unknown_packings() {
    // Skipped with the chunk if its kind is not known either; nothing ties its lengths together.
    for flags in [0, 2] {
        let bytes = with_unknown(Chunk { packing: 9, raw_len: 100, ..Chunk::new(b"note", flags, vec![1]) });
        let file = sound(&bytes);
        let chunk = &file.chunks()[2];
        assert_eq!((chunk.packing, chunk.stored_len, chunk.raw_len), (Packing::Unknown(9), 1, 100));
    }
    let critical = Chunk { packing: 9, ..Chunk::new(b"zzzz", 1, vec![1]) };
    assert_unsupported(&with_unknown(critical), Rule::Critical, entry_at(2) + 4);
    for (tag, flags) in [(b"TILE", 1), (b"META", 2), (b"CROP", 1), (b"MASK", 1)] {
        for packing in [3, 255] {
            let chunk = Chunk { packing, ..Chunk::new(tag, flags, vec![1]) };
            assert_unsupported(&with_second(chunk), Rule::Packing, entry_at(1) + 6);
        }
    }
    assert_unsupported(&patched(&smallest(), entry_at(0) + 6, &[3]), Rule::Packing, entry_at(0) + 6);
}

#[test]
fn only_tiles_are_packed() {
    for (tag, flags) in [(b"META", 2), (b"CROP", 1), (b"MASK", 1)] {
        for packing in [1, 2] {
            let chunk = Chunk { packing, ..Chunk::new(tag, flags, vec![1]) };
            assert_breaks(&with_second(chunk), Rule::Packing, entry_at(1) + 6);
        }
    }
    assert_breaks(&patched(&smallest(), entry_at(0) + 6, &[1]), Rule::Packing, entry_at(0) + 6);
}

#[test]
fn the_tile_codec_is_for_bc1_only() {
    let packed =
        |encoding| Field::new(vec![Slab { encoding, ..Slab::smallest() }]).file(|_, _| (2, vec![1, 2, 3])).to_bytes();
    let bytes = packed(1);
    let tile = sound(&bytes).tile(0, 0).unwrap();
    assert_eq!((tile.packing, tile.bytes, tile.raw_len), (Packing::Tile, &[1u8, 2, 3][..], 8));
    for encoding in [2, 3] {
        assert_breaks(&packed(encoding), Rule::Packing, entry_at(1) + 6);
    }
}

#[test]
fn tags_and_flags() {
    for tag in [b"no e", b"n\0te", b"not\xE9", b"n_te"] {
        assert_breaks(&with_unknown(Chunk::new(tag, 0, vec![1])), Rule::Tag, entry_at(2));
    }
    for flags in [3, 4, 0x8000, 0x8001] {
        assert_breaks(&with_unknown(Chunk::new(b"note", flags, vec![1])), Rule::Flags, entry_at(2) + 4);
    }
    for (tag, wrong) in [(b"META", [0, 1, 3]), (b"CROP", [0, 2, 3]), (b"MASK", [0, 2, 3]), (b"TILE", [0, 2, 3])] {
        for flags in wrong {
            assert_breaks(&with_second(Chunk::new(tag, flags, vec![1])), Rule::Flags, entry_at(1) + 4);
        }
    }
    for flags in [0, 2, 3] {
        assert_breaks(&patched(&smallest(), entry_at(0) + 4, &[flags]), Rule::Flags, entry_at(0) + 4);
    }
}

#[test]
fn subjects() {
    for (tag, flags) in [(b"META", 2), (b"CROP", 1), (b"MASK", 1)] {
        let chunk = Chunk { tile: 1, ..Chunk::new(tag, flags, vec![1]) };
        assert_breaks(&with_second(chunk), Rule::Subject, entry_at(1) + 12);
    }
    for (tag, flags) in [(b"META", 2), (b"CROP", 1), (b"MASK", 1), (b"TILE", 1)] {
        let chunk = Chunk { slab: 1, ..Chunk::new(tag, flags, vec![1]) };
        let after_tiles = usize::from(tag == b"TILE");
        let file = smallest().with(1 + after_tiles, chunk).to_bytes();
        assert_breaks(&file, Rule::Subject, entry_at(1 + after_tiles) + 8);
    }
    for field in [8, 12] {
        assert_breaks(&patched(&smallest(), entry_at(0) + field, &[1]), Rule::Subject, entry_at(0) + field);
    }
}

#[test]
fn lengths_and_reserved_bytes() {
    assert_breaks(&with_unknown(Chunk::new(b"note", 0, vec![])), Rule::StoredLength, entry_at(2) + 24);
    let longer = Chunk { raw_len: 4, ..Chunk::new(b"note", 0, vec![1; 3]) };
    assert_breaks(&with_unknown(longer), Rule::RawLength, entry_at(2) + 32);
    for index in [0, 1] {
        let at = entry_at(index) + 7;
        assert_breaks(&patched(&smallest(), at, &[1]), Rule::EntryReserved, at);
    }
}

#[test]
fn payloads_follow_each_other() {
    let tile = entry_at(1);
    // An alignment too far, too near (on top of the payload before), and between alignments.
    for offset in [384u64, 256, 192, 0, 321, 328] {
        assert_breaks(&patched(&smallest(), tile + 16, &offset.to_le_bytes()), Rule::Offset, tile + 16);
    }
    assert_breaks(&patched(&smallest(), entry_at(0) + 16, &[0, 1]), Rule::Offset, entry_at(0) + 16);
    // Reaches past the end of the file.
    let mut file = smallest().to_bytes();
    (file[tile + 24], file[tile + 32]) = (9, 9);
    reseal(&mut file);
    assert_breaks(&file, Rule::StoredLength, tile + 24);
    // Padding after the last chunk.
    let mut file = smallest().to_bytes();
    file.resize(384, 0);
    file[16..24].copy_from_slice(&384u64.to_le_bytes());
    reseal(&mut file);
    assert_breaks(&file, Rule::Tail, 328);
}

#[test]
fn padding_is_zero() {
    for at in (160..192).chain(PADDING[0]..PADDING[1]) {
        assert_damaged(&patched(&smallest(), at, &[1]), Rule::Padding, at);
    }
}

#[test]
fn checksums_of_chunks() {
    let flipped = |file: &File, at: usize| {
        let mut bytes = file.to_bytes();
        bytes[at] ^= 1;
        bytes
    };
    let tile = flipped(&smallest(), 320);
    assert_damaged(&tile, Rule::Checksum, entry_at(1) + 40);
    let error = parse(&tile).tile(0, 0).unwrap_err();
    assert_eq!(error.broken_rule(), Some((Rule::Checksum, entry_at(1) as u64 + 40)));
    let message = error.to_string();
    assert!(message.contains("chunk TILE (slab 0, tile 0) bytes 320..328") && message.contains("§4.8"), "{message}");
    assert_breaks(&flipped(&smallest(), 192), Rule::Checksum, entry_at(0) + 40);
    let noted = smallest().with(2, Chunk::new(b"note", 2, vec![1]));
    assert_damaged(&flipped(&noted, 448), Rule::Checksum, entry_at(2) + 40);
    // What is stored of a chunk is not the chunk alone, but also what it is.
    let renamed = patched(&noted, entry_at(2), b"none");
    assert_damaged(&renamed, Rule::Checksum, entry_at(2) + 40);
}

#[test]
fn verifying_reports_everything() {
    let mut bytes = smallest().to_bytes();
    for at in [170, 310, 327] {
        bytes[at] ^= 1;
    }
    let mut rules = Vec::new();
    parse(&bytes).verify(|error| rules.push(error.broken_rule().unwrap()));
    assert_eq!(rules, [(Rule::Padding, 170), (Rule::Padding, 310)], "a chunk is as far as one error goes");
    bytes[310] ^= 1;
    rules.clear();
    parse(&bytes).verify(|error| rules.push(error.broken_rule().unwrap()));
    assert_eq!(rules, [(Rule::Padding, 170), (Rule::Checksum, entry_at(1) as u64 + 40)]);
}

#[test]
fn order_and_presence() {
    let mut swapped = smallest();
    swapped.chunks.swap(0, 1);
    assert_breaks(&swapped.to_bytes(), Rule::Order, entry_at(0));
    let without_tile = smallest().with(2, Chunk::new(b"note", 0, vec![1]));
    let without_tile =
        File { chunks: [without_tile.chunks[0].clone(), without_tile.chunks[2].clone()].to_vec(), ..without_tile };
    assert_breaks(&without_tile.to_bytes(), Rule::Order, entry_at(1));
    let mut one_more = smallest();
    one_more.chunks.push(Chunk { tile: 1, ..one_more.chunks[1].clone() });
    assert_breaks(&one_more.to_bytes(), Rule::Order, entry_at(2));
}

#[test]
fn nothing_occurs_twice() {
    for index in [0, 1] {
        let twice = smallest().with(index, smallest().chunks[index].clone());
        assert_breaks(&twice.to_bytes(), Rule::Order, entry_at(index + 1));
    }
    let note = |byte| Chunk::new(b"note", 0, vec![byte]);
    assert_breaks(&smallest().with(2, note(1)).with(3, note(2)).to_bytes(), Rule::Order, entry_at(3));
    sound(&smallest().with(2, note(1)).with(3, Chunk { tile: 1, ..note(2) }).to_bytes());
}

/// Every pair of neighbours in the directory of a file with all kinds of chunks stands in the only order there is.
#[test]
fn any_two_chunks_that_change_places_are_refused() {
    let file = crate::damage::full_file();
    sound(&file.to_bytes());
    for index in 0..file.chunks.len() - 1 {
        let mut swapped = file.clone();
        swapped.chunks.swap(index, index + 1);
        let bytes = swapped.to_bytes();
        let later = if index == 0 { 0 } else { index + 1 };
        assert_breaks(&bytes, Rule::Order, entry_at(later));
    }
}

#[test]
fn any_tile_that_is_missing_is_missed() {
    let file = crate::damage::full_file();
    for index in 0..file.chunks.len() {
        if &file.chunks[index].tag == b"TILE" {
            let mut without = file.clone();
            without.chunks.remove(index);
            assert_breaks(&without.to_bytes(), Rule::Order, entry_at(index));
        }
    }
}

#[test]
fn raw_length_follows_from_the_geometry() {
    let mut file = smallest();
    file.chunks[1] = Chunk { packing: 1, raw_len: 16, ..Chunk::new(b"TILE", 1, vec![1, 2, 3]) };
    assert_breaks(&file.to_bytes(), Rule::RawLength, entry_at(1) + 32);
    file.chunks[1] = Chunk::new(b"TILE", 1, vec![0; 16]);
    assert_breaks(&file.to_bytes(), Rule::RawLength, entry_at(1) + 32);
    file.chunks[1] = Chunk { packing: 1, raw_len: 8, ..Chunk::new(b"TILE", 1, vec![1, 2, 3]) };
    let bytes = file.to_bytes();
    let tile = sound(&bytes).tile(0, 0).unwrap();
    assert_eq!((tile.packing, tile.bytes, tile.raw_len), (Packing::Zstd, &[1u8, 2, 3][..], 8));
}

#[test]
fn there_is_no_tile_but_those_of_the_file() {
    let bytes = smallest().to_bytes();
    let file = parse(&bytes);
    assert_eq!(file.tile_chunk(0, 0), Some(1));
    for (slab, tile) in [(0, 1), (1, 0), (usize::MAX, 0), (0, u32::MAX)] {
        assert_eq!(file.tile_chunk(slab, tile), None);
        assert_eq!(file.tile(slab, tile).unwrap_err().id(), "argument");
    }
}

#[test]
fn chunks_name_themselves() {
    let bytes = crate::damage::full_file().to_bytes();
    let listed: Vec<String> = parse(&bytes).chunks().iter().map(ToString::to_string).collect();
    let expected =
        ["chunk GEOM", "chunk META", "chunk CROP (slab 1)", "chunk MASK (slab 0)", "chunk TILE (slab 0, tile 0)"];
    assert_eq!(listed[..5], expected);
}

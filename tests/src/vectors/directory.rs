//! Files that break a rule of clause 4.

use super::packed::{cropped, masked, scene, uneven};
use super::{Vector, damaged, malformed, unsupported};
use crate::assemble::{Chunk, File, entry_at, patched, reseal};
use crate::layout::{Field, RED, Slab, smallest};

pub(crate) fn vectors() -> Vec<Vector> {
    [tags_and_flags(), packings(), subjects(), places(), lengths(), checksums(), order()].concat()
}

fn note() -> Chunk {
    Chunk::new(b"note", 0, vec![1, 2, 3])
}

/// The smallest file with another chunk at its end.
fn ending(chunk: Chunk) -> Vec<u8> {
    smallest().with(2, chunk).to_bytes()
}

/// The smallest file with sound metadata, and a change to its chunk.
fn meta(change: impl FnOnce(&mut Chunk)) -> Vec<u8> {
    let metadata = vec![("scene".to_owned(), "nothing".to_owned())];
    let field = Field { metadata, ..Field::new(vec![Slab::smallest()]) };
    changed(field.file(|_, _| (0, RED.to_vec())), 1, change)
}

/// A file with a change to a chunk.
fn changed(mut file: File, chunk: usize, change: impl FnOnce(&mut Chunk)) -> Vec<u8> {
    change(&mut file.chunks[chunk]);
    file.to_bytes()
}

fn tags_and_flags() -> Vec<Vector> {
    let tagged = |tag| ending(Chunk::new(tag, 0, vec![1]));
    let flagged = |flags| ending(Chunk { flags, ..note() });
    vec![
        malformed("tag-space", "entry.tag", "§4.1", "a tag with a space", tagged(b"no e")),
        malformed("tag-not-ascii", "entry.tag", "§4.1", "a tag with a byte that is not ASCII", tagged(b"not\xE9")),
        malformed("flags-both", "entry.flags", "§4.2", "critical and safe to copy", flagged(3)),
        malformed("flags-undefined", "entry.flags", "§4.2", "a flag that there is not", flagged(4)),
        malformed(
            "flags-of-geom",
            "entry.flags",
            "§4.2",
            "GEOM is not critical",
            changed(smallest(), 0, |chunk| chunk.flags = 0),
        ),
        malformed(
            "flags-of-tile",
            "entry.flags",
            "§4.2",
            "TILE is safe to copy",
            changed(smallest(), 1, |chunk| chunk.flags = 2),
        ),
        malformed("flags-of-meta", "entry.flags", "§4.2", "META is critical", meta(|chunk| chunk.flags = 1)),
        malformed(
            "flags-of-crop",
            "entry.flags",
            "§4.2",
            "CROP is not critical",
            changed(scene(cropped(1), 0), 1, |chunk| chunk.flags = 0),
        ),
        malformed(
            "flags-of-mask",
            "entry.flags",
            "§4.2",
            "MASK is not critical",
            changed(scene(masked(1), 0), 1, |chunk| chunk.flags = 0),
        ),
        unsupported(
            "critical-unknown",
            "entry.critical",
            "§4.2",
            "a critical chunk of a tag that is not known",
            ending(Chunk::new(b"NEWC", 1, vec![1])),
        ),
    ]
}

fn packings() -> Vec<Vector> {
    let tile = |packing| changed(smallest(), 1, |chunk| chunk.packing = packing);
    let coded = |encoding| Field::new(vec![Slab { encoding, ..Slab::smallest() }]).file(|_, _| (2, vec![1])).to_bytes();
    vec![
        unsupported("packing-3", "entry.packing", "§4.3", "a tile in a packing that is not known", tile(3)),
        unsupported("packing-private", "entry.packing", "§4.3", "a tile in a private packing", tile(128)),
        malformed(
            "packed-geom",
            "entry.packing",
            "§4.3",
            "GEOM is packed",
            changed(smallest(), 0, |chunk| chunk.packing = 1),
        ),
        malformed("packed-meta", "entry.packing", "§4.3", "META is packed", meta(|chunk| chunk.packing = 1)),
        malformed(
            "packed-crop",
            "entry.packing",
            "§4.3",
            "CROP is packed",
            changed(scene(cropped(1), 0), 1, |chunk| chunk.packing = 1),
        ),
        malformed(
            "packed-mask",
            "entry.packing",
            "§4.3",
            "MASK is in the tile codec",
            changed(scene(masked(1), 0), 1, |chunk| chunk.packing = 2),
        ),
        malformed("tile-codec-rgba8", "entry.packing", "§4.3", "RGBA8 in the tile codec", coded(2)),
        malformed("tile-codec-rgb16f", "entry.packing", "§4.3", "RGB16F in the tile codec", coded(3)),
    ]
}

fn subjects() -> Vec<Vector> {
    let crop = |change: fn(&mut Chunk)| changed(scene(cropped(1), 0), 1, change);
    let mask = |change: fn(&mut Chunk)| changed(scene(masked(1), 0), 1, change);
    let stray = Chunk { slab: 1, ..smallest().chunks.remove(1) };
    vec![
        malformed(
            "geom-of-slab",
            "entry.subject",
            "§4.4",
            "GEOM names slab 1",
            changed(smallest(), 0, |chunk| chunk.slab = 1),
        ),
        malformed(
            "geom-of-tile",
            "entry.subject",
            "§4.4",
            "GEOM names tile 1",
            changed(smallest(), 0, |chunk| chunk.tile = 1),
        ),
        malformed("meta-of-slab", "entry.subject", "§4.4", "META names slab 1", meta(|chunk| chunk.slab = 1)),
        malformed("crop-of-tile", "entry.subject", "§4.4", "CROP names tile 1", crop(|chunk| chunk.tile = 1)),
        malformed(
            "crop-of-no-slab",
            "entry.subject",
            "§4.4",
            "CROP names a slab that there is not",
            crop(|chunk| chunk.slab = 1),
        ),
        malformed("mask-of-tile", "entry.subject", "§4.4", "MASK names tile 1", mask(|chunk| chunk.tile = 1)),
        malformed(
            "mask-of-no-slab",
            "entry.subject",
            "§4.4",
            "MASK names a slab that there is not",
            mask(|chunk| chunk.slab = 1),
        ),
        malformed("tile-of-no-slab", "entry.subject", "§4.4", "TILE names a slab that there is not", ending(stray)),
    ]
}

/// The smallest file with its tile elsewhere, the file as long as that needs.
fn tile_at(offset: usize) -> Vec<u8> {
    let mut file = smallest().to_bytes();
    file.truncate(320);
    file.resize(offset, 0);
    file.extend(RED);
    let len = file.len() as u64;
    file[16..24].copy_from_slice(&len.to_le_bytes());
    file[entry_at(1) + 16..][..8].copy_from_slice(&(offset as u64).to_le_bytes());
    reseal(&mut file);
    file
}

/// Two chunks that are not known on the same bytes.
fn overlapping() -> Vec<u8> {
    let file = smallest().with(2, note()).with(3, Chunk { tile: 1, ..note() });
    let (first, mut bytes) = (file.payload_at(2), file.to_bytes());
    bytes.truncate(first + 3);
    let len = bytes.len() as u64;
    bytes[16..24].copy_from_slice(&len.to_le_bytes());
    bytes[entry_at(3) + 16..][..8].copy_from_slice(&(first as u64).to_le_bytes());
    reseal(&mut bytes);
    bytes
}

fn places() -> Vec<Vector> {
    let padding = |at| {
        let mut file = smallest().to_bytes();
        file[at] = 1;
        file
    };
    vec![
        malformed("offset-hole", "entry.offset", "§4.5", "64 bytes more than needed before a payload", tile_at(384)),
        malformed("offset-unaligned", "entry.offset", "§4.5", "a payload right after the one before", tile_at(300)),
        malformed("offset-overlap", "entry.offset", "§4.5", "two chunks on the same bytes", overlapping()),
        malformed(
            "offset-overflow",
            "entry.offset",
            "§2.2 §4.5",
            "an offset of 2^64 − 64",
            patched(&smallest(), entry_at(1) + 16, &(u64::MAX - 63).to_le_bytes()),
        ),
        damaged(
            "padding-after-directory",
            "file.padding",
            "§4.5",
            "padding before the first payload is not zero",
            padding(191),
        ),
        damaged(
            "padding-between-payloads",
            "file.padding",
            "§4.5",
            "padding between payloads is not zero",
            padding(300),
        ),
    ]
}

/// The smallest file with other lengths of its tile, stored and raw alike.
fn tile_of_len(len: u64) -> Vec<u8> {
    patched(&smallest(), entry_at(1) + 24, &[len.to_le_bytes(); 2].concat())
}

fn lengths() -> Vec<Vector> {
    let geometry = Field::new(vec![Slab::smallest()]);
    let zstd = changed(geometry.file(|_, _| (1, super::frames::zstd(&RED))), 1, |chunk| chunk.raw_len = 16);
    vec![
        malformed(
            "stored-length-0",
            "entry.stored-length",
            "§4.6",
            "an empty chunk",
            ending(Chunk::new(b"note", 0, vec![])),
        ),
        malformed(
            "stored-length-beyond-file",
            "entry.stored-length",
            "§4.6",
            "a payload ends a byte after the file",
            tile_of_len(9),
        ),
        malformed(
            "stored-length-overflow",
            "entry.stored-length",
            "§2.2 §4.6",
            "offset and length together exceed 64 bits",
            tile_of_len(u64::MAX),
        ),
        malformed(
            "raw-length-not-packed",
            "entry.raw-length",
            "§4.7",
            "raw and stored length differ without packing",
            ending(Chunk { raw_len: 4, ..note() }),
        ),
        malformed(
            "raw-length-of-tile",
            "entry.raw-length",
            "§4.7",
            "a tile longer than geometry makes it",
            changed(smallest(), 1, |chunk| {
                chunk.payload.extend(RED);
                chunk.raw_len = 16;
            }),
        ),
        malformed(
            "raw-length-of-packed-tile",
            "entry.raw-length",
            "§4.7",
            "a packed tile whose raw length is not that of geometry",
            zstd,
        ),
        malformed(
            "raw-length-of-cropped-tile",
            "entry.raw-length",
            "§4.7 §7.2",
            "a tile as long as if it were not cropped",
            uncropped_length(),
        ),
        malformed(
            "entry-reserved",
            "entry.reserved",
            "§4.9",
            "byte 7 of an entry is not zero",
            patched(&smallest(), entry_at(1) + 7, &[1]),
        ),
    ]
}

/// The first tile of a cropped slab as long as whole images make it.
fn uncropped_length() -> Vec<u8> {
    let whole = scene(uneven(1), 0).chunks.remove(1);
    changed(scene(cropped(1), 0), 2, |chunk| *chunk = whole)
}

fn checksums() -> Vec<Vector> {
    let flipped = |file: File, chunk: usize| {
        let mut bytes = file.to_bytes();
        bytes[file.payload_at(chunk)] ^= 1;
        bytes
    };
    // Only the checksum of GEOM itself is wrong: its first byte is one of the cell's centre.
    vec![
        malformed("checksum-of-geom", "entry.checksum", "§4.8", "a flipped bit in GEOM", flipped(smallest(), 0)),
        malformed(
            "checksum-of-crop",
            "entry.checksum",
            "§4.8",
            "a flipped bit in CROP",
            flipped(scene(cropped(1), 0), 1),
        ),
        malformed(
            "checksum-of-mask",
            "entry.checksum",
            "§4.8",
            "a flipped bit in MASK",
            flipped(scene(masked(1), 0), 1),
        ),
        damaged("checksum-of-tile", "entry.checksum", "§2.5 §4.8", "a flipped bit in a tile", flipped(smallest(), 1)),
        damaged(
            "checksum-of-unknown",
            "entry.checksum",
            "§4.8",
            "a flipped bit in a chunk that is skipped",
            flipped(smallest().with(2, note()), 2),
        ),
        damaged(
            "checksum-of-tag",
            "entry.checksum",
            "§4.8",
            "the tag of a chunk was changed after its checksum was made",
            patched(&smallest().with(2, note()), entry_at(2), b"none"),
        ),
    ]
}

fn order() -> Vec<Vector> {
    let swapped = |mut file: File, chunk: usize| {
        file.chunks.swap(chunk, chunk + 1);
        file.to_bytes()
    };
    let twice = |file: File, chunk: usize| {
        let copy = file.chunks[chunk].clone();
        file.with(chunk, copy).to_bytes()
    };
    let without = |mut file: File, chunk: usize| {
        file.chunks.remove(chunk);
        file.to_bytes()
    };
    let both = || scene(Slab { mask: Some(vec![true, false, false, true, false, true]), ..cropped(1) }, 0);
    let notes = || smallest().with(2, note()).with(3, Chunk { tile: 1, ..note() });
    let tags = smallest().with(2, note()).with(3, Chunk::new(b"more", 0, vec![1]));
    let after_tile = smallest().with(2, Chunk::new(b"META", 2, crate::layout::metadata(&[(b"scene", b"")])));
    let absent = Chunk { tile: 3, ..Chunk::new(b"TILE", 1, vec![0; 48]) };
    let beyond = Chunk { tile: 1, ..smallest().chunks.remove(1) };
    let end = scene(masked(1), 0).chunks.len();
    vec![
        malformed("order-tile-first", "entry.order", "§4.10", "TILE before GEOM", swapped(smallest(), 0)),
        malformed("order-meta-last", "entry.order", "§4.10", "META after TILE", after_tile.to_bytes()),
        malformed("order-mask-before-crop", "entry.order", "§4.10", "MASK before CROP", swapped(both(), 1)),
        malformed("order-tiles", "entry.order", "§4.10", "tile 1 before tile 0", swapped(scene(uneven(1), 0), 1)),
        malformed(
            "order-tags",
            "entry.order",
            "§4.10",
            "chunks that are not known, not in the order of their tags",
            tags.to_bytes(),
        ),
        malformed(
            "order-unknown",
            "entry.order",
            "§4.10",
            "chunks that are not known, not in the order of their tiles",
            swapped(notes(), 2),
        ),
        malformed(
            "order-unknown-before-tile",
            "entry.order",
            "§4.10",
            "a chunk that is not known before the tiles",
            swapped(smallest().with(2, note()), 1),
        ),
        malformed("twice-geom", "entry.order", "§4.10", "two GEOM", twice(smallest(), 0)),
        malformed("twice-crop", "entry.order", "§4.10", "two CROP of a slab", twice(scene(cropped(1), 0), 1)),
        malformed("twice-tile", "entry.order", "§4.10", "a tile twice", twice(smallest(), 1)),
        malformed(
            "twice-unknown",
            "entry.order",
            "§4.10",
            "two chunks alike in tag, slab and tile",
            twice(smallest().with(2, note()), 2),
        ),
        malformed("missing-tile", "entry.order", "§4.10", "a tile is missing", without(scene(uneven(1), 0), 2)),
        malformed(
            "missing-last-tile",
            "entry.order",
            "§4.10",
            "the last tile is missing",
            without(scene(uneven(1), 0), 4),
        ),
        malformed("tile-beyond", "entry.order", "§4.10", "a tile that the slab has not", ending(beyond)),
        malformed(
            "tile-without-cameras",
            "entry.order",
            "§4.10 §7.1",
            "a tile none of whose cameras is stored",
            scene(masked(1), 0).with(end, absent).to_bytes(),
        ),
    ]
}

//! Files that every reader must read.

use super::Vector;
use super::frames::Frame;
use super::packed::{cropped, file, masked, scene, stored, uneven};
use super::paint::{Paint, digest, raw_tile};
use crate::assemble::{Chunk, File};
use crate::layout::{Field, Slab, smallest};

pub(crate) fn vectors() -> Vec<Vector> {
    [fields(), packings(), left_out(), chunks(), extremes(), frames()].concat()
}

/// A file and the light field that it holds.
fn vector(name: &str, clauses: &str, shows: &str, field: &Field, paint: Paint, file: &File) -> Vector {
    let digests = field.slabs.iter().map(|slab| digest(slab, paint)).collect();
    Vector { digests, ..Vector::new(name, shows, clauses, file.to_bytes()) }
}

/// A light field with a scene, in tiles that are not packed.
fn plain(name: &str, clauses: &str, shows: &str, slabs: Vec<Slab>) -> Vector {
    let field = Field::new(slabs);
    vector(name, clauses, shows, &field, Paint::Scene, &file(&field, Paint::Scene, 0))
}

/// A slab with a scene in some packing.
fn packed(name: &str, clauses: &str, shows: &str, slab: Slab, packing: u8) -> Vector {
    let file = scene(slab.clone(), packing);
    vector(name, clauses, shows, &Field::new(vec![slab]), Paint::Scene, &file)
}

fn fields() -> Vec<Vector> {
    let two = (-0.25, 0.5, 2);
    let small = Slab { st: [two; 2], per_tile: [2, 2], ..Slab::smallest() };
    let six = (0..6).map(|face| Slab { face, ..small.clone() }).collect();
    let edge = Slab { st: [(-1.0, 0.5, 5), (-0.5, 0.5, 3)], per_tile: [2, 2], ..small.clone() };
    let far =
        Field { center: [1.0e7, -2.5, 123_456.789], half_extent: [0.5, 1.0, 2.0], ..Field::new(vec![small.clone()]) };
    let far_file = file(&far, Paint::Scene, 0);
    let centre = Slab { face: 3, plane: 0.0, ..small.clone() };
    let focal = Slab { focal_depth: 2.5, ..small.clone() };
    let mixed = (1..=3).map(|encoding| Slab { face: 2 * encoding - 1, ..uneven(encoding) }).collect();
    let red = Field::new(vec![Slab::smallest()]);
    vec![
        vector("smallest", "§11", "the example of the specification", &red, Paint::Red, &smallest()),
        plain("six-slabs", "§5.2 §5.3", "all six faces", six),
        plain("one-face", "§5.2", "one slab of 2×2 cameras in one tile", vec![small]),
        plain("mixed-encodings", "§5.4 §5.5", "three slabs, each in another texel encoding", mixed),
        plain("edge-tiles", "§5.9 §7.1", "5×3 cameras in tiles of 2×2: tiles at the edges are smaller", vec![edge]),
        plain("odd-images", "§7.2", "images of 10×6 texels, padded to 12×8", vec![uneven(1)]),
        plain("plane-at-centre", "§5.6", "a camera plane through the cell's centre, face −Y", vec![centre]),
        plain("focal-depth", "§5.8", "a focal plane", vec![focal]),
        vector("far-cell", "§5.1", "an oblong cell far from the world's origin", &far, Paint::Scene, &far_file),
    ]
}

fn packings() -> Vec<Vector> {
    vec![
        packed("bc1", "§7.3", "BC1 in 4-colour blocks and blocks of one colour, not packed", uneven(1), 0),
        packed("bc1-zstd", "§7.5", "BC1 packed by zstd", uneven(1), 1),
        packed("bc1-tile-codec", "§7.8 T.1 T.2 T.3 T.4 T.5 T.6 T.7", "BC1 in the tile codec", uneven(1), 2),
        packed("rgba8", "§7.4", "RGBA8, not packed", uneven(2), 0),
        packed("rgba8-zstd", "§7.5", "RGBA8 packed by zstd", uneven(2), 1),
        packed("rgb16f", "§7.9", "RGB16F, not packed; 0, the smallest and the largest number occur", uneven(3), 0),
        packed("rgb16f-zstd", "§7.5", "RGB16F packed by zstd", uneven(3), 1),
    ]
}

fn left_out() -> Vec<Vector> {
    let windows = |windows: [Vec<[u32; 2]>; 2]| Slab { crop: Some(windows), ..uneven(1) };
    let overlapping = windows([vec![[1, 2], [0, 2], [0, 3]], vec![[1, 1], [0, 1]]]);
    // Cameras that a mask leaves out of a cropped slab.
    let both = |encoding| Slab { mask: Some(vec![true, false, false, true, false, true]), ..cropped(encoding) };
    let one = Slab { mask: Some((0..6).map(|camera| camera == 4).collect()), ..uneven(1) };
    // A tile of which no column has a window.
    let empty = windows([vec![[0, 0], [0, 0], [0, 3]], vec![[0, 2], [1, 1]]]);
    vec![
        packed("crop", "§6.1 §7.2", "a window of each image", overlapping, 0),
        packed("crop-empty-windows", "§6.1 §6.3", "a column of cameras without a window", cropped(1), 0),
        packed("crop-tile-left-out", "§7.1", "tiles without any window are not in the file", empty, 0),
        packed("crop-tile-codec", "§7.8 T.2 T.3", "windows in the tile codec", cropped(1), 2),
        packed("crop-rgba8-zstd", "§6.1 §7.4", "windows of RGBA8", cropped(2), 1),
        packed("crop-rgb16f", "§6.1 §7.9", "windows of RGB16F", cropped(3), 0),
        packed("mask", "§6.2 §7.1 §7.2", "cameras left out, and a tile with them", masked(1), 0),
        packed("mask-tile-codec", "§6.2 T.2", "cameras left out, which the tile codec codes as zeros", masked(1), 2),
        packed("mask-rgba8", "§6.2 §7.4", "cameras left out of RGBA8", masked(2), 0),
        packed("mask-one-camera", "§6.3", "one camera of six", one, 1),
        packed("crop-mask", "§6.1 §6.2 §6.3", "windows and a mask; a tile is not stored", both(1), 0),
        packed("crop-mask-tile-codec", "§6.2 §7.8", "the same in the tile codec", both(1), 2),
        packed("crop-mask-rgb16f", "§6.2 §7.9", "the same in RGB16F", both(3), 1),
    ]
}

/// The smallest file with something that changes no texel.
fn red(name: &str, clauses: &str, shows: &str, file: &File) -> Vector {
    vector(name, clauses, shows, &Field::new(vec![Slab::smallest()]), Paint::Red, file)
}

fn chunks() -> Vec<Vector> {
    let note = |flags| Chunk::new(b"note", flags, b"private".to_vec());
    let packed = Chunk { packing: 200, slab: 77, tile: u32::MAX, raw_len: 1 << 40, ..note(0) };
    let reserved = Chunk { packing: 3, raw_len: 1, ..Chunk::new(b"NEWC", 0, vec![1, 2, 3]) };
    let several =
        smallest().with(2, Chunk::new(b"2nd0", 2, vec![0])).with(3, note(2)).with(4, Chunk { tile: 1, ..note(0) });
    let all = Field { metadata: metadata(), ..Field::new(vec![Slab::smallest()]) };
    let one = Field { metadata: vec![("scene".into(), String::new())], ..all.clone() };
    let version = |minor| File { version: (1, minor), ..smallest() };
    vec![
        red(
            "metadata",
            "§8.1 §8.2 §8.3 §8.4 §8.5",
            "all standard keys, a private one, UTF-8",
            &file(&all, Paint::Red, 0),
        ),
        red("metadata-empty-value", "§8.4", "one key with an empty value", &file(&one, Paint::Red, 0)),
        red("private-chunk", "§4.1 §4.2", "a private chunk that is safe to copy", &smallest().with(2, note(2))),
        red(
            "unknown-chunk",
            "§4.2 §4.3",
            "a chunk of a reserved tag in a packing that is not known",
            &smallest().with(2, reserved),
        ),
        red(
            "private-packing",
            "§4.3 §4.4",
            "a private chunk in a private packing, of a slab that there is not",
            &smallest().with(2, packed),
        ),
        red("several-unknown-chunks", "§4.10", "three chunks after the tiles, in their order", &several),
        red("minor-version-9", "§3.2 §9.1", "version 1.9", &version(9)),
        red("minor-version-65535", "§3.2", "the last minor version that there can be", &version(u16::MAX)),
    ]
}

fn metadata() -> Vec<(String, String)> {
    let pairs = [
        ("attribution", "Ann Example, Jürgen Beispiel, 例 太郎"),
        ("coverage", "rays to the upper half"),
        ("created-by-preset", "small"),
        ("example.note", "tab\tand line\nfeed, 🎈, e\u{301}, \u{85}"),
        ("generator", "write_vectors 1"),
        ("license", "CC0-1.0"),
        ("scene", "nothing"),
        ("x234567890123456789012345678901234567890123456789012345678901234", ""),
    ];
    pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).into()
}

fn extremes() -> Vec<Vector> {
    let black = |name, clauses, shows, slab: Slab| {
        let field = Field::new(vec![slab]);
        vector(name, clauses, shows, &field, Paint::Black, &file(&field, Paint::Black, 1))
    };
    let most = 1 << 16;
    let line =
        Slab { st: [(0.0, 1.0, most), (0.0, 1.0, 1)], uv: [(0.0, 1.0, 1); 2], per_tile: [most, 1], ..Slab::smallest() };
    let wide = Slab { uv: [(-1.0, 3e-5, most), (0.0, 1.0, 1)], ..Slab::smallest() };
    let (tiny, huge) = (f32::from_bits(1), f32::MAX);
    let st = [(huge, tiny, 3), (-huge, huge, 1)];
    let uv = [(-0.0, tiny, 4), (-huge, 1e38, 4)];
    let slab = Slab { plane: -huge, st, uv, focal_depth: huge, per_tile: [3, 1], encoding: 2, ..Slab::smallest() };
    let field = Field {
        center: [f64::MAX, -f64::MIN_POSITIVE, -0.0],
        half_extent: [tiny, huge, 1.0],
        ..Field::new(vec![slab])
    };
    vec![
        black("most-cameras", "§5.7", "65,536 cameras of one texel in one tile", line),
        black("most-texels", "§5.7", "an image of 65,536×1 texels", wide),
        vector(
            "extreme-numbers",
            "§2.1 §5.7",
            "the largest and the smallest numbers",
            &field,
            Paint::Scene,
            &file(&field, Paint::Scene, 0),
        ),
    ]
}

/// A slab of one tile in a packing, its stored bytes given.
fn one_tile(name: &str, clauses: &str, shows: &str, slab: Slab, (packing, bytes): (u8, Vec<u8>)) -> Vector {
    let field = Field::new(vec![slab]);
    let file = field.file(|_, _| (packing, bytes.clone()));
    vector(name, clauses, shows, &field, Paint::Scene, &file)
}

fn frames() -> Vec<Vector> {
    let (bc1, rgba8) = (whole(1), whole(2));
    let raw = raw_tile(&rgba8, 0, Paint::Scene);
    let pack = |frame: Frame| (1, frame.pack(&raw));
    let window = Frame { window: Some((13, 0)), ..Frame::of(&raw) };
    let checksum = Frame { checksum: true, ..Frame::of(&raw) };
    let coded = stored(&bc1, 0, Paint::Scene, 2);
    vec![
        one_tile("zstd-window-8-mib", "§7.5", "a frame with the largest window", rgba8.clone(), pack(window)),
        one_tile("zstd-checksum", "§7.5", "a frame with a checksum of its content", rgba8.clone(), pack(checksum)),
        one_tile(
            "zstd-compressed",
            "§7.5",
            "a frame with sequences and entropy coding, by zstd 1.5",
            rgba8,
            (1, ZSTD_RGBA8.to_vec()),
        ),
        one_tile(
            "tile-codec-compressed",
            "§7.8 T.1",
            "streams in such a frame",
            bc1.clone(),
            (2, ZSTD_STREAMS.to_vec()),
        ),
        one_tile("tile-codec-one-tile", "§7.8", "the same streams as they are", bc1, (2, coded)),
    ]
}

/// 3 × 2 cameras of 8 × 8 texels in one tile.
fn whole(encoding: u8) -> Slab {
    Slab { uv: [(-0.875, 0.25, 8); 2], per_tile: [3, 2], ..uneven(encoding) }
}

/// The raw tile of [`whole`] in RGBA8, packed by zstd 1.5 at level 19, with a checksum.
const ZSTD_RGBA8: &[u8] = &[
    0x28, 0xB5, 0x2F, 0xFD, 0x64, 0x00, 0x05, 0xE5, 0x11, 0x00, 0x16, 0xE9, 0x83, 0x39, 0x30, 0x53, 0xC1, 0x03, 0x54,
    0xF7, 0xF2, 0x29, 0x7D, 0xB1, 0xFC, 0xC8, 0x70, 0x9A, 0xDF, 0x6E, 0x2B, 0xB2, 0xFF, 0xB4, 0x83, 0x4D, 0x32, 0xAE,
    0xD5, 0x4E, 0xB9, 0x4C, 0xEA, 0x41, 0xB0, 0x1D, 0x7D, 0x19, 0xA6, 0x40, 0x86, 0xB2, 0x4D, 0x44, 0x5E, 0xA9, 0x92,
    0x26, 0x2F, 0x15, 0x3A, 0xC2, 0x65, 0x11, 0x05, 0x08, 0xD2, 0x92, 0x3A, 0x79, 0xA6, 0x79, 0x00, 0x79, 0x00, 0x71,
    0x00, 0x16, 0x9C, 0x79, 0x16, 0x4C, 0x49, 0x8E, 0x62, 0xF8, 0x75, 0xDB, 0x0B, 0x30, 0xA0, 0xC7, 0x65, 0x58, 0xBE,
    0xD3, 0x33, 0x30, 0xD7, 0x4D, 0x30, 0xD6, 0x3F, 0x30, 0xD5, 0x41, 0x30, 0xD2, 0x35, 0x30, 0xCF, 0x37, 0x30, 0xCD,
    0x73, 0x30, 0xCB, 0x49, 0x98, 0x79, 0x02, 0x4A, 0x49, 0x8E, 0x62, 0xF8, 0x75, 0xDB, 0x7D, 0x28, 0xA0, 0xC7, 0x65,
    0x58, 0xBE, 0xD3, 0x77, 0x28, 0xD7, 0x03, 0x28, 0xD6, 0x47, 0x94, 0xEA, 0x40, 0x14, 0xE9, 0x3A, 0x94, 0xE7, 0x13,
    0x94, 0xE6, 0x1E, 0x94, 0xE5, 0x22, 0x94, 0xF9, 0x14, 0xB3, 0x24, 0x47, 0x31, 0xFC, 0xBA, 0xED, 0x0B, 0x26, 0xE8,
    0x71, 0x19, 0x96, 0xEF, 0x74, 0x1A, 0xF3, 0x7A, 0x8B, 0x69, 0xDD, 0xC6, 0xAC, 0x3E, 0x32, 0xA5, 0x33, 0xF3, 0x79,
    0x87, 0xD9, 0x7C, 0x99, 0xCB, 0x05, 0xCC, 0x19, 0xD4, 0x72, 0x07, 0xD4, 0xFC, 0x80, 0xA8, 0x24, 0x47, 0x31, 0xFC,
    0xBA, 0xED, 0x15, 0x22, 0xD0, 0xE3, 0x32, 0x2C, 0xDF, 0xE9, 0x14, 0xA2, 0xEB, 0x10, 0x22, 0xEB, 0x23, 0xA2, 0xEA,
    0x57, 0x24, 0x5D, 0x24, 0x7A, 0x8E, 0x21, 0x6A, 0xAE, 0x44, 0xCB, 0x0F, 0x44, 0xF3, 0x31, 0xA0, 0x92, 0x1C, 0xC5,
    0xF0, 0xEB, 0xB6, 0xF7, 0x80, 0x40, 0x8F, 0xCB, 0xB0, 0x7C, 0xA7, 0x4B, 0x80, 0xAE, 0x8B, 0x40, 0xD6, 0x4B, 0x40,
    0xD5, 0x49, 0x20, 0xE9, 0x33, 0xA0, 0xE7, 0x3C, 0xA0, 0xE6, 0x32, 0xA0, 0xE5, 0x28, 0xA0, 0xF9, 0x1B, 0x4E, 0x49,
    0x8E, 0x62, 0xF8, 0x75, 0xDB, 0x19, 0x38, 0xA0, 0xC7, 0x65, 0x58, 0xBE, 0xD3, 0x4B, 0x9C, 0xEB, 0x30, 0x1C, 0xEB,
    0x11, 0x9C, 0xEA, 0x24, 0x1C, 0xE9, 0xD7, 0x79, 0x7E, 0xE2, 0x34, 0xF7, 0x9C, 0xE5, 0x01, 0xD6, 0x5A, 0x6B, 0xAD,
    0xB5, 0xD6, 0x5A, 0x6B, 0x6D, 0xAD, 0xB5, 0xD6, 0x5A, 0x6B, 0xAD, 0xB5, 0xD6, 0x5A, 0x6B, 0xAD, 0xB5, 0xD6, 0x5A,
    0x2B, 0xA5, 0x94, 0x52, 0x4A, 0x29, 0xA5, 0x94, 0x52, 0x4A, 0x29, 0xA5, 0x94, 0x52, 0x4A, 0xE9, 0x7C, 0xC9, 0x2D,
    0xC9, 0x51, 0x0C, 0xBF, 0x6E, 0xBB, 0x8B, 0x0B, 0x7A, 0x5C, 0x86, 0xE5, 0x3B, 0x3D, 0xC1, 0xBD, 0x4E, 0xAF, 0xF5,
    0x15, 0xB7, 0xBA, 0x82, 0x2B, 0x1D, 0xC7, 0x7D, 0x7E, 0x6F, 0xF3, 0x90, 0xBB, 0x3C, 0xC4, 0x9D, 0x07, 0x40, 0x95,
    0xE4, 0x28, 0x86, 0x5F, 0xB7, 0xFD, 0x07, 0x05, 0x7A, 0x5C, 0x86, 0xE5, 0x3B, 0x1D, 0x01, 0x75, 0x3D, 0x84, 0xB2,
    0x7E, 0x81, 0xAA, 0xDE, 0x80, 0x92, 0x7E, 0x42, 0x3D, 0xF7, 0x41, 0x35, 0xA7, 0x01, 0xAF, 0xA1, 0x95, 0x37, 0xD1,
    0xC8, 0x51, 0x0C, 0xBF, 0x6E, 0xBB, 0x89, 0x06, 0x7A, 0x5C, 0x86, 0xE5, 0x3B, 0x9D, 0x83, 0x76, 0xFD, 0x81, 0x66,
    0xDD, 0x80, 0x56, 0x9D, 0xD4, 0xA4, 0x07, 0xD1, 0x9E, 0x9F, 0xD0, 0x9A, 0xBF, 0xD0, 0x96, 0xAB, 0xD0, 0xF6, 0xDE,
    0x7B, 0xEF, 0xBD, 0xF7, 0xDE, 0x7B, 0xEF, 0xBD, 0xF7, 0xDE, 0x7B, 0xEF, 0xBD, 0xB5, 0xD6, 0x5A, 0x6B, 0xAD, 0xB5,
    0xD6, 0x5A, 0x6B, 0xAD, 0xB5, 0xD6, 0x5A, 0x6B, 0xAD, 0x73, 0xCE, 0x39, 0xE7, 0x9C, 0x73, 0xCE, 0x39, 0xE7, 0x9C,
    0x73, 0xCE, 0x39, 0xE7, 0x9C, 0x31, 0xC6, 0x18, 0x63, 0x8C, 0x31, 0xC6, 0x18, 0x63, 0x8C, 0x31, 0xC6, 0x18, 0x63,
    0x8C, 0xAD, 0xB5, 0xD6, 0x5A, 0x6B, 0xAD, 0x0D, 0x81, 0x25, 0xA4, 0x11, 0xC0, 0xC7, 0xD9, 0xBF, 0x03, 0xE1, 0xB3,
    0x6C, 0x06, 0x00, 0xB6, 0x39, 0x20, 0x0C, 0x00, 0x00, 0x48, 0xF6, 0xA8, 0xE1, 0x58, 0xE4, 0x51, 0xA4, 0x51, 0xE4,
    0x28, 0xE4, 0x28, 0xE4, 0x28, 0xE4, 0x28, 0xE2, 0x33, 0xF2, 0x6A, 0x15, 0x47, 0x8A, 0x11, 0xE3,
];

/// The streams of [`whole`] in BC1, packed by zstd 1.5 at level 19.
const ZSTD_STREAMS: &[u8] = &[
    0x28, 0xB5, 0x2F, 0xFD, 0x20, 0xD0, 0xA5, 0x05, 0x00, 0xA4, 0x09, 0x00, 0x07, 0x00, 0x00, 0x00, 0x11, 0x00, 0x00,
    0x00, 0x26, 0x00, 0x00, 0x00, 0x28, 0x00, 0x00, 0x00, 0x4E, 0x00, 0x00, 0x00, 0xAF, 0xEF, 0xEF, 0xCA, 0x2F, 0xFF,
    0xFF, 0xEF, 0xFF, 0xCF, 0xFF, 0xEA, 0x1F, 0x6F, 0xFF, 0xCA, 0xEA, 0xDF, 0xD3, 0xEA, 0xCA, 0xDF, 0x6A, 0xCA, 0xFF,
    0x71, 0x71, 0x70, 0x70, 0xFF, 0x70, 0x71, 0x71, 0x6F, 0x6F, 0x75, 0x75, 0x70, 0x70, 0x1F, 0x95, 0x0F, 0x11, 0x10,
    0x95, 0x00, 0x11, 0x3F, 0x95, 0x2F, 0x11, 0x30, 0x95, 0x20, 0x93, 0x9E, 0x83, 0x1A, 0xB3, 0x9E, 0xA3, 0x1A, 0x0A,
    0x0A, 0x5A, 0x5A, 0x2D, 0x2D, 0x49, 0x49, 0xA0, 0xA0, 0x05, 0x05, 0xA5, 0x94, 0x7F, 0xA0, 0x39, 0x39, 0x99, 0xF0,
    0xF0, 0x5A, 0x5A, 0x7C, 0x7C, 0xD6, 0xD6, 0x01, 0x01, 0x30, 0x30, 0xFA, 0xF5, 0x3E, 0x3D, 0x57, 0x70, 0x70, 0x54,
    0xAF, 0xAF, 0xA5, 0xA5, 0x69, 0x69, 0xC3, 0xC3, 0x33, 0x33, 0x5A, 0xF5, 0x96, 0x3D, 0xA5, 0x0F, 0x08, 0x08, 0x0C,
    0x0C, 0x02, 0x02, 0x03, 0x03, 0x50, 0xF0, 0xF0, 0xF5, 0xFE, 0x7C, 0xFF, 0x5F, 0x0B, 0x20, 0x90, 0x2C, 0x79, 0x03,
    0x41, 0x61, 0x00, 0x68, 0xE4, 0xBC, 0x90, 0x19, 0x58, 0x2B, 0x38, 0x4D, 0xF8, 0xEA, 0x5E, 0x4A, 0xE6, 0x84,
];

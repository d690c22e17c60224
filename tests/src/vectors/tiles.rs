//! Files that break a rule of clause 7 or of the tile codec inside a tile.

use super::frames::{Frame, bomb, zstd};
use super::packed::{masked, scene, streams, uneven};
use super::paint::{Paint, raw_tile};
use super::tile_codec::Streams;
use super::{Kind, Stage, Vector, damaged, unsound};
use crate::assemble::Chunk;
use crate::layout::{Field, Slab};

pub(crate) fn vectors() -> Vec<Vector> {
    [contents(), frames(), streams_of_tiles(), bombs()].concat()
}

/// A slab of one tile, its stored bytes given.
fn with_tile(slab: Slab, packing: u8, mut bytes: Vec<u8>) -> Vec<u8> {
    Field::new(vec![slab]).file(|_, _| (packing, std::mem::take(&mut bytes))).to_bytes()
}

/// The smallest file with another block.
fn block(color0: u16, color1: u16, indices: u32) -> Vec<u8> {
    let bytes = [&color0.to_le_bytes()[..], &color1.to_le_bytes(), &indices.to_le_bytes()].concat();
    with_tile(Slab::smallest(), 0, bytes)
}

/// 4×4 texels of another encoding with a few bytes of one texel changed.
fn texel(encoding: u8, at: usize, bytes: &[u8]) -> Vec<u8> {
    let slab = Slab { encoding, ..Slab::smallest() };
    let mut raw = raw_tile(&slab, 0, Paint::Scene);
    raw[at..at + bytes.len()].copy_from_slice(bytes);
    with_tile(slab, 0, raw)
}

/// A file with a mask whose first tile has something in place of camera (1, 0).
fn absent(encoding: u8, byte: usize) -> Vec<u8> {
    scene(masked(encoding), 0).patch(2, byte, &[1]).to_bytes()
}

fn contents() -> Vec<Vector> {
    // Rows of the first tile have 2 × 3 blocks or 2 × 12 texels; the second camera begins in the middle.
    vec![
        unsound(
            "absent-camera-bc1",
            "tile.padding",
            "§7.2",
            "a block in place of a camera that is not stored",
            absent(1, 3 * 8 + 4),
        ),
        unsound(
            "absent-camera-rgba8",
            "tile.padding",
            "§7.2",
            "a texel in place of a camera that is not stored",
            absent(2, 12 * 4),
        ),
        unsound(
            "absent-camera-rgb16f",
            "tile.padding",
            "§7.2",
            "a value in place of a camera that is not stored",
            absent(3, 12 * 6),
        ),
        unsound("bc1-transparent", "tile.opaque", "§7.3", "a block with color0 < color1", block(0x001F, 0xF800, 0)),
        unsound(
            "bc1-transparent-texel",
            "tile.opaque",
            "§7.3",
            "equal colours and an index 3",
            block(0xF800, 0xF800, 0xC000_0000),
        ),
        unsound("alpha-0", "tile.alpha", "§7.4", "an alpha of 0", texel(2, 7, &[0])),
        unsound("alpha-254", "tile.alpha", "§7.4", "an alpha of 254", texel(2, 63, &[254])),
        unsound(
            "half-float-infinite",
            "tile.finite",
            "§2.1 §7.9",
            "an infinite value",
            texel(3, 10, &0x7C00u16.to_le_bytes()),
        ),
        unsound(
            "half-float-nan",
            "tile.finite",
            "§2.1 §7.9",
            "a value that is not a number",
            texel(3, 94, &0xFE01u16.to_le_bytes()),
        ),
    ]
}

/// 4×4 texels of RGBA8 in a frame.
fn framed(pack: impl FnOnce(&[u8]) -> Vec<u8>) -> Vec<u8> {
    let slab = Slab { encoding: 2, ..Slab::smallest() };
    let frame = pack(&raw_tile(&slab, 0, Paint::Scene));
    with_tile(slab, 1, frame)
}

/// The same, with other fields in the header of the frame.
fn with_header(change: impl FnOnce(Frame) -> Frame) -> Vec<u8> {
    framed(|raw| change(Frame::of(raw)).pack(raw))
}

const SKIPPABLE: [u8; 12] = [0x50, 0x2A, 0x4D, 0x18, 4, 0, 0, 0, 1, 2, 3, 4];

fn frames() -> Vec<Vector> {
    let broken = |name, shows, bytes| damaged(name, "tile.zstd", "§7.5", shows, bytes);
    let wide = |window| with_header(|frame| Frame { window: Some(window), ..frame });
    let after = |more: &[u8]| framed(|raw| [&zstd(raw)[..], more].concat());
    let stating = |size| with_header(|frame| Frame { content_size: size, window: Some((13, 0)), ..frame });
    let large = Slab { uv: [(0.0, 1.0, 16_384), (0.0, 1.0, 1_152)], ..Slab::smallest() };
    let zeros = zstd(&vec![0; 9 << 20]);
    let checksum = |raw: &[u8]| {
        let frame = Frame { checksum: true, ..Frame::of(raw) }.pack(raw);
        [&frame[..frame.len() - 1], &[!frame[frame.len() - 1]]].concat()
    };
    let cut = |raw: &[u8]| zstd(raw)[..40].to_vec();
    vec![
        broken("zstd-no-content-size", "the frame does not state its size", stating(None)),
        broken("zstd-content-size-short", "the frame states and holds a byte less", framed(|raw| zstd(&raw[..63]))),
        broken(
            "zstd-content-size-long",
            "the frame states and holds a byte more",
            framed(|raw| zstd(&[raw, &[0]].concat())),
        ),
        broken(
            "zstd-content-size-wrong",
            "the frame states the right size and holds a byte less",
            framed(|raw| Frame::of(raw).pack(&raw[..63])),
        ),
        broken("zstd-window-9-mib", "a window of 9 MiB", wide((13, 1))),
        broken("zstd-window-16-mib", "a window of 16 MiB", wide((14, 0))),
        broken(
            "zstd-window-single-segment",
            "9 MiB in a single segment, which is the window",
            with_tile(large, 1, zeros),
        ),
        broken(
            "zstd-dictionary",
            "a frame that needs a dictionary",
            with_header(|frame| Frame { dictionary: Some(7), ..frame }),
        ),
        broken("zstd-two-frames", "two frames", framed(|raw| [zstd(&raw[..32]), zstd(&raw[32..])].concat())),
        broken("zstd-empty-frame-after", "an empty frame after the frame", after(&zstd(&[]))),
        broken("zstd-skippable-after", "a skippable frame after the frame", after(&SKIPPABLE)),
        broken(
            "zstd-skippable-before",
            "a skippable frame before the frame",
            framed(|raw| [&SKIPPABLE, &zstd(raw)[..]].concat()),
        ),
        broken("zstd-byte-after", "a byte after the frame", after(&[0])),
        broken("zstd-cut-off", "the frame is cut off", framed(cut)),
        broken("zstd-checksum-wrong", "a wrong checksum of the content", framed(checksum)),
        broken("zstd-not-a-frame", "raw bytes that claim to be packed", framed(<[u8]>::to_vec)),
    ]
}

/// The second tile of an uneven slab in the tile codec, all others sound, after a change to its streams.
fn coded(change: impl FnOnce(&mut Streams)) -> Vec<u8> {
    content_of(|mut streams| {
        change(&mut streams);
        streams.content()
    })
}

/// The same after any change to the content of its frame.
fn content_of(change: impl FnOnce(Streams) -> Vec<u8>) -> Vec<u8> {
    let mut file = scene(uneven(1), 2);
    let payload = zstd(&change(streams(&uneven(1), 1, Paint::Scene)));
    let raw_len = file.chunks[2].raw_len;
    file.chunks[2] = Chunk { packing: 2, tile: 1, raw_len, ..Chunk::new(b"TILE", 1, payload) };
    file.to_bytes()
}

/// The block of the smallest file in the tile codec: kind 6, its endpoints by what stream 4 and 5 hold.
fn stepped(steps: &[u8], escapes: &[u8]) -> Vec<u8> {
    let mut streams = Streams::default();
    (streams.0[3], streams.0[4], streams.0[5]) = (vec![6 << 5], steps.to_vec(), escapes.to_vec());
    with_tile(Slab::smallest(), 2, zstd(&streams.content()))
}

fn streams_of_tiles() -> Vec<Vector> {
    let broken = |name, clauses, shows, bytes| damaged(name, "tile.codec", clauses, shows, bytes);
    let frame = |name, shows, bytes| damaged(name, "tile.zstd", "§7.5 §7.8 T.1", shows, bytes);
    let longer = |stream: usize| coded(|streams| streams.0[stream].push(0));
    let shorter = |stream: usize| coded(|streams| streams.0[stream].truncate(streams.0[stream].len() - 1));
    let lengths = |by: i32| {
        content_of(|streams| {
            let mut content = streams.content();
            content[24] = content[24].wrapping_add_signed(by as i8);
            content
        })
    };
    let content = |streams: Streams| streams.content();
    let long = with_tile(Slab::smallest(), 2, zstd(&[0; 28 + 12]));
    let sound = content(streams(&Slab::smallest(), 0, Paint::Red));
    let two = with_tile(Slab::smallest(), 2, [zstd(&sound), zstd(&sound)].concat());
    let unsized_frame =
        |content: &[u8]| Frame { content_size: None, window: Some((0, 0)), ..Frame::of(content) }.pack(content);
    let sizeless = unsized_frame(&sound);
    vec![
        frame("tile-codec-too-long", "more content than the blocks can need", long),
        frame("tile-codec-two-frames", "two frames", two),
        frame(
            "tile-codec-no-content-size",
            "a frame that does not state its size",
            with_tile(Slab::smallest(), 2, sizeless),
        ),
        broken(
            "tile-codec-no-header",
            "T.1",
            "content shorter than its header",
            with_tile(Slab::smallest(), 2, zstd(&[0; 27])),
        ),
        broken("tile-codec-not-filled", "T.1", "streams that end before the content", lengths(-1)),
        broken("tile-codec-beyond", "T.1", "streams that end after the content", lengths(1)),
        broken("tile-codec-mode-left", "T.1", "a mode too many", longer(3)),
        broken("tile-codec-step-left", "T.1", "a step too many", longer(4)),
        broken("tile-codec-escape-left", "T.1", "half an endpoint too many", longer(5)),
        broken("tile-codec-correction-left", "T.1", "a correction too many", longer(6)),
        broken("tile-codec-mode-missing", "T.1", "a mode too few", shorter(3)),
        broken("tile-codec-correction-missing", "T.1", "a correction too few", shorter(6)),
        broken(
            "tile-codec-escape-missing",
            "T.1 T.5",
            "an escaped endpoint that is not there",
            stepped(&[255, 0], &[]),
        ),
        broken("tile-codec-step-225", "T.5", "a step that is none", stepped(&[112, 225], &[])),
        broken("tile-codec-step-254", "T.5", "a step that is none", stepped(&[254, 112], &[])),
    ]
}

fn bombs() -> Vec<Vector> {
    // 2^27 blocks of black: the format allows it.
    let huge = Slab { uv: [(0.0, 1.0, 65_536), (0.0, 1.0, 32_768)], ..Slab::smallest() };
    let gib = with_tile(huge, 1, bomb(1 << 30, 8192));
    let mut honest = Vector::new("one-gib-of-zeros", "32 KiB that unpack to 1 GiB", "§10", gib).refused(
        "limit",
        Kind::Limit,
        Stage::Tile,
    );
    if let Some(refusal) = &mut honest.refusal {
        refusal.memory_bytes = Some(256 << 20);
    }
    let lying = with_tile(Slab { encoding: 2, ..Slab::smallest() }, 1, bomb(64, 1024));
    let codec = with_tile(Slab::smallest(), 2, bomb(1 << 30, 8));
    vec![
        honest,
        damaged("zstd-bomb", "tile.zstd", "§7.5", "a frame that states 64 bytes and holds 128 MiB", lying),
        damaged("tile-codec-bomb", "tile.zstd", "§7.5 §7.8 T.1", "a frame that states 1 GiB for one block", codec),
    ]
}

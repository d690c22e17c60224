//! Files from anywhere: both readers agree, nothing panics, and memory stays within the budget. Besides the bytes themselves, a
//! file is built around them whose checksums and offsets are right, as random changes do not get past those.

use std::io::Cursor;

use arbitrary::{Arbitrary, Unstructured};
use lf_format::{Container, FileReader, FormatError, Limits};

use crate::assemble::{Chunk, File, reseal};

#[derive(Arbitrary, Debug)]
struct Input {
    chunks: Vec<Piece>,
    minor: u16,
    /// Changes to header and directory after the checksums were set.
    patches: Vec<(u8, u8)>,
    rest: Vec<u8>,
}

#[derive(Arbitrary, Debug)]
struct Piece {
    tag: u8,
    flags: Option<u8>,
    packing: u8,
    slab: u8,
    tile: u8,
    raw_len: Option<u16>,
    payload: Vec<u8>,
}

impl Piece {
    fn chunk(self) -> Chunk {
        let tags = [b"GEOM", b"META", b"CROP", b"MASK", b"TILE", b"note", b"NEWC"];
        let tag = tags[usize::from(self.tag) % tags.len()];
        let usual = if tag == b"META" { 2 } else { u16::from(tag != b"note" && tag != b"NEWC") };
        let flags = self.flags.map_or(usual, u16::from);
        let mut chunk = Chunk::new(tag, flags, self.payload);
        chunk.packing = self.packing % 4;
        chunk.slab = (self.slab % 7).into();
        chunk.tile = self.tile.into();
        chunk.raw_len = self.raw_len.map_or(chunk.raw_len, u64::from);
        chunk
    }
}

/// Room for what such small files can ask for.
const LIMITS: Limits = Limits { memory_bytes: 16 << 20 };

/// See the module.
pub fn run(data: &[u8]) {
    check(data);
    let Ok(input) = Input::arbitrary_take_rest(Unstructured::new(data)) else { return };
    check(&input.rest);
    let mut file = File::new(input.chunks.into_iter().map(Piece::chunk).collect());
    file.version.1 = input.minor;
    let mut bytes = file.to_bytes();
    check(&bytes);
    for (at, value) in input.patches {
        // Version and entry count stay, so that the checksums can be found.
        if let Some(byte) = bytes.get_mut(usize::from(at)).filter(|_| !(32..36).contains(&at)) {
            *byte = value;
        }
    }
    reseal(&mut bytes);
    check(&bytes);
}

fn check(bytes: &[u8]) {
    let in_memory = Container::parse(bytes, &LIMITS);
    let by_parts = FileReader::open(Cursor::new(bytes), &LIMITS);
    let (container, mut reader) = match (in_memory, by_parts) {
        (Ok(container), Ok(reader)) => (container, reader),
        (Err(a), Err(b)) => return assert_eq!(text(&a), text(&b)),
        (a, b) => panic!("the readers disagree: {a:?} {b:?}"),
    };
    let (mut a, mut b) = (Vec::new(), Vec::new());
    container.verify(|error| a.push(text(&error)));
    reader.verify(|error| b.push(text(&error))).expect("there is no input error");
    assert_eq!(a, b);
    let mut buffer = Vec::new();
    for (slab, tiling) in container.tilings().iter().enumerate() {
        for tile in tiling.stored_tiles() {
            let (a, b) = (container.tile(slab, tile), reader.tile(slab, tile, &mut buffer));
            assert_eq!(a.as_ref().map_err(text), b.as_ref().map_err(text));
        }
    }
}

fn text(error: &FormatError) -> String {
    format!("{} {error}", error.id())
}

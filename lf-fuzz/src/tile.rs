//! Packed tiles from anywhere, of whole and of cropped images, decode or are refused, without panic; what was packed comes back; RDO keeps its bound.

use std::ops::Range;

use arbitrary::{Arbitrary, Unstructured};
use lf_compress::bc1::decode_block;
use lf_compress::tile::{RdoOptions, TileShape, decode, encode, optimise};

#[derive(Arbitrary, Debug)]
struct Input {
    /// First block and number of blocks of each column and each row of cameras.
    windows: [Vec<[u8; 2]>; 2],
    /// Whether all have the first one's window.
    uniform: [bool; 2],
    /// Taken as a packed tile, as the content of a frame, and as blocks.
    bytes: Vec<u8>,
    texels: [[u8; 4]; 16],
    lambda: u16,
}

/// At most six, of at most four blocks.
fn windows(numbers: &[[u8; 2]], uniform: bool) -> Vec<Range<u32>> {
    let window = |[first, count]: [u8; 2]| u32::from(first % 8)..u32::from(first % 8 + count % 5);
    let chosen = numbers.iter().take(6).map(|pair| if uniform { numbers[0] } else { *pair });
    chosen.map(window).collect()
}

/// See the module.
pub fn run(data: &[u8]) {
    let Ok(input) = Input::arbitrary_take_rest(Unstructured::new(data)) else { return };
    let [columns, rows] = [0, 1].map(|axis| windows(&input.windows[axis], input.uniform[axis]));
    let Ok(shape) = TileShape::windowed(&columns, &rows) else { return };
    let _ = decode(&shape, &input.bytes);
    // A whole frame around any content comes further than random bytes do.
    let frame = zstd::bulk::compress(&input.bytes, 1).expect("zstd packs");
    if let Ok(decoded) = decode(&shape, &frame) {
        assert_eq!(decoded.len(), shape.raw_len());
    }
    let mut raw: Vec<u8> = input.bytes.iter().copied().cycle().take(shape.raw_len()).collect();
    raw.resize(shape.raw_len(), 0);
    let packed = encode(&shape, &raw, 1).expect("the length is right");
    assert!(decode(&shape, &packed).expect("it was packed just now") == raw);

    let texels: Vec<[u8; 4]> = input.texels.iter().copied().cycle().take(2 * raw.len()).collect();
    let options = RdoOptions { lambda: f32::from(input.lambda), ..RdoOptions::default() };
    optimise(&shape, &texels, &mut raw, &options).expect("the sizes are right");
    raw.as_chunks().0.iter().for_each(|block| _ = decode_block(block));
}

//! Packed tiles from anywhere decode or are refused, without panic; what was packed comes back; RDO keeps its bound.

#![no_main]

use arbitrary::Arbitrary;
use lf_compress::bc1::decode_block;
use lf_compress::tile::{RdoOptions, TileShape, decode, encode, optimise};
use libfuzzer_sys::fuzz_target;

#[derive(Arbitrary, Debug)]
struct Input {
    cameras: [u8; 2],
    blocks: [u8; 2],
    /// Taken as a packed tile, as the content of a frame, and as blocks.
    bytes: Vec<u8>,
    texels: [[u8; 4]; 16],
    lambda: u16,
}

fuzz_target!(|input: Input| {
    let [cameras, blocks] = [input.cameras, input.blocks].map(|pair| pair.map(|n| u32::from(n % 5)));
    let Ok(shape) = TileShape::new(cameras, blocks) else { return };
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
});

//! Tiles whose stored bytes come from anywhere, in files that are sound otherwise: they unpack and decode or are refused.

use arbitrary::{Arbitrary, Unstructured};
use lf_compress::format::{Packing, SlabTiling, StoredTile, TexelEncoding};
use lf_compress::{check_tile, decode_into, unpack_into};

use crate::field::Shape;

#[derive(Arbitrary, Debug)]
struct Input {
    shape: Shape,
    encoding: u8,
    packing: u8,
    per_tile: [u8; 2],
    tile: u8,
    /// Whether the bytes are the content of a frame.
    framed: bool,
    bytes: Vec<u8>,
}

/// See the module.
pub fn run(data: &[u8]) {
    let Ok(input) = Input::arbitrary_take_rest(Unstructured::new(data)) else { return };
    let Some((geometry, coverages)) = input.shape.geometry() else { return };
    let encodings = [TexelEncoding::Bc1, TexelEncoding::Rgba8, TexelEncoding::Rgb16F];
    let encoding = encodings[usize::from(input.encoding) % 3];
    let packing = [Packing::None, Packing::Zstd, Packing::Tile][usize::from(input.packing) % 3];
    let slab = &geometry.slabs()[0];
    let per_tile = [0, 1].map(|i: usize| u32::from(input.per_tile[i]) % slab.cameras()[i] + 1);
    let Ok(tiling) = SlabTiling::covering(slab, encoding, per_tile, coverages[0].clone()) else { return };
    let tiles: Vec<u32> = tiling.stored_tiles().collect();
    let tile = tiles[usize::from(input.tile) % tiles.len()];
    let frame = zstd::bulk::compress(&input.bytes, 1).expect("zstd packs");
    let bytes = if input.framed { &frame } else { &input.bytes };
    let stored = StoredTile { packing, bytes, raw_len: tiling.raw_len(tile) };
    let mut raw = vec![0; tiling.raw_len(tile) as usize];
    let unpacked = unpack_into(&stored, &tiling, 0, tile, &mut raw);
    let checked = check_tile(&stored, &tiling, 0, tile);
    assert!(unpacked.is_ok() || checked.is_err());
    if unpacked.is_ok() && encoding != TexelEncoding::Rgb16F {
        let [width, height] = tiling.tile_size(tile);
        let mut texels = vec![[0; 4]; (width * height) as usize];
        decode_into(&raw, &tiling, tile, &mut texels).expect("the lengths are right");
    }
}

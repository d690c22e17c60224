//! Slabs that many vectors share, and their tiles in every packing.

use super::frames::zstd;
use super::paint::{Paint, raw_tile, windows};
use super::tile_codec::{Streams, encode};
use crate::assemble::File;
use crate::layout::{Field, Slab};

/// 3 × 2 cameras of 10 × 6 texels, two columns and one row in a tile: edge tiles, and images that end within a block.
pub(crate) fn uneven(encoding: u8) -> Slab {
    let st = [(-0.5, 0.5, 3), (-0.25, 0.5, 2)];
    let uv = [(-0.9, 0.2, 10), (-0.75, 0.3, 6)];
    Slab { encoding, st, uv, per_tile: [2, 1], ..Slab::smallest() }
}

/// [`uneven`] with a window of each image: the second column of cameras sees nothing.
pub(crate) fn cropped(encoding: u8) -> Slab {
    Slab { crop: Some([vec![[0, 2], [0, 0], [1, 2]], vec![[1, 1], [0, 2]]]), ..uneven(encoding) }
}

/// [`uneven`] without the cameras (1, 0) and (2, 1): the last tile is not in the file.
pub(crate) fn masked(encoding: u8) -> Slab {
    Slab { mask: Some(vec![true, false, true, true, true, false]), ..uneven(encoding) }
}

/// The streams of a tile in the tile codec.
pub(crate) fn streams(slab: &Slab, tile: u32, paint: Paint) -> Streams {
    let [columns, rows] = windows(slab, tile);
    encode(&columns, &rows, &raw_tile(slab, tile, paint))
}

/// The stored bytes of a tile.
pub(crate) fn stored(slab: &Slab, tile: u32, paint: Paint, packing: u8) -> Vec<u8> {
    match packing {
        0 => raw_tile(slab, tile, paint),
        1 => zstd(&raw_tile(slab, tile, paint)),
        _ => zstd(&streams(slab, tile, paint).content()),
    }
}

/// The file of a light field, all tiles in one packing.
pub(crate) fn file(field: &Field, paint: Paint, packing: u8) -> File {
    field.file(|slab, tile| (packing, stored(&field.slabs[slab], tile, paint, packing)))
}

/// The file of one slab with a scene.
pub(crate) fn scene(slab: Slab, packing: u8) -> File {
    file(&Field::new(vec![slab]), Paint::Scene, packing)
}

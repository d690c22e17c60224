//! A slab's blocks in memory.

use lf_compress::format::{CameraPlace, SlabTiling, TexelEncoding};
use lf_compress::{PackError, PackedLightField};
use lf_math::{Face, Slab};

use super::axis::Axis;

/// In place of where a camera's blocks begin: there are none.
pub(super) const ABSENT: u32 = u32::MAX;

/// A BC1 block: its two endpoints, the first in the low half, and its indices.
pub(super) type Block = [u32; 2];

/// One slab: camera after camera (s fastest), of each image the window that is there, row of blocks after row.
#[derive(Debug, Clone)]
pub(super) struct SlabBlocks {
    pub(super) face: Face,
    pub(super) plane: f32,
    pub(super) axes: [Axis; 2],
    /// Where each camera's blocks begin; empty if all images are whole.
    pub(super) starts: Vec<u32>,
    /// Endpoints and indices. One block more than there are, so that two can be read at each.
    pub(super) blocks: Vec<Block>,
}

impl SlabBlocks {
    pub(super) fn new(field: &PackedLightField, index: usize) -> Result<Self, PackError> {
        let (slab, tiling) = (&field.geometry().slabs()[index], &field.tilings()[index]);
        if tiling.encoding() != TexelEncoding::Bc1 {
            return Err(PackError::Encoding(tiling.encoding()));
        }
        let mut blocks = Vec::new();
        let starts = append_cameras(&mut blocks, tiling, field.tiles(index));
        let (bytes, limit) = (8 * blocks.len() as u64, 8 * u64::from(ABSENT));
        if bytes >= limit {
            return Err(PackError::TooLarge { bytes, limit });
        }
        blocks.push([0; 2]);
        let starts = if tiling.coverage().is_whole() { Vec::new() } else { starts };
        Ok(Self { face: slab.face(), plane: slab.plane(), axes: axes(slab, tiling), starts, blocks })
    }
}

fn axes(slab: &Slab, tiling: &SlabTiling) -> [Axis; 2] {
    let windows = [tiling.coverage().columns(), tiling.coverage().rows()];
    let disparity = slab.disparity().to_array();
    [0, 1].map(|i| Axis::new(slab.st()[i], slab.uv()[i], disparity[i], windows[i]))
}

/// Appends the blocks of all cameras, and returns where those of each begin. Past 2³² the numbers are wrong.
fn append_cameras(blocks: &mut Vec<Block>, tiling: &SlabTiling, tiles: &[Vec<u8>]) -> Vec<u32> {
    let numbers: Vec<u32> = tiling.stored_tiles().collect();
    let cameras = tiling.coverage().cameras();
    let mut append = |camera| {
        let place = tiling.place(camera)?;
        let tile = &tiles[numbers.binary_search(&place.tile).ok()?];
        let start = blocks.len() as u32;
        append_window(blocks, &place, tile, tiling.tile_size(place.tile)[0]);
        Some(start)
    };
    cameras.map(|camera| append(camera).unwrap_or(ABSENT)).collect()
}

/// Appends the blocks of a camera's window, which lies in a tile's picture of a width in texels.
fn append_window(blocks: &mut Vec<Block>, place: &CameraPlace, tile: &[u8], width: u32) {
    let [x, y] = place.corner.map(|n| n as usize / 4);
    let [across, down] = place.window.clone().map(|window| window.len().div_ceil(4));
    let rows = tile.as_chunks::<8>().0.chunks_exact(width as usize / 4);
    for row in rows.skip(y).take(down) {
        blocks.extend(row[x..][..across].iter().map(words));
    }
}

fn words(&[a, b, c, d, e, f, g, h]: &[u8; 8]) -> Block {
    [u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h])]
}

//! A slab's blocks in memory.

use lf_compress::format::{CameraPlace, SlabTiling, TexelEncoding};
use lf_compress::{PackError, PackedLightField};
use lf_math::{Face, Slab};

use super::axis::Axis;
use crate::palette::{Block, has_three_colors, words};

/// In place of where a camera's blocks begin: there are none.
pub(super) const ABSENT: u32 = u32::MAX;

/// Rows of cameras in a band. What a ray needs of its four images is so mostly in one page of memory: in 4 KiB there is a row of blocks of
/// 4×4 images that are 32 blocks wide. More rows would have fewer columns in a page.
pub(super) const BAND: u32 = 4;

/// One slab. Whole images are [`interleaved`]; of others, camera after camera (s fastest), the window that is there, row of blocks
/// after row.
#[derive(Debug, Clone)]
pub(super) struct SlabBlocks {
    pub(super) face: Face,
    pub(super) plane: f32,
    pub(super) axes: [Axis; 2],
    /// Where each camera's blocks begin; empty if all images are whole.
    pub(super) starts: Vec<u32>,
    /// Recoded blocks ([`words`]). Two more than there are, so that two can be read at each, and if there is none.
    pub(super) blocks: Vec<Block>,
    /// Whether any block has three colours.
    pub(super) three: bool,
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
        let axes = axes(slab, tiling);
        let whole = tiling.coverage().is_whole();
        let (starts, mut blocks) = if whole { (Vec::new(), interleaved(&blocks, &axes)) } else { (starts, blocks) };
        blocks.extend([[0; 2]; 2]);
        let three = blocks.iter().any(has_three_colors);
        Ok(Self { face: slab.face(), plane: slab.plane(), axes, starts, blocks, three })
    }
}

fn axes(slab: &Slab, tiling: &SlabTiling) -> [Axis; 2] {
    let windows = [tiling.coverage().columns(), tiling.coverage().rows()];
    let disparity = slab.disparity().to_array();
    [0, 1].map(|i| Axis::new(slab.st()[i], slab.uv()[i], disparity[i], windows[i]))
}

/// Whole images in bands of [`BAND`] rows of cameras: row of blocks after row, and of each those of the band's cameras, t fastest.
fn interleaved(blocks: &[Block], axes: &[Axis; 2]) -> Vec<Block> {
    let [across, down] = axes.each_ref().map(|axis| axis.cameras() as usize);
    let [width, height] = axes.each_ref().map(|axis| axis.blocks() as usize);
    let mut out = Vec::with_capacity(blocks.len() + 1);
    for band in (0..down).step_by(BAND as usize) {
        let rows = band..(band + BAND as usize).min(down);
        for (y, s) in (0..height).flat_map(|y| (0..across).map(move |s| (y, s))) {
            for camera in rows.clone().map(|t| t * across + s) {
                out.extend_from_slice(&blocks[(camera * height + y) * width..][..width]);
            }
        }
    }
    out
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

//! Cutting an encoded light field anew, without decoding it: other windows, other cameras, other tiles.

use std::ops::Range;

use glam::Vec3;
use lf_format::{CameraPlace, SlabTiling};
use lf_math::{Coverage, Slab};
use rayon::prelude::*;

use crate::error::PackError;
use crate::packed::PackedLightField;
use crate::picture::{Unit, cameras_of};
use crate::volume::cameras_per_tile;

impl PackedLightField {
    /// The same light field with what no ray through the cell asks for left out (clause 6 of the file format).
    ///
    /// Every such ray finds the same texels, bit by bit: blocks are moved, not encoded again. Slabs of which nothing is
    /// needed keep what they have.
    ///
    /// # Errors
    /// If the volume would be too large.
    pub fn cropped(&self) -> Result<Self, PackError> {
        let half_extent = self.geometry().cell().half_extent();
        self.cropped_to([-half_extent, half_extent])
    }

    /// As [`Self::cropped`], for rays from a box given by its least and greatest corner, cell space, metres: where a reflector stays
    /// in part of the cell. Cameras that none of these rays asks for are left out altogether.
    ///
    /// # Errors
    /// As [`Self::cropped`].
    pub fn cropped_to(&self, corners: [Vec3; 2]) -> Result<Self, PackError> {
        let slabs = self.geometry().slabs().iter().zip(self.tilings());
        let needed = slabs.map(|(slab, tiling)| {
            let needed = Coverage::of_box(slab, corners).intersection(tiling.coverage());
            if needed.keeps_any() { needed } else { tiling.coverage().clone() }
        });
        self.recut(needed.collect())
    }

    /// The same light field with whole images of all cameras, in at most `max_bytes`. What is not stored is zero: black.
    ///
    /// # Errors
    /// If it would take more, or the volume would be too large.
    pub fn whole(&self, max_bytes: u64) -> Result<Self, PackError> {
        let (slabs, tilings) = (self.geometry().slabs(), self.tilings());
        let slab_bytes = |(slab, tiling): (&Slab, &SlabTiling)| {
            let blocks = slab.resolution().map(|texels| u64::from(texels).div_ceil(4));
            let counts = slab.cameras().map(u64::from).into_iter().chain(blocks);
            counts.fold(tiling.encoding().block_len(), u64::saturating_mul)
        };
        let bytes = slabs.iter().zip(tilings).map(slab_bytes).fold(0, u64::saturating_add);
        if bytes > max_bytes {
            return Err(PackError::TooLarge { bytes, limit: max_bytes });
        }
        self.recut(slabs.iter().map(Coverage::whole).collect())
    }

    /// Cuts each slab to a coverage, rounded out to blocks.
    fn recut(&self, coverages: Vec<Coverage>) -> Result<Self, PackError> {
        let mut tilings = Vec::new();
        for ((slab, tiling), coverage) in self.geometry().slabs().iter().zip(self.tilings()).zip(coverages) {
            let per_tile = cameras_per_tile(&coverage);
            tilings.push(SlabTiling::covering(slab, tiling.encoding(), per_tile, coverage)?);
        }
        let cut_slab = |(slab, tiling): (usize, &SlabTiling)| {
            let old: Vec<u32> = self.tilings()[slab].stored_tiles().collect();
            let source = Cut { tiling: &self.tilings()[slab], tiles: old.into_iter().zip(self.tiles(slab)).collect() };
            let stored: Vec<u32> = tiling.stored_tiles().collect();
            stored.into_par_iter().map(|tile| source.tile(tiling, tile)).collect()
        };
        let tiles = tilings.iter().enumerate().map(cut_slab).collect();
        Self::from_tiles(self.geometry().clone(), tilings, tiles)
    }
}

/// A slab as it is cut now.
struct Cut<'a> {
    tiling: &'a SlabTiling,
    /// By number.
    tiles: Vec<(u32, &'a Vec<u8>)>,
}

impl Cut<'_> {
    /// A tile of another cut of the same slab.
    fn tile(&self, tiling: &SlabTiling, tile: u32) -> Vec<u8> {
        let mut out = vec![0; tiling.raw_len(tile) as usize];
        for camera in cameras_of(tiling, tile) {
            self.copy_camera(tiling, camera, &mut out);
        }
        out
    }

    /// Copies what both cuts hold of a camera's image, padding included, into its tile.
    fn copy_camera(&self, tiling: &SlabTiling, camera: [u32; 2], out: &mut [u8]) {
        let (Some(to), Some(from)) = (tiling.place(camera), self.tiling.place(camera)) else { return };
        let Ok(found) = self.tiles.binary_search_by_key(&from.tile, |(tile, _)| *tile) else { return };
        let (unit, source) = (Unit::of(tiling.encoding()), self.tiles[found].1);
        let [u, v] = [0, 1].map(|i: usize| common(&padded(&from.window[i]), &padded(&to.window[i])));
        let (from_width, to_width) = (self.tiling.tile_size(from.tile)[0], tiling.tile_size(to.tile)[0]);
        for y in v.step_by(unit.texels as usize) {
            let start = |place: &CameraPlace, width: u32| {
                let [x, y] =
                    [place.corner[0] + u.start - place.window[0].start, place.corner[1] + y - place.window[1].start];
                unit.offset(width, [x, y])
            };
            let (from, to) = (start(&from, from_width), start(&to, to_width));
            let len = unit.row_bytes(u.end - u.start);
            out[to..to + len].copy_from_slice(&source[from..from + len]);
        }
    }
}

/// A window with the padding that makes it whole blocks.
fn padded(window: &Range<u32>) -> Range<u32> {
    window.start..window.end.next_multiple_of(4)
}

fn common(a: &Range<u32>, b: &Range<u32>) -> Range<u32> {
    let start = a.start.max(b.start);
    start..a.end.min(b.end).max(start)
}

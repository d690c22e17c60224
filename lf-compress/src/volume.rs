//! Where each camera image lies in the volume texture (§7 and Fig. 8 of the paper).
//!
//! A *slice* is the picture of a tile: neighbouring camera images, or what is kept of them. A slab fills consecutive slices in
//! the order `idx.y·groups_s + idx.x`, `idx` being the tile's place in the slab.
//!
//! Whole slabs make a volume whose sizes are powers of two, as the paper's hardware wanted, each slab having a *slot* of
//! equally many slices: six slabs of 32×32 cameras × 128×128 texels take 8 slots of 1024×1024×16 in 1024×1024×128, 64 MiB in
//! BC1. Cropped slabs would lose to rounding what they gain, and slabs follow each other without gaps.

use std::cmp::Reverse;

use lf_format::{CameraPlace, SlabTiling, TexelEncoding};
use lf_math::{Coverage, Windows};
use thiserror::Error;

use crate::picture::Unit;
use crate::{PackError, PackedLightField, rgba16f};

/// Edge length in texels that a slice has where camera images are small enough: the paper's 1024.
///
/// Smaller slices would mean more of them (3D textures end at 2048); larger ones make tiles coarser to load.
const SLICE_EDGE: u32 = 1024;
/// Edge that slices of cropped images do not exceed: every device has 3D textures of this size.
const CROPPED_EDGE: u32 = 2048;

/// The volume would be larger than its coordinates can say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("the packed volume would exceed 2^31 texels along an axis; use fewer cameras or smaller images")]
pub struct VolumeTooLarge;

/// The place of every texel of a light field in one volume.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VolumeLayout {
    size: [u32; 3],
    slabs: Vec<SlabLayout>,
}

/// One slab's part of the volume.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SlabLayout {
    tiling: SlabTiling,
    /// For each column and each row of tiles: its number among those that are not empty.
    ranks: [Vec<Option<u32>>; 2],
    groups: [u32; 2],
    first_slice: u32,
}

/// A texel of the light field by its integer indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sample {
    /// Position of the slab in the light field.
    pub slab: usize,
    /// Camera (s, t).
    pub camera: [u32; 2],
    /// Texel (u, v).
    pub texel: [u32; 2],
}

/// How many cameras of a slab, of which `coverage` is kept, share a tile along s and t.
///
/// Of whole images the largest power of two that fits in 1024 texels, at least one, and not more than there are. Of
/// windows as many as waste least where the tiles of a row differ in width, within 2048 texels.
#[must_use]
pub fn cameras_per_tile(coverage: &Coverage) -> [u32; 2] {
    let coverage = coverage.clone().aligned(4);
    [coverage.columns(), coverage.rows()].map(|windows| {
        if windows.is_whole() { whole_per_tile(windows.cameras(), windows.texels()) } else { cropped_per_tile(windows) }
    })
}

fn whole_per_tile(cameras: u32, texels: u32) -> u32 {
    let fitting = SLICE_EDGE / texels.checked_next_multiple_of(4).unwrap_or(u32::MAX);
    let largest = if fitting == 0 { 1 } else { 1 << fitting.ilog2() };
    cameras.min(largest)
}

/// The number with which tiles as wide as the widest cover least; of equal ones the largest: cameras of one tile are packed
/// against each other.
fn cropped_per_tile(windows: &Windows) -> u32 {
    let widths: Vec<u32> = windows.iter().map(|window| (window.end - window.start).next_multiple_of(4)).collect();
    let cost = |per_tile: usize| {
        let tiles = widths.chunks(per_tile).map(|tile| tile.iter().map(|&w| u64::from(w)).sum::<u64>());
        let widest = tiles.max().unwrap_or(0);
        (per_tile > 1 && widest > u64::from(CROPPED_EDGE), widest * widths.len().div_ceil(per_tile) as u64)
    };
    // More cameras than this are wider than the edge, but for empty windows.
    let most = widths.len().min(CROPPED_EDGE as usize / 4);
    (1..=most).min_by_key(|&per_tile| (cost(per_tile), Reverse(per_tile))).unwrap_or(1) as u32
}

impl VolumeLayout {
    /// The layout of a light field's slabs, each tile a slice.
    ///
    /// # Errors
    /// If an axis of the volume would reach 2³¹ texels.
    pub fn new(tilings: &[SlabTiling]) -> Result<Self, VolumeTooLarge> {
        let slabs: Vec<_> = tilings.iter().map(SlabLayout::new).collect();
        Self::place(slabs).ok_or(VolumeTooLarge)
    }

    /// Gives each slab its slices.
    fn place(mut slabs: Vec<SlabLayout>) -> Option<Self> {
        let whole = slabs.iter().all(|slab| slab.tiling.coverage().is_whole());
        let rounded = |n: u32| if whole { n.checked_next_power_of_two() } else { Some(n) };
        let largest = |f: &dyn Fn(&SlabLayout) -> u32| slabs.iter().map(f).max().unwrap_or(0);
        let [width, height] = [0, 1].map(|axis| rounded(largest(&|slab| slab.slice_size()[axis])));
        let slot = if whole { Some(rounded(largest(&SlabLayout::slices))?) } else { None };
        let mut depth = 0u32;
        for slab in &mut slabs {
            slab.first_slice = depth;
            depth = depth.checked_add(slot.unwrap_or(slab.slices()))?;
        }
        let size = [width?, height?, rounded(depth)?];
        size.iter().all(|&n| n < 1 << 31).then_some(Self { size, slabs })
    }

    /// Width, height and depth in texels.
    #[must_use]
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// Slices up to the last that a slab has: what is left of the depth is there to make it a power of two.
    #[must_use]
    pub fn slices(&self) -> u32 {
        self.slabs.iter().map(|slab| slab.first_slice + slab.slices()).max().unwrap_or(0)
    }

    /// The parts, by position of the slab.
    #[must_use]
    pub fn slabs(&self) -> &[SlabLayout] {
        &self.slabs
    }

    /// Where a sample lies: texel x, y and slice z. `None` for indices outside the light field and what is not stored.
    #[must_use]
    pub fn texel(&self, sample: &Sample) -> Option<[u32; 3]> {
        let slab = self.slabs.get(sample.slab)?;
        let CameraPlace { tile, corner, window } = slab.tiling.place(sample.camera)?;
        let inside = |i: usize| window[i].contains(&sample.texel[i]);
        (inside(0) && inside(1)).then_some(())?;
        let place = |i: usize| corner[i] + sample.texel[i] - window[i].start;
        Some([place(0), place(1), slab.slice(tile)?])
    }

    /// The sample at a texel of the volume; `None` where none is stored. Inverse of [`Self::texel`].
    #[must_use]
    pub fn sample(&self, texel: [u32; 3]) -> Option<Sample> {
        let within = |slab: &&SlabLayout| texel[2].checked_sub(slab.first_slice).is_some_and(|z| z < slab.slices());
        let (slab, part) = self.slabs.iter().enumerate().find(|(_, slab)| within(slab))?;
        let [columns, rows] = part.tiling.cameras_of(part.tile(texel[2])?);
        let camera = [
            last_before(columns, |s| part.tiling.column_place(s), texel[0])?,
            last_before(rows, |t| part.tiling.row_place(t), texel[1])?,
        ];
        let CameraPlace { corner, window, .. } = part.tiling.place(camera)?;
        let at = |i: usize| Some(window[i].start + texel[i].checked_sub(corner[i])?).filter(|u| window[i].contains(u));
        Some(Sample { slab, camera, texel: [at(0)?, at(1)?] })
    }
}

impl PackedLightField {
    /// The slices of the volume as a graphics API takes them, each whole: rows of BC1 blocks, of RGBA8 texels, or of RGBA half
    /// floats for half-float texels. What no tile covers is zero. All slabs must have the same encoding, and the slices take at
    /// most `max_bytes`.
    ///
    /// # Errors
    /// [`PackError::Encoding`] if a slab has another than the first, [`PackError::TooLarge`] if more would be needed.
    pub fn volume_slices(&self, max_bytes: u64) -> Result<Vec<Vec<u8>>, PackError> {
        let encoding = self.tilings()[0].encoding();
        if let Some(other) = self.tilings().iter().find(|tiling| tiling.encoding() != encoding) {
            return Err(PackError::Encoding(other.encoding()));
        }
        let ([width, height, depth], unit) = (self.layout().size(), Unit::of(encoding));
        let blocks =
            [width, height].map(|texels| u64::from(texels / 4)).iter().product::<u64>().saturating_mul(depth.into());
        // Half floats get a fourth channel.
        let block_len = if encoding == TexelEncoding::Rgb16F { 128 } else { encoding.block_len() };
        let bytes = blocks.saturating_mul(block_len);
        if bytes > max_bytes {
            return Err(PackError::TooLarge { bytes, limit: max_bytes });
        }
        let rows = (height / unit.texels) as usize;
        let mut slices = vec![vec![0; unit.row_bytes(width) * rows]; depth as usize];
        for (slab, layout) in self.layout().slabs().iter().enumerate() {
            for (number, tile) in layout.tiling().stored_tiles().zip(self.tiles(slab)) {
                let Some(slice) = layout.slice(number) else { continue };
                let tile_row = unit.row_bytes(layout.tiling().tile_size(number)[0]);
                let rows = slices[slice as usize].chunks_exact_mut(unit.row_bytes(width));
                rows.zip(tile.chunks_exact(tile_row)).for_each(|(to, from)| to[..tile_row].copy_from_slice(from));
            }
        }
        if encoding == TexelEncoding::Rgb16F {
            slices = slices.iter().map(|slice| rgba16f(slice)).collect();
        }
        Ok(slices)
    }
}

/// The last camera of a range whose window begins at or before a texel: those before it begin no later.
fn last_before(cameras: std::ops::Range<u32>, place: impl Fn(u32) -> u32, texel: u32) -> Option<u32> {
    cameras.rev().find(|&camera| place(camera) <= texel)
}

impl SlabLayout {
    fn new(tiling: &SlabTiling) -> Self {
        let [across, down] = tiling.tiles();
        let filled = |n: u32, extent: &dyn Fn(u32) -> u32| {
            let mut next = 0..;
            (0..n).map(|i| if extent(i) > 0 { next.next() } else { None }).collect::<Vec<Option<u32>>>()
        };
        let ranks = [filled(across, &|i| tiling.tile_size(i)[0]), filled(down, &|j| tiling.tile_size(j * across)[1])];
        let groups = [0, 1].map(|i: usize| ranks[i].iter().flatten().count() as u32);
        Self { tiling: tiling.clone(), ranks, groups, first_slice: 0 }
    }

    /// Width and height that its slices need.
    fn slice_size(&self) -> [u32; 2] {
        let [across, down] = self.tiling.tiles();
        [
            (0..across).map(|i| self.tiling.tile_size(i)[0]).max().unwrap_or(0),
            (0..down).map(|j| self.tiling.tile_size(j * across)[1]).max().unwrap_or(0),
        ]
    }

    /// How the slab is stored.
    #[must_use]
    pub fn tiling(&self) -> &SlabTiling {
        &self.tiling
    }

    /// Slices along s and t: tiles, those without any window left out.
    #[must_use]
    pub fn groups(&self) -> [u32; 2] {
        self.groups
    }

    /// Number of slices. One whose cameras are all left out is there, but empty.
    #[must_use]
    pub fn slices(&self) -> u32 {
        self.groups[0] * self.groups[1]
    }

    /// The volume slice where the slab begins.
    #[must_use]
    pub fn first_slice(&self) -> u32 {
        self.first_slice
    }

    /// The number of a column (axis 0) or row (axis 1) of tiles among those that are not empty.
    #[must_use]
    pub fn rank(&self, axis: usize, tile: u32) -> Option<u32> {
        *self.ranks.get(axis)?.get(tile as usize)?
    }

    /// The volume slice of a tile; `None` if it holds no window.
    #[must_use]
    pub fn slice(&self, tile: u32) -> Option<u32> {
        let [across, _] = self.tiling.tiles();
        Some(self.first_slice + self.rank(1, tile / across)? * self.groups[0] + self.rank(0, tile % across)?)
    }

    /// The tile in a volume slice.
    fn tile(&self, slice: u32) -> Option<u32> {
        let place = slice.checked_sub(self.first_slice)?;
        let find = |axis: usize, rank: u32| self.ranks[axis].iter().position(|&r| r == Some(rank)).map(|i| i as u32);
        Some(find(1, place / self.groups[0])? * self.tiling.tiles()[0] + find(0, place % self.groups[0])?)
    }
}

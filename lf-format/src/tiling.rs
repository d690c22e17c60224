//! How the camera images of a slab are cut into tiles (spec §7.1 and §7.2).

use alloc::vec::Vec;
use core::ops::Range;

use lf_math::{Coverage, Slab};

use crate::geometry::check_cameras_per_tile;
use crate::{FormatError, TexelEncoding};

/// Edge of a BC1 block in texels. Windows are whole blocks in every encoding, so that re-encoding a file moves no texel.
pub(crate) const BLOCK: u32 = 4;

/// How one slab is stored: its texel encoding, what is kept of its images, and how many neighbouring cameras share a
/// tile.
///
/// Tile (i, j), number `j·tiles_s + i`, holds the cameras from `[i·gs, j·gt]` on, where `[gs, gt]` are the cameras per tile,
/// as far as there are any. Unpacked it is one picture: the windows of its cameras, in whole blocks of 4×4 texels, beside
/// and below each other without gaps. A tile of which no camera is stored is not in the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SlabTiling {
    encoding: TexelEncoding,
    cameras_per_tile: [u32; 2],
    coverage: Coverage,
    /// Whether cameras are left out that have a window.
    masked: bool,
    axes: [Axis; 2],
}

/// One axis of the cut: columns of cameras along s with windows along u, or rows along t with windows along v.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Axis {
    /// Where the window of each camera begins in its tile's picture, texels.
    places: Vec<u32>,
    /// How many texels the picture of each tile has.
    extents: Vec<u32>,
}

/// Where the window of one camera lies.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CameraPlace {
    /// The number of its tile.
    pub tile: u32,
    /// The place [x, y] of the window's first texel in the tile's picture, x to the right and y down.
    pub corner: [u32; 2],
    /// The window along u and v, in texels of the whole image, without padding.
    pub window: [Range<u32>; 2],
}

impl SlabTiling {
    /// The tiling of whole images with `cameras_per_tile` along (s, t).
    ///
    /// # Errors
    /// As [`Self::covering`].
    pub fn new(slab: &Slab, encoding: TexelEncoding, cameras_per_tile: [u32; 2]) -> Result<Self, FormatError> {
        Self::covering(slab, encoding, cameras_per_tile, Coverage::whole(slab))
    }

    /// The tiling of what `coverage` keeps, its windows rounded out to blocks of 4 texels.
    ///
    /// # Errors
    /// [`FormatError::InvalidArgument`] if the coverage is that of another slab or empty, a tile would hold no camera or more than
    /// there are, or a size would not fit its integer.
    pub fn covering(
        slab: &Slab,
        encoding: TexelEncoding,
        cameras_per_tile: [u32; 2],
        coverage: Coverage,
    ) -> Result<Self, FormatError> {
        let cameras = [coverage.columns().len(), coverage.rows().len()];
        if cameras != slab.cameras().map(|n| n as usize) || coverage.resolution() != slab.resolution() {
            return Err(FormatError::argument("the coverage is that of another slab"));
        }
        check_cameras_per_tile(slab, cameras_per_tile).map_err(FormatError::argument)?;
        if !coverage.keeps_any() {
            return Err(FormatError::argument("a slab must store at least one camera; leave it out instead"));
        }
        Self::checked(encoding, cameras_per_tile, coverage)
            .ok_or_else(|| FormatError::argument("the slab or its tiles are too large"))
    }

    /// As [`Self::covering`] for numbers that are known to fit each other; `None` if a size does not fit its integer.
    pub(crate) fn checked(encoding: TexelEncoding, cameras_per_tile: [u32; 2], coverage: Coverage) -> Option<Self> {
        let coverage = coverage.aligned(BLOCK);
        let axes =
            [Axis::new(coverage.columns(), cameras_per_tile[0])?, Axis::new(coverage.rows(), cameras_per_tile[1])?];
        let [across, down] = [0, 1].map(|i: usize| u32::try_from(axes[i].extents.len()).ok());
        across?.checked_mul(down?)?;
        let masked = !coverage.keeps_all_cameras();
        Some(Self { encoding, cameras_per_tile, coverage, masked, axes })
    }

    /// How texels are stored.
    #[must_use]
    pub fn encoding(&self) -> TexelEncoding {
        self.encoding
    }

    /// What is stored of the images; windows are whole blocks, but end with the image.
    #[must_use]
    pub fn coverage(&self) -> &Coverage {
        &self.coverage
    }

    /// Number of cameras of the slab along s and t.
    #[must_use]
    pub fn cameras(&self) -> [u32; 2] {
        [0, 1].map(|i: usize| self.axes[i].places.len() as u32)
    }

    /// Texels of one whole camera image along u and v, without padding.
    #[must_use]
    pub fn resolution(&self) -> [u32; 2] {
        self.coverage.resolution()
    }

    /// Cameras of one tile along s and t.
    #[must_use]
    pub fn cameras_per_tile(&self) -> [u32; 2] {
        self.cameras_per_tile
    }

    /// Number of tiles along s and t, those that are not stored among them.
    #[must_use]
    pub fn tiles(&self) -> [u32; 2] {
        [0, 1].map(|i: usize| self.axes[i].extents.len() as u32)
    }

    /// The numbers of the tiles that are stored, in ascending order.
    pub fn stored_tiles(&self) -> impl Iterator<Item = u32> {
        let [across, _] = self.tiles();
        let [columns, rows] = [0, 1].map(|i: usize| self.axes[i].filled());
        let numbers = rows.into_iter().flat_map(move |j| columns.clone().into_iter().map(move |i| j * across + i));
        numbers.filter(|&tile| self.stores(tile))
    }

    /// Whether a tile is stored: at least one of its cameras is.
    #[must_use]
    pub fn stores(&self, tile: u32) -> bool {
        let [columns, rows] = self.cameras_of(tile);
        // Without a mask no camera need be tried: windows can leave one of four billion.
        let any_camera = || rows.clone().any(|t| columns.clone().any(|s| self.coverage.window([s, t]).is_some()));
        !self.tile_size(tile).contains(&0) && (!self.masked || any_camera())
    }

    /// The cameras of a tile along s and t; empty if there is no such tile.
    #[must_use]
    pub fn cameras_of(&self, tile: u32) -> [Range<u32>; 2] {
        let ([across, down], [per_s, per_t]) = (self.tiles(), self.cameras_per_tile);
        let (i, j) = (tile % across, tile / across);
        if j >= down {
            return [0..0, 0..0];
        }
        let [cameras_s, cameras_t] = self.cameras();
        // Nothing overflows: the first camera of a tile exists.
        let range = |i: u32, per: u32, count: u32| i * per..(i * per).saturating_add(per).min(count);
        [range(i, per_s, cameras_s), range(j, per_t, cameras_t)]
    }

    /// The windows of a tile's columns along u and of its rows along v, in blocks of the whole image.
    #[must_use]
    pub fn block_windows(&self, tile: u32) -> [Vec<Range<u32>>; 2] {
        let [columns, rows] = self.cameras_of(tile);
        let blocks = |window: &Range<u32>| window.start / BLOCK..window.end.div_ceil(BLOCK);
        let of = |windows: &[Range<u32>], cameras: Range<u32>| {
            windows.get(cameras.start as usize..cameras.end as usize).unwrap_or_default().iter().map(blocks).collect()
        };
        [of(self.coverage.columns(), columns), of(self.coverage.rows(), rows)]
    }

    /// Width and height of a tile's picture, texels; 0 for a tile that there is not.
    #[must_use]
    pub fn tile_size(&self, tile: u32) -> [u32; 2] {
        let [across, _] = self.tiles();
        let extent = |axis: &Axis, i: u32| axis.extents.get(i as usize).copied().unwrap_or(0);
        [extent(&self.axes[0], tile % across), extent(&self.axes[1], tile / across)]
    }

    /// Length of one unpacked tile, bytes.
    #[must_use]
    pub fn raw_len(&self, tile: u32) -> u64 {
        let [width, height] = self.tile_size(tile).map(|texels| u64::from(texels / BLOCK));
        width.saturating_mul(height).saturating_mul(self.encoding.block_len())
    }

    /// Where the window of a camera (s, t) is; `None` if the camera is not stored.
    #[must_use]
    pub fn place(&self, camera: [u32; 2]) -> Option<CameraPlace> {
        let window = self.coverage.window(camera)?;
        let [per_s, per_t] = self.cameras_per_tile;
        let corner = [self.column_place(camera[0]), self.row_place(camera[1])];
        Some(CameraPlace { tile: camera[1] / per_t * self.tiles()[0] + camera[0] / per_s, corner, window })
    }
}

impl SlabTiling {
    /// Where the windows of a column of cameras begin in their tile's pictures: texels from the left. 0 if there is no such
    /// column.
    #[must_use]
    pub fn column_place(&self, s: u32) -> u32 {
        self.axes[0].places.get(s as usize).copied().unwrap_or(0)
    }

    /// Where the windows of a row of cameras begin in their tile's pictures: texels from the top. 0 if there is no such row.
    #[must_use]
    pub fn row_place(&self, t: u32) -> u32 {
        self.axes[1].places.get(t as usize).copied().unwrap_or(0)
    }
}

impl Axis {
    /// `None` if a tile would be too large.
    fn new(windows: &[Range<u32>], per_tile: u32) -> Option<Self> {
        let mut axis = Self { places: Vec::with_capacity(windows.len()), extents: Vec::new() };
        for tile in windows.chunks(per_tile as usize) {
            let mut end = 0u32;
            for window in tile {
                axis.places.push(end);
                let blocks = window.end.div_ceil(BLOCK) - window.start / BLOCK;
                end = end.checked_add(blocks.checked_mul(BLOCK)?)?;
            }
            axis.extents.push(end);
        }
        Some(axis)
    }

    /// The columns or rows of tiles that are not empty.
    fn filled(&self) -> Vec<u32> {
        (0u32..).zip(&self.extents).filter(|&(_, &extent)| extent > 0).map(|(i, _)| i).collect()
    }
}

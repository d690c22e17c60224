//! How the camera images of a slab are cut into tiles (spec §7.1 and §7.2).

use alloc::vec::Vec;
use core::ops::Range;

use lf_math::{Coverage, Slab, Windows};

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
    axes: [Axis; 2],
}

/// One axis of the cut: columns of cameras along s with windows along u, or rows along t with windows along v.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Axis {
    /// Whole images, padded to `pitch` texels.
    Whole { cameras: u32, per_tile: u32, pitch: u32 },
    Cropped {
        /// Where the window of each camera begins in its tile's picture, texels.
        places: Vec<u32>,
        /// How many texels the picture of each tile has.
        extents: Vec<u32>,
    },
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
        let cameras = [coverage.columns().cameras(), coverage.rows().cameras()];
        if cameras != slab.cameras() || coverage.resolution() != slab.resolution() {
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
        let [per_s, per_t] = cameras_per_tile;
        let axes = [Axis::new(coverage.columns(), per_s)?, Axis::new(coverage.rows(), per_t)?];
        axes[0].tiles().checked_mul(axes[1].tiles())?;
        Some(Self { encoding, cameras_per_tile, coverage, axes })
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
        [self.coverage.columns().cameras(), self.coverage.rows().cameras()]
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
        [self.axes[0].tiles(), self.axes[1].tiles()]
    }

    /// The numbers of the tiles that are stored, in ascending order.
    pub fn stored_tiles(&self) -> impl Iterator<Item = u32> {
        let ([across, _], columns, rows) = (self.tiles(), self.axes[0].filled(), self.axes[1].filled());
        let count = columns.count() * rows.count();
        let number = move |n: u32| Some(rows.get(n / columns.count())? * across + columns.get(n % columns.count())?);
        let unmasked = self.coverage.keeps_all_cameras();
        (0..count).filter_map(number).filter(move |&tile| unmasked || self.stores(tile))
    }

    /// Whether a tile is stored: at least one of its cameras is.
    #[must_use]
    pub fn stores(&self, tile: u32) -> bool {
        let [columns, rows] = self.cameras_of(tile);
        // Without a mask no camera need be tried: windows can leave one of four billion.
        let any_camera = || rows.clone().any(|t| columns.clone().any(|s| self.coverage.window([s, t]).is_some()));
        !self.tile_size(tile).contains(&0) && (self.coverage.keeps_all_cameras() || any_camera())
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
        let blocks = |window: Range<u32>| window.start / BLOCK..window.end.div_ceil(BLOCK);
        let of = |windows: &Windows, cameras: Range<u32>| cameras.filter_map(|i| windows.get(i)).map(blocks).collect();
        [of(self.coverage.columns(), columns), of(self.coverage.rows(), rows)]
    }

    /// Width and height of a tile's picture, texels; 0 for a tile that there is not.
    #[must_use]
    pub fn tile_size(&self, tile: u32) -> [u32; 2] {
        let [across, _] = self.tiles();
        [self.axes[0].extent(tile % across), self.axes[1].extent(tile / across)]
    }

    /// Length of one unpacked tile, bytes.
    #[must_use]
    pub fn raw_len(&self, tile: u32) -> u64 {
        let [width, height] = self.tile_size(tile).map(|texels| u64::from(texels / BLOCK));
        width.saturating_mul(height).saturating_mul(self.encoding.block_len())
    }

    /// Length of all tiles unpacked, those that are not stored among them, bytes; `None` for 2⁶⁴ and more.
    pub(crate) fn total_raw_len(&self) -> Option<u64> {
        let [across, down] = [self.axes[0].total() / u64::from(BLOCK), self.axes[1].total() / u64::from(BLOCK)];
        across.checked_mul(down)?.checked_mul(self.encoding.block_len())
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
        self.axes[0].place(s)
    }

    /// Where the windows of a row of cameras begin in their tile's pictures: texels from the top. 0 if there is no such row.
    #[must_use]
    pub fn row_place(&self, t: u32) -> u32 {
        self.axes[1].place(t)
    }
}

impl Axis {
    /// `None` if a tile would be too large. `per_tile` is at least 1 and at most the number of cameras.
    fn new(windows: &Windows, per_tile: u32) -> Option<Self> {
        if windows.is_whole() {
            let pitch = windows.texels().checked_next_multiple_of(BLOCK)?;
            pitch.checked_mul(per_tile)?;
            return Some(Self::Whole { cameras: windows.cameras(), per_tile, pitch });
        }
        let (mut places, mut extents) = (Vec::new(), Vec::new());
        let mut end = 0u32;
        for (camera, window) in (0u32..).zip(windows.iter()) {
            if camera % per_tile == 0 {
                extents.push(0);
                end = 0;
            }
            places.push(end);
            let blocks = window.end.div_ceil(BLOCK) - window.start / BLOCK;
            end = end.checked_add(blocks.checked_mul(BLOCK)?)?;
            *extents.last_mut()? = end;
        }
        Some(Self::Cropped { places, extents })
    }

    /// Number of tiles, empty ones too.
    fn tiles(&self) -> u32 {
        match self {
            Self::Whole { cameras, per_tile, .. } => cameras.div_ceil(*per_tile),
            Self::Cropped { extents, .. } => extents.len() as u32,
        }
    }

    /// Texels of a tile's picture; 0 if there is no such tile.
    fn extent(&self, tile: u32) -> u32 {
        match self {
            Self::Whole { cameras, per_tile, pitch } => {
                cameras.saturating_sub(tile.saturating_mul(*per_tile)).min(*per_tile) * pitch
            }
            Self::Cropped { extents, .. } => extents.get(tile as usize).copied().unwrap_or(0),
        }
    }

    /// Texels of the pictures of all tiles.
    fn total(&self) -> u64 {
        match self {
            Self::Whole { cameras, pitch, .. } => u64::from(*cameras) * u64::from(*pitch),
            Self::Cropped { extents, .. } => extents.iter().map(|&extent| u64::from(extent)).sum(),
        }
    }

    /// Where the window of a camera begins in its tile's picture; 0 if there is no such camera.
    fn place(&self, camera: u32) -> u32 {
        match self {
            Self::Whole { cameras, per_tile, pitch } if camera < *cameras => camera % per_tile * pitch,
            Self::Whole { .. } => 0,
            Self::Cropped { places, .. } => places.get(camera as usize).copied().unwrap_or(0),
        }
    }

    /// The columns or rows of tiles that are not empty.
    fn filled(&self) -> Filled {
        match self {
            Self::Whole { .. } => Filled::All(self.tiles()),
            Self::Cropped { extents, .. } => {
                Filled::These((0u32..).zip(extents).filter(|&(_, &extent)| extent > 0).map(|(i, _)| i).collect())
            }
        }
    }
}

/// Which columns or rows of tiles are not empty.
enum Filled {
    All(u32),
    These(Vec<u32>),
}

impl Filled {
    fn count(&self) -> u32 {
        match self {
            Self::All(count) => *count,
            Self::These(list) => list.len() as u32,
        }
    }

    fn get(&self, n: u32) -> Option<u32> {
        match self {
            Self::All(count) => (n < *count).then_some(n),
            Self::These(list) => list.get(n as usize).copied(),
        }
    }
}

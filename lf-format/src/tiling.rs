//! How the camera images of a slab are cut into tiles (spec §7).

use lf_math::Slab;

use crate::{FormatError, Packing};

/// Edge of a BC1 block in texels. Images are padded to multiples of it in either encoding, so that re-encoding a file
/// moves no texel.
const BLOCK: u32 = 4;

/// How texels are stored in a raw tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum TexelEncoding {
    /// Opaque BC1 (DXT1) blocks, 4×4 texels in 8 bytes (spec §7.3).
    Bc1,
    /// Four bytes a texel: red, green, blue, 255 (spec §7.4).
    Rgba8,
}

impl TexelEncoding {
    pub(crate) fn id(self) -> u8 {
        match self {
            Self::Bc1 => 1,
            Self::Rgba8 => 2,
        }
    }

    pub(crate) fn from_id(id: u8) -> Option<Self> {
        [Self::Bc1, Self::Rgba8].into_iter().find(|encoding| encoding.id() == id)
    }

    /// Whether tiles of this encoding may be packed so.
    pub(crate) fn allows(self, packing: Packing) -> bool {
        self == Self::Bc1 || packing != Packing::Tile
    }

    /// Bytes of 4×4 texels.
    fn block_len(self) -> u64 {
        match self {
            Self::Bc1 => 8,
            Self::Rgba8 => 64,
        }
    }
}

/// How one slab is stored: its texel encoding, and how many neighbouring cameras share a tile.
///
/// Tile (i, j), number `j·tiles_s + i`, holds cameras `i·gs … (i+1)·gs − 1` along s and likewise along t, where
/// `[gs, gt]` are the cameras per tile. Unpacked it is one picture: camera (s, t) has its first texel at
/// `((s mod gs)·pitch_u, (t mod gt)·pitch_v)`, where the pitch is the image resolution rounded up to a multiple of 4.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SlabTiling {
    encoding: TexelEncoding,
    cameras: [u32; 2],
    resolution: [u32; 2],
    cameras_per_tile: [u32; 2],
    tiles: [u32; 2],
    tile_count: u32,
    image_pitch: [u32; 2],
    tile_size: [u32; 2],
    raw_len: u64,
}

impl SlabTiling {
    /// The tiling of `slab` with `cameras_per_tile` along (s, t). These need not divide the slab's cameras, and may
    /// exceed them.
    ///
    /// # Errors
    /// [`FormatError::InvalidArgument`] if a tile would hold no camera, or a size would not fit its integer.
    pub fn new(slab: &Slab, encoding: TexelEncoding, cameras_per_tile: [u32; 2]) -> Result<Self, FormatError> {
        Self::checked(slab, encoding, cameras_per_tile).map_err(FormatError::argument)
    }

    pub(crate) fn checked(
        slab: &Slab,
        encoding: TexelEncoding,
        cameras_per_tile: [u32; 2],
    ) -> Result<Self, &'static str> {
        if cameras_per_tile.contains(&0) {
            return Err("a tile must hold at least one camera along each axis");
        }
        let ([cameras_s, cameras_t], [per_s, per_t]) = (slab.cameras(), cameras_per_tile);
        let tiles = [cameras_s.div_ceil(per_s), cameras_t.div_ceil(per_t)];
        Self::sizes(slab, encoding, cameras_per_tile, tiles).ok_or("the slab or its tiles are too large")
    }

    /// `None` if a size does not fit its integer.
    fn sizes(slab: &Slab, encoding: TexelEncoding, cameras_per_tile: [u32; 2], tiles: [u32; 2]) -> Option<Self> {
        let ([tiles_s, tiles_t], [per_s, per_t], [res_u, res_v]) = (tiles, cameras_per_tile, slab.resolution());
        let [pitch_u, pitch_v] = [res_u.checked_next_multiple_of(BLOCK)?, res_v.checked_next_multiple_of(BLOCK)?];
        let [width, height] = [per_s.checked_mul(pitch_u)?, per_t.checked_mul(pitch_v)?];
        let blocks = u64::from(width / BLOCK) * u64::from(height / BLOCK);
        Some(Self {
            encoding,
            cameras: slab.cameras(),
            resolution: slab.resolution(),
            cameras_per_tile,
            tiles,
            tile_count: tiles_s.checked_mul(tiles_t)?,
            image_pitch: [pitch_u, pitch_v],
            tile_size: [width, height],
            raw_len: blocks.checked_mul(encoding.block_len())?,
        })
    }

    /// How texels are stored.
    #[must_use]
    pub fn encoding(&self) -> TexelEncoding {
        self.encoding
    }

    /// Number of cameras of the slab along s and t.
    #[must_use]
    pub fn cameras(&self) -> [u32; 2] {
        self.cameras
    }

    /// Texels of one camera image along u and v, without padding.
    #[must_use]
    pub fn resolution(&self) -> [u32; 2] {
        self.resolution
    }

    /// Cameras of one tile along s and t, each at least 1.
    #[must_use]
    pub fn cameras_per_tile(&self) -> [u32; 2] {
        self.cameras_per_tile
    }

    /// Number of tiles along s and t.
    #[must_use]
    pub fn tiles(&self) -> [u32; 2] {
        self.tiles
    }

    /// Number of tiles in all.
    #[must_use]
    pub fn tile_count(&self) -> u32 {
        self.tile_count
    }

    /// Size of one padded camera image along u and v, texels: the distance between neighbouring cameras in a tile.
    #[must_use]
    pub fn image_pitch(&self) -> [u32; 2] {
        self.image_pitch
    }

    /// Width and height of a tile's picture, texels.
    #[must_use]
    pub fn tile_size(&self) -> [u32; 2] {
        self.tile_size
    }

    /// Length of one unpacked tile, bytes. All tiles of a slab are equally long.
    #[must_use]
    pub fn raw_len(&self) -> u64 {
        self.raw_len
    }

    /// Where the image of a camera (s, t) is: the number of its tile, and the place `[x, y]` of its first texel in the
    /// tile's picture, x to the right and y down (spec §7.6, steps 1 and 2). `None` if the slab has no such camera.
    #[must_use]
    pub fn place(&self, camera: [u32; 2]) -> Option<(u32, [u32; 2])> {
        let ([s, t], [per_s, per_t], [pitch_u, pitch_v]) = (camera, self.cameras_per_tile, self.image_pitch);
        if s >= self.cameras[0] || t >= self.cameras[1] {
            return None;
        }
        // Nothing overflows: the tile is below `tile_count`, the place within `tile_size`.
        let tile = t / per_t * self.tiles[0] + s / per_s;
        Some((tile, [s % per_s * pitch_u, t % per_t * pitch_v]))
    }
}

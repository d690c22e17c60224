//! A whole light field as encoded tiles.

use lf_format::{Container, FormatError, Metadata, Packing, SlabTiling, TexelEncoding, Writer};
use lf_math::{GeometryError, Image, LightFieldGeometry, SlabTexels};
use rayon::prelude::*;
use thiserror::Error;

use crate::bc1::{self, Bc1Error, Quality};
use crate::volume::{VolumeLayout, VolumeTooLarge, cameras_per_slice};
use crate::zstd_tile;

/// Why a light field could not be packed or unpacked.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PackError {
    /// The container refused it.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The block codec refused it.
    #[error(transparent)]
    Bc1(#[from] Bc1Error),
    /// A shape does not fit.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The volume texture would be too large.
    #[error(transparent)]
    Volume(#[from] VolumeTooLarge),
    /// A tile's bytes do not hold what the file says they do.
    #[error("tile {tile} of slab {slab} {what}; the file is damaged or was written by a faulty program")]
    Tile {
        /// Position of the slab in the file.
        slab: usize,
        /// The tile's number in the slab.
        tile: u32,
        /// What is wrong, as the rest of a sentence.
        what: String,
    },
    /// zstd failed to pack a tile.
    #[error("zstd could not pack a tile: {0}")]
    Zstd(std::io::Error),
    /// The texels given are not those of the geometry.
    #[error("the light field has {slabs} slabs but texels for {texels}")]
    SlabCount {
        /// Slabs in the geometry.
        slabs: usize,
        /// Slabs with texels.
        texels: usize,
    },
}

/// A light field whose texels are encoded (BC1 blocks or plain RGBA), tile by tile, ready to be uploaded or stored.
#[derive(Debug, Clone)]
pub struct PackedLightField {
    geometry: LightFieldGeometry,
    tilings: Vec<SlabTiling>,
    layout: VolumeLayout,
    tiles: Vec<Vec<Vec<u8>>>,
}

impl PackedLightField {
    /// Encodes the texels of a light field's slabs, on all threads. `quality` concerns BC1 only.
    ///
    /// # Errors
    /// There must be one set of texels for each slab, with the slab's numbers of cameras and texels.
    pub fn encode(
        geometry: LightFieldGeometry,
        texels: &[SlabTexels],
        encoding: TexelEncoding,
        quality: Quality,
    ) -> Result<Self, PackError> {
        let slabs = geometry.slabs();
        if slabs.len() != texels.len() {
            return Err(PackError::SlabCount { slabs: slabs.len(), texels: texels.len() });
        }
        let tiling = |slab| SlabTiling::new(slab, encoding, cameras_per_slice(slab));
        let tilings = slabs.iter().map(tiling).collect::<Result<Vec<_>, _>>()?;
        let encode_slab = |(tiling, texels): (&SlabTiling, &SlabTexels)| {
            let tile = |tile| encode_picture(&tile_picture(texels, tiling, tile), tiling.encoding(), quality);
            (0..tiling.tile_count()).into_par_iter().map(tile).collect::<Result<Vec<_>, _>>()
        };
        for (slab, texels) in slabs.iter().zip(texels) {
            texels.check(slab)?;
        }
        let tiles = tilings.iter().zip(texels).map(encode_slab).collect::<Result<_, _>>()?;
        Self::assemble(geometry, tilings, tiles)
    }

    /// Unpacks all tiles of a container, on all threads.
    ///
    /// # Errors
    /// A tile that is missing, or whose bytes do not unpack to the length that the geometry asks for.
    pub fn read(container: &Container<'_>) -> Result<Self, PackError> {
        let read_slab = |slab: usize| {
            let tiling = container.tilings()[slab];
            (0..tiling.tile_count())
                .into_par_iter()
                .map(|tile| unpack_tile(container, slab, tile).map_err(|what| PackError::Tile { slab, tile, what }))
                .collect::<Result<Vec<_>, _>>()
        };
        let tiles = (0..container.tilings().len()).map(read_slab).collect::<Result<_, _>>()?;
        Self::assemble(container.geometry().clone(), container.tilings().to_vec(), tiles)
    }

    fn assemble(
        geometry: LightFieldGeometry,
        tilings: Vec<SlabTiling>,
        tiles: Vec<Vec<Vec<u8>>>,
    ) -> Result<Self, PackError> {
        let layout = VolumeLayout::with_cameras_per_slice(&geometry, |i| tilings[i].cameras_per_tile())?;
        Ok(Self { geometry, tilings, layout, tiles })
    }

    /// Packs the tiles by zstd into a container, on all threads.
    ///
    /// # Errors
    /// See [`Writer`].
    pub fn to_writer(&self, metadata: Metadata) -> Result<Writer, PackError> {
        let mut writer = Writer::new(self.geometry.clone(), self.tilings.clone(), metadata)?;
        for (slab, tiles) in self.tiles.iter().enumerate() {
            let packed = tiles.par_iter().map(|raw| zstd_tile::pack(raw)).collect::<Result<Vec<_>, _>>();
            for (tile, bytes) in (0..).zip(packed.map_err(PackError::Zstd)?) {
                writer.add_tile(slab, tile, Packing::Zstd, bytes)?;
            }
        }
        Ok(writer)
    }

    /// Decodes all texels, on all threads.
    ///
    /// # Errors
    /// None for a value made by [`Self::encode`] or [`Self::read`]; the block codec checks its lengths again.
    pub fn decode(&self) -> Result<Vec<SlabTexels>, PackError> {
        (0..self.tilings.len()).map(|slab| self.decode_slab(slab)).collect()
    }

    fn decode_slab(&self, slab: usize) -> Result<SlabTexels, PackError> {
        let geometry = &self.geometry.slabs()[slab];
        let tiling = &self.tilings[slab];
        let pictures =
            self.tiles[slab].par_iter().map(|raw| decode_picture(raw, tiling)).collect::<Result<Vec<_>, _>>()?;
        let [cameras_s, cameras_t] = geometry.cameras();
        let [width, height] = geometry.resolution();
        let mut texels = Vec::with_capacity(cameras_s as usize * cameras_t as usize * width as usize * height as usize);
        for t in 0..cameras_t {
            for s in 0..cameras_s {
                let (tile, [x, y]) = place_of(tiling, [s, t]);
                let picture = &pictures[tile as usize];
                let rows =
                    picture.texels().chunks_exact(picture.width() as usize).skip(y as usize).take(height as usize);
                texels.extend(rows.flat_map(|row| &row[x as usize..][..width as usize]));
            }
        }
        Ok(SlabTexels::new(geometry, texels)?)
    }

    /// The cell and the slabs.
    #[must_use]
    pub fn geometry(&self) -> &LightFieldGeometry {
        &self.geometry
    }

    /// The place of every texel in the volume texture: tile `i` of a slab is its `i`-th slice.
    #[must_use]
    pub fn layout(&self) -> &VolumeLayout {
        &self.layout
    }

    /// How each slab is cut into tiles and encoded.
    #[must_use]
    pub fn tilings(&self) -> &[SlabTiling] {
        &self.tilings
    }

    /// The encoded tiles of a slab, in the order of its slices.
    #[must_use]
    pub fn tiles(&self, slab: usize) -> &[Vec<u8>] {
        self.tiles.get(slab).map_or(&[], Vec::as_slice)
    }
}

/// The tile that holds a camera's image, and the image's top left texel there.
fn place_of(tiling: &SlabTiling, camera: [u32; 2]) -> (u32, [u32; 2]) {
    let [per_s, per_t] = tiling.cameras_per_tile();
    let [pitch_u, pitch_v] = tiling.image_pitch();
    let tile = camera[1] / per_t * tiling.tiles()[0] + camera[0] / per_s;
    (tile, [camera[0] % per_s * pitch_u, camera[1] % per_t * pitch_v])
}

/// The picture of a tile: its cameras' images, each padded to whole blocks by repeating its last column and row.
fn tile_picture(texels: &SlabTexels, tiling: &SlabTiling, tile: u32) -> Image<[u8; 4]> {
    let [per_s, per_t] = tiling.cameras_per_tile();
    let [width, height] = tiling.tile_size();
    let (first_s, first_t) = (tile % tiling.tiles()[0] * per_s, tile / tiling.tiles()[0] * per_t);
    let mut picture = Image::filled(width, height, [0; 4]);
    for t in first_t..texels.cameras()[1].min(first_t + per_t) {
        for s in first_s..texels.cameras()[0].min(first_s + per_s) {
            let (_, [x, y]) = place_of(tiling, [s, t]);
            let padded = pad(texels.image([s, t]), texels.resolution(), tiling.image_pitch());
            picture.blit_rows(&padded, tiling.image_pitch()[0], x, y);
        }
    }
    picture
}

fn pad(image: &[[u8; 4]], [width, height]: [u32; 2], [pitch_u, pitch_v]: [u32; 2]) -> Vec<[u8; 4]> {
    let row = |v: u32| &image[v.min(height - 1) as usize * width as usize..][..width as usize];
    (0..pitch_v).flat_map(|v| (0..pitch_u).map(move |u| row(v)[u.min(width - 1) as usize])).collect()
}

fn encode_picture(picture: &Image<[u8; 4]>, encoding: TexelEncoding, quality: Quality) -> Result<Vec<u8>, PackError> {
    match encoding {
        TexelEncoding::Bc1 => Ok(bc1::encode_image(picture.width(), picture.height(), picture.texels(), quality)?),
        TexelEncoding::Rgba8 => Ok(bytemuck::cast_slice(picture.texels()).to_vec()),
        _ => Err(PackError::Tile { slab: 0, tile: 0, what: format!("has no encoder for {encoding:?}") }),
    }
}

fn decode_picture(raw: &[u8], tiling: &SlabTiling) -> Result<Image<[u8; 4]>, PackError> {
    let [width, height] = tiling.tile_size();
    let texels = match tiling.encoding() {
        TexelEncoding::Bc1 => bc1::decode_image(width, height, raw)?,
        // Read as opaque, like BC1: the fourth byte is padding.
        _ => raw.chunks_exact(4).map(|t| [t[0], t[1], t[2], t[3]]).collect(),
    };
    Ok(Image::new(width, height, texels)?)
}

fn unpack_tile(container: &Container<'_>, slab: usize, tile: u32) -> Result<Vec<u8>, String> {
    let stored = container.tile(slab, tile).ok_or("is missing")?;
    let raw_len = usize::try_from(stored.raw_len).map_err(|_| "is larger than this machine's memory")?;
    match stored.packing {
        Packing::None => Ok(stored.bytes.to_vec()),
        Packing::Zstd => zstd_tile::unpack(stored.bytes, raw_len),
        other => Err(format!("is packed by {other:?}, which this program does not know")),
    }
}

//! A whole light field as encoded tiles.

use lf_format::{Container, FormatError, Metadata, Packing, SlabTiling, TexelEncoding, Writer};
use lf_math::{GeometryError, Image, LightFieldGeometry, Slab, SlabTexels};
use rayon::prelude::*;
use thiserror::Error;

use crate::bc1::{self, Bc1Error, EncodeOptions, Quality};
use crate::tile::{self, RdoOptions, TileError, TileShape};
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
    #[error("tile {tile} of slab {slab} {what} (clauses 7.5 and 7.8 of the file format)")]
    Tile {
        /// Position of the slab in the file.
        slab: usize,
        /// The tile's number in the slab.
        tile: u32,
        /// What is wrong, as the rest of a sentence.
        what: String,
    },
    /// This crate has no codec for an encoding.
    #[error("this version cannot encode or decode {0:?} texels")]
    Encoding(TexelEncoding),
    /// The decoded texels would need more memory than allowed.
    #[error("the decoded light field takes {bytes} bytes, more than the {limit} allowed")]
    TooLarge {
        /// Bytes of the decoded texels.
        bytes: u64,
        /// The limit given.
        limit: u64,
    },
    /// zstd failed to pack a tile.
    #[error("zstd could not pack a tile: {0}")]
    Zstd(std::io::Error),
    /// The tile codec refused a tile.
    #[error(transparent)]
    TileCodec(#[from] TileError),
    /// The texels given are not those of the geometry.
    #[error("the light field has {slabs} slabs but texels for {texels}")]
    SlabCount {
        /// Slabs in the geometry.
        slabs: usize,
        /// Slabs with texels.
        texels: usize,
    },
}

/// How texels become blocks. Concerns BC1 only.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PackOptions {
    /// How hard the block encoder searches.
    pub quality: Quality,
    /// Error traded for bits in the file; none by default.
    pub rdo: RdoOptions,
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
        Self::encode_with(geometry, texels, encoding, &PackOptions { quality, ..PackOptions::default() })
    }

    /// As [`Self::encode`], with blocks that pack better at the cost of some error if the options ask for it.
    ///
    /// # Errors
    /// As [`Self::encode`].
    pub fn encode_with(
        geometry: LightFieldGeometry,
        texels: &[SlabTexels],
        encoding: TexelEncoding,
        options: &PackOptions,
    ) -> Result<Self, PackError> {
        let slabs = geometry.slabs();
        if slabs.len() != texels.len() {
            return Err(PackError::SlabCount { slabs: slabs.len(), texels: texels.len() });
        }
        for (slab, texels) in slabs.iter().zip(texels) {
            texels.check(slab)?;
        }
        let tiling = |slab| SlabTiling::new(slab, encoding, cameras_per_slice(slab));
        let tilings = slabs.iter().map(tiling).collect::<Result<Vec<_>, _>>()?;
        let layout = layout(&geometry, &tilings)?;
        let encode_slab = |(tiling, texels): (&SlabTiling, &SlabTexels)| {
            let tile = |tile| encode_picture(&tile_picture(texels, tiling, tile), tiling, options);
            (0..tiling.tile_count()).into_par_iter().map(tile).collect::<Result<Vec<_>, _>>()
        };
        let tiles = tilings.iter().zip(texels).map(encode_slab).collect::<Result<_, _>>()?;
        Ok(Self { geometry, tilings, layout, tiles })
    }

    /// Unpacks all tiles of a container, on all threads.
    ///
    /// # Errors
    /// A tile that is missing, or whose bytes do not unpack to the length that the geometry asks for.
    pub fn read(container: &Container<'_>) -> Result<Self, PackError> {
        let (geometry, tilings) = (container.geometry().clone(), container.tilings().to_vec());
        let layout = layout(&geometry, &tilings)?;
        let read_slab = |slab: usize| {
            let tiling = container.tilings()[slab];
            (0..tiling.tile_count())
                .into_par_iter()
                .map(|tile| unpack_tile(container, slab, tile).map_err(|what| PackError::Tile { slab, tile, what }))
                .collect::<Result<Vec<_>, _>>()
        };
        let tiles = (0..container.tilings().len()).map(read_slab).collect::<Result<_, _>>()?;
        Ok(Self { geometry, tilings, layout, tiles })
    }

    /// Packs the tiles into a container, BC1 by the [tile codec](crate::tile) or by zstd, whichever is smaller, others by
    /// zstd, on all threads. A tile that does not shrink is stored as it is.
    ///
    /// # Errors
    /// See [`Writer`].
    pub fn to_writer(&self, metadata: Metadata) -> Result<Writer, PackError> {
        let mut writer = Writer::new(self.geometry.clone(), self.tilings.clone(), metadata)?;
        for (slab, tiles) in self.tiles.iter().enumerate() {
            let tiling = &self.tilings[slab];
            let packed = tiles.par_iter().map(|raw| pack_tile(raw, tiling)).collect::<Result<Vec<_>, _>>()?;
            for (tile, (raw, (packing, packed))) in (0..).zip(tiles.iter().zip(packed)) {
                if packed.len() < raw.len() {
                    writer.add_tile(slab, tile, packing, packed)?;
                } else {
                    writer.add_tile(slab, tile, Packing::None, raw.clone())?;
                }
            }
        }
        Ok(writer)
    }

    /// Decodes all texels, on all threads, into at most `max_bytes` (4 a texel), beside which one row of tiles is held.
    ///
    /// # Errors
    /// If more would be needed.
    pub fn decode(&self, max_bytes: u64) -> Result<Vec<SlabTexels>, PackError> {
        let texels = |slab: &Slab| {
            let sizes = [slab.cameras(), slab.resolution()].concat();
            sizes.into_iter().fold(4, |product: u64, n| product.saturating_mul(u64::from(n)))
        };
        let bytes = self.geometry.slabs().iter().map(texels).fold(0, u64::saturating_add);
        if bytes > max_bytes {
            return Err(PackError::TooLarge { bytes, limit: max_bytes });
        }
        (0..self.tilings.len()).map(|slab| self.decode_slab(slab)).collect()
    }

    fn decode_slab(&self, slab: usize) -> Result<SlabTexels, PackError> {
        let (geometry, tiling) = (&self.geometry.slabs()[slab], &self.tilings[slab]);
        let ([cameras_s, cameras_t], [width, height]) = (geometry.cameras(), geometry.resolution());
        let mut texels = Vec::new();
        let rows_of_tiles = self.tiles[slab].chunks(tiling.tiles()[0] as usize);
        for (row, tiles) in (0..).zip(rows_of_tiles) {
            let decode = |raw: &Vec<u8>| decode_picture(raw, tiling);
            let pictures = tiles.par_iter().map(decode).collect::<Result<Vec<_>, _>>()?;
            let per_t = tiling.cameras_per_tile()[1];
            for t in row * per_t..cameras_t.min((row + 1).saturating_mul(per_t)) {
                for s in 0..cameras_s {
                    let Some((tile, corner)) = tiling.place([s, t]) else { continue };
                    let picture = &pictures[tile as usize % pictures.len()];
                    let [x, y] = corner.map(|n| n as usize);
                    let rows = picture.texels().chunks_exact(picture.width() as usize).skip(y).take(height as usize);
                    texels.extend(rows.flat_map(|row| &row[x..][..width as usize]));
                }
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

fn layout(geometry: &LightFieldGeometry, tilings: &[SlabTiling]) -> Result<VolumeLayout, VolumeTooLarge> {
    VolumeLayout::with_cameras_per_slice(geometry, |i| tilings[i].cameras_per_tile())
}

/// The picture of a tile: its cameras' images, opaque, each padded to whole blocks by repeating its last column and row.
fn tile_picture(texels: &SlabTexels, tiling: &SlabTiling, tile: u32) -> Image<[u8; 4]> {
    let [per_s, per_t] = tiling.cameras_per_tile();
    let [width, height] = tiling.tile_size();
    let (first_s, first_t) = (tile % tiling.tiles()[0] * per_s, tile / tiling.tiles()[0] * per_t);
    let mut picture = Image::filled(width, height, [0; 4]);
    for t in first_t..texels.cameras()[1].min(first_t + per_t) {
        for s in first_s..texels.cameras()[0].min(first_s + per_s) {
            let Some((_, [x, y])) = tiling.place([s, t]) else { continue };
            let padded = pad(texels.image([s, t]), texels.resolution(), tiling.image_pitch());
            picture.blit_rows(&padded, tiling.image_pitch()[0], x, y);
        }
    }
    picture
}

fn pad(image: &[[u8; 4]], [width, height]: [u32; 2], [pitch_u, pitch_v]: [u32; 2]) -> Vec<[u8; 4]> {
    let row = |v: u32| &image[v.min(height - 1) as usize * width as usize..][..width as usize];
    let opaque = |[r, g, b, _]: [u8; 4]| [r, g, b, 255];
    (0..pitch_v).flat_map(|v| (0..pitch_u).map(move |u| opaque(row(v)[u.min(width - 1) as usize]))).collect()
}

fn encode_picture(picture: &Image<[u8; 4]>, tiling: &SlabTiling, options: &PackOptions) -> Result<Vec<u8>, PackError> {
    match tiling.encoding() {
        TexelEncoding::Bc1 => {
            let (width, height, texels) = (picture.width(), picture.height(), picture.texels());
            let shape = tile_shape(tiling)?;
            let encode = EncodeOptions::new(options.quality).repeat_blocks(shape.blocks()[0]);
            let mut blocks = bc1::encode_image(width, height, texels, encode)?;
            if options.rdo.lambda > 0.0 {
                tile::optimise(&shape, texels, &mut blocks, &options.rdo)?;
            }
            Ok(blocks)
        }
        TexelEncoding::Rgba8 => Ok(bytemuck::cast_slice(picture.texels()).to_vec()),
        other => Err(PackError::Encoding(other)),
    }
}

fn decode_picture(raw: &[u8], tiling: &SlabTiling) -> Result<Image<[u8; 4]>, PackError> {
    let [width, height] = tiling.tile_size();
    let texels = match tiling.encoding() {
        TexelEncoding::Bc1 => bc1::decode_image(width, height, raw)?,
        // The fourth byte is to be ignored.
        TexelEncoding::Rgba8 => raw.chunks_exact(4).map(|t| [t[0], t[1], t[2], 255]).collect(),
        other => return Err(PackError::Encoding(other)),
    };
    Ok(Image::new(width, height, texels)?)
}

/// The cameras of a tile and the blocks of their padded images.
fn tile_shape(tiling: &SlabTiling) -> Result<TileShape, TileError> {
    TileShape::new(tiling.cameras_per_tile(), tiling.image_pitch().map(|texels| texels / 4))
}

/// Packs a tile by the codec for its encoding. Tiles too large for the tile codec are left to zstd.
/// The smaller of the tile codec's result and zstd's: surroundings that repeat themselves to the bit, as rendered tiles
/// and bricks do, are better matched than predicted.
fn pack_tile(raw: &[u8], tiling: &SlabTiling) -> Result<(Packing, Vec<u8>), PackError> {
    let matched = |level| zstd_tile::pack(raw, level).map_err(PackError::Zstd);
    let quick = matched(zstd_tile::LEVEL)?;
    if tiling.encoding() != TexelEncoding::Bc1 {
        return Ok((Packing::Zstd, quick));
    }
    let predicted = tile::encode(&tile_shape(tiling)?, raw, tile::LEVEL)?;
    if predicted.len() <= quick.len() {
        return Ok((Packing::Tile, predicted));
    }
    Ok((Packing::Zstd, matched(zstd_tile::HIGH_LEVEL)?))
}

fn unpack_tile(container: &Container<'_>, slab: usize, tile: u32) -> Result<Vec<u8>, String> {
    let stored = container.tile(slab, tile).ok_or("is missing")?;
    let raw_len = usize::try_from(stored.raw_len).map_err(|_| "is larger than this machine's memory")?;
    match stored.packing {
        Packing::None => Ok(stored.bytes.to_vec()),
        Packing::Zstd => zstd_tile::unpack(stored.bytes, raw_len),
        Packing::Tile => unpack_coded(stored.bytes, &container.tilings()[slab]).map_err(|error| match error {
            TileError::Frame(what) => what,
            other => format!("does not unpack: {other}"),
        }),
        other => Err(format!("is packed by {other:?}, which this program does not know")),
    }
}

fn unpack_coded(bytes: &[u8], tiling: &SlabTiling) -> Result<Vec<u8>, TileError> {
    tile::decode(&tile_shape(tiling)?, bytes)
}

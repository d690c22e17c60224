//! A whole light field as encoded tiles.

use half::f16;
use lf_format::{SlabTiling, TexelEncoding};
use lf_math::{GeometryError, Image, LightFieldGeometry, SlabTexels};
use rayon::prelude::*;

use crate::bc1::{self, EncodeOptions, Quality};
use crate::error::{PackError, check_buffer};
use crate::picture::{self, Texel};
use crate::tile::{self, RdoOptions, TileError, TileShape};
use crate::volume::{VolumeLayout, cameras_per_tile};

/// How texels become blocks. Concerns BC1 only.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PackOptions {
    /// How hard the block encoder searches.
    pub quality: Quality,
    /// Error traded for bits in the file; none by default.
    pub rdo: RdoOptions,
}

/// A light field whose texels are encoded (BC1 blocks, plain RGBA or half floats), tile by tile, ready to be uploaded or
/// stored.
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
    /// Stored is what the texels' coverage holds, rounded out to blocks of 4×4 texels; texels of such a block that the coverage
    /// lacks repeat the nearest.
    ///
    /// # Errors
    /// There must be one set of texels for each slab, with the slab's numbers of cameras and texels, and `encoding` must be
    /// for 8-bit texels.
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
        Self::encode_tiles(geometry, texels, encoding, |picture, tiling, tile| {
            encode_tile(picture, tiling, tile, options)
        })
    }

    /// Encodes linear texels as half floats.
    ///
    /// # Errors
    /// As [`Self::encode`]; also if a value is not finite.
    pub fn encode_linear(geometry: LightFieldGeometry, texels: &[SlabTexels<[f16; 3]>]) -> Result<Self, PackError> {
        Self::encode_tiles(geometry, texels, TexelEncoding::Rgb16F, |picture, _, _| encode_linear_tile(picture))
    }

    fn encode_tiles<T: Texel>(
        geometry: LightFieldGeometry,
        texels: &[SlabTexels<T>],
        encoding: TexelEncoding,
        encode: impl Fn(&Image<T>, &SlabTiling, u32) -> Result<Vec<u8>, PackError> + Sync,
    ) -> Result<Self, PackError> {
        let slabs = geometry.slabs();
        if slabs.len() != texels.len() {
            return Err(PackError::SlabCount { slabs: slabs.len(), texels: texels.len() });
        }
        let mut tilings = Vec::new();
        for (slab, texels) in slabs.iter().zip(texels) {
            texels.check(slab)?;
            let coverage = texels.coverage().clone();
            tilings.push(SlabTiling::covering(slab, encoding, cameras_per_tile(&coverage), coverage)?);
        }
        let encode_slab = |(tiling, texels): (&SlabTiling, &SlabTexels<T>)| {
            let stored: Vec<u32> = tiling.stored_tiles().collect();
            let picture = |tile| picture::tile_picture(tiling, tile, |camera| texels.image(camera));
            let tile = |tile| encode(&picture(tile), tiling, tile);
            stored.into_par_iter().map(tile).collect::<Result<Vec<_>, _>>()
        };
        let tiles = tilings.iter().zip(texels).map(encode_slab).collect::<Result<_, _>>()?;
        Self::from_tiles(geometry, tilings, tiles)
    }

    /// A light field from raw tiles, in the order of [`SlabTiling::stored_tiles`].
    pub(crate) fn from_tiles(
        geometry: LightFieldGeometry,
        tilings: Vec<SlabTiling>,
        tiles: Vec<Vec<Vec<u8>>>,
    ) -> Result<Self, PackError> {
        let layout = VolumeLayout::new(&tilings)?;
        Ok(Self { geometry, tilings, layout, tiles })
    }

    /// Decodes all texels, on all threads, into at most `max_bytes` (4 a texel), beside which one row of tiles is held.
    ///
    /// # Errors
    /// If more would be needed, or the texels are not 8-bit ones.
    pub fn decode(&self, max_bytes: u64) -> Result<Vec<SlabTexels>, PackError> {
        self.decode_slabs(max_bytes, decode_srgb)
    }

    /// Decodes all half-float texels, as [`Self::decode`] does (6 bytes a texel).
    ///
    /// # Errors
    /// As [`Self::decode`]; also if a value is not finite.
    pub fn decode_linear(&self, max_bytes: u64) -> Result<Vec<SlabTexels<[f16; 3]>>, PackError> {
        self.decode_slabs(max_bytes, decode_linear)
    }

    fn decode_slabs<T: Texel>(&self, max_bytes: u64, decode: Decode<T>) -> Result<Vec<SlabTexels<T>>, PackError> {
        let slab_bytes = |tiling: &SlabTiling| {
            let [across, down] = tiling.cameras().map(u64::from);
            // Where cameras are left out, the place of each is kept.
            let places = if tiling.coverage().keeps_all_cameras() { 0 } else { 8 * across * down };
            tiling.coverage().texels().saturating_mul(size_of::<T>() as u64).saturating_add(places)
        };
        let bytes = self.tilings.iter().map(slab_bytes).fold(0, u64::saturating_add);
        if bytes > max_bytes {
            return Err(PackError::TooLarge { bytes, limit: max_bytes });
        }
        (0..self.tilings.len()).map(|slab| self.decode_slab(slab, decode)).collect()
    }

    fn decode_slab<T: Texel>(&self, slab: usize, decode: Decode<T>) -> Result<SlabTexels<T>, PackError> {
        let tiling = &self.tilings[slab];
        let [across, _] = tiling.tiles();
        let stored: Vec<(u32, &Vec<u8>)> = tiling.stored_tiles().zip(&self.tiles[slab]).collect();
        let mut texels = Vec::new();
        for row in stored.chunk_by(|(a, _), (b, _)| a / across == b / across) {
            let decode =
                |&(tile, raw): &(u32, &Vec<u8>)| Ok((tile, decode(raw, tiling.encoding(), tiling.tile_size(tile))?));
            let pictures = row.par_iter().map(decode).collect::<Result<Vec<(u32, Image<T>)>, PackError>>()?;
            picture::append_row(&mut texels, tiling, &pictures);
        }
        Ok(SlabTexels::covering(tiling.coverage().clone(), texels)?)
    }

    /// The cell and the slabs.
    #[must_use]
    pub fn geometry(&self) -> &LightFieldGeometry {
        &self.geometry
    }

    /// The place of every texel in the volume texture.
    #[must_use]
    pub fn layout(&self) -> &VolumeLayout {
        &self.layout
    }

    /// How each slab is cut into tiles and encoded.
    #[must_use]
    pub fn tilings(&self) -> &[SlabTiling] {
        &self.tilings
    }

    /// The encoded tiles of a slab, in the order of [`SlabTiling::stored_tiles`].
    #[must_use]
    pub fn tiles(&self, slab: usize) -> &[Vec<u8>] {
        self.tiles.get(slab).map_or(&[], Vec::as_slice)
    }
}

/// From a raw tile, its encoding and the size of its picture to the picture.
type Decode<T> = fn(&[u8], TexelEncoding, [u32; 2]) -> Result<Image<T>, PackError>;

/// The cameras of a tile and the windows of their images, in blocks.
pub(crate) fn tile_shape(tiling: &SlabTiling, tile: u32) -> Result<TileShape, TileError> {
    let [columns, rows] = tiling.block_windows(tile);
    TileShape::windowed(&columns, &rows)
}

/// Encodes the picture of a tile as `tiling` says: the bytes of the raw tile. On all threads.
///
/// # Errors
/// [`PackError::Encoding`] unless the encoding is for 8-bit texels; [`PackError::BufferLength`] if the picture has another
/// size than the [tile](SlabTiling::tile_size).
pub fn encode_tile(
    picture: &Image<[u8; 4]>,
    tiling: &SlabTiling,
    tile: u32,
    options: &PackOptions,
) -> Result<Vec<u8>, PackError> {
    let [width, height] = tiling.tile_size(tile);
    check_buffer(u64::from(width) * u64::from(height), picture.texels().len())?;
    match tiling.encoding() {
        TexelEncoding::Bc1 => encode_bc1(picture, tiling, tile, options),
        TexelEncoding::Rgba8 => Ok(picture.texels().as_flattened().to_vec()),
        other => Err(PackError::Encoding(other)),
    }
}

/// The bytes of a raw tile of half floats, given its picture.
///
/// # Errors
/// [`PackError::NotFinite`] if a value is not finite.
pub fn encode_linear_tile(picture: &Image<[f16; 3]>) -> Result<Vec<u8>, PackError> {
    let values = picture.texels().as_flattened();
    if values.iter().any(|value| !value.is_finite()) {
        return Err(PackError::NotFinite);
    }
    Ok(values.iter().flat_map(|value| value.to_le_bytes()).collect())
}

fn encode_bc1(
    picture: &Image<[u8; 4]>,
    tiling: &SlabTiling,
    tile: u32,
    options: &PackOptions,
) -> Result<Vec<u8>, PackError> {
    let (width, height, texels) = (picture.width(), picture.height(), picture.texels());
    let shape = tile_shape(tiling, tile)?;
    let encode = EncodeOptions::new(options.quality).repeat_blocks(usual_width(tiling, tile));
    let mut blocks = bc1::encode_image(width, height, texels, encode)?;
    if options.rdo.lambda > 0.0 {
        tile::optimise(&shape, texels, &mut blocks, &options.rdo)?;
    }
    Ok(blocks)
}

/// The window's width in blocks that most columns of a tile come near to: the distance of what neighbouring cameras see.
fn usual_width(tiling: &SlabTiling, tile: u32) -> u32 {
    let [columns, _] = tiling.block_windows(tile);
    let mut widths: Vec<u32> = columns.iter().map(|window| window.end - window.start).filter(|&n| n > 0).collect();
    widths.sort_unstable();
    widths.get(widths.len() / 2).copied().unwrap_or(0)
}

fn decode_srgb(raw: &[u8], encoding: TexelEncoding, [width, height]: [u32; 2]) -> Result<Image<[u8; 4]>, PackError> {
    let texels = match encoding {
        TexelEncoding::Bc1 => bc1::decode_image(width, height, raw)?,
        // The fourth byte is to be ignored.
        TexelEncoding::Rgba8 => raw.as_chunks().0.iter().map(|&[r, g, b, _]| [r, g, b, 255]).collect(),
        other => return Err(PackError::Encoding(other)),
    };
    Ok(Image::new(width, height, texels)?)
}

fn decode_linear(raw: &[u8], encoding: TexelEncoding, [width, height]: [u32; 2]) -> Result<Image<[f16; 3]>, PackError> {
    if encoding != TexelEncoding::Rgb16F {
        return Err(PackError::Encoding(encoding));
    }
    let half = |&bytes: &[u8; 2]| f16::from_le_bytes(bytes);
    let values: Vec<f16> = raw.as_chunks().0.iter().map(half).collect();
    if !values.iter().all(|value| value.is_finite()) {
        return Err(PackError::NotFinite);
    }
    let image: Result<_, GeometryError> = Image::new(width, height, values.as_chunks().0.to_vec());
    Ok(image?)
}

//! From the camera images of a tile to its stored bytes.

use lf_compress::{PackError, encode_linear_tile, encode_tile, pack_tile, tile_picture};
use lf_format::{CameraPlace, Packing, SlabTiling};

use crate::image::{CameraImage, is_traced};
use crate::plan::{Plan, TileId};

/// A tile as it is stored, with what is told of it at the end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct EncodedTile {
    pub(crate) id: TileId,
    /// Texels that were traced.
    pub(crate) traced: u64,
    /// Squared error of the traced texels as they are stored, summed over red, green and blue.
    pub(crate) squares: u64,
    pub(crate) radiance: (Packing, Vec<u8>),
    /// If depth is asked for.
    pub(crate) depth: Option<(Packing, Vec<u8>)>,
}

impl EncodedTile {
    /// Encodes and packs a tile, given the images of its cameras.
    pub(crate) fn new(plan: &Plan, id: TileId, images: &[([u32; 2], CameraImage)]) -> Result<Self, PackError> {
        let image = |camera: [u32; 2]| images.iter().find(|(of, _)| *of == camera).map(|(_, image)| image);
        let tiling = &plan.tilings()[id.slab];
        let picture = tile_picture(tiling, id.tile, |camera| Some(image(camera)?.texel_window()));
        let raw = encode_tile(&picture, tiling, id.tile, &plan.options().pack)?;
        let depth = plan.depth_tilings().map(|tilings| {
            let tiling = &tilings[id.slab];
            let picture = tile_picture(tiling, id.tile, |camera| Some(image(camera)?.depth_window()));
            packed(&encode_linear_tile(&picture)?, tiling, id.tile)
        });
        Ok(Self {
            id,
            traced: images.iter().map(|(_, image)| traced(image)).sum(),
            squares: squares(&raw, tiling, id.tile, images)?,
            radiance: packed(&raw, tiling, id.tile)?,
            depth: depth.transpose()?,
        })
    }
}

fn packed(raw: &[u8], tiling: &SlabTiling, tile: u32) -> Result<(Packing, Vec<u8>), PackError> {
    let (packing, bytes) = pack_tile(raw, tiling, tile)?;
    Ok((packing, bytes.into_owned()))
}

fn traced(image: &CameraImage) -> u64 {
    image.texels.iter().filter(|texel| is_traced(texel)).count() as u64
}

/// The squared error of the traced texels of a raw tile.
fn squares(raw: &[u8], tiling: &SlabTiling, tile: u32, images: &[([u32; 2], CameraImage)]) -> Result<u64, PackError> {
    let [width, height] = tiling.tile_size(tile).map(|n| n as usize);
    let mut stored = vec![[0; 4]; width * height];
    lf_compress::decode_into(raw, tiling, tile, &mut stored)?;
    let mut sum = 0;
    for (camera, image) in images {
        let Some(CameraPlace { corner: [x, y], window: [u, _], .. }) = tiling.place(*camera) else { continue };
        for (row, texels) in image.texels.chunks(u.len().max(1)).enumerate() {
            let stored = &stored[(y as usize + row) * width + x as usize..][..texels.len()];
            let pairs = texels.iter().zip(stored).filter(|(texel, _)| is_traced(texel));
            sum += pairs.map(|(texel, stored)| squared_difference(texel, stored)).sum::<u64>();
        }
    }
    Ok(sum)
}

fn squared_difference(a: &[u8; 4], b: &[u8; 4]) -> u64 {
    (0..3).map(|c| u64::from(a[c].abs_diff(b[c])).pow(2)).sum()
}

//! Between the camera images of a slab and the pictures of its tiles (clause 7.2 of the file format).

use std::ops::Range;

use half::f16;
use lf_format::{CameraPlace, SlabTiling, TexelEncoding};
use lf_math::{Image, ImageWindow};

/// A texel as slabs store it: 8-bit RGBA, or linear half-float RGB.
pub trait Texel: Copy + Send + Sync {
    /// What stands for cameras that are not there.
    const ZERO: Self;
    /// The texel without what is not stored.
    fn opaque(self) -> Self;
}

impl Texel for [u8; 4] {
    const ZERO: Self = [0; 4];

    fn opaque(self) -> Self {
        let [r, g, b, _] = self;
        [r, g, b, 255]
    }
}

impl Texel for [f16; 3] {
    const ZERO: Self = [f16::ZERO; 3];

    fn opaque(self) -> Self {
        self
    }
}

/// The picture of a tile: the windows of its cameras, as `image` has them, in whole blocks; what lies beyond a window repeats its
/// nearest texel, cameras without one are zero.
#[must_use]
pub fn tile_picture<'a, T: Texel + 'a>(
    tiling: &SlabTiling,
    tile: u32,
    image: impl Fn([u32; 2]) -> Option<ImageWindow<'a, T>>,
) -> Image<T> {
    let [width, height] = tiling.tile_size(tile);
    let mut picture = Image::filled(width, height, T::ZERO);
    for camera in cameras_of(tiling, tile) {
        let (Some(CameraPlace { corner, window, .. }), Some(image)) = (tiling.place(camera), image(camera)) else {
            continue;
        };
        let [u, v] = window.map(|range| range.start..range.end.next_multiple_of(4));
        let padded: Vec<T> = v.flat_map(|v| padded_row(&image, u.clone(), v)).collect();
        picture.blit_rows(&padded, u.end - u.start, corner[0], corner[1]);
    }
    picture
}

/// Row `v` of an image from texel to texel, each the nearest that there is.
fn padded_row<T: Texel>(image: &ImageWindow<'_, T>, u: Range<u32>, v: u32) -> impl Iterator<Item = T> {
    let width = image.u.len();
    let row = (v.clamp(image.v.start, image.v.end - 1) - image.v.start) as usize * width;
    let (first, last) = (image.u.start, image.u.end - 1);
    u.map(move |u| image.texels[row + (u.clamp(first, last) - first) as usize].opaque())
}

/// Appends the windows of all cameras in a row of tiles, given by its pictures, camera after camera.
pub(crate) fn append_row<T: Texel>(out: &mut Vec<T>, tiling: &SlabTiling, pictures: &[(u32, Image<T>)]) {
    let Some(&(first, _)) = pictures.first() else { return };
    let [_, rows] = tiling.cameras_of(first);
    for camera in tiling.coverage().windowed(0..tiling.cameras()[0], rows) {
        let Some(CameraPlace { tile, corner, window: [u, v] }) = tiling.place(camera) else { continue };
        let Ok(found) = pictures.binary_search_by_key(&tile, |(tile, _)| *tile) else { continue };
        let picture = &pictures[found].1;
        let [x, y] = corner.map(|n| n as usize);
        let rows = picture.texels().chunks_exact(picture.width() as usize).skip(y).take(v.len());
        out.extend(rows.flat_map(|row| &row[x..][..u.len()]));
    }
}

/// The cameras of a tile that have room in its picture, stored or not.
pub(crate) fn cameras_of(tiling: &SlabTiling, tile: u32) -> impl Iterator<Item = [u32; 2]> {
    let [columns, rows] = tiling.cameras_of(tile);
    tiling.coverage().windowed(columns, rows)
}

/// What a raw tile is made of: blocks of 4×4 texels, or single texels.
#[derive(Clone, Copy)]
pub(crate) struct Unit {
    /// Texels along an edge.
    pub(crate) texels: u32,
    bytes: usize,
}

impl Unit {
    pub(crate) fn of(encoding: TexelEncoding) -> Self {
        let texels = if encoding == TexelEncoding::Bc1 { 4 } else { 1 };
        Self { texels, bytes: encoding.block_len() as usize * (texels * texels) as usize / 16 }
    }

    /// Bytes of a row of units as wide as so many texels.
    pub(crate) fn row_bytes(self, width: u32) -> usize {
        (width / self.texels) as usize * self.bytes
    }

    /// Where the unit at a texel (x, y) begins in a picture of a width in texels.
    pub(crate) fn offset(self, width: u32, [x, y]: [u32; 2]) -> usize {
        (y / self.texels) as usize * self.row_bytes(width) + self.row_bytes(x)
    }
}

/// RGB half floats as the RGBA half floats that graphics devices take: the fourth is 1.
#[must_use]
pub fn rgba16f(rgb: &[u8]) -> Vec<u8> {
    let opaque = |&[a, b, c, d, e, f]: &[u8; 6]| [a, b, c, d, e, f, 0x00, 0x3C];
    rgb.as_chunks().0.iter().flat_map(opaque).collect()
}

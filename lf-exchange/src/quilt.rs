//! Looking Glass quilts: the views of one row of cameras, tiled in one picture.
//!
//! View 0 is the leftmost camera and the tile at the bottom left; views go to the right, then up. The name ends in
//! `_qsCxRaA`: columns, rows and the aspect ratio (width by height) of a view as it is shown.

use std::path::{Path, PathBuf};

use lf_math::Image;

use crate::field::SlabPictures;
use crate::{ExchangeError, Texel as _};

/// Tiles of a quilt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QuiltLayout {
    /// Tiles side by side.
    pub columns: u32,
    /// Tiles one above the other.
    pub rows: u32,
}

impl QuiltLayout {
    /// The layout nearest to a square that holds exactly this many views. A prime number of views gives a single row.
    #[must_use]
    pub fn for_views(views: u32) -> Self {
        let rows = (1..=views.isqrt()).rev().find(|&rows| views.is_multiple_of(rows)).unwrap_or(1);
        Self { columns: views / rows, rows }
    }

    /// The number of views, or `None` if it does not fit 32 bits.
    #[must_use]
    pub fn views(self) -> Option<u32> {
        self.columns.checked_mul(self.rows)
    }

    /// Column and row, from the top left, of the tile of a view.
    pub(crate) fn tile(self, view: u32) -> [u32; 2] {
        let columns = self.columns.max(1);
        [view % columns, (self.rows.saturating_sub(1)).saturating_sub(view / columns)]
    }
}

/// Writes the quilt of one row of a slab's cameras to `folder`, and returns the file: `{name}_qs{C}x{R}a{A}.png`.
///
/// # Errors
/// [`ExchangeError::InvalidArgument`] if there is no such row, or if the layout does not have exactly as many tiles as
/// the row has cameras; [`ExchangeError::Unsupported`] if the quilt has more than 2³² − 1 pixels along an edge;
/// [`ExchangeError::Picture`] if the system refuses.
pub fn write_quilt(
    folder: &Path,
    name: &str,
    pictures: &SlabPictures<'_, [u8; 4]>,
    row: u32,
    layout: QuiltLayout,
) -> Result<PathBuf, ExchangeError> {
    let quilt = quilt(pictures, row, layout)?;
    let camera = pictures.intrinsics();
    let tangents = [0, 1].map(|i| f64::from(camera.size[i]) / camera.focal[i]);
    // Five decimals, as in 1.77778; shorter where that is the same number.
    let aspect = (1e5 * tangents[0] / tangents[1]).round() / 1e5;
    let path = folder.join(format!("{name}_qs{}x{}a{aspect}.png", layout.columns, layout.rows));
    std::fs::create_dir_all(folder).map_err(ExchangeError::io(folder))?;
    <[u8; 4]>::write_picture(&quilt, &path)?;
    Ok(path)
}

fn quilt(pictures: &SlabPictures<'_, [u8; 4]>, row: u32, layout: QuiltLayout) -> Result<Image<[u8; 4]>, ExchangeError> {
    let ([views, _], [width, height]) = (pictures.grid(), pictures.intrinsics().size);
    if layout.views() != Some(views) {
        let what = format!("{}×{} tiles do not hold {views} views exactly", layout.columns, layout.rows);
        return Err(ExchangeError::argument(what));
    }
    let size = width.checked_mul(layout.columns).zip(height.checked_mul(layout.rows));
    let (quilt_width, quilt_height) = size.ok_or_else(|| ExchangeError::unsupported("a quilt of that many pixels"))?;
    let mut quilt = Image::filled(quilt_width, quilt_height, <[u8; 4]>::BLACK);
    for view in 0..views {
        let [column, tile_row] = layout.tile(view);
        quilt.blit(&pictures.picture(view, row)?, column * width, tile_row * height);
    }
    Ok(quilt)
}

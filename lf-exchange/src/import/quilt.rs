//! Looking Glass quilts.

use std::path::Path;

use lf_math::{Face, Image};

use crate::import::assemble::{CameraGrid, camera, centered, focal_plane, spacing_or_default};
use crate::import::decode::{self, Decode as _};
use crate::import::{ImportOptions, Imported};
use crate::{ExchangeError, QuiltLayout};

/// Imports a quilt as a slab with a single row of cameras, view 0 being the leftmost.
///
/// Layout and aspect ratio come from the options, or from a name that ends in `_qsCxR` or `_qsCxRaA`. Most quilts are
/// rendered with a common focal plane: see [`ImportOptions::focal_plane`].
///
/// # Errors
/// [`ExchangeError::InvalidArgument`] if the layout is not known or empty; [`ExchangeError::Malformed`] if a tile has
/// no pixel; [`ExchangeError::LimitExceeded`] before anything is decoded; others as their names say.
pub fn import_quilt(file: &Path, options: &ImportOptions) -> Result<Imported, ExchangeError> {
    let named = file.file_stem().and_then(|stem| stem.to_str()).and_then(settings);
    let layout = options.quilt.or(named.map(|(layout, _)| layout)).ok_or_else(unknown_layout)?;
    let views = layout.views().filter(|&views| views > 0).ok_or_else(unknown_layout)?;
    if decode::is_exr(file) {
        return Err(ExchangeError::unsupported("quilts are PNG or JPEG, not OpenEXR"));
    }
    let quilt_size = decode::size(file, options.max_bytes)?;
    let size = [quilt_size[0] / layout.columns, quilt_size[1] / layout.rows];
    if size.contains(&0) {
        let what =
            format!("{}×{} pixels hold no {}×{} views", quilt_size[0], quilt_size[1], layout.columns, layout.rows);
        return Err(ExchangeError::malformed(file, what));
    }
    let mut notes = Vec::new();
    if size[0] * layout.columns != quilt_size[0] || size[1] * layout.rows != quilt_size[1] {
        notes.push("the quilt's size is no multiple of its tiles'; parts of pixels are cut off".into());
    }
    let spacing = spacing_or_default(options, &mut notes)?;
    let aspect = named.and_then(|(_, aspect)| aspect);
    let grid = CameraGrid {
        face: options.face.unwrap_or(Face::NegZ),
        plane: options.plane.unwrap_or(0.0),
        positions: [centered(views, spacing), centered(1, spacing)],
        camera: camera(size, options, (None, aspect), &mut notes)?,
        focal_plane: focal_plane(options)?,
        linear: false,
        notes,
    };
    grid.check_budget(options, quilt_size)?;
    let quilt = <[u8; 4]>::decode(file, quilt_size)?;
    grid.assemble(options, |column, _| {
        let view = if options.columns_leftwards { views - 1 - column } else { column };
        Ok(Some(tile(&quilt, layout, view, size)?))
    })
}

fn unknown_layout() -> ExchangeError {
    ExchangeError::argument("the quilt's columns and rows are not known; give them, or name the file …_qs8x6a0.75.png")
}

/// Layout and aspect ratio from the end of a name.
fn settings(stem: &str) -> Option<(QuiltLayout, Option<f64>)> {
    let (_, settings) = stem.rsplit_once("_qs")?;
    let (columns, rest) = settings.split_once('x')?;
    let (rows, aspect) = rest.split_once('a').map_or((rest, None), |(rows, aspect)| (rows, Some(aspect)));
    let aspect =
        aspect.and_then(|aspect| aspect.parse().ok()).filter(|aspect: &f64| aspect.is_finite() && *aspect > 0.0);
    Some((QuiltLayout { columns: columns.parse().ok()?, rows: rows.parse().ok()? }, aspect))
}

/// The tile of a view. Tiles of a quilt that is no multiple of them begin at the whole pixel before their edge.
fn tile(
    quilt: &Image<[u8; 4]>,
    layout: QuiltLayout,
    view: u32,
    size: [u32; 2],
) -> Result<Image<[u8; 4]>, ExchangeError> {
    let [column, row] = layout.tile(view).map(u64::from);
    let x = (column * u64::from(quilt.width()) / u64::from(layout.columns)) as u32;
    let y = (row * u64::from(quilt.height()) / u64::from(layout.rows)) as u32;
    let pixels = (0..size[1]).flat_map(|j| (0..size[0]).map(move |i| (x + i, y + j)));
    Ok(Image::new(size[0], size[1], pixels.map(|(x, y)| quilt.get(x, y)).collect())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_read_from_names() {
        let layout = |columns, rows| QuiltLayout { columns, rows };
        assert_eq!(settings("wasp_qs8x6a0.75"), Some((layout(8, 6), Some(0.75))));
        assert_eq!(settings("a_qs1x1_b_qs5x9a1.77778"), Some((layout(5, 9), Some(1.77778))));
        assert_eq!(settings("plain_qs4x8"), Some((layout(4, 8), None)));
        assert_eq!(settings("plain_qs4x8a-1"), Some((layout(4, 8), None)));
        assert_eq!(settings("quilt-4x8"), None);
        assert_eq!(settings("quilt_qs4"), None);
        assert_eq!(settings("quilt_qsax8"), None);
    }

    #[test]
    fn view_0_is_at_the_bottom_left() {
        let layout = QuiltLayout { columns: 4, rows: 3 };
        assert_eq!([0, 3, 4, 11].map(|view| layout.tile(view)), [[0, 2], [3, 2], [0, 1], [3, 0]]);
        assert_eq!(QuiltLayout::for_views(48), QuiltLayout { columns: 8, rows: 6 });
        assert_eq!(QuiltLayout::for_views(7), QuiltLayout { columns: 7, rows: 1 });
    }
}

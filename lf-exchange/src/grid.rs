//! Camera grids: one picture file a camera, with the camera's place in its name.

use std::fs;
use std::path::Path;

use lf_math::Face;

use crate::field::SlabPictures;
use crate::{ExchangeError, LightField, Texel};

/// How the picture files of a grid are named. Rows are counted from the highest camera, columns from the leftmost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GridNaming {
    /// As in the (New) Stanford Light Field Archive: `out_RR_CC_Y_X.png`, where Y and X are the camera's coordinates
    /// downwards and to the right, relative to the world's origin, in millimetres.
    #[default]
    Stanford,
    /// `RR_CC.png`.
    RowColumn,
}

/// Writes the pictures of every slab to a folder of its own in `folder`, named as [`face_folder`] says: PNG or OpenEXR,
/// as the texels are. Cameras that the slab has nothing of are left out. Folders that do not exist are made; files of the same names are replaced.
///
/// # Errors
/// [`ExchangeError::Io`] and [`ExchangeError::Picture`] if the system refuses.
pub fn write_grid<T: Texel>(folder: &Path, field: &LightField<'_, T>, naming: GridNaming) -> Result<(), ExchangeError> {
    field.all_pictures().try_for_each(|pictures| {
        let folder = folder.join(face_folder(pictures.slab().face()));
        write_slab_grid(&folder, &pictures, naming)
    })
}

/// Writes the pictures of one slab straight into `folder`.
///
/// # Errors
/// As [`write_grid`].
pub fn write_slab_grid<T: Texel>(
    folder: &Path,
    pictures: &SlabPictures<'_, T>,
    naming: GridNaming,
) -> Result<(), ExchangeError> {
    fs::create_dir_all(folder).map_err(ExchangeError::io(folder))?;
    pictures.stored_cameras().try_for_each(|(column, row)| {
        let stem = match naming {
            GridNaming::Stanford => stanford_name(pictures, column, row),
            GridNaming::RowColumn => format!("{row:02}_{column:02}"),
        };
        T::write_picture(&pictures.picture(column, row)?, &folder.join(format!("{stem}.{}", T::EXTENSION)))
    })
}

/// The folder of a face's pictures: `posx`, `negx`, `posy`, `negy`, `posz` or `negz`, as cube maps are often named.
#[must_use]
pub fn face_folder(face: Face) -> &'static str {
    match face {
        Face::PosX => "posx",
        Face::NegX => "negx",
        Face::PosY => "posy",
        Face::NegY => "negy",
        Face::PosZ => "posz",
        Face::NegZ => "negz",
    }
}

/// Six decimals of a millimetre are a nanometre, less than what `f32` positions hold.
fn stanford_name<T: Texel>(pictures: &SlabPictures<'_, T>, column: u32, row: u32) -> String {
    let [right, down] = pictures.positions();
    format!("out_{row:02}_{column:02}_{:.6}_{:.6}", 1e3 * down.coord(row), 1e3 * right.coord(column))
}

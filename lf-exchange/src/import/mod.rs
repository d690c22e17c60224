//! Pictures of a camera grid, from other people's files, as a slab.
//!
//! | source | function |
//! |---|---|
//! | a folder of `…_RR_CC_Y_X…`, as in the Stanford archive, or `…_RR_CC` | [`import_grid`] |
//! | a scene of the 4D Light Field Benchmark | [`import_hci`] |
//! | a Looking Glass quilt | [`import_quilt`] |
//! | any of them, by what is there | [`import`] |
//!
//! All files are untrusted: sizes are read and held to [`ImportOptions::max_bytes`] before anything is decoded.

mod assemble;
pub(crate) mod decode;
pub(crate) mod folder;
mod hci;
mod names;
mod quilt;
mod regular;
mod resample;

use lf_math::{Cell, Face, LightFieldGeometry};

use std::path::Path;

use crate::{ExchangeError, QuiltLayout, Texels};

pub use folder::import_grid;
pub use hci::import_hci;
pub use quilt::import_quilt;

/// What the files do not say, or where the caller knows better. To change one, set the field:
///
/// ```
/// use lf_exchange::{ImportOptions, Lens};
///
/// let mut options = ImportOptions::default();
/// options.lens = Some(Lens::FocalLength(800.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ImportOptions {
    /// The face that the slab serves. `None`: the one that a benchmark scene's cameras look along, if they look along an
    /// axis with the right way up, and else −Z.
    pub face: Option<Face>,
    /// What the cameras see. `None`: what the files say, and else 60° from left to right.
    pub lens: Option<Lens>,
    /// Width by height of a view as it is shown, where that is not the aspect ratio of its pixels, as in many quilts.
    /// `None`: what a quilt's name says, and else square pixels.
    pub aspect: Option<f64>,
    /// Distance between neighbouring cameras, metres; of the columns where rows are spaced otherwise. `None`: what the
    /// files say, positions in names being millimetres, and else 1 cm.
    pub spacing: Option<f64>,
    /// How far the plane is from the cameras, metres, on which all pictures agree: the pictures were taken or rectified
    /// so that points on it lie at the same pixels in all of them. `None`: as a benchmark scene says, and else infinitely
    /// far, as with parallel cameras that all look straight ahead.
    ///
    /// The pictures are shifted, and interpolated if need be, so that all cameras share one grid of slopes: that of
    /// a camera in the middle. Where a picture ends, its edge is repeated. The plane becomes the slab's focal plane.
    pub focal_plane: Option<f64>,
    /// The coordinate of the camera plane along the face's axis, world space, metres. `None`: as a benchmark scene says,
    /// and else 0.
    pub plane: Option<f64>,
    /// The cell. `None`: a cube around the middle of the grid, as wide as the grid's shorter side, or as the distance of
    /// two cameras if there is only one.
    pub cell: Option<Cell>,
    /// The tiles of a quilt. `None`: what its name says.
    pub quilt: Option<QuiltLayout>,
    /// What names begin with, before row and column, where a folder holds pictures of several kinds.
    pub series: Option<String>,
    /// Without positions in the names: row 0 is the lowest, not the highest.
    pub rows_upwards: bool,
    /// Without positions in the names: column 0 is the rightmost, not the leftmost. Also for quilts.
    pub columns_leftwards: bool,
    /// The most memory that texels, and one picture in the making, may take. Default 4 GiB.
    pub max_bytes: u64,
}

impl Default for ImportOptions {
    fn default() -> Self {
        Self {
            face: None,
            lens: None,
            aspect: None,
            spacing: None,
            focal_plane: None,
            plane: None,
            cell: None,
            quilt: None,
            series: None,
            rows_upwards: false,
            columns_leftwards: false,
            max_bytes: 4 << 30,
        }
    }
}

/// What a camera sees. The optical axis goes through the middle of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Lens {
    /// From the left edge of the picture to the right one, radians, greater than 0 and less than π.
    FieldOfView(f64),
    /// Focal length in pixels, by their width, greater than 0.
    FocalLength(f64),
}

/// An imported light field of one slab.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Imported {
    /// The cell and the slab.
    pub geometry: LightFieldGeometry,
    /// The slab's texels; those of missing cameras are black.
    pub texels: Texels,
    /// Which cameras have no picture: camera (s, t) at t · columns + s.
    pub missing: Vec<bool>,
    /// What was assumed, ignored or found to be inexact; sentences for people.
    pub notes: Vec<String>,
}

impl Imported {
    /// How many cameras have no picture.
    #[must_use]
    pub fn missing_count(&self) -> usize {
        self.missing.iter().filter(|&&missing| missing).count()
    }
}

/// Imports whatever `path` is: a file is taken for a quilt, a folder with a `parameters.cfg` for a benchmark scene, any other
/// folder for a camera grid.
///
/// # Errors
/// As [`import_quilt`], [`import_hci`] and [`import_grid`].
pub fn import(path: &Path, options: &ImportOptions) -> Result<Imported, ExchangeError> {
    if path.is_file() {
        import_quilt(path, options)
    } else if path.join("parameters.cfg").is_file() {
        import_hci(path, options)
    } else {
        import_grid(path, options)
    }
}

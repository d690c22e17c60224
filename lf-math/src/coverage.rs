//! Which texels of a slab are needed: the separable crop.
//!
//! A ray that passes through the cell leads from a point of the cell to the camera plane. With the plane on the cell's
//! face, a camera at a distance a outside the cell's edge is met only along slopes of at least a/l, l being the cell's
//! depth; the range of useful slopes u hangs on s alone, that of v on t alone. Each camera column then has one window
//! along u and each row one along v, and the windows of all images tile one rectangle without gaps.
//!
//! In the limit of many cameras this keeps a quarter of the samples of a cube cell with planes on its faces. Exactly
//! needed are 2/9 of them, since both slopes of a ray share the depth at which it left the cell; that set
//! ([`NeededTexels`](crate::NeededTexels)) is not separable, and takes an index for each camera. With the planes through the cell's centre nothing can be left out so.

use alloc::vec::Vec;
use core::ops::Range;

use glam::Vec3;

use crate::error::GeometryError;
use crate::shadow::Shadow;
use crate::{Cell, Slab, Windows};

/// The texels that are kept of a slab: a window of each image, the same along u for all cameras of a column and along v for
/// all cameras of a row, and which cameras there are at all.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Coverage {
    columns: Windows,
    rows: Windows,
    /// By camera, t·columns + s. Empty if none is left out.
    kept: Vec<bool>,
}

impl Coverage {
    /// Everything.
    #[must_use]
    pub fn whole(slab: &Slab) -> Self {
        let ([s, t], [u, v]) = (slab.cameras(), slab.resolution());
        Self { columns: Windows::whole(s, u), rows: Windows::whole(t, v), kept: Vec::new() }
    }

    /// The texels that [`Slab::taps`] and bilinear interpolation use, with a weight greater than 0, for any ray whose
    /// dominant face is the slab's and whose origin lies in `cell`, rounding in `f32` included. Windows may be empty.
    #[must_use]
    pub fn of_cell(slab: &Slab, cell: &Cell) -> Self {
        Self::of_box(slab, [-cell.half_extent(), cell.half_extent()])
    }

    /// As [`Self::of_cell`], for rays whose origin lies in a box given by its least and greatest corner, cell space: where a
    /// reflector stays in part of the cell.
    #[must_use]
    pub fn of_box(slab: &Slab, corners: [Vec3; 2]) -> Self {
        let [columns, rows] = [0, 1].map(|i| Shadow::new(slab, corners, i).windows());
        Self { columns, rows, kept: Vec::new() }
    }

    /// The texels in given windows, in texels: `columns` along u for each s, `rows` along v for each t.
    ///
    /// # Errors
    /// There must be a window for each column and row of the slab's cameras, within its images.
    pub fn new(slab: &Slab, columns: Vec<Range<u32>>, rows: Vec<Range<u32>>) -> Result<Self, GeometryError> {
        let (cameras, resolution) = (slab.cameras(), slab.resolution());
        for (i, windows) in [&columns, &rows].into_iter().enumerate() {
            let (len, expected) = (windows.len(), cameras[i] as usize);
            if len != expected {
                return Err(GeometryError::Length { what: "windows of a slab", len, expected });
            }
            if let Some(window) = windows.iter().find(|w| w.start > w.end || w.end > resolution[i]) {
                return Err(GeometryError::Window { start: window.start, end: window.end, texels: resolution[i] });
            }
        }
        let (columns, rows) = (Windows::new(columns, resolution[0]), Windows::new(rows, resolution[1]));
        Ok(Self { columns, rows, kept: Vec::new() })
    }

    /// The same without the cameras for which `kept`, by t·columns + s, is false.
    ///
    /// # Errors
    /// There must be one value for each camera.
    pub fn with_cameras(self, kept: Vec<bool>) -> Result<Self, GeometryError> {
        let (len, expected) = (kept.len(), self.camera_count());
        if len != expected {
            return Err(GeometryError::Length { what: "camera mask", len, expected });
        }
        Ok(Self { kept, ..self }.canonical())
    }

    /// What is kept by this and by another coverage of the same slab. Columns and rows that one of them lacks are empty.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        let keeps = |coverage: &Self, camera: usize| coverage.kept.get(camera).is_none_or(|&kept| kept);
        let masked = if self.kept.is_empty() && other.kept.is_empty() { 0 } else { self.camera_count() };
        Self {
            columns: self.columns.intersection(&other.columns),
            rows: self.rows.intersection(&other.rows),
            kept: (0..masked).map(|camera| keeps(self, camera) && keeps(other, camera)).collect(),
        }
        .canonical()
    }

    /// One way to say which cameras are kept: those with empty windows are not, and no list if all others are.
    fn canonical(self) -> Self {
        let windowed =
            |[s, t]: [u32; 2]| [self.columns.get(s), self.rows.get(t)].iter().flatten().all(|w| !w.is_empty());
        let whole = self.cameras().zip(&self.kept).all(|(camera, &kept)| kept || !windowed(camera));
        let kept = self.cameras().zip(&self.kept).map(|(camera, &kept)| kept && windowed(camera));
        let kept = if whole { Vec::new() } else { kept.collect() };
        Self { kept, ..self }
    }

    /// The same with windows rounded out to multiples of `block` texels, as far as the images reach.
    #[must_use]
    pub fn aligned(self, block: u32) -> Self {
        Self { columns: self.columns.aligned(block), rows: self.rows.aligned(block), kept: self.kept }
    }

    /// The window along u of each column of cameras.
    #[must_use]
    #[inline]
    pub fn columns(&self) -> &Windows {
        &self.columns
    }

    /// The window along v of each row of cameras.
    #[must_use]
    #[inline]
    pub fn rows(&self) -> &Windows {
        &self.rows
    }

    /// Texels of a whole image along u and v.
    #[must_use]
    #[inline]
    pub fn resolution(&self) -> [u32; 2] {
        [self.columns.texels(), self.rows.texels()]
    }

    fn camera_count(&self) -> usize {
        (self.columns.cameras() as usize).saturating_mul(self.rows.cameras() as usize)
    }

    /// The windows of a camera (s, t) along u and v; `None` if there is no such camera or nothing of it is kept.
    #[must_use]
    #[inline]
    pub fn window(&self, [s, t]: [u32; 2]) -> Option<[Range<u32>; 2]> {
        let (u, v) = (self.columns.get(s)?, self.rows.get(t)?);
        let place = t as usize * self.columns.cameras() as usize + s as usize;
        let kept = self.kept.get(place).is_none_or(|&kept| kept);
        (kept && !u.is_empty() && !v.is_empty()).then_some([u, v])
    }

    /// Whether all of every image is kept.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.kept.is_empty() && self.columns.is_whole() && self.rows.is_whole()
    }

    /// All cameras of the slab, kept or not: s fastest, then t.
    pub fn cameras(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let (across, down) = (self.columns.cameras(), self.rows.cameras());
        (0..down).flat_map(move |t| (0..across).map(move |s| [s, t]))
    }

    /// The cameras in a range of columns and a range of rows whose windows are not empty, kept or not: s fastest, then t. Takes no
    /// time for those with empty windows but what it takes to look at each column and each row once.
    pub fn windowed(&self, s: Range<u32>, t: Range<u32>) -> impl Iterator<Item = [u32; 2]> + use<> {
        let filled = |windows: &Windows, range: Range<u32>| -> Vec<u32> {
            range.filter(|&camera| windows.get(camera).is_some_and(|window| !window.is_empty())).collect()
        };
        let (columns, rows) = (filled(&self.columns, s), filled(&self.rows, t));
        let count = columns.len() * rows.len();
        (0..count).map(move |n| [columns[n % columns.len()], rows[n / columns.len()]])
    }

    /// The cameras that are kept: s fastest, then t.
    pub fn stored(&self) -> impl Iterator<Item = ([u32; 2], [Range<u32>; 2])> {
        let windowed = self.windowed(0..self.columns.cameras(), 0..self.rows.cameras());
        windowed.filter_map(|camera| Some((camera, self.window(camera)?)))
    }

    /// Whether anything is kept.
    #[must_use]
    pub fn keeps_any(&self) -> bool {
        // Without a list no camera need be tried.
        let any_camera = || self.cameras().any(|camera| self.window(camera).is_some());
        self.columns.any() && self.rows.any() && (self.kept.is_empty() || any_camera())
    }

    /// Whether every camera whose windows are not empty is kept.
    #[must_use]
    pub fn keeps_all_cameras(&self) -> bool {
        self.kept.is_empty()
    }

    /// How many texels are kept.
    #[must_use]
    pub fn texels(&self) -> u64 {
        if self.kept.is_empty() {
            return self.columns.total().saturating_mul(self.rows.total());
        }
        self.stored().map(|(_, [u, v])| u.len() as u64 * v.len() as u64).sum()
    }
}

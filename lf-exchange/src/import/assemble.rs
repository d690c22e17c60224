//! From a grid of pictures and what is known about their cameras to a slab.

use glam::DVec3;
use half::f16;
use lf_math::{Cell, Face, Image, LightFieldGeometry, Slab, SlabTexels};

use crate::import::decode::Decode;
use crate::import::resample::shifted;
use crate::import::{ImportOptions, Imported, Lens};
use crate::{ExchangeError, Intrinsics, PictureAxis, PictureBasis};

/// What is assumed where nothing is said.
const DEFAULT_FIELD_OF_VIEW: f64 = std::f64::consts::FRAC_PI_3;
pub(crate) const DEFAULT_SPACING: f64 = 0.01;

/// A grid of cameras, as its pictures show it: column 0 on the left, row 0 at the top.
pub(crate) struct CameraGrid {
    pub(crate) face: Face,
    /// Coordinate of the camera plane along the face's axis, world space.
    pub(crate) plane: f64,
    /// Positions along right and down, world space.
    pub(crate) positions: [PictureAxis; 2],
    pub(crate) camera: Intrinsics,
    /// The distance of the plane on which the pictures agree; `None` is infinity.
    pub(crate) focal_plane: Option<f64>,
    pub(crate) linear: bool,
    pub(crate) notes: Vec<String>,
}

impl CameraGrid {
    /// Holds the memory for all texels, and for a picture that takes `picture` bytes while it is decoded, to the limit.
    pub(crate) fn check_budget(&self, options: &ImportOptions, decoded: [u32; 2]) -> Result<(), ExchangeError> {
        let texel = if self.linear { size_of::<[f16; 3]>() } else { size_of::<[u8; 4]>() } as u64;
        let [columns, rows] = self.positions.map(|axis| u64::from(axis.count));
        let [width, height] = self.camera.size.map(u64::from);
        let slab = [rows, width, height, texel].into_iter().fold(columns, u64::saturating_mul);
        // 16-bit RGBA or 32-bit RGB, and what it is converted to.
        let picture = u64::from(decoded[0]).saturating_mul(decoded[1].into()).saturating_mul(16 + texel);
        let (bytes, limit) = (slab.saturating_add(picture), options.max_bytes);
        if bytes <= limit {
            return Ok(());
        }
        let what = format!("a grid of {columns}×{rows} pictures of {width}×{height} pixels");
        Err(ExchangeError::LimitExceeded { what, bytes, limit })
    }

    /// Loads the pictures by column and row, and makes the slab. `load` returns `None` for a missing one.
    pub(crate) fn assemble<T: Decode>(
        self,
        options: &ImportOptions,
        mut load: impl FnMut(u32, u32) -> Result<Option<Image<T>>, ExchangeError>,
    ) -> Result<Imported, ExchangeError> {
        let basis = PictureBasis::new(self.face);
        let geometry = self.geometry(basis, options)?;
        let slab = *geometry.slabs().first().ok_or_else(|| ExchangeError::argument("there is no slab"))?;
        let (grid, counts) = (slab.cameras(), slab.resolution());
        // The caller's limit has let this pass; growing on demand would take up to twice as much.
        let cameras = grid[0] as usize * grid[1] as usize;
        let mut texels = Vec::with_capacity(cameras * counts[0] as usize * counts[1] as usize);
        let mut missing = Vec::with_capacity(cameras);
        for camera in (0..grid[1]).flat_map(|t| (0..grid[0]).map(move |s| [s, t])) {
            let [column, row] = basis.pixel(camera, grid);
            let picture = load(column, row)?.map(|picture| shifted(picture, self.shift(column, row)));
            missing.push(picture.is_none());
            let samples = (0..counts[1]).flat_map(|v| (0..counts[0]).map(move |u| [u, v]));
            texels.extend(samples.map(|sample| match &picture {
                Some(picture) => {
                    let [x, y] = basis.pixel(sample, counts);
                    picture.get(x, y)
                }
                None => T::BLACK,
            }));
        }
        let texels = T::texels(SlabTexels::new(&slab, texels)?);
        Ok(Imported { geometry, texels, missing, notes: self.notes })
    }

    /// How far a picture's pixels are from where the middle camera has the same slopes.
    ///
    /// Pixel x of all pictures meets the focal plane at one point, which the middle camera, at m, sees along the slope
    /// (x − c)/f and a camera at p along (x − c)/f − (p − m)/D.
    fn shift(&self, column: u32, row: u32) -> [f64; 2] {
        let Some(depth) = self.focal_plane else { return [0.0; 2] };
        let [right, down] = self.positions;
        let [x, y] = [right.coord(column) - right.middle(), down.coord(row) - down.middle()];
        [self.camera.focal[0] * x / depth, self.camera.focal[1] * y / depth]
    }

    fn geometry(&self, basis: PictureBasis, options: &ImportOptions) -> Result<LightFieldGeometry, ExchangeError> {
        let axis = self.face.axis();
        let world_from_camera = basis.world_from_camera();
        let [right, down] = self.positions;
        let cell = options.cell.map_or_else(
            || {
                let mut middle = world_from_camera * DVec3::new(right.middle(), -down.middle(), 0.0);
                middle[axis] = self.plane;
                Cell::cube(middle, self.default_cell_size() as f32)
            },
            Ok,
        )?;
        let center = world_from_camera.transpose() * cell.center();
        let in_cell = |axis: PictureAxis, origin: f64| PictureAxis { first: axis.first - origin, ..axis };
        let st = basis.sampled_axes([in_cell(right, center.x), in_cell(down, -center.y)])?;
        let uv = basis.sampled_axes(self.camera.slopes())?;
        let plane = (self.plane - cell.center()[axis]) as f32;
        let slab = Slab::new(self.face, plane, st, uv, self.focal_plane.map(|depth| depth as f32))?;
        Ok(LightFieldGeometry::new(cell, vec![slab])?)
    }

    fn default_cell_size(&self) -> f64 {
        let extents = self.positions.into_iter().filter(|axis| axis.count > 1).map(|axis| axis.last() - axis.first);
        extents.reduce(f64::min).unwrap_or(self.positions[0].step)
    }
}

/// The camera of pictures of this size. The lens and the aspect ratio of the view are, in this order: what the caller says,
/// what the files say, and 60° from left to right with square pixels.
pub(crate) fn camera(
    size: [u32; 2],
    options: &ImportOptions,
    (lens, aspect): (Option<Lens>, Option<f64>),
    notes: &mut Vec<String>,
) -> Result<Intrinsics, ExchangeError> {
    let [width, height] = size.map(f64::from);
    let lens = options.lens.or(lens).unwrap_or_else(|| {
        notes.push("the field of view is not known; 60° from left to right is assumed".into());
        Lens::FieldOfView(DEFAULT_FIELD_OF_VIEW)
    });
    let focal = match lens {
        Lens::FieldOfView(angle) if angle > 0.0 && angle < std::f64::consts::PI => 0.5 * width / (0.5 * angle).tan(),
        Lens::FieldOfView(angle) => {
            return Err(ExchangeError::argument(format!("a field of view is 0 to π radians, not {angle}")));
        }
        Lens::FocalLength(pixels) => positive("the focal length", pixels)?,
    };
    let aspect = positive("the aspect ratio", options.aspect.or(aspect).unwrap_or(width / height))?;
    Ok(Intrinsics { size, focal: [focal, focal * aspect * height / width], principal: [0.5 * width, 0.5 * height] })
}

/// The depth of the focal plane as the options have it.
pub(crate) fn focal_plane(options: &ImportOptions) -> Result<Option<f64>, ExchangeError> {
    options.focal_plane.map(|depth| positive("the depth of the focal plane", depth)).transpose()
}

/// The distance between cameras as the options have it.
pub(crate) fn spacing(options: &ImportOptions) -> Result<Option<f64>, ExchangeError> {
    options.spacing.map(|spacing| positive("the camera spacing", spacing)).transpose()
}

/// The distance between cameras where the files say nothing.
pub(crate) fn spacing_or_default(options: &ImportOptions, notes: &mut Vec<String>) -> Result<f64, ExchangeError> {
    Ok(spacing(options)?.unwrap_or_else(|| {
        notes.push(format!("the camera spacing is not known; {DEFAULT_SPACING} m is assumed"));
        DEFAULT_SPACING
    }))
}

/// A regular axis around the origin.
pub(crate) fn centered(count: u32, step: f64) -> PictureAxis {
    PictureAxis { first: -0.5 * f64::from(count.saturating_sub(1)) * step, step, count }
}

/// A number that has to be finite and greater than 0.
pub(crate) fn positive(what: &str, value: f64) -> Result<f64, ExchangeError> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(ExchangeError::argument(format!("{what} has to be greater than 0, is {value}")))
}

//! What is exported: a light field with the texels of all its slabs.

use glam::DVec3;
use glam::Vec2;
use lf_math::{Image, LightFieldGeometry, Slab, SlabTexels};

use crate::basis::{Intrinsics, PictureAxis, PictureBasis};
use crate::{ExchangeError, Texel};

/// A light field to export: its geometry and, slab by slab, its texels.
#[derive(Debug, Clone, Copy)]
pub struct LightField<'a, T> {
    geometry: &'a LightFieldGeometry,
    texels: &'a [SlabTexels<T>],
}

impl<'a, T: Texel> LightField<'a, T> {
    /// A light field from its parts; `texels` are those of the slabs, in the same order.
    ///
    /// # Errors
    /// [`ExchangeError::InvalidArgument`] if there are more or fewer texels than slabs, [`ExchangeError::Geometry`] if
    /// they have another size.
    pub fn new(geometry: &'a LightFieldGeometry, texels: &'a [SlabTexels<T>]) -> Result<Self, ExchangeError> {
        let slabs = geometry.slabs();
        if slabs.len() != texels.len() {
            let what = format!("there are {} slabs, but the texels of {}", slabs.len(), texels.len());
            return Err(ExchangeError::argument(what));
        }
        slabs.iter().zip(texels).try_for_each(|(slab, texels)| texels.check(slab))?;
        Ok(Self { geometry, texels })
    }

    /// The cell and the slabs.
    #[must_use]
    pub fn geometry(&self) -> &'a LightFieldGeometry {
        self.geometry
    }

    /// The pictures of one slab, by its position among the slabs.
    ///
    /// # Errors
    /// [`ExchangeError::InvalidArgument`] if there is no such slab.
    pub fn pictures(&self, slab: usize) -> Result<SlabPictures<'a, T>, ExchangeError> {
        let count = self.texels.len();
        let missing = || ExchangeError::argument(format!("there is no slab {slab}; there are {count}, counted from 0"));
        let (slab, texels) = self.geometry.slabs().get(slab).zip(self.texels.get(slab)).ok_or_else(missing)?;
        Ok(SlabPictures { center: self.geometry.cell().center(), slab, texels, basis: PictureBasis::new(slab.face()) })
    }

    /// The pictures of all slabs, in their order.
    pub fn all_pictures(&self) -> impl Iterator<Item = SlabPictures<'a, T>> {
        let center = self.geometry.cell().center();
        self.geometry.slabs().iter().zip(self.texels).map(move |(slab, texels)| SlabPictures {
            center,
            slab,
            texels,
            basis: PictureBasis::new(slab.face()),
        })
    }
}

/// One slab as a grid of true pictures, as [`PictureBasis`] has them: column 0 of the grid is the leftmost camera and
/// row 0 the highest, as its cameras see left and high.
///
/// A slab stores what is seen from where a ray leaves the cell (`spec/lfslab-1.0.md` §5.7). The pictures are those of
/// pinhole cameras on its plane as long as nothing stands between the plane and that point.
#[derive(Debug, Clone, Copy)]
pub struct SlabPictures<'a, T> {
    center: DVec3,
    slab: &'a Slab,
    texels: &'a SlabTexels<T>,
    basis: PictureBasis,
}

impl<T: Texel> SlabPictures<'_, T> {
    /// The slab.
    #[must_use]
    pub fn slab(&self) -> &Slab {
        self.slab
    }

    /// How the pictures lie against the slab's images.
    #[must_use]
    pub fn basis(&self) -> PictureBasis {
        self.basis
    }

    /// Columns and rows of the grid of cameras.
    #[must_use]
    pub fn grid(&self) -> [u32; 2] {
        self.basis.size(self.slab.cameras())
    }

    /// The camera that all pictures share.
    #[must_use]
    pub fn intrinsics(&self) -> Intrinsics {
        Intrinsics::from_slopes(self.basis.picture_axes(self.slab.uv()))
    }

    /// The cameras' positions along right and down, metres, relative to the world's origin.
    #[must_use]
    pub fn positions(&self) -> [PictureAxis; 2] {
        let center = self.basis.world_from_camera().transpose() * self.center;
        let [right, down] = self.basis.picture_axes(self.slab.st());
        [PictureAxis { first: right.first + center.x, ..right }, PictureAxis { first: down.first - center.y, ..down }]
    }

    /// Where the camera in this column and row stands, world space, metres.
    ///
    /// # Panics
    /// In debug builds, if it is outside the grid.
    #[must_use]
    pub fn position(&self, column: u32, row: u32) -> DVec3 {
        let camera = self.basis.sample([column, row], self.slab.cameras());
        let ray = self.slab.sample_ray(Vec2::new(camera[0] as f32, camera[1] as f32), Vec2::ZERO);
        self.center + ray.origin.as_dvec3()
    }

    /// Whether the slab has anything of the picture of the camera in this column and row.
    #[must_use]
    pub fn is_stored(&self, column: u32, row: u32) -> bool {
        let [columns, rows] = self.grid();
        let camera = || self.basis.sample([column, row], self.slab.cameras());
        column < columns && row < rows && self.texels.image(camera()).is_some()
    }

    /// The picture of the camera in this column and row; what the slab leaves out of it is black.
    ///
    /// # Errors
    /// [`ExchangeError::InvalidArgument`] if it is outside the grid.
    pub fn picture(&self, column: u32, row: u32) -> Result<Image<T>, ExchangeError> {
        let grid = self.grid();
        if column >= grid[0] || row >= grid[1] {
            let what = format!("there is no camera in column {column}, row {row} of {}×{}", grid[0], grid[1]);
            return Err(ExchangeError::argument(what));
        }
        let camera = self.basis.sample([column, row], self.slab.cameras());
        let counts = self.slab.resolution();
        let [width, height] = self.basis.size(counts);
        let texel = |(x, y)| self.texels.texel(camera, self.basis.sample([x, y], counts)).unwrap_or(T::BLACK);
        let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(texel).collect();
        Ok(Image::new(width, height, texels)?)
    }

    /// Column and row of each camera, row after row.
    pub fn cameras(&self) -> impl Iterator<Item = (u32, u32)> + use<T> {
        let [columns, rows] = self.grid();
        (0..rows).flat_map(move |row| (0..columns).map(move |column| (column, row)))
    }

    /// Those of [`Self::cameras`] that the slab has anything of.
    pub fn stored_cameras(&self) -> impl Iterator<Item = (u32, u32)> {
        self.cameras().filter(|&(column, row)| self.is_stored(column, row))
    }
}

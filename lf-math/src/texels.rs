//! The 4D array of one slab's texels, decoded.

use alloc::vec::Vec;
use core::ops::Range;

use crate::error::GeometryError;
use crate::{Coverage, Slab, Windows};

/// The texels of a slab, camera after camera (s fastest, then t), of each image the window that its [`Coverage`] keeps, row
/// after row. Texels are by default 8-bit RGBA, sRGB-encoded.
#[derive(Debug, Clone, PartialEq)]
pub struct SlabTexels<T = [u8; 4]> {
    coverage: Coverage,
    starts: Starts,
    texels: Vec<T>,
}

/// Where each camera's image begins.
#[derive(Debug, Clone, PartialEq)]
enum Starts {
    /// All cameras with windows are there: a row of cameras takes the width of all windows times its height. Texels in the
    /// windows before each column and before each row, and after the last.
    Regular { columns: Vec<usize>, rows: Vec<usize> },
    /// By camera, t·columns + s; of those that are not there, that of the next one.
    Each(Vec<usize>),
}

/// The part of one camera's image that is there.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageWindow<'a, T = [u8; 4]> {
    /// Texels along u, of the whole image's.
    pub u: Range<u32>,
    /// Texels along v, of the whole image's.
    pub v: Range<u32>,
    /// Row after row.
    pub texels: &'a [T],
}

impl<T: Copy> SlabTexels<T> {
    /// All texels of `slab`, in the order ((t·cameras_s + s)·resolution_v + v)·resolution_u + u.
    ///
    /// # Errors
    /// `texels` must hold exactly one value for each sample of the slab.
    pub fn new(slab: &Slab, texels: Vec<T>) -> Result<Self, GeometryError> {
        let (cameras, resolution) = (slab.cameras(), slab.resolution());
        let sizes = [cameras[0], cameras[1], resolution[0], resolution[1]];
        // A product past the address space cannot equal any length.
        let product = sizes.iter().try_fold(1usize, |product, &n| product.checked_mul(n as usize));
        let expected = product.unwrap_or(usize::MAX);
        if texels.len() != expected {
            return Err(GeometryError::Length { what: "slab texels", len: texels.len(), expected });
        }
        Self::covering(Coverage::whole(slab), texels)
    }

    /// The texels that `coverage` keeps, window after window.
    ///
    /// # Errors
    /// `texels` must hold exactly one value for each.
    pub fn covering(coverage: Coverage, texels: Vec<T>) -> Result<Self, GeometryError> {
        let expected = usize::try_from(coverage.texels()).unwrap_or(usize::MAX);
        if texels.len() != expected {
            return Err(GeometryError::Length { what: "slab texels", len: texels.len(), expected });
        }
        // Nothing overflows: all texels are there.
        Ok(Self { starts: Starts::new(&coverage), coverage, texels })
    }

    /// The same with every texel mapped.
    #[must_use]
    pub fn map<U: Copy>(&self, f: impl FnMut(T) -> U) -> SlabTexels<U> {
        let texels = self.texels.iter().copied().map(f).collect();
        SlabTexels { coverage: self.coverage.clone(), starts: self.starts.clone(), texels }
    }

    /// What `coverage` keeps of these texels.
    ///
    /// # Errors
    /// If it asks for texels that are not there.
    pub fn crop(&self, coverage: Coverage) -> Result<Self, GeometryError> {
        let mut texels = Vec::new();
        for (camera, [u, v]) in coverage.stored() {
            let missing = || GeometryError::Window { start: u.start, end: u.end, texels: 0 };
            let image = self.image(camera).ok_or_else(missing)?;
            for row in v {
                texels.extend_from_slice(image.row(row, u.clone()).ok_or_else(missing)?);
            }
        }
        Self::covering(coverage, texels)
    }

    /// Checks that the texels are those of a slab with the numbers of cameras and texels of `slab`.
    ///
    /// # Errors
    /// If any of the four numbers differs.
    pub fn check(&self, slab: &Slab) -> Result<(), GeometryError> {
        let sizes = [
            ("camera grid of slab texels", self.cameras(), slab.cameras()),
            ("image of slab texels", self.resolution(), slab.resolution()),
        ];
        for (what, have, want) in sizes {
            if have != want {
                return Err(GeometryError::Size { what, have, want });
            }
        }
        Ok(())
    }

    /// Number of cameras along s and t.
    #[must_use]
    pub fn cameras(&self) -> [u32; 2] {
        [self.coverage.columns().cameras(), self.coverage.rows().cameras()]
    }

    /// Texels of a whole image along u and v.
    #[must_use]
    pub fn resolution(&self) -> [u32; 2] {
        self.coverage.resolution()
    }

    /// Which texels there are.
    #[must_use]
    pub fn coverage(&self) -> &Coverage {
        &self.coverage
    }

    /// All texels in storage order.
    #[must_use]
    pub fn texels(&self) -> &[T] {
        &self.texels
    }

    /// What there is of one camera's image; `None` if nothing is.
    #[must_use]
    pub fn image(&self, camera: [u32; 2]) -> Option<ImageWindow<'_, T>> {
        let [u, v] = self.coverage.window(camera)?;
        let start = self.starts.get(camera, v.len(), self.cameras()[0])?;
        let texels = self.texels.get(start..)?.get(..u.len() * v.len())?;
        Some(ImageWindow { u, v, texels })
    }

    /// One texel; `None` if it is not there.
    #[must_use]
    pub fn texel(&self, camera: [u32; 2], texel: [u32; 2]) -> Option<T> {
        self.image(camera)?.row(texel[1], texel[0]..texel[0].checked_add(1)?)?.first().copied()
    }
}

impl Starts {
    fn new(coverage: &Coverage) -> Self {
        if coverage.keeps_all_cameras() {
            return Self::Regular { columns: sums(coverage.columns()), rows: sums(coverage.rows()) };
        }
        let mut end = 0;
        let start = |camera| {
            let start = end;
            end += coverage.window(camera).map_or(0, |[u, v]| u.len() * v.len());
            start
        };
        Self::Each(coverage.cameras().map(start).collect())
    }

    /// The place of the image of a camera (s, t), whose window has a height, in a grid of so many columns.
    #[inline]
    fn get(&self, [s, t]: [u32; 2], height: usize, across: u32) -> Option<usize> {
        match self {
            Self::Regular { columns, rows } => {
                Some(rows.get(t as usize)? * columns.last()? + columns.get(s as usize)? * height)
            }
            Self::Each(starts) => starts.get(t as usize * across as usize + s as usize).copied(),
        }
    }
}

/// Texels in the windows before each one, and in all of them.
fn sums(windows: &Windows) -> Vec<usize> {
    let mut end = 0;
    let ends = windows.iter().map(|window| {
        end += window.len();
        end
    });
    core::iter::once(0).chain(ends).collect()
}

impl<'a, T> ImageWindow<'a, T> {
    /// Part of a row of the image; `None` if it is not all there.
    #[must_use]
    pub fn row(&self, v: u32, u: Range<u32>) -> Option<&'a [T]> {
        if !self.v.contains(&v) || u.start < self.u.start || u.end > self.u.end || u.start > u.end {
            return None;
        }
        let start = (v - self.v.start) as usize * self.u.len() + (u.start - self.u.start) as usize;
        self.texels.get(start..start + u.len())
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use super::*;
    use crate::{Face, SampledAxis};

    fn slab() -> Slab {
        let axis = |count| SampledAxis::spanning(-1.0, 1.0, count).unwrap();
        Slab::new(Face::PosX, 0.0, [axis(2), axis(3)], [axis(4), axis(5)], None).unwrap()
    }

    #[test]
    fn texels_are_addressed_camera_by_camera() {
        let all: Vec<[u8; 4]> = (0..120).map(|i| [i, 0, 0, 255]).collect();
        let texels = SlabTexels::new(&slab(), all.clone()).unwrap();
        assert_eq!(texels.texel([1, 2], [3, 4]), Some([((2 * 2 + 1) * 5 + 4) * 4 + 3, 0, 0, 255]));
        assert_eq!(texels.image([1, 2]).unwrap().texels[4 * 4 + 3], texels.texel([1, 2], [3, 4]).unwrap());
        assert_eq!(texels.texel([2, 0], [0, 0]), None);
        assert_eq!(texels.texel([0, 0], [4, 0]), None);
        assert!(SlabTexels::new(&slab(), all[1..].to_vec()).is_err());
    }

    #[test]
    fn a_crop_keeps_its_windows_and_nothing_else() {
        let all = SlabTexels::new(&slab(), (0..120u8).collect()).unwrap();
        let coverage = Coverage::new(&slab(), vec![0..2, 1..4], vec![2..2, 0..5, 4..5]).unwrap();
        let kept = coverage.with_cameras(vec![true, true, false, true, true, true]).unwrap();
        let cropped = all.crop(kept.clone()).unwrap();
        assert_eq!(cropped.texels().len() as u64, kept.texels());
        assert_eq!(kept.texels(), 3 * 5 + 2 + 3);
        for camera in kept.cameras() {
            for texel in (0..5).flat_map(|v| (0..4).map(move |u| [u, v])) {
                let inside = kept.window(camera).is_some_and(|[u, v]| u.contains(&texel[0]) && v.contains(&texel[1]));
                let expected = all.texel(camera, texel).filter(|_| inside);
                assert_eq!(cropped.texel(camera, texel), expected, "{camera:?} {texel:?}");
            }
        }
        assert!(cropped.crop(Coverage::whole(&slab())).is_err());
        assert!(Coverage::new(&slab(), vec![0..2, 1..5], vec![0..5; 3]).is_err());
        assert!(Coverage::new(&slab(), vec![0..2; 1], vec![0..5; 3]).is_err());
        assert!(Coverage::whole(&slab()).is_whole() && !kept.is_whole());
    }
}

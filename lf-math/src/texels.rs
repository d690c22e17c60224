//! The 4D array of one slab's texels, decoded.

use alloc::vec::Vec;

use crate::Slab;
use crate::error::GeometryError;

/// All texels of a slab, camera after camera (s fastest, then t), each image row after row: by default 8-bit RGBA,
/// sRGB-encoded.
#[derive(Debug, Clone, PartialEq)]
pub struct SlabTexels<T = [u8; 4]> {
    cameras: [u32; 2],
    resolution: [u32; 2],
    texels: Vec<T>,
}

impl<T: Copy> SlabTexels<T> {
    /// The texels of `slab`, in the order ((t·cameras_s + s)·resolution_v + v)·resolution_u + u.
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
        Ok(Self { cameras, resolution, texels })
    }

    /// Checks that the texels are those of a slab with the numbers of cameras and texels of `slab`.
    ///
    /// # Errors
    /// If any of the four numbers differs.
    pub fn check(&self, slab: &Slab) -> Result<(), GeometryError> {
        let sizes = [
            ("camera grid of slab texels", self.cameras, slab.cameras()),
            ("image of slab texels", self.resolution, slab.resolution()),
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
        self.cameras
    }

    /// Texels of one image along u and v.
    #[must_use]
    pub fn resolution(&self) -> [u32; 2] {
        self.resolution
    }

    /// All texels in storage order.
    #[must_use]
    pub fn texels(&self) -> &[T] {
        &self.texels
    }

    /// The texels of one camera's image, row after row.
    ///
    /// # Panics
    /// If the camera is outside the grid.
    #[must_use]
    pub fn image(&self, camera: [u32; 2]) -> &[T] {
        assert!(camera[0] < self.cameras[0] && camera[1] < self.cameras[1], "camera {camera:?} of {:?}", self.cameras);
        let size = self.resolution[0] as usize * self.resolution[1] as usize;
        let index = camera[1] as usize * self.cameras[0] as usize + camera[0] as usize;
        &self.texels[index * size..][..size]
    }

    /// One texel.
    ///
    /// # Panics
    /// If the camera or the texel is outside the slab.
    #[must_use]
    pub fn texel(&self, camera: [u32; 2], texel: [u32; 2]) -> T {
        assert!(texel[0] < self.resolution[0], "texel {texel:?} of {:?}", self.resolution);
        self.image(camera)[texel[1] as usize * self.resolution[0] as usize + texel[0] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Face, SampledAxis};

    #[test]
    fn texels_are_addressed_camera_by_camera() {
        let axis = |count| SampledAxis::spanning(-1.0, 1.0, count).unwrap();
        let slab = Slab::new(Face::PosX, 0.0, [axis(2), axis(3)], [axis(4), axis(5)], None).unwrap();
        let all: Vec<[u8; 4]> = (0..120).map(|i| [i, 0, 0, 255]).collect();
        let texels = SlabTexels::new(&slab, all.clone()).unwrap();
        assert_eq!(texels.texel([1, 2], [3, 4]), [((2 * 2 + 1) * 5 + 4) * 4 + 3, 0, 0, 255]);
        assert_eq!(texels.image([1, 2])[4 * 4 + 3], texels.texel([1, 2], [3, 4]));
        assert!(SlabTexels::new(&slab, all[1..].to_vec()).is_err());
    }
}

//! A distance cube as a device holds it.

use glam::Vec3;
use lf_math::{CubeMap, DistanceCube, Image};

use crate::bc1::{self, EncodeOptions};
use crate::error::PackError;
use crate::planes::PlaneImage;

/// A distance cube encoded: BC1 blocks and inverse depths in blocks of two planes, by face.
#[derive(Debug, Clone, PartialEq)]
pub struct PackedCube {
    position: Vec3,
    size: u32,
    radiance: [Vec<u8>; 6],
    inverse_depths: [PlaneImage; 6],
}

impl PackedCube {
    /// Encodes a cube.
    ///
    /// # Errors
    /// If its pictures are too large to encode.
    pub fn encode(cube: &DistanceCube, options: impl Into<EncodeOptions>) -> Result<Self, PackError> {
        let (size, options) = (cube.radiance().size(), options.into());
        let mut radiance: [Vec<u8>; 6] = Default::default();
        for (to, face) in radiance.iter_mut().zip(cube.radiance().faces()) {
            *to = bc1::encode_image(size, size, face.texels(), options)?;
        }
        let inverse_depths = cube.inverse_depths().each_ref().map(|face| {
            let encoded = PlaneImage::encode(face.width(), face.height(), face.texels());
            encoded.unwrap_or_else(|| unreachable!("an image has as many texels as its sides say"))
        });
        Ok(Self { position: cube.position(), size, radiance, inverse_depths })
    }

    /// Where it was taken, cell space.
    #[must_use]
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// The BC1 blocks of each face, of pictures of [`Self::size`] texels along an edge.
    #[must_use]
    pub fn radiance(&self) -> &[Vec<u8>; 6] {
        &self.radiance
    }

    /// Texels along the edge of a face's picture.
    #[must_use]
    pub fn size(&self) -> u32 {
        self.size
    }

    /// The inverse depths of each face.
    #[must_use]
    pub fn inverse_depths(&self) -> &[PlaneImage; 6] {
        &self.inverse_depths
    }

    /// The largest depth of what is seen, metres along the axes of the faces; 0 if that is nothing.
    #[must_use]
    pub fn largest_depth(&self) -> f32 {
        let met = self.inverse_depths.iter().flat_map(PlaneImage::decode).filter(|inverse| *inverse > 0.0);
        met.fold(f32::INFINITY, f32::min).recip()
    }

    /// Bytes of all blocks.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let depths = self.inverse_depths.iter().map(PlaneImage::bytes);
        self.radiance.iter().map(Vec::len).chain(depths).sum()
    }

    /// The cube again, as the blocks hold it.
    ///
    /// # Errors
    /// Never of one that was encoded here.
    pub fn decode(&self) -> Result<DistanceCube, PackError> {
        let mut pictures = [(); 6].map(|()| Image::filled(self.size, self.size, [0; 4]));
        for (to, blocks) in pictures.iter_mut().zip(&self.radiance) {
            *to = Image::new(self.size, self.size, bc1::decode_image(self.size, self.size, blocks)?)?;
        }
        let mut depths = self.inverse_depths.each_ref().map(|face| Image::filled(face.width(), face.height(), 0.0));
        for (to, face) in depths.iter_mut().zip(&self.inverse_depths) {
            *to = Image::new(face.width(), face.height(), face.decode())?;
        }
        Ok(DistanceCube::new(self.position, CubeMap::new(pictures)?, depths)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bc1::Quality;

    #[test]
    fn a_cube_comes_back_in_its_place() {
        let picture = |i: usize| Image::filled(12, 12, [40 * i as u8, 0, 248, 255]);
        let depths = |i: usize| Image::filled(9, 9, 0.25 * (i + 1) as f32);
        let number = [0, 1, 2, 3, 4, 5];
        let radiance = CubeMap::new(number.map(picture)).unwrap();
        let cube = DistanceCube::new(Vec3::new(1.0, 2.0, 3.0), radiance, number.map(depths)).unwrap();
        let packed = PackedCube::encode(&cube, Quality::Standard).unwrap();
        assert_eq!(packed.bytes(), 6 * (9 * 8 + 4 * 20));
        let back = packed.decode().unwrap();
        assert_eq!((back.position(), back.inverse_depths()), (cube.position(), cube.inverse_depths()));
        for (a, b) in back.radiance().faces().iter().zip(cube.radiance().faces()) {
            let apart = a.texels().iter().zip(b.texels()).flat_map(|(a, b)| [0, 1, 2].map(|c| a[c].abs_diff(b[c])));
            assert!(apart.max().unwrap() <= 3);
        }
    }
}

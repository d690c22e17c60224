//! A distance cube as a device holds it.

use glam::Vec3;
use lf_math::{CubeMap, DistanceCube, Image};

use crate::bc1::{self, EncodeOptions};
use crate::error::PackError;
use crate::planes::{BLOCK_EDGE, PlaneBlock, PlaneImage};

/// Blocks whose planes' [`PackedCube::mirrors`] share a word.
const MARKED_BLOCKS: usize = 16;

/// A distance cube encoded: BC1 blocks and inverse depths in blocks of two planes, by face. Where texels are mirrors, so are planes.
#[derive(Debug, Clone, PartialEq)]
pub struct PackedCube {
    position: Vec3,
    size: u32,
    radiance: [Vec<u8>; 6],
    inverse_depths: [PlaneImage; 6],
    /// Two bits a block; empty if no plane is a mirror.
    mirrors: Vec<u32>,
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
        let mirrors = cube.mirrors().map_or_else(Vec::new, |mirrors| marks(mirrors, &inverse_depths));
        Ok(Self { position: cube.position(), size, radiance, inverse_depths, mirrors })
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

    /// Whether any plane is a mirror.
    #[must_use]
    pub fn has_mirrors(&self) -> bool {
        !self.mirrors.is_empty()
    }

    /// Which of a block's two planes are mirrors, most of their texels being such. Blocks are numbered row after row, face after face.
    #[must_use]
    pub fn mirrors(&self, block: usize) -> [bool; 2] {
        let marks = self.mirrors.get(block / MARKED_BLOCKS).map_or(0, |word| word >> (2 * (block % MARKED_BLOCKS)));
        [marks & 1 == 1, marks & 2 == 2]
    }

    /// The largest depth of what is seen, metres along the axes of the faces; 0 if that is nothing.
    #[must_use]
    pub fn largest_depth(&self) -> f32 {
        let met = self.inverse_depths.iter().flat_map(PlaneImage::decode).filter(|inverse| *inverse > 0.0);
        met.fold(f32::INFINITY, f32::min).recip()
    }

    /// Bytes of all blocks, and of the two bits that say which of their planes are mirrors.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let depths = self.inverse_depths.iter().map(PlaneImage::bytes);
        self.radiance.iter().map(Vec::len).chain(depths).sum::<usize>() + size_of_val(&self.mirrors[..])
    }

    /// The cube again, as the blocks hold it; which texels were mirrors is not told.
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

/// Two bits for each block, the first block's lowest: whether most texels of each plane are mirrors.
fn marks(mirrors: &[Image<bool>; 6], depths: &[PlaneImage; 6]) -> Vec<u32> {
    let of_face = |(mirrors, depths): (&Image<bool>, &PlaneImage)| {
        let across = depths.width().div_ceil(BLOCK_EDGE as u32);
        let mark = |(number, block): (u32, &PlaneBlock)| {
            let corner = [number % across, number / across].map(|place| place * BLOCK_EDGE as u32);
            // More mirrors than others on each plane.
            let mut more = [0i32; 2];
            for bit in 0..64 {
                let [x, y] = [corner[0] + bit % BLOCK_EDGE as u32, corner[1] + bit / BLOCK_EDGE as u32];
                if x < mirrors.width() && y < mirrors.height() {
                    more[(block.mask >> bit & 1) as usize] += if mirrors.get(x, y) { 1 } else { -1 };
                }
            }
            u32::from(more[0] > 0) | u32::from(more[1] > 0) << 1
        };
        (0..).zip(depths.blocks()).map(mark).collect::<Vec<_>>()
    };
    let marks: Vec<u32> = mirrors.iter().zip(depths).flat_map(of_face).collect();
    if marks.iter().all(|mark| *mark == 0) {
        return vec![];
    }
    let word = |marks: &[u32]| marks.iter().rev().fold(0, |word, mark| word << 2 | mark);
    marks.chunks(MARKED_BLOCKS).map(word).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bc1::Quality;
    use lf_math::Face;

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

    /// A wall, and in front of its right part a mirror, on one face.
    #[test]
    fn planes_of_mirrors_are_marked() {
        const SIZE: u32 = 20;
        let is_mirror = |face: Face, x: u32| face == Face::NegZ && x >= 11;
        let image = |face| {
            let depths = (0..SIZE * SIZE).map(|i| if is_mirror(face, i % SIZE) { 0.5 } else { 0.25 });
            Image::new(SIZE, SIZE, depths.collect::<Vec<f32>>()).unwrap()
        };
        let marked = |face| {
            let texels = (0..SIZE * SIZE).map(|i| is_mirror(face, i % SIZE));
            Image::new(SIZE, SIZE, texels.collect::<Vec<bool>>()).unwrap()
        };
        let radiance = CubeMap::new([0; 6].map(|_| Image::filled(SIZE, SIZE, [200, 100, 0, 255]))).unwrap();
        let plain = DistanceCube::new(Vec3::ZERO, radiance, Face::ALL.map(image)).unwrap();
        let without = PackedCube::encode(&plain, Quality::Standard).unwrap();
        let with = PackedCube::encode(&plain.with_mirrors(Face::ALL.map(marked)).unwrap(), Quality::Standard).unwrap();
        assert!(with.has_mirrors() && !without.has_mirrors());
        // Nine blocks a face, 54 of them in four words.
        assert_eq!(with.bytes(), without.bytes() + 4 * 4);
        for number in 0..54 {
            let (face, block) = (number / 9, with.inverse_depths()[number / 9].blocks()[number % 9]);
            let marks = with.mirrors(number);
            assert_eq!(without.mirrors(number), [false; 2]);
            for bit in 0..64usize {
                let x = number % 3 * BLOCK_EDGE + bit % BLOCK_EDGE;
                let row = number % 9 / 3 * BLOCK_EDGE + bit / BLOCK_EDGE;
                if x < SIZE as usize && row < SIZE as usize {
                    let expected = is_mirror(Face::ALL[face], x as u32);
                    assert_eq!(marks[(block.mask >> bit & 1) as usize], expected, "{number} {bit}");
                }
            }
        }
    }
}

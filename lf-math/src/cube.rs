//! Cube map addressing, as Vulkan, Direct3D and WebGPU define it.

use glam::{Vec2, Vec3};

use crate::{Face, GeometryError, Image};

/// Where a direction meets a cube map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubeCoord {
    /// The face.
    pub face: Face,
    /// Position on the face, 0 … 1 from left to right and top to bottom.
    pub uv: Vec2,
}

/// Six square images of equal size around a point, in the order of the faces: the classic environment map
/// (Greene 1986). 8-bit RGBA, sRGB-encoded.
#[derive(Debug, Clone, PartialEq)]
pub struct CubeMap {
    faces: [Image<[u8; 4]>; 6],
}

impl CubeMap {
    /// A cube map from its faces +X −X +Y −Y +Z −Z.
    ///
    /// # Errors
    /// All six must be square and of one size.
    pub fn new(faces: [Image<[u8; 4]>; 6]) -> Result<Self, GeometryError> {
        let want = [faces[0].width(); 2];
        for have in faces.each_ref().map(|face| [face.width(), face.height()]) {
            if have != want {
                return Err(GeometryError::Size { what: "cube map face", have, want });
            }
        }
        Ok(Self { faces })
    }

    /// The six images.
    #[must_use]
    pub fn faces(&self) -> &[Image<[u8; 4]>; 6] {
        &self.faces
    }

    /// Texels along the edge of a face.
    #[must_use]
    pub fn size(&self) -> u32 {
        self.faces[0].width()
    }
}

/// The signed axis vectors (right, down) of a face's image, looking from the centre.
fn frame(face: Face) -> (Vec3, Vec3) {
    match face {
        Face::PosX => (-Vec3::Z, -Vec3::Y),
        Face::NegX => (Vec3::Z, -Vec3::Y),
        Face::PosY => (Vec3::X, Vec3::Z),
        Face::NegY => (Vec3::X, -Vec3::Z),
        Face::PosZ => (Vec3::X, -Vec3::Y),
        Face::NegZ => (-Vec3::X, -Vec3::Y),
    }
}

/// The face and position of a direction (Vulkan specification, "Cube Map Face Selection and Transformations").
///
/// `None` for a direction that is zero or not finite.
#[must_use]
#[inline]
pub fn cube_coord(direction: Vec3) -> Option<CubeCoord> {
    let face = Face::dominant(direction)?;
    let largest = direction[face.axis()].abs();
    // Divide first: a quotient is at most 1, whatever the length of the direction.
    let [x, y, z] = (direction / largest).to_array();
    // As `frame` has them, without products with 0.
    let (right, down) = match face {
        Face::PosX => (-z, -y),
        Face::NegX => (z, -y),
        Face::PosY => (x, z),
        Face::NegY => (x, -z),
        Face::PosZ => (x, -y),
        Face::NegZ => (-x, -y),
    };
    Some(CubeCoord { face, uv: 0.5 * Vec2::new(right, down) + 0.5 })
}

/// The direction (largest component ±1) through a position on a face; inverse of [`cube_coord`].
#[must_use]
#[inline]
pub fn cube_direction(coord: CubeCoord) -> Vec3 {
    let (right, down) = frame(coord.face);
    let p = 2.0 * coord.uv - 1.0;
    let forward = coord.face.vector(Vec2::ZERO, coord.face.sign());
    forward + p.x * right + p.y * down
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_round_trip() {
        for face in Face::ALL {
            for uv in [Vec2::new(0.25, 0.75), Vec2::splat(0.5), Vec2::new(0.9, 0.1)] {
                let coord = CubeCoord { face, uv };
                let back = cube_coord(cube_direction(coord) * 3.0).unwrap();
                assert_eq!(back.face, face);
                assert!((back.uv - uv).abs().max_element() < 1e-6);
            }
        }
    }

    #[test]
    fn faces_must_be_equal_squares() {
        let square = Image::filled(4, 4, [0; 4]);
        let mut faces: [Image<[u8; 4]>; 6] = core::array::from_fn(|_| square.clone());
        assert_eq!(CubeMap::new(faces.clone()).unwrap().size(), 4);
        faces[3] = Image::filled(4, 5, [0; 4]);
        assert!(CubeMap::new(faces).is_err());
    }

    #[test]
    fn seen_from_inside_up_is_up() {
        // On the four side faces, a smaller v means a larger y.
        for face in [Face::PosX, Face::NegX, Face::PosZ, Face::NegZ] {
            let top = cube_direction(CubeCoord { face, uv: Vec2::new(0.5, 0.0) });
            assert_eq!(top.y, 1.0);
        }
    }
}

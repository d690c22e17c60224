//! The six faces of a cell and the axes that belong to them.

use glam::{Vec2, Vec3};

/// A face direction, numbered as the faces of a cube map: +X −X +Y −Y +Z −Z are 0 … 5.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Face {
    /// Towards +X.
    PosX = 0,
    /// Towards −X.
    NegX = 1,
    /// Towards +Y.
    PosY = 2,
    /// Towards −Y.
    NegY = 3,
    /// Towards +Z.
    PosZ = 4,
    /// Towards −Z.
    NegZ = 5,
}

impl Face {
    /// All six, in order.
    pub const ALL: [Self; 6] = [Self::PosX, Self::NegX, Self::PosY, Self::NegY, Self::PosZ, Self::NegZ];

    /// The face of a number 0 … 5.
    #[must_use]
    pub fn from_index(index: u8) -> Option<Self> {
        Self::ALL.get(usize::from(index)).copied()
    }

    /// The number 0 … 5.
    #[must_use]
    #[inline]
    pub fn index(self) -> u8 {
        self as u8
    }

    /// The axis `k` the face is perpendicular to: 0, 1 or 2 for x, y or z.
    #[must_use]
    #[inline]
    pub fn axis(self) -> usize {
        usize::from(self.index() / 2)
    }

    /// +1 or −1: which way along its axis the face looks.
    #[must_use]
    #[inline]
    pub fn sign(self) -> f32 {
        if self.index().is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    /// The two axes along which (s, t) and (u, v) run, in cyclic order: X → (y, z), Y → (z, x), Z → (x, y).
    ///
    /// Both faces of an axis use the same pair without a flip, as the paper's Fig. 6 does for z. The image of a negative
    /// face is thus mirrored against what a camera there would see.
    #[must_use]
    pub fn tangents(self) -> [usize; 2] {
        let k = self.axis();
        [(k + 1) % 3, (k + 2) % 3]
    }

    /// The components of `v` along [`Self::tangents`].
    #[must_use]
    pub fn tangential(self, v: Vec3) -> Vec2 {
        let [s, t] = self.tangents();
        Vec2::new(v[s], v[t])
    }

    /// The vector with the given tangential parts and `along` on the face's axis (not multiplied by the sign).
    #[must_use]
    pub fn vector(self, tangential: Vec2, along: f32) -> Vec3 {
        let [s, t] = self.tangents();
        let mut v = [0.0; 3];
        v[s] = tangential.x;
        v[t] = tangential.y;
        v[self.axis()] = along;
        Vec3::from_array(v)
    }

    /// The face that a direction leads to: the axis of largest magnitude (§5 of the paper), on a tie the first of x, y, z.
    ///
    /// `None` for a direction that is zero or not finite: such a ray has no face.
    #[must_use]
    #[inline]
    pub fn dominant(direction: Vec3) -> Option<Self> {
        let a = direction.abs();
        if !direction.is_finite() || a.max_element() == 0.0 {
            return None;
        }
        let (along, positive, negative) = if a.x >= a.y && a.x >= a.z {
            (direction.x, Self::PosX, Self::NegX)
        } else if a.y >= a.z {
            (direction.y, Self::PosY, Self::NegY)
        } else {
            (direction.z, Self::PosZ, Self::NegZ)
        };
        Some(if along < 0.0 { negative } else { positive })
    }

    /// The name used in messages and file listings, such as `+X`.
    #[must_use]
    pub fn name(self) -> &'static str {
        ["+X", "-X", "+Y", "-Y", "+Z", "-Z"][usize::from(self.index())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_round_trip() {
        for (i, face) in Face::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(face.index()), i);
            assert_eq!(Face::from_index(i as u8), Some(face));
        }
        assert_eq!(Face::from_index(6), None);
    }

    #[test]
    fn the_dominant_face_is_the_largest_component() {
        for face in Face::ALL {
            let direction = face.vector(Vec2::new(0.9, -0.9), face.sign());
            assert_eq!(Face::dominant(direction), Some(face));
            assert_eq!(Face::dominant(direction * 1e-38), Some(face));
            assert_eq!(Face::dominant(direction * 1e38), Some(face));
        }
    }

    #[test]
    fn ties_go_to_the_first_axis() {
        assert_eq!(Face::dominant(Vec3::new(-1.0, 1.0, 1.0)), Some(Face::NegX));
        assert_eq!(Face::dominant(Vec3::new(0.5, -1.0, 1.0)), Some(Face::NegY));
        assert_eq!(Face::dominant(Vec3::new(-0.0, 0.0, 0.0)), None);
        assert_eq!(Face::dominant(Vec3::new(f32::NAN, 1.0, 0.0)), None);
        assert_eq!(Face::dominant(Vec3::new(1.0, f32::INFINITY, 0.0)), None);
    }

    #[test]
    fn tangents_and_axis_are_a_cyclic_frame() {
        for face in Face::ALL {
            let [s, t] = face.tangents();
            assert_eq!(Vec3::AXES[s].cross(Vec3::AXES[t]), Vec3::AXES[face.axis()]);
            let v = Vec3::new(1.0, 2.0, 3.0);
            assert_eq!(face.vector(face.tangential(v), v[face.axis()]), v);
        }
    }
}

//! Where a mesh stands in the cell.

use glam::{Mat4, Quat, Vec3, Vec4};

use crate::error::{GeometryError, finite, positive};
use crate::scale::to_one;

/// A similarity from a mesh's own space to cell space: scaled alike along all axes, turned, then moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    scale: f32,
    rotation: Quat,
    translation: Vec3,
}

impl Placement {
    /// The mesh's own space is cell space.
    pub const IDENTITY: Self = Self { scale: 1.0, rotation: Quat::IDENTITY, translation: Vec3::ZERO };

    /// `scale` has no unit, `rotation` need not have unit length, `translation` is in metres.
    ///
    /// # Errors
    /// All must be finite, the scale greater than 0 and the rotation not zero.
    pub fn new(scale: f32, rotation: Quat, translation: Vec3) -> Result<Self, GeometryError> {
        positive("scale", scale)?;
        for value in rotation.to_array() {
            finite("rotation", value)?;
        }
        // A power of two keeps the squares of any rotation in range.
        let rotation = rotation * to_one(Vec4::from(rotation).abs().max_element());
        positive("length of the rotation", rotation.length())?;
        for value in translation.to_array() {
            finite("translation", value)?;
        }
        Ok(Self { scale, rotation: rotation.normalize(), translation })
    }

    /// As a matrix.
    #[must_use]
    pub fn cell_from_mesh(&self) -> Mat4 {
        Mat4::from_scale_rotation_translation(Vec3::splat(self.scale), self.rotation, self.translation)
    }

    /// A point in cell space.
    #[must_use]
    pub fn point(&self, point: Vec3) -> Vec3 {
        self.cell_from_mesh().transform_point3(point)
    }

    /// A direction in cell space; its length is kept.
    #[must_use]
    pub fn direction(&self, direction: Vec3) -> Vec3 {
        self.rotation * direction
    }

    /// The point of the mesh's own space that comes to a point of cell space.
    #[must_use]
    pub fn mesh_point(&self, point: Vec3) -> Vec3 {
        self.mesh_direction(point - self.translation) / self.scale
    }

    /// The direction in the mesh's own space that comes to one in cell space; its length is kept.
    #[must_use]
    pub fn mesh_direction(&self, direction: Vec3) -> Vec3 {
        self.rotation.conjugate() * direction
    }

    /// The smallest box around a placed box, both as (min, max).
    #[must_use]
    pub fn bounds(&self, (min, max): (Vec3, Vec3)) -> (Vec3, Vec3) {
        let half = 0.5 * (max - min);
        let columns = self.cell_from_mesh();
        let reach = columns.x_axis.truncate().abs() * half.x
            + columns.y_axis.truncate().abs() * half.y
            + columns.z_axis.truncate().abs() * half.z;
        let middle = self.point(min + half);
        (middle - reach, middle + reach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::FRAC_PI_2;

    #[test]
    fn scaled_turned_then_moved() {
        let quarter = Quat::from_rotation_y(FRAC_PI_2);
        let placement = Placement::new(2.0, quarter * 3.0, Vec3::new(0.0, 1.0, 0.0)).unwrap();
        assert!((placement.point(Vec3::X) - Vec3::new(0.0, 1.0, -2.0)).length() < 1e-6);
        assert!((placement.direction(Vec3::X) + Vec3::Z).length() < 1e-6);
        assert!((placement.mesh_point(Vec3::new(0.0, 1.0, -2.0)) - Vec3::X).length() < 1e-6);
        assert!((placement.mesh_direction(Vec3::NEG_Z) - Vec3::X).length() < 1e-6);
        let (min, max) = placement.bounds((Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)));
        assert!((min - Vec3::new(0.0, 1.0, -2.0)).length() < 1e-5, "{min}");
        assert!((max - Vec3::new(6.0, 5.0, 0.0)).length() < 1e-5, "{max}");
    }

    #[test]
    fn rotations_may_have_any_length() {
        let turn = Quat::from_xyzw(0.1, -0.2, 0.3, 0.9);
        let placement = |turn| Placement::new(1.0, turn, Vec3::ZERO).unwrap();
        for exponent in [-100, 100] {
            assert_eq!(placement(turn * 2.0f32.powi(exponent)), placement(turn), "2^{exponent}");
        }
    }

    #[test]
    fn what_is_no_similarity_is_refused() {
        let turn = Quat::IDENTITY;
        assert!(Placement::new(0.0, turn, Vec3::ZERO).is_err());
        assert!(Placement::new(1.0, turn * 0.0, Vec3::ZERO).is_err());
        assert!(Placement::new(1.0, turn * f32::NAN, Vec3::ZERO).is_err());
        assert!(Placement::new(1.0, turn, Vec3::INFINITY).is_err());
    }
}

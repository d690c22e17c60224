//! The box in which reflectors may move.

use glam::{DVec3, Vec3};

use crate::Ray;
use crate::error::{GeometryError, positive};

/// The axis-aligned box, in world space, inside which every reflector stays (§5 of the paper: the bounding box of
/// length l; here it need not be a cube).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    center: DVec3,
    half_extent: Vec3,
}

impl Cell {
    /// A box by its centre (world space, metres) and half its edge lengths (metres).
    ///
    /// # Errors
    /// The centre must be finite, the half extents finite and greater than 0.
    pub fn new(center: DVec3, half_extent: Vec3) -> Result<Self, GeometryError> {
        if !center.is_finite() {
            return Err(GeometryError::NotFinite { what: "cell centre", value: f32::NAN });
        }
        for extent in half_extent.to_array() {
            positive("cell half extent", extent)?;
        }
        Ok(Self { center, half_extent })
    }

    /// The cube of edge length `size` (metres) around `center` (world space).
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn cube(center: DVec3, size: f32) -> Result<Self, GeometryError> {
        Self::new(center, Vec3::splat(0.5 * size))
    }

    /// Centre in world space, metres. Double precision, so that a cell far from the origin keeps its place.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// Half the edge lengths, metres.
    #[must_use]
    pub fn half_extent(&self) -> Vec3 {
        self.half_extent
    }

    /// A world-space point in cell space.
    #[must_use]
    pub fn cell_from_world(&self, point: DVec3) -> Vec3 {
        (point - self.center).as_vec3()
    }

    /// A cell-space point in world space.
    #[must_use]
    pub fn world_from_cell(&self, point: Vec3) -> DVec3 {
        self.center + point.as_dvec3()
    }

    /// Whether a cell-space point lies in the box or on its surface.
    #[must_use]
    pub fn contains(&self, point: Vec3) -> bool {
        point.abs().cmple(self.half_extent).all()
    }

    /// The ray parameter at which a line, given in cell space, leaves the box for good along its direction.
    ///
    /// Slab test per axis (Kay & Kajiya 1986): the smallest of the three exit parameters. For a line that misses the
    /// box this is still a finite, continuous function of the line wherever no direction component is zero: the
    /// point where it leaves the first of the three slabs. A component of zero contributes +∞ inside its slab and −∞
    /// outside. The result is therefore clamped to where the line enters and leaves the slab of its dominant axis.
    ///
    /// Returns `None` for a direction that is zero or not finite, an origin that is not finite, or a parameter that is beyond
    /// the range of `f32`, which takes a direction shorter than 1e-38 times the way.
    #[inline]
    #[must_use]
    pub fn exit(&self, ray: &Ray) -> Option<f32> {
        let axis = crate::Face::dominant(ray.direction).filter(|_| ray.origin.is_finite())?.axis();
        let towards = self.half_extent * Vec3::ONE.copysign(ray.direction);
        let exits = (towards - ray.origin) / ray.direction;
        // 0/0: the line lies in a face's plane, which counts as inside.
        let bounded = Vec3::from_array(exits.to_array().map(|t| if t.is_nan() { f32::INFINITY } else { t }));
        let leave = bounded[axis];
        let enter = (-towards[axis] - ray.origin[axis]) / ray.direction[axis];
        Some(bounded.min_element().clamp(enter, leave)).filter(|t| t.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn unit_cell() -> Cell {
        Cell::cube(DVec3::ZERO, 2.0).unwrap()
    }

    #[test]
    fn exit_of_rays_from_the_centre() {
        let cell = unit_cell();
        for direction in [Vec3::X, -Vec3::Y, Vec3::new(0.0, 0.0, 3.0), Vec3::ONE] {
            let t = cell.exit(&Ray { origin: Vec3::ZERO, direction }).unwrap();
            assert_eq!((direction * t).abs().max_element(), 1.0);
        }
    }

    #[test]
    fn exit_beside_the_cell_is_clamped_to_the_slab() {
        // Parallel to X, above the box: starts where it enters the slab |x| ≤ 1.
        let ray = Ray { origin: Vec3::new(1.0, 2.0, 0.0), direction: Vec3::X };
        assert_eq!(unit_cell().exit(&ray), Some(-2.0));
    }

    #[test]
    fn exit_refuses_no_direction() {
        for direction in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
            assert_eq!(unit_cell().exit(&Ray { origin: Vec3::ZERO, direction }), None);
        }
        assert_eq!(unit_cell().exit(&Ray { origin: Vec3::NAN, direction: Vec3::X }), None);
        assert_eq!(unit_cell().exit(&Ray { origin: Vec3::ZERO, direction: Vec3::X * 1e-39 }), None);
    }

    #[test]
    fn a_line_in_a_face_plane_leaves_at_the_far_edge() {
        let ray = Ray { origin: Vec3::new(0.0, 1.0, 0.0), direction: Vec3::X };
        assert_eq!(unit_cell().exit(&ray), Some(1.0));
    }

    proptest! {
        #[test]
        fn a_ray_from_inside_leaves_through_the_surface(
            o in prop::array::uniform3(-0.99f32..0.99), d in prop::array::uniform3(-1.0f32..1.0)
        ) {
            let ray = Ray { origin: Vec3::from(o), direction: Vec3::from(d) };
            prop_assume!(ray.direction.abs().max_element() > 1e-3);
            let at = ray.at(unit_cell().exit(&ray).unwrap()).abs().max_element();
            prop_assert!((at - 1.0).abs() < 1e-5, "leaves at {at}");
        }

        #[test]
        fn far_cells_keep_their_precision(x in -0.5f64..0.5) {
            let cell = Cell::cube(DVec3::splat(1e6), 1.0).unwrap();
            let local = cell.cell_from_world(DVec3::splat(1e6 + x));
            prop_assert!((f64::from(local.x) - x).abs() < 1e-7);
        }
    }
}

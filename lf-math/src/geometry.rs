//! The slabs of one environment light field together.

use alloc::vec::Vec;

use glam::Vec2;

use crate::{Cell, Face, GeometryError, Ray, SampledAxis, Slab, SlabCoord};

/// A cell and the slabs around it: one to six, at most one for each face, in the order of the faces.
#[derive(Debug, Clone, PartialEq)]
pub struct LightFieldGeometry {
    cell: Cell,
    slabs: Vec<Slab>,
}

/// Where the camera planes stand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlanePlacement {
    /// On the cell's faces, as in Fig. 7 of the paper: a cube cell of edge l needs slabs of length 3l.
    CellFaces,
    /// Through the cell's centre: length 2l is enough, so the same cameras stand 1.5 times as close.
    CellCenter,
    /// This far from the cell's centre towards each face, metres; negative beyond the centre.
    Offset(f32),
}

impl PlanePlacement {
    /// How far from the cell's centre, towards the face that is `half` away from it.
    fn offset(self, half: f32) -> f32 {
        match self {
            Self::CellFaces => half,
            Self::CellCenter => 0.0,
            Self::Offset(offset) => offset,
        }
    }
}

/// A ray with the slab that answers it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IndexedRay {
    /// Position of the slab in [`LightFieldGeometry::slabs`].
    pub slab: usize,
    /// The ray's sample indices there.
    pub coord: SlabCoord,
}

impl LightFieldGeometry {
    /// A light field from its slabs.
    ///
    /// # Errors
    /// There must be one to six slabs, with faces in ascending order and none twice.
    pub fn new(cell: Cell, slabs: Vec<Slab>) -> Result<Self, GeometryError> {
        for pair in slabs.windows(2) {
            match pair[0].face().cmp(&pair[1].face()) {
                core::cmp::Ordering::Less => {}
                core::cmp::Ordering::Equal => {
                    return Err(GeometryError::DuplicateFace { face: pair[0].face().name() });
                }
                core::cmp::Ordering::Greater => return Err(GeometryError::SlabOrder),
            }
        }
        if slabs.is_empty() {
            return Err(GeometryError::SlabOrder);
        }
        Ok(Self { cell, slabs })
    }

    /// Six slabs that together hold every ray through the cell (§5 of the paper), without a focal plane.
    ///
    /// Slopes reach from −1 to 1 (θ = π/4). `cameras` and `resolution` are per axis. A ray with dominant axis k that
    /// passes the cell crosses the plane within `h_i + max|x_k − plane|` of the centre on each other axis i, with h the
    /// cell's half extents: 3l in all for a cube of edge l with planes on its faces, 2l with planes through its centre.
    ///
    /// # Errors
    /// Both counts must be 1 to 2²⁴, and the slabs of finite size.
    pub fn around(cell: Cell, placement: PlanePlacement, cameras: u32, resolution: u32) -> Result<Self, GeometryError> {
        Self::around_with(cell, placement, [cameras; 2], [resolution; 2])
    }

    /// As [`Self::around`], with cameras along s and t and texels along u and v.
    ///
    /// # Errors
    /// As there.
    pub fn around_with(
        cell: Cell,
        placement: PlanePlacement,
        cameras: [u32; 2],
        resolution: [u32; 2],
    ) -> Result<Self, GeometryError> {
        let half = cell.half_extent();
        let slab = |face: Face| {
            let offset = placement.offset(half[face.axis()]);
            let slopes = |i: usize| SampledAxis::spanning(-1.0, 1.0, resolution[i]);
            let positions = |i: usize| {
                let reach = half[face.tangents()[i]] + half[face.axis()] + offset.abs();
                SampledAxis::spanning(-reach, reach, cameras[i])
            };
            Slab::new(face, face.sign() * offset, [positions(0)?, positions(1)?], [slopes(0)?, slopes(1)?], None)
        };
        Self::new(cell, Face::ALL.into_iter().map(slab).collect::<Result<_, _>>()?)
    }

    /// The cell.
    #[inline]
    #[must_use]
    pub fn cell(&self) -> &Cell {
        &self.cell
    }

    /// The slabs, in the order of their faces.
    #[inline]
    #[must_use]
    pub fn slabs(&self) -> &[Slab] {
        &self.slabs
    }

    /// The slab of a ray's dominant direction and the ray's indices there, which are finite; `None` if the direction is zero
    /// or not finite, no slab serves it, or the origin is not finite or so far away that an index is not. The indices may lie
    /// outside the slab: see [`Slab::contains`].
    #[inline]
    #[must_use]
    pub fn index_ray(&self, ray: &Ray) -> Option<IndexedRay> {
        let face = Face::dominant(ray.direction)?;
        let slab = self.slabs.iter().position(|slab| slab.face() == face)?;
        let coord = self.slabs[slab].index_ray(ray);
        (coord.st.is_finite() && coord.uv.is_finite()).then_some(IndexedRay { slab, coord })
    }

    /// The stored ray of a sample as it is captured: from the point where it leaves the cell, so that objects standing
    /// beside the cell, in front of an extended camera plane, are seen. The direction's largest component is ±1.
    ///
    /// `slab` is a position in [`Self::slabs`], `camera` and `texel` are real-valued indices.
    ///
    /// # Panics
    /// If there is no such slab.
    #[must_use]
    pub fn capture_ray(&self, slab: usize, camera: Vec2, texel: Vec2) -> Ray {
        let ray = self.slabs[slab].sample_ray(camera, texel);
        let start = self.cell.exit(&ray).unwrap_or(0.0);
        Ray { origin: ray.at(start), direction: ray.direction }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use glam::{DVec3, Vec3};
    use proptest::prelude::*;

    fn placements() -> impl Strategy<Value = PlanePlacement> {
        let offset = (-4.0f32..4.0).prop_map(PlanePlacement::Offset);
        prop_oneof![Just(PlanePlacement::CellFaces), Just(PlanePlacement::CellCenter), offset]
    }

    fn around(half: Vec3, placement: PlanePlacement) -> LightFieldGeometry {
        LightFieldGeometry::around(Cell::new(DVec3::ZERO, half).unwrap(), placement, 9, 17).unwrap()
    }

    #[test]
    fn the_papers_set_up() {
        let field = around(Vec3::splat(0.5), PlanePlacement::CellFaces);
        for slab in field.slabs() {
            assert_eq!(slab.plane(), 0.5 * slab.face().sign());
            assert!((slab.st()[0].first() + 1.5).abs() < 1e-6 && (slab.st()[1].last() - 1.5).abs() < 1e-6);
            assert_eq!((slab.uv()[0].first(), slab.uv()[1].last()), (-1.0, 1.0));
        }
    }

    #[test]
    fn order_and_duplicates_are_checked() {
        let field = around(Vec3::ONE, PlanePlacement::CellCenter);
        let [a, b] = [field.slabs()[0], field.slabs()[1]];
        assert_eq!(LightFieldGeometry::new(*field.cell(), vec![b, a]), Err(GeometryError::SlabOrder));
        assert!(LightFieldGeometry::new(*field.cell(), vec![a, a]).is_err());
        assert!(LightFieldGeometry::new(*field.cell(), vec![]).is_err());
        assert!(LightFieldGeometry::new(*field.cell(), vec![b]).is_ok());
    }

    #[test]
    fn a_missing_slab_answers_nothing() {
        let field = around(Vec3::ONE, PlanePlacement::CellCenter);
        let only_z = LightFieldGeometry::new(*field.cell(), vec![field.slabs()[4]]).unwrap();
        let ray = |direction| Ray { origin: Vec3::ZERO, direction };
        assert_eq!(only_z.index_ray(&ray(Vec3::Z)).map(|r| r.slab), Some(0));
        assert_eq!(only_z.index_ray(&ray(-Vec3::Z)), None);
        assert_eq!(field.index_ray(&ray(Vec3::ZERO)), None);
    }

    #[test]
    fn rays_from_nowhere_are_answered_by_nothing() {
        let field = around(Vec3::ONE, PlanePlacement::CellCenter);
        for origin in [Vec3::NAN, Vec3::INFINITY, Vec3::new(0.0, f32::NEG_INFINITY, 0.0), Vec3::splat(f32::MAX)] {
            assert_eq!(field.index_ray(&Ray { origin, direction: Vec3::new(0.1, 0.2, 1.0) }), None, "{origin}");
        }
        let far = Ray { origin: Vec3::splat(1e30), direction: Vec3::new(0.1, 0.2, 1.0) };
        assert!(field.index_ray(&far).is_some_and(|indexed| !field.slabs()[indexed.slab].contains(&indexed.coord)));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// §5: "guarantee that all rays going through the box are captured", for any box and all placements.
        #[test]
        fn every_ray_through_the_cell_is_inside(
            half in prop::array::uniform3(0.1f32..3.0), p in prop::array::uniform3(-1.0f32..=1.0),
            d in prop::array::uniform3(-1.0f32..1.0), placement in placements()
        ) {
            let direction = Vec3::from(d);
            prop_assume!(direction.abs().max_element() > 1e-6);
            let half = Vec3::from(half);
            let field = around(half, placement);
            let ray = Ray { origin: half * Vec3::from(p), direction };
            let indexed = field.index_ray(&ray).unwrap();
            prop_assert!(field.slabs()[indexed.slab].contains(&indexed.coord), "{indexed:?}");
        }

        #[test]
        fn captured_rays_start_on_the_cell_and_index_to_their_sample(
            slab in 0usize..6, s in 2.0f32..6.0, t in 2.0f32..6.0, u in 0.0f32..16.0, v in 0.0f32..16.0
        ) {
            let field = around(Vec3::new(0.5, 0.7, 0.9), PlanePlacement::CellFaces);
            let ray = field.capture_ray(slab, Vec2::new(s, t), Vec2::new(u, v));
            let mid = |t: f32| (ray.at(-t) / field.cell().half_extent()).abs().max_element();
            // Rays through the cell start on its surface and come from its inside.
            if mid(0.01) < 1.0 {
                prop_assert!((mid(0.0) - 1.0).abs() < 1e-4);
            }
            // Whatever the start, it is the same line.
            let coord = field.slabs()[slab].index_ray(&ray);
            prop_assert!((coord.st - Vec2::new(s, t)).abs().max_element() < 1e-4, "{ray:?}");
            prop_assert!((coord.uv - Vec2::new(u, v)).abs().max_element() < 1e-4, "{ray:?}");
        }
    }
}

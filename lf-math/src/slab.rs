//! One light field slab: a grid of cameras on a plane, all sharing one grid of ray slopes.

use glam::{Vec2, Vec3};

use crate::error::{GeometryError, finite, positive};
use crate::{Face, Ray, SampledAxis};

/// A slab of the environment light field (§3 and §5 of the paper), in cell space.
///
/// With k the axis of the face, the camera with indices (i, j) stands at `s[i], t[j]` on the plane `x_k = plane`. Texel
/// (m, n) of every camera's image holds the light seen along the slopes `u[m] = d_s/|d_k|`, `v[n] = d_t/|d_k|`, towards the
/// side the face looks to. (s, u) run along the first and (t, v) along the second of [`Face::tangents`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slab {
    face: Face,
    plane: f32,
    st: [SampledAxis; 2],
    uv: [SampledAxis; 2],
    focal_depth: Option<f32>,
}

/// A ray in the sample indices (s′, t′, u′, v′) of one slab (Eq. 1 of the paper): real-valued, sample centres at integers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlabCoord {
    /// (s′, t′): which camera.
    pub st: Vec2,
    /// (u′, v′): which texel of a camera standing exactly at (s′, t′).
    pub uv: Vec2,
}

/// One of the four cameras around a ray, where to look in its image, and how much it counts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CameraTap {
    /// Camera indices along s and t.
    pub camera: [u32; 2],
    /// Position in that camera's image in index units, within 0 … count − 1: all four bilinear neighbours are its own.
    pub uv: Vec2,
    /// Bilinear weight, 0 … 1; the four add up to 1.
    pub weight: f32,
}

impl Slab {
    /// A slab from its parts: `plane` is the signed coordinate of the camera plane along the face's axis (metres, cell
    /// space), `st` the camera positions (metres), `uv` the slopes (no unit), `focal_depth` the distance from the camera
    /// plane to the focal plane (metres), or `None` to focus at infinity.
    ///
    /// # Errors
    /// `plane` must be finite, `focal_depth` finite, greater than 0 and not so small that the disparity overflows.
    pub fn new(
        face: Face,
        plane: f32,
        st: [SampledAxis; 2],
        uv: [SampledAxis; 2],
        focal_depth: Option<f32>,
    ) -> Result<Self, GeometryError> {
        finite("camera plane", plane)?;
        if let Some(depth) = focal_depth {
            positive("focal depth", depth)?;
        }
        let slab = Self { face, plane, st, uv, focal_depth };
        finite("disparity", slab.disparity().max_element())?;
        Ok(slab)
    }

    /// The face direction this slab serves.
    #[inline]
    #[must_use]
    pub fn face(&self) -> Face {
        self.face
    }

    /// Coordinate of the camera plane along the face's axis, metres, cell space.
    #[inline]
    #[must_use]
    pub fn plane(&self) -> f32 {
        self.plane
    }

    /// Camera positions along s and t.
    #[must_use]
    pub fn st(&self) -> [SampledAxis; 2] {
        self.st
    }

    /// Ray slopes along u and v.
    #[must_use]
    pub fn uv(&self) -> [SampledAxis; 2] {
        self.uv
    }

    /// Distance from the camera plane to the focal plane, metres; `None` is infinity.
    #[must_use]
    pub fn focal_depth(&self) -> Option<f32> {
        self.focal_depth
    }

    /// The same slab with another focal plane.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_focal_depth(self, focal_depth: Option<f32>) -> Result<Self, GeometryError> {
        Self::new(self.face, self.plane, self.st, self.uv, focal_depth)
    }

    /// Number of camera images.
    #[inline]
    #[must_use]
    pub fn cameras(&self) -> [u32; 2] {
        self.st.map(|axis| axis.count())
    }

    /// Texels of one camera image.
    #[inline]
    #[must_use]
    pub fn resolution(&self) -> [u32; 2] {
        self.uv.map(|axis| axis.count())
    }

    /// The ray that a sample stores, starting on the camera plane: `camera` and `texel` are real-valued indices along
    /// (s, t) and (u, v). The direction's component along the face's axis is ±1.
    #[must_use]
    pub fn sample_ray(&self, camera: Vec2, texel: Vec2) -> Ray {
        let at = |axes: &[SampledAxis; 2], index: Vec2| Vec2::new(axes[0].coord(index.x), axes[1].coord(index.y));
        Ray {
            origin: self.face.vector(at(&self.st, camera), self.plane),
            direction: self.face.vector(at(&self.uv, texel), self.face.sign()),
        }
    }

    /// The sample indices of a ray whose dominant face is this slab's (Eqs. 1, 3 and 4; Fig. 6 of the paper).
    ///
    /// `direction` must have its component of largest magnitude on this slab's axis and towards its face; then every
    /// quotient is at most 1 and the result is finite for every finite origin that is not astronomically far away.
    #[inline]
    #[must_use]
    pub fn index_ray(&self, ray: &Ray) -> SlabCoord {
        let k = self.face.axis();
        let slope = self.face.tangential(ray.direction) / ray.direction[k].abs();
        let run = self.face.sign() * (self.plane - ray.origin[k]);
        let position = self.face.tangential(ray.origin) + run * slope;
        let index = |axes: &[SampledAxis; 2], v: Vec2| Vec2::new(axes[0].index(v.x), axes[1].index(v.y));
        SlabCoord { st: index(&self.st, position), uv: index(&self.uv, slope) }
    }

    /// Whether a ray lies within the slab's 4D range, (0, 0, 0, 0) to the last indices (§3 of the paper).
    #[must_use]
    pub fn contains(&self, coord: &SlabCoord) -> bool {
        let inside = |axes: &[SampledAxis; 2], v: Vec2| axes[0].contains_index(v.x) && axes[1].contains_index(v.y);
        inside(&self.st, coord.st) && inside(&self.uv, coord.uv)
    }

    /// Texels that a point on the focal plane moves per camera step, along u and along v; 0 without a focal plane.
    ///
    /// A ray through `s` with slope `u` meets depth D at `s + D·u`; camera `sᵢ` sees that point along
    /// `u + (s − sᵢ)/D`. In index units that is `step_s / (D·step_u)` texels per camera. The paper's `disparity`
    /// (Eq. 6) multiplies `sᵢ − s`, so it is this number with the opposite sign.
    #[inline]
    #[must_use]
    pub fn disparity(&self) -> Vec2 {
        let per_step = |i: usize| self.focal_depth.map_or(0.0, |depth| self.st[i].step() / depth / self.uv[i].step());
        Vec2::new(per_step(0), per_step(1))
    }

    /// [`Self::disparity`] of a plane at any inverse depth, 1/m: 0 is infinity, and of pictures that were rectified to agree on
    /// a plane, what lies behind it has a negative one.
    #[inline]
    #[must_use]
    pub fn disparity_at(&self, inverse_depth: f32) -> Vec2 {
        let per_step = |i: usize| self.st[i].step() * inverse_depth / self.uv[i].step();
        Vec2::new(per_step(0), per_step(1))
    }

    /// The four cameras around a ray with their image positions and bilinear weights (Eqs. 5 and 6; Fig. 8).
    ///
    /// Indices outside the slab are clamped to its edge, one that is no number counts as 0, before anything becomes an integer:
    /// ask [`Self::contains`] first where that matters. On an axis with
    /// a single camera both neighbours are that camera.
    #[inline]
    #[must_use]
    pub fn taps(&self, coord: &SlabCoord) -> [CameraTap; 4] {
        self.taps_with(coord, self.disparity())
    }

    /// As [`Self::taps`], with a disparity other than that of the focal plane.
    #[inline]
    #[must_use]
    pub fn taps_with(&self, coord: &SlabCoord, disparity: Vec2) -> [CameraTap; 4] {
        let last = |axes: &[SampledAxis; 2]| Vec2::new(axes[0].last_index(), axes[1].last_index());
        // `max` takes its second operand where the first is no number.
        let st = coord.st.max(Vec2::ZERO).min(last(&self.st));
        // The last camera is reached with weight 1 from the last but one, so that both always exist.
        let base = st.floor().min((last(&self.st) - 1.0).max(Vec2::ZERO));
        let fraction = st - base;
        let (uv, uv_last) = (coord.uv, last(&self.uv));
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|corner: [u32; 2]| {
            let offset = Vec2::new(corner[0] as f32, corner[1] as f32);
            let shares = (1.0 - offset) + (2.0 * offset - 1.0) * fraction;
            let camera = (base + offset).min(last(&self.st));
            CameraTap {
                camera: [camera.x as u32, camera.y as u32],
                uv: (uv + disparity * (st - camera)).max(Vec2::ZERO).min(uv_last),
                weight: shares.x * shares.y,
            }
        })
    }

    /// Camera and texel of the `n`-th of the samples spread evenly over the four axes: an additive sequence whose steps are powers
    /// of 1/g, where g⁵ = g + 1 (Roberts 2018). Any number of them, from the first on, is spread so; some samples come twice.
    #[must_use]
    pub fn spread_sample(&self, n: u32) -> [[u32; 2]; 2] {
        const STEPS: [f64; 4] =
            [0.856_674_883_854_502_9, 0.733_891_856_627_126, 0.628_706_721_037_806_7, 0.538_597_257_223_612_6];
        let counts = [self.st[0].count(), self.st[1].count(), self.uv[0].count(), self.uv[1].count()];
        let place = |i: usize| {
            let turns = f64::from(n) * STEPS[i];
            ((turns - libm::floor(turns)) * f64::from(counts[i])) as u32
        };
        [[place(0), place(1)], [place(2), place(3)]]
    }

    /// Distance from the camera plane to a cell-space point, along the face's axis.
    #[must_use]
    pub fn depth(&self, point: Vec3) -> f32 {
        self.face.sign() * (point[self.face.axis()] - self.plane)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn slab(face: Face, focal_depth: Option<f32>) -> Slab {
        let st = SampledAxis::spanning(-1.5, 1.5, 32).unwrap();
        let uv = SampledAxis::spanning(-1.0, 1.0, 128).unwrap();
        Slab::new(face, 0.5 * face.sign(), [st, st], [uv, uv], focal_depth).unwrap()
    }

    /// Eq. 4 in double precision, written from the paper: intersect the line with the st plane.
    fn index_by_eq_4(slab: &Slab, ray: &Ray) -> [f64; 4] {
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let k = slab.face().axis();
        let lambda = (f64::from(slab.plane()) - o[k]) / d[k];
        let mut out = [0.0; 4];
        for (i, axis) in slab.face().tangents().into_iter().enumerate() {
            let [st, uv] = [slab.st()[i], slab.uv()[i]];
            out[i] = (o[axis] + lambda * d[axis] - f64::from(st.first())) / f64::from(st.step());
            out[2 + i] = (d[axis] / d[k].abs() - f64::from(uv.first())) / f64::from(uv.step());
        }
        out
    }

    #[test]
    fn a_stored_sample_indexes_to_itself() {
        for face in Face::ALL {
            let slab = slab(face, None);
            for (camera, texel) in [(Vec2::new(3.0, 30.0), Vec2::new(1.0, 126.0)), (Vec2::ZERO, Vec2::splat(64.0))] {
                let ray = slab.sample_ray(camera, texel);
                assert_eq!(Face::dominant(ray.direction), Some(face));
                let coord = slab.index_ray(&ray);
                assert!((coord.st - camera).abs().max_element() < 1e-4, "{face:?} {coord:?}");
                assert!((coord.uv - texel).abs().max_element() < 1e-4, "{face:?} {coord:?}");
            }
        }
    }

    #[test]
    fn disparities_are_those_of_focal_planes_and_reach_beyond_infinity() {
        let (plain, focused) = (slab(Face::PosX, None), slab(Face::PosX, Some(2.5)));
        assert!((plain.disparity_at(0.4) - focused.disparity()).abs().max_element() < 1e-6);
        assert_eq!((plain.disparity_at(0.0), plain.disparity_at(-0.4)), (Vec2::ZERO, -plain.disparity_at(0.4)));
        let coord = SlabCoord { st: Vec2::new(3.3, 7.9), uv: Vec2::new(50.0, 60.5) };
        assert_eq!(plain.taps_with(&coord, focused.disparity()), focused.taps(&coord));
        let beyond = plain.taps_with(&coord, Vec2::new(-2.0, 0.5));
        assert!((beyond[3].uv - Vec2::new(50.0 - 2.0 * (3.3 - 4.0), 60.5 + 0.5 * (7.9 - 8.0))).length() < 1e-4);
    }

    /// Every camera and every column of texels gets its share.
    #[test]
    fn spread_samples_are_spread() {
        let slab = slab(Face::PosX, None);
        let (mut cameras, mut columns) = ([0; 32 * 32], [0; 128]);
        for n in 0..1 << 15 {
            let [camera, texel] = slab.spread_sample(n);
            cameras[(camera[1] * 32 + camera[0]) as usize] += 1;
            columns[texel[0] as usize] += 1;
        }
        assert!(cameras.iter().all(|n| (24..=40).contains(n)), "{:?}", cameras.iter().min());
        assert!(columns.iter().all(|n| (250..=262).contains(n)), "{:?}", columns.iter().min());
    }

    #[test]
    fn single_cameras_and_single_texels_work() {
        let one = SampledAxis::spanning(-1.0, 1.0, 1).unwrap();
        let slab = Slab::new(Face::PosZ, 1.0, [one, one], [one, one], Some(2.0)).unwrap();
        let taps = slab.taps(&slab.index_ray(&Ray { origin: Vec3::ZERO, direction: Vec3::Z }));
        assert_eq!(taps.iter().map(|tap| tap.weight).sum::<f32>(), 1.0);
        assert!(taps.iter().all(|tap| tap.camera == [0, 0] && tap.uv == Vec2::ZERO));
    }

    #[test]
    fn refuses_bad_planes() {
        let s = slab(Face::PosX, None);
        assert!(Slab::new(Face::PosX, f32::NAN, s.st(), s.uv(), None).is_err());
        assert!(s.with_focal_depth(Some(0.0)).is_err());
        assert!(s.with_focal_depth(Some(f32::INFINITY)).is_err());
        assert!(s.with_focal_depth(Some(1e-40)).is_err());
    }

    proptest! {
        #[test]
        fn indices_match_the_papers_equations(
            o in prop::array::uniform3(-0.5f32..0.5), d in prop::array::uniform3(-1.0f32..1.0)
        ) {
            let ray = Ray { origin: Vec3::from(o), direction: Vec3::from(d) };
            prop_assume!(ray.direction.abs().max_element() > 1e-3);
            let slab = slab(Face::dominant(ray.direction).unwrap(), None);
            let coord = slab.index_ray(&ray);
            let exact = index_by_eq_4(&slab, &ray);
            for (value, exact) in [coord.st.x, coord.st.y, coord.uv.x, coord.uv.y].into_iter().zip(exact) {
                prop_assert!((f64::from(value) - exact).abs() < 2e-5 * 128.0 / 32.0, "{value} {exact}");
            }
            prop_assert!(slab.contains(&coord));
        }

        #[test]
        fn weights_are_a_partition_of_unity(s in -3.0f32..40.0, t in -3.0f32..40.0, depth in 0.1f32..100.0) {
            let slab = slab(Face::NegY, Some(depth));
            let taps = slab.taps(&SlabCoord { st: Vec2::new(s, t), uv: Vec2::new(60.0, 3.0) });
            let sum: f32 = taps.iter().map(|tap| tap.weight).sum();
            prop_assert!((sum - 1.0).abs() <= f32::EPSILON);
            for tap in taps {
                prop_assert!((0.0..=1.0).contains(&tap.weight));
                prop_assert!(tap.camera.iter().all(|&c| c < 32));
                prop_assert!(tap.uv.cmpge(Vec2::ZERO).all() && tap.uv.cmple(Vec2::splat(127.0)).all());
            }
            // The weighted camera positions give back the ray's own.
            let mean: Vec2 = taps.iter().map(|tap| tap.weight * Vec2::from(tap.camera.map(|c| c as f32))).sum();
            prop_assert!((mean - Vec2::new(s, t).clamp(Vec2::ZERO, Vec2::splat(31.0))).abs().max_element() < 1e-5);
        }

        /// All four cameras must look at the same point of the focal plane as the ray.
        #[test]
        fn taps_meet_on_the_focal_plane(x in -0.4f32..0.4, y in -0.4f32..0.4, u in -0.5f32..0.5, depth in 1.0f32..9.0) {
            let slab = slab(Face::NegZ, Some(depth));
            let ray = Ray { origin: Vec3::new(x, y, 0.2), direction: Vec3::new(u, 0.3, -1.0) };
            let target = ray.at((depth + 0.5) + 0.2);
            prop_assert!((slab.depth(target) - depth).abs() < 1e-5);
            for tap in slab.taps(&slab.index_ray(&ray)) {
                let seen = slab.sample_ray(Vec2::from(tap.camera.map(|c| c as f32)), tap.uv).at(depth);
                prop_assert!((seen - target).length() < 2e-4 * depth, "{seen} {target}");
            }
        }
    }
}

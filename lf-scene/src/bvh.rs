//! Nearest hits on triangles.
//!
//! The acceleration structure is `obvhs`' CWBVH (Ylitie et al. 2017): pure Rust and, of the crates we measured on
//! mirror-sphere rays, the fastest without C++. Its own triangle test lets rays slip through shared edges, so the test
//! here is the watertight one of Woop, Benthin & Wald (JCGT 2013).
//!
//! The structure has two more places where rays may slip, and both depend on the unit of length: it takes no box that ends
//! before t = 1e-4, and it compares rounded distances to boxes. So the triangles are kept scaled by a power of two, which
//! rounds nothing, with coordinates up to 2²⁰; and every box is enlarged by 1, which is more than its distances
//! can be wrong for a ray that starts within the scene's reach.

use glam::{Vec3, Vec3A, Vec3Swizzles};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray, RayHit};
use obvhs::{Boundable, BvhBuildParams};

/// The exponent of the largest coordinate after scaling.
const REACH_EXPONENT: i32 = 19;

/// A triangle's corners, scaled: x of all three, y, z.
#[derive(Clone, Copy)]
struct Corners([Vec3A; 3]);

/// Triangles in a bounding volume hierarchy.
pub(crate) struct TriangleBvh {
    bvh: CwBvh,
    /// In the order of the leaves, so that a leaf's triangles are neighbours in memory.
    triangles: Vec<Corners>,
    /// Scaled from given coordinates: a power of two.
    scale: f32,
}

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hit {
    /// Ray parameter.
    pub(crate) t: f32,
    /// The triangle's number in the order given to [`TriangleBvh::new`].
    pub(crate) triangle: usize,
    /// Shares of the triangle's corners at the hit point.
    pub(crate) shares: Vec3,
}

/// A ray in the scaled space, its direction between 1 and 2 in the largest component.
struct ScaledRay {
    ray: Ray,
    sheared: ShearedRay,
    /// Ray parameter of the given ray from that of the scaled one: a power of two.
    given_from_scaled: f32,
}

impl TriangleBvh {
    pub(crate) fn new(corners: impl Iterator<Item = [Vec3; 3]> + Clone) -> Self {
        let scale = scale_for(corners.clone().flatten());
        let all: Vec<_> = corners.map(|points| Corners::new(points, scale)).collect();
        let bvh = build_cwbvh(&all, BvhBuildParams::medium_build(), &mut std::time::Duration::default());
        let triangles = bvh.primitive_indices.iter().map(|&i| all[i as usize]).collect();
        Self { bvh, triangles, scale }
    }

    /// Memory of nodes, indices and corners, bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        let (nodes, indices) = (self.bvh.nodes.as_slice(), self.bvh.primitive_indices.as_slice());
        size_of_val(nodes) + size_of_val(indices) + size_of_val(self.triangles.as_slice())
    }

    /// A power of two to make lengths independent of the unit.
    pub(crate) fn scale(&self) -> f32 {
        self.scale
    }

    /// The nearest hit that `stops` a ray, given the triangle's number and the shares of its corners; none for a direction
    /// that is zero or for numbers that are not finite.
    pub(crate) fn nearest(&self, origin: Vec3, direction: Vec3, stops: impl Fn(usize, Vec3) -> bool) -> Option<Hit> {
        let ScaledRay { ray, sheared, given_from_scaled } = self.scaled(origin, direction, f32::INFINITY)?;
        let mut shares = Vec3::ZERO;
        let mut nearest = RayHit::none();
        let meets = |ray: &Ray, slot: usize| match sheared.hit(&self.triangles[slot], ray.tmax) {
            Some((t, at)) if t < ray.tmax && stops(self.number(slot), at) => {
                shares = at;
                t
            }
            _ => f32::INFINITY,
        };
        let hit = self.bvh.ray_traverse(ray, &mut nearest, meets);
        let triangle = || self.number(nearest.primitive_id as usize);
        hit.then(|| Hit { t: nearest.t * given_from_scaled, triangle: triangle(), shares })
    }

    /// Whether anything that `stops` rays lies between `origin` and `origin + farthest·direction`.
    pub(crate) fn occluded(
        &self,
        origin: Vec3,
        direction: Vec3,
        farthest: f32,
        stops: impl Fn(usize, Vec3) -> bool,
    ) -> bool {
        let Some(ScaledRay { ray, sheared, .. }) = self.scaled(origin, direction, farthest) else { return false };
        let meets = |ray: &Ray, slot: usize| match sheared.hit(&self.triangles[slot], ray.tmax) {
            Some((t, at)) if stops(self.number(slot), at) => t,
            _ => f32::INFINITY,
        };
        !self.bvh.ray_traverse_miss(ray, meets)
    }

    fn number(&self, slot: usize) -> usize {
        self.bvh.primitive_indices[slot] as usize
    }

    #[inline]
    fn scaled(&self, origin: Vec3, direction: Vec3, farthest: f32) -> Option<ScaledRay> {
        let largest = direction.abs().max_element();
        if !(origin.is_finite() && direction.is_finite() && largest > 0.0) {
            return None;
        }
        let to_one = power_of_two(-exponent(largest));
        // Adding zero turns −0 into 0: the structure takes the former for a negative direction in one place only.
        let (origin, direction) = (Vec3A::from(origin) * self.scale, Vec3A::from(direction) * to_one + 0.0);
        let given_from_scaled = to_one / self.scale;
        let ray = Ray::new(origin, direction, 0.0, farthest / given_from_scaled);
        origin.is_finite().then(|| ScaledRay { ray, sheared: ShearedRay::new(origin, direction), given_from_scaled })
    }
}

impl Corners {
    fn new([a, b, c]: [Vec3; 3], scale: f32) -> Self {
        Self([0, 1, 2].map(|axis| Vec3A::new(a[axis], b[axis], c[axis]) * scale))
    }
}

impl Boundable for Corners {
    fn aabb(&self) -> Aabb {
        let [x, y, z] = self.0;
        let min = Vec3A::new(x.min_element(), y.min_element(), z.min_element());
        let max = Vec3A::new(x.max_element(), y.max_element(), z.max_element());
        Aabb::new(min - 1.0, max + 1.0)
    }
}

/// The power of two that brings the largest coordinate to between 2¹⁹ and 2²⁰.
fn scale_for(points: impl Iterator<Item = Vec3>) -> f32 {
    let reach = points.fold(0.0f32, |reach, p| reach.max(p.abs().max_element()));
    power_of_two(if reach > 0.0 { REACH_EXPONENT - exponent(reach) } else { 0 })
}

/// The exponent of a positive number: it is between 2ᵉ and 2ᵉ⁺¹. A subnormal one has that of the smallest normal one.
fn exponent(x: f32) -> i32 {
    ((x.to_bits() >> 23) as i32).max(1) - 127
}

/// 2ᵉ, or the nearest to it that is a normal number.
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent.clamp(-126, 127) + 127) as u32) << 23)
}

/// A ray with the shear that turns its direction into an axis (Woop et al., §3).
struct ShearedRay {
    origin: Vec3A,
    /// Number of that axis.
    axis: usize,
    /// Shear of the two next axes, in turn, and the scale of this one.
    shear: Vec3A,
}

impl ShearedRay {
    /// Expects a direction that is finite and not zero.
    #[inline]
    fn new(origin: Vec3A, direction: Vec3A) -> Self {
        let size = direction.abs();
        let axis = if size.z >= size.x.max(size.y) { 2 } else { usize::from(size.y >= size.x) };
        let d = direction[axis];
        let shear = Vec3A::new(direction[(axis + 1) % 3] / d, direction[(axis + 2) % 3] / d, 1.0 / d);
        Self { origin, axis, shear }
    }

    /// Ray parameter in 0 … `farthest` and the corners' shares. A ray through an edge or a corner
    /// meets each triangle there: a point on an edge has the same sign, or zero, for both neighbours.
    #[inline]
    fn hit(&self, corners: &Corners, farthest: f32) -> Option<(f32, Vec3)> {
        let [x, y, z] = corners.0;
        let (x, y, z) = (x - self.origin.x, y - self.origin.y, z - self.origin.z);
        let (x, y, z) = match self.axis {
            0 => (y, z, x),
            1 => (z, x, y),
            _ => (x, y, z),
        };
        let (x, y) = (x - z * self.shear.x, y - z * self.shear.y);
        let mut e = x.zxy() * y.yzx() - y.zxy() * x.yzx();
        if e.cmpeq(Vec3A::ZERO).any() {
            // A product may have been rounded to a tie; doubles hold products of floats exactly.
            let (x, y) = (x.as_dvec3(), y.as_dvec3());
            e = (x.zxy() * y.yzx() - y.zxy() * x.yzx()).as_vec3a();
        }
        let determinant = e.element_sum();
        if (e.cmplt(Vec3A::ZERO).any() && e.cmpgt(Vec3A::ZERO).any()) || determinant == 0.0 {
            return None;
        }
        let shares = e / determinant;
        let t = self.shear.z * shares.dot(z);
        (t >= 0.0 && t <= farthest).then_some((t, shares.into()))
    }
}

/// A value at the corners of a triangle, interpolated.
pub(crate) fn interpolate([a, b, c]: [Vec3; 3], shares: Vec3) -> Vec3 {
    a * shares.x + b * shares.y + c * shares.z
}

/// The unit normal of a triangle's plane; +Y if it has no area.
pub(crate) fn plane_normal(corners: [Vec3; 3]) -> Vec3 {
    lf_math::triangle_normal(corners).unwrap_or(Vec3::Y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reflectors;

    const ALL: fn(usize, Vec3) -> bool = |_, _| true;

    /// The corners of the twelve triangles of a cube from −1 to 1.
    fn cube() -> Vec<[Vec3; 3]> {
        let quad = |normal: Vec3, u: Vec3| {
            let v = normal.cross(u);
            let at = |a: f32, b: f32| normal + u * a + v * b;
            [[at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0)], [at(-1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)]]
        };
        [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)]
            .into_iter()
            .flat_map(|(normal, u)| [quad(normal, u), quad(-normal, u)])
            .flatten()
            .collect()
    }

    fn ball() -> Vec<[Vec3; 3]> {
        let mesh = reflectors::sphere(3);
        mesh.triangles().iter().map(|t| t.map(|i| mesh.positions()[i as usize])).collect()
    }

    /// No ray from inside a closed mesh may escape, least of all through its vertices and edges, whatever the unit of length.
    #[test]
    fn closed_meshes_hold_every_ray() {
        for (mesh, scale) in
            [(ball(), 1.0), (cube(), 1.0), (cube(), 1e-6), (ball(), 1e-9), (cube(), 1e6), (ball(), 1e11)]
        {
            let mesh: Vec<_> = mesh.into_iter().map(|t| t.map(|p| p * scale)).collect();
            let bvh = TriangleBvh::new(mesh.iter().copied());
            for origin in [Vec3::ZERO, Vec3::new(0.3, -0.2, 0.1) * scale, Vec3::splat(0.99 * 0.5) * scale] {
                for &[a, b, c] in &mesh {
                    for target in [a, 0.5 * (a + b), b.lerp(c, 0.25), (a + b + c) / 3.0] {
                        let hit = bvh.nearest(origin, target - origin, ALL).expect("the mesh is closed");
                        assert!((hit.t - 1.0).abs() < 1e-5, "{hit:?}");
                        assert!(bvh.occluded(origin, target - origin, 1.1, ALL));
                        assert!(!bvh.occluded(origin, target - origin, 0.9, ALL));
                    }
                }
            }
        }
    }

    /// Hits and their places are the same bits in every scale that is a power of two.
    #[test]
    fn powers_of_two_scale_exactly() {
        let mesh = ball();
        let bvh = TriangleBvh::new(mesh.iter().copied());
        for exponent in [-40, -20, 20, 30] {
            let scale = power_of_two(exponent);
            let scaled = TriangleBvh::new(mesh.iter().map(|t| t.map(|p| p * scale)));
            for i in 0..1000 {
                let angle = 2.4 * i as f32;
                let direction = Vec3::new(angle.cos(), 1.0 - i as f32 / 500.0, angle.sin());
                let origin = Vec3::new(0.3, -0.2, 0.1);
                let one = bvh.nearest(origin, direction, ALL).unwrap();
                let other = scaled.nearest(origin * scale, direction, ALL).unwrap();
                assert_eq!((one.triangle, one.shares, one.t * scale), (other.triangle, other.shares, other.t));
                let third = scaled.nearest(origin * scale, direction * scale, ALL).unwrap();
                assert_eq!((one.triangle, one.shares, one.t), (third.triangle, third.shares, third.t));
            }
        }
    }

    #[test]
    fn zeros_of_either_sign_are_the_same() {
        let bvh = TriangleBvh::new(cube().into_iter());
        for direction in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]) {
            for direction in [direction, direction * Vec3::new(-1.0, 1.0, -1.0), -direction] {
                assert_eq!(
                    bvh.nearest(Vec3::splat(0.1), direction, ALL).map(|hit| hit.t > 0.8),
                    Some(true),
                    "{direction:?}"
                );
            }
        }
    }

    #[test]
    fn shares_give_back_the_hit_point() {
        let corners = [Vec3::new(0.0, 0.0, 2.0), Vec3::new(3.0, 0.0, 2.5), Vec3::new(0.0, 4.0, 1.5)];
        let bvh = TriangleBvh::new([corners].into_iter());
        let (origin, direction) = (Vec3::new(0.1, -0.3, 0.0), Vec3::new(0.2, 0.5, 1.0));
        let hit = bvh.nearest(origin, direction, ALL).expect("hits");
        assert!((interpolate(corners, hit.shares) - (origin + direction * hit.t)).length() < 1e-5);
        assert!(bvh.nearest(origin, direction, |_, _| false).is_none());
    }
}

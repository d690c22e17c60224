//! Nearest hits on triangles.
//!
//! The acceleration structure is `obvhs`' CWBVH (Ylitie et al. 2017): pure Rust and, of the crates we measured on
//! mirror-sphere rays, the fastest without C++. Its own triangle test lets rays slip through shared edges, so the test
//! here is the watertight one of Woop, Benthin & Wald (JCGT 2013).

use glam::{DVec3, Vec2, Vec3};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;

/// The corners of a triangle.
type Corners = [Vec3; 3];

/// Triangles in a bounding volume hierarchy.
pub(crate) struct TriangleBvh {
    bvh: CwBvh,
    /// In the order of the leaves, so that a leaf's triangles are neighbours in memory.
    triangles: Vec<Corners>,
}

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hit {
    /// Ray parameter.
    pub(crate) t: f32,
    /// The triangle's number in the order given to [`TriangleBvh::new`].
    pub(crate) triangle: usize,
    /// Shares of the triangle's second and third corner at the hit point.
    pub(crate) shares: Vec2,
    /// Unit normal of the triangle's plane; +Y if it has no area.
    pub(crate) normal: Vec3,
}

impl TriangleBvh {
    pub(crate) fn new(corners: impl Iterator<Item = Corners>) -> Self {
        let all: Vec<_> = corners.map(|[a, b, c]| Triangle { v0: a.into(), v1: b.into(), v2: c.into() }).collect();
        let bvh = build_cwbvh_from_tris(&all, BvhBuildParams::medium_build(), &mut std::time::Duration::default());
        let corners = |t: &Triangle| [t.v0, t.v1, t.v2].map(Vec3::from);
        let triangles = bvh.primitive_indices.iter().map(|&i| corners(&all[i as usize])).collect();
        Self { bvh, triangles }
    }

    /// Memory of nodes, indices and corners, bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        let (nodes, indices) = (self.bvh.nodes.as_slice(), self.bvh.primitive_indices.as_slice());
        size_of_val(nodes) + size_of_val(indices) + size_of_val(self.triangles.as_slice())
    }

    /// The nearest hit; none for a direction that is zero or for numbers that are not finite.
    pub(crate) fn nearest(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        let sheared = ShearedRay::new(origin, direction)?;
        let mut nearest = RayHit::none();
        let distance =
            |ray: &Ray, i: usize| sheared.hit(&self.triangles[i], ray.tmax).map_or(f32::INFINITY, |(t, _)| t);
        if !self.bvh.ray_traverse(Ray::new_inf(origin.into(), direction.into()), &mut nearest, distance) {
            return None;
        }
        let slot = nearest.primitive_id as usize;
        let [a, b, c] = self.triangles[slot];
        let (t, shares) = sheared.hit(&[a, b, c], f32::INFINITY)?;
        let normal = lf_math::normalized((b - a).cross(c - a)).unwrap_or(Vec3::Y);
        Some(Hit { t, triangle: self.bvh.primitive_indices[slot] as usize, shares, normal })
    }

    /// Whether anything lies between `origin` and `origin + distance·towards`.
    pub(crate) fn occluded(&self, origin: Vec3, towards: Vec3, distance: f32) -> bool {
        let Some(sheared) = ShearedRay::new(origin, towards) else { return false };
        let ray = Ray::new(origin.into(), towards.into(), 0.0, distance);
        let meets = |_: &Ray, i: usize| sheared.hit(&self.triangles[i], distance).map_or(f32::INFINITY, |(t, _)| t);
        !self.bvh.ray_traverse_miss(ray, meets)
    }
}

/// A ray with the shear that turns its direction into an axis (Woop et al., §3).
struct ShearedRay {
    origin: Vec3,
    axes: [usize; 3],
    shear: Vec3,
}

impl ShearedRay {
    fn new(origin: Vec3, direction: Vec3) -> Option<Self> {
        let z = lf_math::Face::dominant(direction).filter(|_| origin.is_finite())?.axis();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let d = direction[z];
        Some(Self { origin, axes, shear: Vec3::new(direction[axes[0]] / d, direction[axes[1]] / d, 1.0 / d) })
    }

    /// Ray parameter in 0 … `farthest` and the shares of the second and third corner. A ray through an edge or a corner
    /// meets each triangle there: a point on an edge has the same sign, or zero, for both neighbours.
    fn hit(&self, corners: &Corners, farthest: f32) -> Option<(f32, Vec2)> {
        let [a, b, c] = corners.map(|p| self.sheared(p - self.origin));
        let edge = |p: Vec3, q: Vec3| p.x * q.y - p.y * q.x;
        let mut e = Vec3::new(edge(c, b), edge(a, c), edge(b, a));
        if e.x == 0.0 || e.y == 0.0 || e.z == 0.0 {
            // A product may have been rounded to a tie; doubles hold products of floats exactly.
            let exact = |p: Vec3, q: Vec3| f64::from(p.x) * f64::from(q.y) - f64::from(p.y) * f64::from(q.x);
            e = DVec3::new(exact(c, b), exact(a, c), exact(b, a)).as_vec3();
        }
        let determinant = e.x + e.y + e.z;
        if (e.min_element() < 0.0 && e.max_element() > 0.0) || determinant == 0.0 {
            return None;
        }
        let shares = e / determinant;
        let t = self.shear.z * shares.dot(Vec3::new(a.z, b.z, c.z));
        (t >= 0.0 && t <= farthest).then_some((t, Vec2::new(shares.y, shares.z)))
    }

    fn sheared(&self, p: Vec3) -> Vec3 {
        let [x, y, z] = self.axes.map(|axis| p[axis]);
        Vec3::new(x - self.shear.x * z, y - self.shear.y * z, z)
    }
}

/// A value at the corners of a triangle, interpolated.
pub(crate) fn interpolate([a, b, c]: [Vec3; 3], shares: Vec2) -> Vec3 {
    a * (1.0 - shares.x - shares.y) + b * shares.x + c * shares.y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reflectors;

    /// No ray from inside a closed mesh may escape, least of all through its vertices and edges.
    #[test]
    fn closed_meshes_hold_every_ray() {
        let mesh = reflectors::sphere(3);
        let corners = |t: &[u32; 3]| t.map(|i| mesh.positions()[i as usize]);
        let bvh = TriangleBvh::new(mesh.triangles().iter().map(corners));
        for origin in [Vec3::ZERO, Vec3::new(0.3, -0.2, 0.1)] {
            for [a, b, c] in mesh.triangles().iter().map(corners) {
                for target in [a, 0.5 * (a + b), b.lerp(c, 0.25), (a + b + c) / 3.0] {
                    let hit = bvh.nearest(origin, target - origin).expect("the mesh is closed");
                    assert!((hit.t - 1.0).abs() < 1e-5, "{hit:?}");
                    assert!(bvh.occluded(origin, target - origin, 1.1));
                    assert!(!bvh.occluded(origin, target - origin, 0.9));
                }
            }
        }
    }

    #[test]
    fn shares_give_back_the_hit_point() {
        let corners = [Vec3::new(0.0, 0.0, 2.0), Vec3::new(3.0, 0.0, 2.5), Vec3::new(0.0, 4.0, 1.5)];
        let bvh = TriangleBvh::new([corners].into_iter());
        let (origin, direction) = (Vec3::new(0.1, -0.3, 0.0), Vec3::new(0.2, 0.5, 1.0));
        let hit = bvh.nearest(origin, direction).expect("hits");
        assert!((interpolate(corners, hit.shares) - (origin + direction * hit.t)).length() < 1e-5);
    }
}

//! A software rasteriser for the reflector's position and normal, and for the light of a scene's triangles.
//!
//! Follows the rules of GPU rasterisation: vertices snapped to 1/256 pixel, pixels covered by their centre, ties on
//! shared edges by the top-left rule, attributes interpolated with perspective, nearest surface kept.

use glam::{Mat4, Vec3, Vec4};
use lf_math::{Image, LitMesh, Pinhole, Ray, TriangleMesh, near_plane, normalized, reflect};

/// Subpixel steps of the snapped coordinates, as Vulkan requires at least 4 bits of and common GPUs have 8 bits of.
const SUBPIXEL: f32 = 256.0;

/// The reflector at one pixel, cell space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fragment {
    /// Interpolated position, metres.
    pub position: Vec3,
    /// Interpolated normal; its length is at most 1.
    pub normal: Vec3,
    /// Which mesh it belongs to.
    pub mesh: u32,
}

impl Fragment {
    /// The interpolated normal at unit length; up where it has none.
    pub(crate) fn unit_normal(&self) -> Vec3 {
        normalized(self.normal).unwrap_or(Vec3::Y)
    }

    /// The mirrored view ray, by a unit normal (Eq. 2 of the paper).
    pub(crate) fn reflected(&self, eye: Vec3, normal: Vec3) -> Ray {
        Ray { origin: self.position, direction: reflect(self.position - eye, normal) }
    }
}

/// The reflector's fragments as seen by a camera.
#[derive(Debug, Clone)]
pub struct GBuffer {
    eye: Vec3,
    target: Target<Fragment>,
}

/// The light of a scene's triangles as seen by a camera.
pub(crate) struct LitBuffer(Target<Vec3>);

/// What is interpolated over triangles.
trait Attributes: Copy {
    /// The share of the way from one to another.
    fn towards(self, other: Self, share: f32) -> Self;

    /// The mean by weights of a sum.
    fn mean(corners: [Self; 3], weights: [f32; 3], sum: f32) -> Self;
}

/// A vertex in clip space with its attributes.
#[derive(Clone, Copy)]
struct ClipVertex<A> {
    clip: Vec4,
    attributes: A,
}

impl Attributes for Vec3 {
    fn towards(self, other: Self, share: f32) -> Self {
        self.lerp(other, share)
    }

    fn mean([p, q, r]: [Self; 3], [a, b, c]: [f32; 3], sum: f32) -> Self {
        (p * a + q * b + r * c) / sum
    }
}

impl Attributes for Fragment {
    fn towards(self, other: Self, share: f32) -> Self {
        let (position, normal) =
            (self.position.towards(other.position, share), self.normal.towards(other.normal, share));
        Self { position, normal, ..self }
    }

    fn mean(corners: [Self; 3], weights: [f32; 3], sum: f32) -> Self {
        let mean = |of: fn(Self) -> Vec3| Vec3::mean(corners.map(of), weights, sum);
        Self { position: mean(|corner| corner.position), normal: mean(|corner| corner.normal), mesh: corners[0].mesh }
    }
}

impl GBuffer {
    /// Draws a mesh given in cell space. Time grows with the triangles and the pixels they cover.
    #[must_use]
    pub fn rasterize(mesh: &TriangleMesh, camera: &Pinhole) -> Self {
        Self::rasterize_all(std::slice::from_ref(mesh), camera)
    }

    /// Draws meshes given in cell space, which hide each other.
    #[must_use]
    pub fn rasterize_all(meshes: &[TriangleMesh], camera: &Pinhole) -> Self {
        let near = near_plane(camera.eye(), meshes.iter().map(TriangleMesh::bounds));
        let clip_from_cell = camera.clip_from_cell(near);
        let mut target = Target::new(camera);
        for (number, mesh) in (0..).zip(meshes) {
            let corners = mesh.positions().iter().zip(mesh.normals());
            let fragments = corners.map(|(&position, &normal)| (position, Fragment { position, normal, mesh: number }));
            target.mesh(fragments, mesh.triangles(), clip_from_cell);
        }
        Self { eye: camera.eye(), target }
    }

    /// The eye that sees the fragments, cell space.
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        self.eye
    }

    /// The fragment at each pixel, where the reflector is.
    #[must_use]
    pub fn fragments(&self) -> &Image<Option<Fragment>> {
        &self.target.fragments
    }

    /// One over the depth of a pixel's fragment, the pixels counted row by row; 0 where there is none.
    pub(crate) fn inverse_depth(&self, pixel: usize) -> f32 {
        self.target.inverse_depths[pixel]
    }
}

impl LitBuffer {
    /// Draws what lies beyond a near plane.
    pub(crate) fn rasterize(mesh: &LitMesh, camera: &Pinhole, near: f32) -> Self {
        let mut target = Target::new(camera);
        let corners = mesh.positions().iter().copied().zip(mesh.light().iter().copied());
        target.mesh(corners, mesh.triangles(), camera.clip_from_cell(near));
        Self(target)
    }

    /// The light at a pixel, if it comes from in front of an inverse depth.
    pub(crate) fn before(&self, pixel: usize, inverse_depth: f32) -> Option<Vec3> {
        self.0.fragments.texels()[pixel].filter(|_| self.0.inverse_depths[pixel] > inverse_depth)
    }
}

/// Cuts a triangle at the near plane, z = w in reversed depth (Sutherland & Hodgman 1974); up to four corners remain.
fn clip_near<A: Attributes>(corners: &[ClipVertex<A>; 3]) -> Vec<ClipVertex<A>> {
    let mut kept = Vec::with_capacity(4);
    for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (&corners[i], &corners[j])) {
        let (from, to) = (a.beyond_near(), b.beyond_near());
        if from > 0.0 {
            kept.push(*a);
        }
        if (from > 0.0) != (to > 0.0) {
            kept.push(a.towards(b, from / (from - to)));
        }
    }
    kept
}

impl<A: Attributes> ClipVertex<A> {
    /// How far the vertex lies beyond the near plane.
    fn beyond_near(&self) -> f32 {
        self.clip.w - self.clip.z
    }

    fn towards(&self, other: &Self, share: f32) -> Self {
        Self { clip: self.clip.lerp(other.clip, share), attributes: self.attributes.towards(other.attributes, share) }
    }
}

#[derive(Debug, Clone)]
struct Target<A> {
    fragments: Image<Option<A>>,
    /// 1/w of the nearest surface so far; 0 is infinitely far.
    inverse_depths: Vec<f32>,
}

impl<A: Attributes> Target<A> {
    fn new(camera: &Pinhole) -> Self {
        let (width, height) = (camera.width(), camera.height());
        Self {
            fragments: Image::filled(width, height, None),
            inverse_depths: vec![0.0; width as usize * height as usize],
        }
    }

    /// Draws triangles between vertices, given by position and attributes.
    fn mesh(&mut self, vertices: impl Iterator<Item = (Vec3, A)>, triangles: &[[u32; 3]], clip_from_cell: Mat4) {
        let vertex =
            |(position, attributes): (Vec3, A)| ClipVertex { clip: clip_from_cell * position.extend(1.0), attributes };
        let vertices: Vec<_> = vertices.map(vertex).collect();
        for triangle in triangles {
            let corners = triangle.map(|i| vertices[i as usize]);
            if corners.iter().all(|v| v.beyond_near() > 0.0) {
                self.triangle(&corners);
            } else {
                let polygon = clip_near(&corners);
                for i in 2..polygon.len() {
                    self.triangle(&[polygon[0], polygon[i - 1], polygon[i]]);
                }
            }
        }
    }

    /// Pixel coordinates in subpixels, y down. They saturate at 4 million pixels, where `edge` still fits in 64 bits; only an
    /// edge that runs so far outside the picture is bent by it.
    fn snap(&self, clip: Vec4) -> [i64; 2] {
        let (width, height) = (self.fragments.width() as f32, self.fragments.height() as f32);
        let x = (0.5 + 0.5 * clip.x / clip.w) * width;
        let y = (0.5 - 0.5 * clip.y / clip.w) * height;
        [x, y].map(|v| (v * SUBPIXEL).round().clamp(-1e9, 1e9) as i64)
    }

    fn triangle(&mut self, corners: &[ClipVertex<A>; 3]) {
        let mut corners = *corners;
        let mut points = corners.map(|corner| self.snap(corner.clip));
        let mut area = edge(points[0], points[1], points[2]);
        if area < 0 {
            // Both sides are drawn: turn the triangle so that its inside is positive.
            corners.swap(1, 2);
            points.swap(1, 2);
            area = -area;
        }
        if area == 0 {
            return;
        }
        let range = |axis: usize, size: u32| {
            let values = points.map(|p| p[axis]);
            let low = values[0].min(values[1]).min(values[2]).div_euclid(SUBPIXEL as i64).max(0);
            let high = values[0].max(values[1]).max(values[2]).div_euclid(SUBPIXEL as i64) + 1;
            low as u32..(high.clamp(0, i64::from(size)) as u32)
        };
        for y in range(1, self.fragments.height()) {
            for x in range(0, self.fragments.width()) {
                let center = [x, y].map(|v| (i64::from(v) * 2 + 1) * (SUBPIXEL as i64 / 2));
                let shares =
                    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| (edge(points[i], points[j], center), points[i], points[j]));
                if shares.iter().all(|&(e, from, to)| e > 0 || (e == 0 && is_top_left(from, to))) {
                    self.cover(x, y, &corners, shares.map(|(e, ..)| e as f32 / area as f32));
                }
            }
        }
    }

    /// Keeps a fragment if it is the nearest so far. `shares` are barycentric on the screen.
    fn cover(&mut self, x: u32, y: u32, corners: &[ClipVertex<A>; 3], shares: [f32; 3]) {
        let weights = [0, 1, 2].map(|i| shares[i] / corners[i].clip.w);
        let inverse_depth = weights[0] + weights[1] + weights[2];
        let index = y as usize * self.fragments.width() as usize + x as usize;
        if inverse_depth <= self.inverse_depths[index] {
            return;
        }
        self.inverse_depths[index] = inverse_depth;
        let attributes = corners.map(|corner| corner.attributes);
        self.fragments.texels_mut()[index] = Some(A::mean(attributes, weights, inverse_depth));
    }
}

/// Twice the signed area of a triangle in subpixels; positive when clockwise on the screen (y down).
fn edge(a: [i64; 2], b: [i64; 2], p: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

/// Whether an edge of a clockwise triangle (y down) is its top edge or a left one.
fn is_top_left(from: [i64; 2], to: [i64; 2]) -> bool {
    to[1] < from[1] || (to[1] == from[1] && to[0] > from[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Pinhole {
        Pinhole::look_at(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 0.6, 64, 48).unwrap()
    }

    /// A square in the plane z = 0 made of a fan of triangles around a point.
    fn square(center: Vec3) -> TriangleMesh {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let positions = corners.into_iter().chain([center]).collect();
        TriangleMesh::new(positions, vec![], vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]).unwrap()
    }

    #[test]
    fn fragments_lie_on_their_pixels_rays() {
        let camera = camera();
        let gbuffer = GBuffer::rasterize(&square(Vec3::new(0.3, -0.2, 0.0)), &camera);
        let mut covered = 0;
        for y in 0..48 {
            for x in 0..64 {
                let ray = camera.ray(x, y);
                let exact = ray.at(-ray.origin.z / ray.direction.z);
                let inside = exact.abs().max_element();
                match gbuffer.fragments().get(x, y) {
                    Some(fragment) => {
                        covered += 1;
                        // Snapping to 1/256 pixel moves a vertex by up to 2e-4 here.
                        assert!((fragment.position - exact).length() < 5e-4, "{x} {y}: {fragment:?} {exact}");
                        assert!((fragment.normal - Vec3::Z).length() < 1e-6);
                        assert!(inside < 1.001);
                    }
                    None => assert!(inside > 0.999, "hole at {x} {y}"),
                }
            }
        }
        assert!(covered > 1000, "{covered}");
    }

    #[test]
    fn the_nearest_surface_wins_whatever_the_order() {
        let near = square(Vec3::ZERO);
        for order in [[0.5f32, -0.5], [-0.5, 0.5]] {
            let shifted = |z: f32| near.positions().iter().map(move |p| p + Vec3::Z * z);
            let positions = order.into_iter().flat_map(shifted).collect();
            let triangles = near.triangles().iter().flat_map(|&t| [t, t.map(|i| i + 5)]).collect();
            let mesh = TriangleMesh::new(positions, vec![], triangles).unwrap();
            let gbuffer = GBuffer::rasterize(&mesh, &camera());
            assert!((gbuffer.fragments().get(32, 24).unwrap().position.z - 0.5).abs() < 1e-3);
        }
    }

    #[test]
    fn what_is_behind_the_eye_is_clipped() {
        // A floor that runs under the eye to far behind it.
        let positions = vec![Vec3::new(-50.0, -1.0, -50.0), Vec3::new(50.0, -1.0, -50.0), Vec3::new(0.0, -1.0, 90.0)];
        let mesh = TriangleMesh::new(positions, vec![], vec![[0, 1, 2]]).unwrap();
        let camera = camera();
        let gbuffer = GBuffer::rasterize(&mesh, &camera);
        for y in 0..48 {
            let ray = camera.ray(32, y);
            let fragment = gbuffer.fragments().get(32, y);
            let t = (-1.0 - ray.origin.y) / ray.direction.y;
            if t > 0.0 && ray.at(t).z > -49.0 {
                let exact = ray.at(t);
                let position = fragment.expect("the floor is seen").position;
                assert!((position - exact).length() < 2e-2 * (1.0 + t), "{y}: {position} {exact}");
            } else if t <= 0.0 {
                assert!(fragment.is_none());
            }
        }
    }
}

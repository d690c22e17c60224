//! Reference pictures: what a perfect mirror in the scene looks like.
//!
//! One ray through each pixel's centre; where it meets the reflector, its mirror image is traced through the scene
//! without the reflector. This is what the image-based methods approximate, ray by ray: a reflection of the
//! surroundings, without the reflector's image in itself.

use glam::Vec3;
use lf_math::{Cell, Image, Pinhole, Ray, TriangleMesh, normalized, reflect};
use rayon::prelude::*;

use crate::bvh::{TriangleBvh, interpolate, plane_normal};
use crate::capture::trace_in_cell_space;
use crate::tracer::Tracer;

/// A reflective mesh that can be hit by rays. Cell space.
pub struct Mirror {
    mesh: TriangleMesh,
    bvh: TriangleBvh,
}

/// A reference picture of a mirror.
#[derive(Debug, Clone)]
pub struct Reference {
    /// Radiance in linear RGB where the mirror is, black elsewhere.
    pub radiance: Image<Vec3>,
    /// Where the mirror is.
    pub mask: Image<bool>,
}

impl Mirror {
    /// Makes a mesh, given in cell space, ready for rays.
    #[must_use]
    pub fn new(mesh: TriangleMesh) -> Self {
        let corners = mesh.triangles().iter().map(|t| t.map(|i| mesh.positions()[i as usize]));
        let bvh = TriangleBvh::new(corners);
        Self { mesh, bvh }
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// The mirrored ray of one that meets the mesh, about the interpolated normal (Eq. 2 of the paper).
    #[must_use]
    pub fn reflected(&self, ray: &Ray) -> Option<Ray> {
        let hit = self.bvh.nearest(ray.origin, ray.direction, |_, _| true)?;
        let corners = self.mesh.triangles()[hit.triangle];
        let normals = corners.map(|i| self.mesh.normals()[i as usize]);
        let plane = || plane_normal(corners.map(|i| self.mesh.positions()[i as usize]));
        let normal = normalized(interpolate(normals, hit.shares)).unwrap_or_else(plane);
        Some(Ray { origin: ray.at(hit.t), direction: reflect(ray.direction, normal) })
    }
}

/// Traces what `camera` sees in `mirror`, which hangs in the scene around `cell`, on all threads.
#[must_use]
pub fn render(tracer: &Tracer, cell: &Cell, mirror: &Mirror, camera: &Pinhole) -> Reference {
    let seen = per_pixel(camera, |ray| {
        mirror.reflected(ray).map(|reflected| trace_in_cell_space(tracer, cell, &reflected).radiance)
    });
    Reference { radiance: seen.map(|radiance| radiance.unwrap_or(Vec3::ZERO)), mask: seen.map(|r| r.is_some()) }
}

/// Traces the scene as `camera` sees it without any mirror: radiance in linear RGB, on all threads.
#[must_use]
pub fn background(tracer: &Tracer, cell: &Cell, camera: &Pinhole) -> Image<Vec3> {
    per_pixel(camera, |ray| trace_in_cell_space(tracer, cell, ray).radiance)
}

fn per_pixel<T: Copy + Default + Send>(camera: &Pinhole, value: impl Fn(&Ray) -> T + Sync) -> Image<T> {
    let width = camera.width();
    let mut image = Image::filled(width, camera.height(), T::default());
    image.texels_mut().par_iter_mut().enumerate().for_each(|(index, pixel)| {
        *pixel = value(&camera.ray(index as u32 % width, index as u32 / width));
    });
    image
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reflectors;

    #[test]
    fn a_fine_sphere_reflects_like_the_exact_one() {
        let mirror = Mirror::new(reflectors::sphere(6).fitted(Vec3::ZERO, 0.4).unwrap());
        let mut worst = 0.0f32;
        for i in 0..2000 {
            let angle = 2.399_963_2 * i as f32;
            let offset = 0.39 * (i as f32 / 2000.0).sqrt();
            let ray =
                Ray { origin: Vec3::new(offset * angle.cos(), offset * angle.sin(), 2.0), direction: Vec3::NEG_Z };
            let reflected = mirror.reflected(&ray).expect("inside the silhouette");
            // Closed form: the normal of a parallel ray at this offset.
            let n = Vec3::new(ray.origin.x, ray.origin.y, (0.16 - offset * offset).sqrt()) / 0.4;
            worst = worst.max(reflected.direction.angle_between(reflect(ray.direction, n)));
        }
        assert!(worst < 0.02, "{worst} rad");
        let beside = Ray { origin: Vec3::new(0.41, 0.0, 2.0), direction: Vec3::NEG_Z };
        assert!(mirror.reflected(&beside).is_none());
    }
}

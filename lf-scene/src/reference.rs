//! Reference pictures: what a perfect mirror in the scene looks like.
//!
//! One ray through each pixel's centre; where it meets the reflector, its mirror image is traced through the scene
//! without the reflector. This is what the image-based methods approximate, ray by ray: a reflection of the
//! surroundings, without the reflector's image in itself.

use glam::Vec3;
use lf_math::{Cell, Image, Pinhole, Ray, TriangleMesh, normalized, reflect};
use rayon::prelude::*;

use crate::bvh::{TriangleBvh, interpolate, plane_normal};
use crate::quality::Estimate;
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
    /// Its standard error ([`Estimate::standard_error`]), 0 where the mirror is not.
    pub standard_error: Image<Vec3>,
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
        mirror.reflected(ray).map(|reflected| {
            let Estimate { radiance, standard_error, .. } = estimate_in_cell_space(tracer, cell, &reflected);
            (radiance, standard_error)
        })
    });
    let (radiance, standard_error) = (seen.map(|s| s.unwrap_or_default().0), seen.map(|s| s.unwrap_or_default().1));
    Reference { radiance, standard_error, mask: seen.map(|s| s.is_some()) }
}

/// Traces the scene as `camera` sees it without any mirror: radiance in linear RGB, on all threads.
#[must_use]
pub fn background(tracer: &Tracer, cell: &Cell, camera: &Pinhole) -> Image<Vec3> {
    per_pixel(camera, |ray| estimate_in_cell_space(tracer, cell, ray).radiance)
}

fn estimate_in_cell_space(tracer: &Tracer, cell: &Cell, ray: &Ray) -> Estimate {
    tracer.estimate(cell.world_from_cell(ray.origin).as_vec3(), ray.direction)
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
    use glam::Vec2;

    use super::*;
    use crate::{Environment, Illumination, Lighting, Material, Quality, SceneBuilder, museum, reflectors};

    /// The error is told where the mirror is, and falls with the root of the samples.
    #[test]
    fn pictures_know_their_noise() {
        let mirror = Mirror::new(reflectors::sphere(3).fitted(Vec3::ZERO, 0.4).unwrap());
        let camera = Pinhole::look_at(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, 0.5, 16, 16).unwrap();
        // Under a sky, no sample is much brighter than others.
        let mut builder = SceneBuilder::default();
        let grey = builder.material(Material::diffuse(Vec3::splat(0.5)));
        builder.parallelogram(Vec3::new(-9.0, 0.0, -9.0), Vec3::Z * 18.0, Vec3::X * 18.0, Vec2::ONE, grey);
        builder.cuboid(Vec3::new(-2.0, 0.0, 2.0), Vec3::new(2.0, 2.0, 3.0), grey);
        let scene = builder.build("yard", Lighting::from_environment(Environment::Sky(Vec3::ONE))).unwrap();
        let noise = |samples: u32| {
            let quality = Quality { illumination: Illumination::Global { max_bounces: 3 }, samples, seed: 0 };
            let tracer = Tracer::new(scene.clone()).with_quality(quality);
            let picture = render(&tracer, &museum::cell(), &mirror, &camera);
            let pairs = picture.mask.texels().iter().zip(picture.standard_error.texels());
            assert!(pairs.clone().all(|(&seen, error)| seen || *error == Vec3::ZERO));
            pairs.map(|(_, error)| error.y).sum::<f32>()
        };
        let ratio = noise(16) / noise(256);
        assert!((3.0..5.0).contains(&ratio), "{ratio}");
    }

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

//! From scene to slabs.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{Vec2, Vec3};
use lf_math::{Cell, GeometryError, LightFieldGeometry, Ray, SlabTexels, srgb8_from_linear};
use rayon::prelude::*;

use crate::focus::focus;
use crate::tracer::{Traced, Tracer};

/// A captured light field.
#[derive(Debug, Clone)]
pub struct Capture {
    /// The slabs as asked for, each with the focal plane that suits the scene.
    pub geometry: LightFieldGeometry,
    /// Their texels.
    pub texels: Vec<SlabTexels>,
    /// How many rays were traced towards the scene for texels (shadow rays not counted).
    pub rays: u64,
}

/// What the texels of a light field in a scene are, one by one: the only place that says so.
///
/// Each stored ray starts where it leaves the cell ([`LightFieldGeometry::capture_ray`]).
#[derive(Clone, Copy)]
pub struct TexelSampler<'a> {
    tracer: &'a Tracer,
    geometry: &'a LightFieldGeometry,
    grid: u32,
}

impl<'a> TexelSampler<'a> {
    /// Texels that are the mean of `grid × grid` rays spread over their footprint in (u, v); 0 counts as 1.
    #[must_use]
    pub fn new(tracer: &'a Tracer, geometry: &'a LightFieldGeometry, grid: u32) -> Self {
        Self { tracer, geometry, grid: grid.max(1) }
    }

    /// Rays that one texel takes.
    #[must_use]
    pub fn rays(&self) -> u64 {
        u64::from(self.grid).pow(2)
    }

    /// The texel of a camera (s, t) of a slab, a position in the geometry's: opaque, 8 bits, sRGB-encoded.
    ///
    /// # Panics
    /// If there is no such slab.
    #[must_use]
    pub fn texel(&self, slab: usize, camera: [u32; 2], texel: [u32; 2]) -> [u8; 4] {
        let radiance = |offset: Vec2| {
            let ray = self.geometry.capture_ray(slab, index(camera), index(texel) + offset);
            trace_in_cell_space(self.tracer, self.geometry.cell(), &ray).radiance
        };
        opaque(subsamples(self.grid).map(radiance).sum::<Vec3>() / (self.grid * self.grid) as f32)
    }

    /// Inverse of the depth of what a texel's middle ray meets: 1/m along the face's axis from the camera plane, negative
    /// behind it, infinite on it, 0 if nothing is met.
    ///
    /// # Panics
    /// If there is no such slab.
    #[must_use]
    pub fn inverse_depth(&self, slab: usize, camera: [u32; 2], texel: [u32; 2]) -> f32 {
        let ray = self.geometry.capture_ray(slab, index(camera), index(texel));
        inverse_depth(self.tracer, self.geometry, slab, &ray)
    }
}

/// Traces every sample of every slab, on all threads, and holds them in memory.
///
/// A texel is as [`TexelSampler`] says, the focal planes are those of [`focus`]. `progress` is told the number of camera
/// images finished so far, from any thread.
///
/// # Errors
/// If the slabs need more texels than fit in memory addresses.
pub fn capture_slabs(
    tracer: &Tracer,
    geometry: &LightFieldGeometry,
    grid: u32,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Capture, GeometryError> {
    let geometry = focus(tracer, geometry)?;
    let sampler = TexelSampler::new(tracer, &geometry, grid);
    let done = AtomicU64::new(0);
    let (mut texels, mut rays) = (Vec::new(), 0);
    for (number, slab) in geometry.slabs().iter().enumerate() {
        let ([across, down], [width, height]) = (slab.cameras(), slab.resolution());
        let image_len = width as usize * height as usize;
        let mut all = vec![[0u8; 4]; across as usize * down as usize * image_len];
        all.par_chunks_mut(image_len).zip(0..across * down).for_each(|(image, camera)| {
            for (texel, index) in image.iter_mut().zip(0u32..) {
                *texel = sampler.texel(number, [camera % across, camera / across], [index % width, index / width]);
            }
            progress(done.fetch_add(1, Ordering::Relaxed) + 1);
        });
        rays += all.len() as u64 * sampler.rays();
        texels.push(SlabTexels::new(slab, all)?);
    }
    Ok(Capture { geometry, texels, rays })
}

/// Traces the inverse depth of every sample of every slab, on all threads: [`TexelSampler::inverse_depth`], but for what stands on a
/// camera plane finite.
///
/// # Errors
/// If the slabs need more texels than fit in memory addresses.
pub fn capture_inverse_depths(
    tracer: &Tracer,
    geometry: &LightFieldGeometry,
) -> Result<Vec<SlabTexels<f32>>, GeometryError> {
    let sampler = TexelSampler::new(tracer, geometry, 1);
    let slab = |(number, slab): (usize, &lf_math::Slab)| {
        let ([across, down], [width, height]) = (slab.cameras(), slab.resolution());
        let cameras = (0..across * down).into_par_iter();
        let image = |camera: u32| {
            let texels = (0..height).flat_map(move |v| (0..width).map(move |u| [u, v]));
            texels.map(move |texel| sampler.inverse_depth(number, [camera % across, camera / across], texel))
        };
        SlabTexels::new(slab, cameras.flat_map_iter(image).collect())
    };
    geometry.slabs().iter().enumerate().map(slab).collect()
}

/// Traces a cell-space ray.
pub(crate) fn trace_in_cell_space(tracer: &Tracer, cell: &Cell, ray: &Ray) -> Traced {
    tracer.trace(cell.world_from_cell(ray.origin).as_vec3(), ray.direction)
}

/// 1/depth of what a cell-space ray meets, as [`TexelSampler::inverse_depth`] has it.
pub(crate) fn inverse_depth(tracer: &Tracer, geometry: &LightFieldGeometry, slab: usize, ray: &Ray) -> f32 {
    let met = tracer.distance(geometry.cell().world_from_cell(ray.origin).as_vec3(), ray.direction);
    met.map_or(0.0, |distance| 1.0 / geometry.slabs()[slab].depth(ray.at(distance)))
}

/// Sample indices as the geometry takes them.
pub(crate) fn index([x, y]: [u32; 2]) -> Vec2 {
    Vec2::new(x as f32, y as f32)
}

/// Offsets from a texel's centre, in texels: the centres of `grid × grid` equal parts.
pub(crate) fn subsamples(grid: u32) -> impl Iterator<Item = Vec2> {
    let part = move |i: u32| (i as f32 + 0.5) / grid as f32 - 0.5;
    (0..grid * grid).map(move |i| Vec2::new(part(i % grid), part(i / grid)))
}

pub(crate) fn opaque(linear: Vec3) -> [u8; 4] {
    let [r, g, b] = srgb8_from_linear(linear);
    [r, g, b, 255]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Environment, Lighting, Material, SceneBuilder};
    use glam::DVec3;
    use lf_math::{Face, PlanePlacement};

    /// A glowing box of half extent 3 around the origin, each face another colour, and a post beside the cell.
    fn box_scene(post: bool) -> Tracer {
        let mut builder = SceneBuilder::default();
        for face in Face::ALL {
            let k = f32::from(face.index() + 1) / 8.0;
            let material = builder.material(Material::glowing(Vec3::new(k, 1.0 - k, 0.25)));
            let corner = face.vector(Vec2::splat(-3.0), 3.0 * face.sign());
            let (u, v) = (face.vector(Vec2::X * 6.0, 0.0), face.vector(Vec2::Y * 6.0, 0.0));
            builder.parallelogram(corner, u, v, Vec2::ONE, material);
        }
        if post {
            let white = builder.material(Material::glowing(Vec3::ONE));
            builder.cuboid(Vec3::new(0.8, -0.1, -3.0), Vec3::new(0.9, 0.1, 3.0), white);
        }
        let lighting = Lighting::from_environment(Environment::BLACK);
        Tracer::new(builder.build("box", lighting).unwrap())
    }

    fn geometry() -> LightFieldGeometry {
        let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
        LightFieldGeometry::around(cell, PlanePlacement::CellFaces, 7, 9).unwrap()
    }

    #[test]
    fn every_texel_holds_the_radiance_of_its_ray() {
        let tracer = box_scene(false);
        let counted = AtomicU64::new(0);
        let progress = |n: u64| {
            counted.fetch_max(n, Ordering::Relaxed);
        };
        let capture = capture_slabs(&tracer, &geometry(), 1, &progress).unwrap();
        assert_eq!((counted.into_inner(), capture.rays), (6 * 49, 6 * 49 * 81));
        // Closed form: the wall that the line from its start meets first.
        for (number, slab) in capture.geometry.slabs().iter().enumerate() {
            for (s, t, u, v) in [(3, 3, 4, 4), (0, 6, 8, 1), (2, 5, 1, 0)] {
                let index = |a: u32, b: u32| Vec2::new(a as f32, b as f32);
                let ray = slab.sample_ray(index(s, t), index(u, v));
                let walls = (Vec3::splat(3.0) * ray.direction.signum() - ray.origin) / ray.direction;
                let axis = (0..3).filter(|&i| ray.direction[i] != 0.0).min_by(|&i, &j| walls[i].total_cmp(&walls[j]));
                let face = Face::dominant(Vec3::AXES[axis.unwrap()] * ray.direction).unwrap();
                let k = f32::from(face.index() + 1) / 8.0;
                let expected = srgb8_from_linear(Vec3::new(k, 1.0 - k, 0.25));
                assert_eq!(capture.texels[number].texel([s, t], [u, v]).unwrap()[..3], expected, "{s} {t} {u} {v}");
            }
        }
    }

    #[test]
    fn a_post_beside_the_cell_is_seen() {
        // From inside the cell along +Z and a little to +X: leaves the cell at x < 0.5, z = 0.5, then meets the post.
        let ray = Ray { origin: Vec3::new(0.45, 0.0, -0.5), direction: Vec3::new(0.9, 0.0, 1.0) };
        let geometry = geometry();
        let coord = geometry.slabs()[4].index_ray(&ray);
        let captured = geometry.capture_ray(4, coord.st, coord.uv);
        let tracer = box_scene(true);
        let seen = |ray: &Ray| trace_in_cell_space(&tracer, geometry.cell(), ray).radiance;
        assert_eq!(seen(&captured), Vec3::ONE);
        // A pinhole camera on the extended plane stands behind the post and misses it.
        let pinhole = geometry.slabs()[4].sample_ray(coord.st, coord.uv);
        assert!(pinhole.origin.x > 0.9);
        assert_ne!(seen(&pinhole), Vec3::ONE);
    }

    #[test]
    fn the_focal_plane_lies_between_near_and_far() {
        let capture = capture_slabs(&box_scene(false), &geometry(), 1, &|_| ()).unwrap();
        for slab in capture.geometry.slabs() {
            // The far wall is 2.5 m from the camera plane; side walls are nearer.
            let depth = slab.focal_depth().unwrap();
            // A bin is 1/512 m⁻¹ wide here, 0.6 % at this depth.
            assert!((1.5..2.52).contains(&depth), "{depth}");
        }
    }

    /// A thing that touches the camera plane has an inverse depth without bound; it must not decide for all.
    #[test]
    fn a_thing_in_the_camera_plane_does_not_pull_the_focus() {
        let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
        let through_center = LightFieldGeometry::around(cell, PlanePlacement::CellCenter, 7, 9).unwrap();
        let capture = capture_slabs(&box_scene(true), &through_center, 1, &|_| ()).unwrap();
        for slab in capture.geometry.slabs() {
            let depth = slab.focal_depth().unwrap();
            assert!((1.5..3.1).contains(&depth), "{}: {depth}", slab.face().name());
        }
    }

    #[test]
    fn threads_do_not_change_the_result() {
        let tracer = box_scene(true);
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| capture_slabs(&tracer, &geometry(), 2, &|_| ()).unwrap())
        };
        let (one, three) = (run(1), run(3));
        assert_eq!((one.geometry, one.texels), (three.geometry, three.texels));
    }
}

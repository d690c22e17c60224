//! From scene to slabs and cube maps.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{Vec2, Vec3};
use lf_math::{
    Cell, CubeCoord, CubeMap, Face, GeometryError, Image, LightFieldGeometry, Ray, SlabTexels, cube_direction,
    srgb8_from_linear,
};
use rayon::prelude::*;

use crate::tracer::{Traced, Tracer};

/// A captured light field.
#[derive(Debug, Clone)]
pub struct Capture {
    /// The slabs as asked for, each with the focal plane that suits what was seen.
    pub geometry: LightFieldGeometry,
    /// Their texels.
    pub texels: Vec<SlabTexels>,
    /// How many rays were traced towards the scene (shadow rays not counted).
    pub rays: u64,
}

/// How often each inverse depth was seen from the camera plane by the rays that pass through the cell.
///
/// Bins are `1/z = i·4/(BINS·h)`, h being the cell's smallest half extent: up to a quarter of h, in steps that shift the
/// paper's 128 texels by 0.01 texel per camera. What is nearer, or behind the plane, only counts as being beyond an end.
#[derive(Debug, Clone)]
struct Depths {
    bin: f64,
    counts: Vec<u64>,
}

/// Number of bins of inverse depth.
const BINS: usize = 4096;

/// Traces every sample of every slab, on all threads.
///
/// Each stored ray starts where it leaves the cell ([`LightFieldGeometry::capture_ray`]). A texel is the mean of
/// `grid × grid` rays spread over its footprint in (u, v); 0 counts as 1. `progress` is told the number of camera images
/// finished so far, from any thread.
///
/// Each slab's focal plane is put at `1 / median(1/z)`, z being the depth of what the rays through the cell meet: the
/// disparity of least mean absolute error. (Chai et al. 2000 give the harmonic mean of the extremes, the minimax choice;
/// a single object that touches the camera plane would pull that, or the mean, to zero depth.)
///
/// # Errors
/// If the slabs need more texels than fit in memory addresses.
pub fn capture_slabs(
    tracer: &Tracer,
    geometry: &LightFieldGeometry,
    grid: u32,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Capture, GeometryError> {
    let done = AtomicU64::new(0);
    let finished = || progress(done.fetch_add(1, Ordering::Relaxed) + 1);
    let grid = grid.max(1);
    let (mut slabs, mut texels, mut rays) = (Vec::new(), Vec::new(), 0);
    for (number, slab) in geometry.slabs().iter().enumerate() {
        let [cameras_s, cameras_t] = slab.cameras();
        let [width, height] = slab.resolution();
        let image_len = width as usize * height as usize;
        let mut all = vec![[0u8; 4]; cameras_s as usize * cameras_t as usize * image_len];
        let images = all.par_chunks_mut(image_len).enumerate().map(|(index, image)| {
            let camera = Vec2::new((index as u32 % cameras_s) as f32, (index as u32 / cameras_s) as f32);
            let depths = capture_image(tracer, geometry, number, camera, grid, image);
            finished();
            depths
        });
        let none = || Depths::new(geometry.cell());
        let depths = images.reduce(none, Depths::plus);
        slabs.push(slab.with_focal_depth(depths.focal_depth())?);
        rays += all.len() as u64 * u64::from(grid * grid);
        texels.push(SlabTexels::new(slab, all)?);
    }
    Ok(Capture { geometry: LightFieldGeometry::new(*geometry.cell(), slabs)?, texels, rays })
}

fn capture_image(
    tracer: &Tracer,
    geometry: &LightFieldGeometry,
    number: usize,
    camera: Vec2,
    grid: u32,
    image: &mut [[u8; 4]],
) -> Depths {
    let slab = &geometry.slabs()[number];
    let width = slab.resolution()[0];
    let mut depths = Depths::new(geometry.cell());
    for (index, texel) in image.iter_mut().enumerate() {
        let center = Vec2::new((index as u32 % width) as f32, (index as u32 / width) as f32);
        let mut sum = Vec3::ZERO;
        for offset in subsamples(grid) {
            let ray = geometry.capture_ray(number, camera, center + offset);
            let traced = trace_in_cell_space(tracer, geometry.cell(), &ray);
            depths.add(geometry.cell(), &ray, slab.depth(ray.at(traced.distance)));
            sum += traced.radiance;
        }
        *texel = opaque(sum / (grid * grid) as f32);
    }
    depths
}

/// The environment map of a cell: six faces of `size × size` texels seen from its centre, each texel the mean of
/// `grid × grid` rays.
///
/// # Errors
/// `size` must be at least 1.
pub fn capture_cube(tracer: &Tracer, cell: &Cell, size: u32, grid: u32) -> Result<CubeMap, GeometryError> {
    let grid = grid.max(1);
    let texel = |face: Face, index: u32| {
        let center = Vec2::new((index % size) as f32, (index / size) as f32) + 0.5;
        let radiance = |offset: Vec2| {
            let direction = cube_direction(CubeCoord { face, uv: (center + offset) / size as f32 });
            trace_in_cell_space(tracer, cell, &Ray { origin: Vec3::ZERO, direction }).radiance
        };
        opaque(subsamples(grid).map(radiance).sum::<Vec3>() / (grid * grid) as f32)
    };
    let face = |face: Face| {
        let texels = (0..size.saturating_mul(size)).into_par_iter().map(|index| texel(face, index)).collect();
        Image::new(size, size, texels)
    };
    let [a, b, c, d, e, f] = Face::ALL.map(face);
    CubeMap::new([a?, b?, c?, d?, e?, f?])
}

/// Traces a cell-space ray.
pub(crate) fn trace_in_cell_space(tracer: &Tracer, cell: &Cell, ray: &Ray) -> Traced {
    tracer.trace(cell.world_from_cell(ray.origin).as_vec3(), ray.direction)
}

/// Offsets from a texel's centre, in texels: the centres of `grid × grid` equal parts.
fn subsamples(grid: u32) -> impl Iterator<Item = Vec2> {
    let part = move |i: u32| (i as f32 + 0.5) / grid as f32 - 0.5;
    (0..grid * grid).map(move |i| Vec2::new(part(i % grid), part(i / grid)))
}

fn opaque(linear: Vec3) -> [u8; 4] {
    let [r, g, b] = srgb8_from_linear(linear);
    [r, g, b, 255]
}

impl Depths {
    fn new(cell: &Cell) -> Self {
        let nearest = 0.25 * f64::from(cell.half_extent().min_element());
        Self { bin: 1.0 / (nearest * BINS as f64), counts: vec![0; BINS] }
    }

    /// Counts a ray if it passes through the cell.
    fn add(&mut self, cell: &Cell, ray: &Ray, depth: f32) {
        // `ray` starts where it leaves the cell, or beside it if it misses.
        if cell.contains(ray.origin * (1.0 - 1e-4)) {
            // What lies behind the plane has a negative inverse depth: below all others.
            let inverse = if depth > 0.0 { 1.0 / f64::from(depth) } else { 0.0 };
            self.counts[((inverse / self.bin) as usize).min(BINS - 1)] += 1;
        }
    }

    fn plus(mut self, other: Self) -> Self {
        for (count, more) in self.counts.iter_mut().zip(other.counts) {
            *count += more;
        }
        self
    }

    /// `1 / median(1/z)`; none (infinity) if nothing was seen, or most of it too far for the first bin.
    fn focal_depth(&self) -> Option<f32> {
        let half = self.counts.iter().sum::<u64>().div_ceil(2);
        let mut below = 0;
        let median = self.counts.iter().position(|count| {
            below += count;
            below >= half
        });
        median.filter(|&i| i > 0).map(|i| (1.0 / (self.bin * (i as f64 + 0.5))) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Environment, Lighting, Material, SceneBuilder};
    use glam::DVec3;
    use lf_math::PlanePlacement;

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
        let seen = trace_in_cell_space(&box_scene(true), geometry.cell(), &captured).radiance;
        assert_eq!(seen, Vec3::ONE);
        // A pinhole camera on the extended plane stands behind the post and misses it.
        let pinhole = geometry.slabs()[4].sample_ray(coord.st, coord.uv);
        assert!(pinhole.origin.x > 0.9);
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

    #[test]
    fn cube_faces_look_where_they_should() {
        let cube = capture_cube(&box_scene(false), geometry().cell(), 4, 2).unwrap();
        for face in Face::ALL {
            let k = f32::from(face.index() + 1) / 8.0;
            let expected = srgb8_from_linear(Vec3::new(k, 1.0 - k, 0.25));
            let image = &cube.faces()[usize::from(face.index())];
            assert!(image.texels().iter().all(|texel| texel[..3] == expected));
        }
    }
}

//! Cube maps of a scene: what is seen from a point in all directions.

use glam::{Vec2, Vec3};
use lf_math::{Cell, CubeCoord, CubeMap, DistanceCube, Face, GeometryError, Image, cube_direction};
use rayon::prelude::*;

use crate::capture::{opaque, subsamples};
use crate::tracer::{Traced, Tracer};

/// Radiance and distance in all directions around a point: six faces of `size × size` texels, in the order and the
/// orientation of [`CubeMap`], on all threads.
///
/// `point` is in world space, metres. A texel's radiance, linear, is the mean of `grid × grid` rays spread over its footprint (0
/// counts as 1). Its distance, metres from the point, is that of the ray through its middle: a mean of distances would be
/// a place where nothing is. It is infinite if nothing is met.
///
/// # Errors
/// `size` must be at least 1.
pub fn trace_cube(tracer: &Tracer, point: Vec3, size: u32, grid: u32) -> Result<[Image<Traced>; 6], GeometryError> {
    let grid = grid.max(1);
    let texel = |face: Face, index: u32| {
        let middle = Vec2::new((index % size) as f32, (index / size) as f32) + 0.5;
        let towards = |offset: Vec2| cube_direction(CubeCoord { face, uv: (middle + offset) / size as f32 });
        let radiance = |offset| tracer.trace(point, towards(offset)).radiance;
        let center = towards(Vec2::ZERO);
        Traced {
            radiance: subsamples(grid).map(radiance).sum::<Vec3>() / (grid * grid) as f32,
            distance: tracer.distance(point, center).map_or(f32::INFINITY, |t| t * center.length()),
        }
    };
    let face = |face: Face| {
        let texels = (0..size.saturating_mul(size)).into_par_iter().map(|index| texel(face, index)).collect();
        Image::new(size, size, texels)
    };
    let [a, b, c, d, e, f] = Face::ALL.map(face);
    Ok([a?, b?, c?, d?, e?, f?])
}

/// The environment map of a cell: six faces of `size × size` texels seen from its centre, each texel the mean of
/// `grid × grid` rays.
///
/// # Errors
/// `size` must be at least 1.
pub fn capture_cube(tracer: &Tracer, cell: &Cell, size: u32, grid: u32) -> Result<CubeMap, GeometryError> {
    let faces = trace_cube(tracer, cell.center().as_vec3(), size, grid)?;
    CubeMap::new(faces.map(|face| face.map(|texel: Traced| opaque(texel.radiance))))
}

/// A distance cube taken at a point of cell space: a picture of `size × size` texels a face, each the mean of `grid × grid` rays, and
/// inverse depths of `depth_size × depth_size`.
///
/// # Errors
/// Both sizes must be at least 1, the point finite and not on a surface.
pub fn capture_distance_cube(
    tracer: &Tracer,
    cell: &Cell,
    point: Vec3,
    [size, depth_size]: [u32; 2],
    grid: u32,
) -> Result<DistanceCube, GeometryError> {
    let world = cell.world_from_cell(point).as_vec3();
    let seen = trace_cube(tracer, world, size, grid)?;
    let radiance = CubeMap::new(seen.map(|face| face.map(|texel: Traced| opaque(texel.radiance))))?;
    let depths = Face::ALL.map(|face| {
        let inverse = |index: u32| {
            let middle = Vec2::new((index % depth_size) as f32, (index / depth_size) as f32) + 0.5;
            // The direction's component along the face's axis is ±1: its length is the depth of what is met.
            let direction = cube_direction(CubeCoord { face, uv: middle / depth_size as f32 });
            tracer.distance(world, direction).map_or(0.0, f32::recip)
        };
        let texels = (0..depth_size.saturating_mul(depth_size)).into_par_iter().map(inverse).collect();
        Image::new(depth_size, depth_size, texels)
    });
    let [a, b, c, d, e, f] = depths;
    DistanceCube::new(point, radiance, [a?, b?, c?, d?, e?, f?])
}

/// The same, of one size, with perfect mirrors as such ([`DistanceCube::with_mirrors`]): what the middle ray of each texel meets counts. In a
/// scene without mirrors it is [`capture_distance_cube`].
///
/// # Errors
/// As there.
pub fn capture_mirror_cube(
    tracer: &Tracer,
    cell: &Cell,
    point: Vec3,
    size: u32,
    grid: u32,
) -> Result<DistanceCube, GeometryError> {
    let cube = capture_distance_cube(tracer, cell, point, [size; 2], grid)?;
    if !tracer.has_mirrors() {
        return Ok(cube);
    }
    let world = cell.world_from_cell(point).as_vec3();
    let of_face = |face: Face| {
        let reflectance = |index: u32| {
            let middle = Vec2::new((index % size) as f32, (index / size) as f32) + 0.5;
            tracer.mirror(world, cube_direction(CubeCoord { face, uv: middle / size as f32 }))
        };
        (0..size * size).into_par_iter().map(reflectance).collect::<Vec<_>>()
    };
    let mirrors = Face::ALL.map(of_face);
    let mut faces = cube.radiance().faces().clone();
    for (face, mirrors) in faces.iter_mut().zip(&mirrors) {
        for (texel, mirror) in face.texels_mut().iter_mut().zip(mirrors) {
            *texel = mirror.map_or(*texel, opaque);
        }
    }
    let marks = mirrors.map(|face| Image::new(size, size, face.iter().map(Option::is_some).collect()));
    let [a, b, c, d, e, f] = marks;
    DistanceCube::new(point, CubeMap::new(faces)?, cube.inverse_depths().clone())?
        .with_mirrors([a?, b?, c?, d?, e?, f?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Environment, Lighting, Material, SceneBuilder};
    use glam::DVec3;

    /// A glowing box from −2 to 4 on each axis, each wall another colour.
    fn room() -> Tracer {
        let mut builder = SceneBuilder::default();
        for face in Face::ALL {
            let k = f32::from(face.index() + 1) / 8.0;
            let material = builder.material(Material::glowing(Vec3::new(k, 1.0 - k, 0.25)));
            let corner = Vec3::ONE + face.vector(Vec2::splat(-3.0), 3.0 * face.sign());
            let (u, v) = (face.vector(Vec2::X * 6.0, 0.0), face.vector(Vec2::Y * 6.0, 0.0));
            builder.parallelogram(corner, u, v, Vec2::ONE, material);
        }
        Tracer::new(builder.build("room", Lighting::from_environment(Environment::BLACK)).unwrap())
    }

    /// Closed form: the wall that a ray leads to, and how far it is.
    #[test]
    fn texels_hold_radiance_and_distance_from_any_point() {
        // From here no texel's ray meets two walls at once.
        let (tracer, point, size) = (room(), Vec3::new(0.51, -1.03, 2.9), 9);
        for grid in [1, 2] {
            for (face, image) in Face::ALL.into_iter().zip(trace_cube(&tracer, point, size, grid).unwrap()) {
                for (index, texel) in image.texels().iter().enumerate() {
                    let middle = Vec2::new((index as u32 % size) as f32, (index as u32 / size) as f32) + 0.5;
                    let direction = cube_direction(CubeCoord { face, uv: middle / size as f32 }).normalize();
                    let walls = (Vec3::ONE + 3.0 * direction.signum() - point) / direction;
                    let expected = walls.min_element();
                    assert!((texel.distance - expected).abs() < 1e-5 * expected, "{texel:?} {expected}");
                    let axis = (0..3).find(|&i| walls[i] == expected).unwrap();
                    let k = f32::from(Face::dominant(Vec3::AXES[axis] * direction).unwrap().index() + 1) / 8.0;
                    let seen = (texel.radiance - Vec3::new(k, 1.0 - k, 0.25)).abs().max_element();
                    assert!(grid > 1 || seen < 1e-6, "{texel:?}");
                }
            }
        }
    }

    /// Closed form: the walls as seen from a point off the cell's centre.
    #[test]
    fn distance_cubes_know_where_the_walls_are() {
        let cell = Cell::cube(DVec3::ONE, 1.0).unwrap();
        let point = Vec3::new(0.3, -0.2, 0.1);
        let cube = capture_distance_cube(&room(), &cell, point, [5, 9], 1).unwrap();
        assert_eq!((cube.radiance().size(), cube.depth_size(), cube.position()), (5, 9, point));
        for face in Face::ALL {
            let depth = 3.0 - face.sign() * point[face.axis()];
            let straight = face.vector(Vec2::ZERO, face.sign() * depth);
            assert!((cube.relative_depth(straight) - 1.0).abs() < 1e-5);
        }
        assert!(capture_distance_cube(&room(), &cell, point, [5, 0], 1).is_err());
    }

    #[test]
    fn cube_faces_look_where_they_should() {
        let cell = Cell::cube(DVec3::ONE, 1.0).unwrap();
        let cube = capture_cube(&room(), &cell, 4, 2).unwrap();
        for face in Face::ALL {
            let k = f32::from(face.index() + 1) / 8.0;
            let expected = opaque(Vec3::new(k, 1.0 - k, 0.25));
            assert!(cube.faces()[usize::from(face.index())].texels().iter().all(|texel| *texel == expected));
        }
        assert!(capture_cube(&room(), &cell, 0, 1).is_err());
    }

    /// Closed form: which rays meet a cuboid first.
    #[test]
    fn texels_of_mirrors_hold_what_those_reflect() {
        let color = Vec3::new(0.9, 0.5, 0.2);
        let (low, high) = (Vec3::new(1.0, -1.0, 0.5), Vec3::new(2.0, 1.5, 1.5));
        let mut builder = SceneBuilder::default();
        let (mirror, wall) =
            (builder.material(Material::mirror(color)), builder.material(Material::glowing(Vec3::splat(0.25))));
        builder.cuboid(low, high, mirror);
        builder.parallelogram(Vec3::new(-9.0, -9.0, 4.0), Vec3::X * 18.0, Vec3::Y * 18.0, Vec2::ONE, wall);
        let tracer = Tracer::new(builder.build("mirror", Lighting::from_environment(Environment::BLACK)).unwrap());
        let (cell, size) = (Cell::cube(DVec3::ZERO, 1.0).unwrap(), 40);
        let point = Vec3::new(0.1, 0.2, -0.3);
        let cube = capture_mirror_cube(&tracer, &cell, point, size, 2).unwrap();
        let plain = capture_distance_cube(&tracer, &cell, point, [size; 2], 2).unwrap();
        assert_eq!(cube.inverse_depths(), plain.inverse_depths());
        let mut met = 0;
        for (number, face) in Face::ALL.into_iter().enumerate() {
            for (x, y) in (0..size * size).map(|i| (i % size, i / size)) {
                let uv = (Vec2::new(x as f32, y as f32) + 0.5) / size as f32;
                let direction = cube_direction(CubeCoord { face, uv });
                let (a, b) = ((low - point) / direction, (high - point) / direction);
                let enters = a.min(b).max_element();
                let expected = enters > 0.0 && enters < a.max(b).min_element();
                met += u32::from(expected);
                assert_eq!(cube.mirrors().unwrap()[number].get(x, y), expected, "{face:?} {x} {y}");
                let texel = cube.radiance().faces()[number].get(x, y);
                let other = plain.radiance().faces()[number].get(x, y);
                assert_eq!(texel, if expected { opaque(color) } else { other });
            }
        }
        assert!(met > 100, "{met}");
        // Without mirrors there is nothing to mark.
        assert_eq!(capture_mirror_cube(&room(), &cell, point, 4, 1).unwrap().mirrors(), None);
    }
}

//! Reflections from an environment map.

use glam::{Vec2, Vec3};
use lf_math::{CubeCoord, CubeMap, Face, Image, Ray, cube_coord, cube_direction};

use crate::bilinear::bilinear;
use crate::frame::Environment;
use crate::texel::Texel;

/// A cube map with a border of one texel around each face, so that bilinear interpolation crosses the edges as it does
/// on a GPU.
#[derive(Debug, Clone)]
pub struct CubeField {
    size: u32,
    faces: [Image<[u8; 4]>; 6],
}

impl CubeField {
    /// Copies the faces of a cube map and borrows their borders from the neighbours.
    #[must_use]
    pub fn new(cube: &CubeMap) -> Self {
        Self { size: cube.size(), faces: Face::ALL.map(|face| bordered(cube, face)) }
    }
}

impl Environment for CubeField {
    /// By direction alone, as if everything were infinitely far away: the origin is not used.
    fn look_up(&self, ray: &Ray) -> Option<Vec3> {
        let coord = cube_coord(ray.direction)?;
        let image = &self.faces[usize::from(coord.face.index())];
        // Texel centres of the face are at ½; the border adds one.
        let position = (coord.uv * self.size as f32 + 0.5).min(Vec2::splat(self.size as f32 + 0.5));
        Some(<[u8; 4]>::color(bilinear(position, |x, y| image.get(x as u32, y as u32))))
    }
}

fn bordered(cube: &CubeMap, face: Face) -> Image<[u8; 4]> {
    let size = cube.size();
    let mut image = Image::filled(size + 2, size + 2, [0; 4]);
    image.blit(&cube.faces()[usize::from(face.index())], 1, 1);
    for i in 0..size {
        for [x, y] in [[0, i + 1], [size + 1, i + 1], [i + 1, 0], [i + 1, size + 1]] {
            set(&mut image, x, y, neighbour(cube, face, x, y));
        }
    }
    // Three faces meet at a corner, where a fourth texel does not exist: the mean of the other three.
    let far = size + 1;
    for ([x, y], [ix, iy]) in
        [([0, 0], [1, 1]), ([far, 0], [size, 1]), ([0, far], [1, size]), ([far, far], [size, size])]
    {
        let three = [image.get(ix, y), image.get(x, iy), image.get(ix, iy)];
        let mean = std::array::from_fn(|c| (three.iter().map(|t| u32::from(t[c])).sum::<u32>() / 3) as u8);
        set(&mut image, x, y, mean);
    }
    image
}

fn set(image: &mut Image<[u8; 4]>, x: u32, y: u32, texel: [u8; 4]) {
    let width = image.width() as usize;
    image.texels_mut()[y as usize * width + x as usize] = texel;
}

/// The texel beyond the edge of a face, at a position of the bordered image.
fn neighbour(cube: &CubeMap, face: Face, x: u32, y: u32) -> [u8; 4] {
    let size = cube.size() as f32;
    // Just across the edge, so that the row along it stays the same on the other face.
    let across = |i: u32| (i as f32 - 0.5).clamp(-1e-3, size + 1e-3) / size;
    let uv = Vec2::new(across(x), across(y));
    let other = cube_coord(cube_direction(CubeCoord { face, uv })).unwrap_or(CubeCoord { face, uv });
    let texel = (other.uv * size).floor().clamp(Vec2::ZERO, Vec2::splat(size - 1.0));
    cube.faces()[usize::from(other.face.index())].get(texel.x as u32, texel.y as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube map that holds a smooth function of the direction.
    fn smooth(size: u32) -> CubeMap {
        let color = |direction: Vec3| {
            let n = direction.normalize();
            [n.x, n.y, n.z, 1.0].map(|c| (127.5 + 120.0 * c).round() as u8)
        };
        let face = |face| {
            let uv = |i: u32| Vec2::new((i % size) as f32 + 0.5, (i / size) as f32 + 0.5) / size as f32;
            let texel = |i| color(cube_direction(CubeCoord { face, uv: uv(i) }));
            Image::new(size, size, (0..size * size).map(texel).collect()).unwrap()
        };
        CubeMap::new(Face::ALL.map(face)).unwrap()
    }

    #[test]
    fn edges_and_corners_are_seamless() {
        let field = CubeField::new(&smooth(64));
        for i in 0..20_000 {
            // Directions that crowd around the edges and corners of the cube.
            let angle = i as f32 * 0.012_34;
            let direction = Vec3::new(angle.sin(), (2.3 * angle).cos(), (0.7 * angle).sin()).signum()
                + 0.1 * Vec3::new((5.0 * angle).sin(), (3.1 * angle).cos(), (7.7 * angle).sin());
            let direction = if i % 3 == 0 { direction * Vec3::new(1.0, 0.3, 1.0) } else { direction };
            let found = field.look_up(&Ray { origin: Vec3::ONE, direction }).unwrap();
            let exact = (127.5 + 120.0 * direction.normalize()) / 255.0;
            assert!((found - exact).abs().max_element() < 0.02, "{direction}: {found} {exact}");
        }
    }

    #[test]
    fn only_the_direction_counts() {
        let field = CubeField::new(&smooth(8));
        let ray = |origin: Vec3| Ray { origin, direction: Vec3::new(0.2, -0.5, 0.9) };
        assert_eq!(field.look_up(&ray(Vec3::ZERO)), field.look_up(&ray(Vec3::splat(100.0))));
        assert_eq!(field.look_up(&Ray { origin: Vec3::ZERO, direction: Vec3::ZERO }), None);
    }
}

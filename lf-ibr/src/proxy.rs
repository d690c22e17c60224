//! Environment maps on a stand-in for the scene's shape: a sphere or a box.
//!
//! The ray is met with the stand-in, and the map is asked for the direction from its own centre to that place. Right where the
//! scene is a room of that shape; whatever stands in the room is painted on its walls.

use glam::Vec3;
use lf_math::{Ray, normalized, sphere_exit};

use crate::cube::CubeField;
use crate::frame::Environment;

/// A cube map projected on a box (Lagarde & Zanuttini 2012), as game engines do in rooms.
#[derive(Debug, Clone)]
pub struct BoxCube {
    cube: CubeField,
    center: Vec3,
    corners: [Vec3; 2],
}

/// A cube map projected on a sphere around its centre (Bjorke 2004).
#[derive(Debug, Clone)]
pub struct SphereCube {
    cube: CubeField,
    center: Vec3,
    radius: f32,
}

impl BoxCube {
    /// A map seen from `center`, on the box between its least and greatest corner. Cell space.
    #[must_use]
    pub fn new(cube: CubeField, center: Vec3, corners: [Vec3; 2]) -> Self {
        Self { cube, center, corners }
    }
}

impl SphereCube {
    /// A map seen from `center`, on the sphere of this radius around it. Cell space, metres.
    #[must_use]
    pub fn new(cube: CubeField, center: Vec3, radius: f32) -> Self {
        Self { cube, center, radius }
    }
}

impl Environment for BoxCube {
    /// A ray from outside the box is taken as it is, by direction alone.
    fn look_up(&self, ray: &Ray) -> Option<Vec3> {
        let direction = normalized(ray.direction)?;
        let [low, high] = self.corners.map(|corner| (corner - ray.origin) / direction);
        // Where it leaves the slab of each axis; 0/0, a ray in a wall's plane, leaves at the others.
        let exits = Vec3::from_array([0, 1, 2].map(|i| if low[i] > high[i] { low[i] } else { high[i] }));
        let leave = exits.to_array().into_iter().filter(|t| !t.is_nan()).fold(f32::INFINITY, f32::min);
        let met = ray.origin + leave * direction - self.center;
        self.cube.look_up(&Ray { origin: self.center, direction: if leave > 0.0 { met } else { direction } })
    }
}

impl Environment for SphereCube {
    /// A ray that misses the sphere is taken as it is, by direction alone.
    fn look_up(&self, ray: &Ray) -> Option<Vec3> {
        let direction = normalized(ray.direction)?;
        let from = ray.origin - self.center;
        let met = sphere_exit(from, direction, self.radius).map(|t| from + t * direction);
        self.cube.look_up(&Ray { origin: self.center, direction: met.unwrap_or(direction) })
    }
}

#[cfg(test)]
mod tests {
    use lf_math::{CubeCoord, CubeMap, Face, Image, cube_direction};
    use proptest::prelude::*;

    use super::*;

    const CENTER: Vec3 = Vec3::new(0.2, -0.1, 0.3);

    /// A map whose colours are a smooth function of the place that is seen of a surface around the centre.
    fn cube(meet: impl Fn(Vec3) -> Vec3) -> CubeField {
        let size = 256;
        let faces = Face::ALL.map(|face| {
            let mut image = Image::filled(size, size, [0; 4]);
            for (i, texel) in (0u32..).zip(image.texels_mut()) {
                let uv = (glam::Vec2::new((i % size) as f32, (i / size) as f32) + 0.5) / size as f32;
                *texel = color(meet(cube_direction(CubeCoord { face, uv })))
                    .extend(1.0)
                    .to_array()
                    .map(|c| (255.0 * c).round() as u8);
            }
            image
        });
        CubeField::new(&CubeMap::new(faces).unwrap())
    }

    fn color(place: Vec3) -> Vec3 {
        0.5 + 0.1 * place
    }

    fn rays() -> impl Strategy<Value = Ray> {
        let unit = || prop::array::uniform3(-1000i32..=1000).prop_map(|v| Vec3::from(v.map(|n| n as f32 / 1000.0)));
        (unit(), unit())
            .prop_filter("a direction", |(_, d)| d.length() > 0.1)
            .prop_map(|(o, direction)| Ray { origin: 0.5 * o, direction })
    }

    proptest! {
        /// In a room of just that shape the answer is exact, from anywhere: the place where the ray really ends.
        #[test]
        fn a_room_of_that_shape_is_exact(ray in rays()) {
            let corners = [Vec3::new(-2.0, -1.0, -1.5), Vec3::new(3.0, 2.0, 2.5)];
            let leave = |o: Vec3, d: Vec3| {
                let t = ((corners[0] - o).as_dvec3() / d.as_dvec3()).max((corners[1] - o).as_dvec3() / d.as_dvec3());
                (o.as_dvec3() + t.min_element() * d.as_dvec3()).as_vec3()
            };
            let field = BoxCube::new(cube(|d| leave(CENTER, d)), CENTER, corners);
            let found = field.look_up(&ray).unwrap();
            let exact = color(leave(ray.origin, ray.direction));
            prop_assert!((found - exact).abs().max_element() < 0.01, "{found} {exact}");
        }

        #[test]
        fn a_round_room_is_exact(ray in rays()) {
            let radius = 2.0;
            let field = SphereCube::new(cube(|d| CENTER + radius * d.normalize()), CENTER, radius);
            // In double precision, from the quadratic's plain roots.
            let (o, d) = ((ray.origin - CENTER).as_dvec3(), ray.direction.as_dvec3().normalize());
            let t = -o.dot(d) + (o.dot(d).powi(2) - o.dot(o) + f64::from(radius * radius)).sqrt();
            let exact = color(CENTER + (o + t * d).as_vec3());
            let found = field.look_up(&ray).unwrap();
            prop_assert!((found - exact).abs().max_element() < 0.01, "{found} {exact}");
        }
    }

    #[test]
    fn what_misses_the_stand_in_is_asked_by_direction() {
        let plain = cube(|d| d.normalize());
        let outside = Ray { origin: Vec3::splat(9.0), direction: Vec3::ONE };
        let expected = plain.look_up(&outside);
        assert_eq!(BoxCube::new(plain.clone(), Vec3::ZERO, [Vec3::NEG_ONE, Vec3::ONE]).look_up(&outside), expected);
        let passing = Ray { origin: Vec3::new(9.0, 9.0, 0.0), direction: Vec3::X };
        assert_eq!(SphereCube::new(plain.clone(), Vec3::ZERO, 1.0).look_up(&passing), plain.look_up(&passing));
        let nowhere = Ray { origin: Vec3::ZERO, direction: Vec3::ZERO };
        assert_eq!(SphereCube::new(plain, Vec3::ZERO, 1.0).look_up(&nowhere), None);
    }

    #[test]
    fn a_ray_in_a_wall_ends_at_the_next() {
        let field = BoxCube::new(cube(|d| d.normalize()), Vec3::ZERO, [Vec3::NEG_ONE, Vec3::ONE]);
        let along = Ray { origin: Vec3::new(0.0, 1.0, 0.0), direction: Vec3::X };
        let exact = color(Vec3::new(1.0, 1.0, 0.0).normalize());
        assert!((field.look_up(&along).unwrap() - exact).abs().max_element() < 0.01);
    }
}

//! The ray tracer: nearest hit, direct light with hard shadows.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use crate::bvh::{Hit, TriangleBvh, interpolate};
use crate::light::Illuminant;
use crate::scene::Scene;

/// What a ray met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traced {
    /// Radiance that arrives at the ray's origin, linear RGB.
    pub radiance: Vec3,
    /// Ray parameter of the hit; infinite if the ray left the scene.
    pub distance: f32,
}

/// A scene ready to be traced. World space, shared between threads.
pub struct Tracer {
    scene: Scene,
    bvh: TriangleBvh,
    /// How far secondary rays start above a surface, metres.
    offset: f32,
}

impl Tracer {
    /// Builds the acceleration structure: about a second per million triangles.
    #[must_use]
    pub fn new(scene: Scene) -> Self {
        let bvh = TriangleBvh::new(scene.triangles().iter().map(|(corners, _)| corners.map(|v| v.position)));
        let (min, max) = scene.bounds();
        // A hit point is off by a few ulp of the largest coordinate involved, about 1e-6 of the scene's reach.
        let offset = 1e-5 * min.abs().max(max.abs()).max_element();
        Self { scene, bvh, offset }
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Memory of the triangles, their hierarchy and the textures, bytes.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        self.scene.memory_bytes() + self.bvh.memory_bytes()
    }

    /// Ray parameter of the nearest hit, if any. The direction may have any length; a direction that is zero or not
    /// finite, or an origin that is not finite, hits nothing.
    #[must_use]
    pub fn distance(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        self.bvh.nearest(origin, direction).map(|hit| hit.t)
    }

    /// Radiance along a ray.
    #[must_use]
    pub fn trace(&self, origin: Vec3, direction: Vec3) -> Traced {
        match self.bvh.nearest(origin, direction) {
            Some(hit) => Traced { radiance: self.shade(&hit, origin, direction), distance: hit.t },
            None => {
                let towards = lf_math::normalized(direction).unwrap_or(Vec3::ZERO);
                Traced { radiance: self.scene.lighting().environment.towards(towards), distance: f32::INFINITY }
            }
        }
    }

    fn shade(&self, hit: &Hit, origin: Vec3, direction: Vec3) -> Vec3 {
        let (corners, _) = &self.scene.triangles()[hit.triangle];
        let geometric = if hit.normal.dot(direction) > 0.0 { -hit.normal } else { hit.normal };
        let smooth = lf_math::normalized(interpolate(corners.map(|v| v.normal), hit.shares));
        let normal = smooth.map_or(geometric, |n| if n.dot(geometric) < 0.0 { -n } else { n });
        let uv = interpolate(corners.map(|v| v.uv.extend(0.0)), hit.shares);
        let material = self.scene.material(hit.triangle);
        let base = material.base.color(Vec2::new(uv.x, uv.y));
        let point = origin + direction * hit.t;
        let front = hit.normal.dot(direction) < 0.0 || material.double_sided;
        let emission = if front { material.emission.color(Vec2::new(uv.x, uv.y)) } else { Vec3::ZERO };
        emission + base / PI * self.irradiance(point, geometric * self.offset, normal)
    }

    /// Irradiance: ambient, and what each visible light adds. Shadow rays start
    /// `lift` above the point.
    fn irradiance(&self, point: Vec3, lift: Vec3, normal: Vec3) -> Vec3 {
        let lighting = self.scene.lighting();
        let mut sum = lighting.ambient_on(normal);
        for light in &lighting.lights {
            let Some(Illuminant { towards, distance, irradiance }) = light.at(point) else { continue };
            let cosine = normal.dot(towards);
            if cosine > 0.0 && !self.bvh.occluded(point + lift, towards, distance) {
                sum += irradiance * cosine;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Environment, Light, Lighting, Material, SceneBuilder};

    fn lit_floor(lights: Vec<Light>) -> Tracer {
        let mut builder = SceneBuilder::default();
        let white = builder.material(Material::diffuse(Vec3::ONE));
        let corner = Vec3::new(-50.0, 0.0, -50.0);
        builder.parallelogram(corner, Vec3::Z * 100.0, Vec3::X * 100.0, Vec2::ONE, white);
        builder.cuboid(Vec3::new(4.0, 1.0, -1.0), Vec3::new(6.0, 2.0, 1.0), white);
        let lighting =
            Lighting { lights, ambient: Vec3::ZERO, environment: Environment::Sky(Vec3::new(0.2, 0.4, 0.8)) };
        Tracer::new(builder.build("floor", lighting).unwrap())
    }

    #[test]
    fn point_light_follows_the_cosine_and_inverse_square_laws() {
        let tracer =
            lit_floor(vec![Light::Point { position: Vec3::new(0.0, 3.0, 0.0), intensity: Vec3::splat(9.0 * PI) }]);
        for x in [0.0f32, 1.0, 2.5] {
            let traced = tracer.trace(Vec3::new(x, 0.5, 0.1), Vec3::new(0.0, -2.0, 0.0));
            let r2 = f64::from(x * x) + 9.0 + 0.01;
            let exact = 9.0 / r2 * 3.0 / r2.sqrt();
            assert!((f64::from(traced.radiance.x) - exact).abs() < 1e-4 * exact, "{x}: {traced:?} {exact}");
            assert!((traced.distance - 0.25).abs() < 1e-6);
        }
    }

    #[test]
    fn a_box_casts_a_shadow_of_the_sun() {
        let tracer = lit_floor(vec![Light::Sun { towards: Vec3::Y, irradiance: Vec3::splat(PI) }]);
        let below = |x: f32| tracer.trace(Vec3::new(x, 0.5, 0.0), Vec3::NEG_Y).radiance.x;
        assert_eq!((below(3.9), below(5.0), below(6.1)), (1.0, 0.0, 1.0));
    }

    #[test]
    fn rays_that_leave_see_the_sky_and_broken_rays_hit_nothing() {
        let tracer = lit_floor(vec![]);
        let up = tracer.trace(Vec3::Y, Vec3::Y);
        assert_eq!(up, Traced { radiance: Vec3::new(0.2, 0.4, 0.8), distance: f32::INFINITY });
        assert_eq!(tracer.distance(Vec3::Y, Vec3::ZERO), None);
        assert_eq!(tracer.distance(Vec3::NAN, Vec3::Y), None);
        assert_eq!(tracer.distance(Vec3::Y, Vec3::new(f32::INFINITY, 0.0, 0.0)), None);
        assert_eq!(tracer.distance(Vec3::Y, Vec3::NEG_Y), Some(1.0));
    }
}

//! The ray tracer.

use glam::Vec3;

use crate::bvh::{Hit, TriangleBvh};
use crate::emitters::Emitters;
use crate::material::{Material, Scattering};
use crate::quality::{Estimate, Illumination, Quality};
use crate::random::Random;
use crate::rounded::RoundedPoint;
use crate::scene::Scene;
use crate::surface_point::{SurfacePoint, uv_on};

/// What a ray met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traced {
    /// Radiance that arrives at the ray's origin, linear RGB.
    pub radiance: Vec3,
    /// Ray parameter of the hit; infinite if the ray left the scene.
    pub distance: f32,
}

/// A scene ready to be traced. World space, shared between threads.
///
/// An answer is a function of scene, quality and ray alone: neither the order of rays nor the number of threads matters. The
/// same scene in a unit that is a power of two larger or smaller gives the same bits.
pub struct Tracer {
    scene: Scene,
    bvh: TriangleBvh,
    quality: Quality,
    emitters: Emitters,
    /// Whether any material has holes.
    has_holes: bool,
}

impl Tracer {
    /// Builds the acceleration structure: about a second per million triangles. Traces direct light, one sample a ray.
    #[must_use]
    pub fn new(scene: Scene) -> Self {
        let bvh = TriangleBvh::new(scene.triangles().iter().map(|(corners, _)| corners.map(|v| v.position)));
        let quality = Quality::default();
        let emitters = emitters(&scene, &quality);
        let has_holes = scene.materials().iter().any(|material| material.alpha_cutoff.is_some());
        Self { scene, bvh, quality, emitters, has_holes }
    }

    /// The same with another quality.
    #[must_use]
    pub fn with_quality(mut self, quality: Quality) -> Self {
        self.set_quality(quality);
        self
    }

    /// Traces with another quality from now on.
    pub fn set_quality(&mut self, quality: Quality) {
        self.emitters = emitters(&self.scene, &quality);
        self.quality = quality;
    }

    /// Whether another seed may give another answer: with all light, light that has an extent, or glass.
    #[must_use]
    pub fn is_random(&self) -> bool {
        let glass = |material: &Material| matches!(material.scattering, Scattering::Glass { .. });
        let direct = self.quality.illumination == Illumination::Direct;
        !direct || !self.emitters.is_empty() || self.scene.materials().iter().any(glass)
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What is traced, and how well.
    #[must_use]
    pub fn quality(&self) -> &Quality {
        &self.quality
    }

    pub(crate) fn emitters(&self) -> &Emitters {
        &self.emitters
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
        self.nearest(origin, direction, None).map(|hit| hit.t)
    }

    /// Whether anything is a perfect mirror, glass and smooth metal apart.
    #[must_use]
    pub fn has_mirrors(&self) -> bool {
        self.scene.materials().iter().any(|material| matches!(material.scattering, Scattering::Mirror))
    }

    /// The colour of the perfect mirror that a ray meets first, the share of light that it reflects; `None` if it meets something else.
    #[must_use]
    pub fn mirror(&self, origin: Vec3, direction: Vec3) -> Option<Vec3> {
        let hit = self.nearest(origin, direction, None)?;
        let material = self.scene.material(hit.triangle);
        let uv = uv_on(&self.scene.triangles()[hit.triangle].0, hit.shares);
        matches!(material.scattering, Scattering::Mirror).then(|| material.base.color(uv))
    }

    /// Radiance along a ray: the mean of all samples.
    #[must_use]
    pub fn trace(&self, origin: Vec3, direction: Vec3) -> Traced {
        let Estimate { radiance, distance, .. } = self.estimate(origin, direction);
        Traced { radiance, distance }
    }

    /// Radiance along a ray, and an upper bound of its standard error.
    #[must_use]
    pub fn estimate(&self, origin: Vec3, direction: Vec3) -> Estimate {
        let Some(towards) = lf_math::normalized(direction) else {
            return Estimate::of(std::iter::once(Vec3::ZERO), f32::INFINITY);
        };
        let first = self.nearest(origin, direction, None);
        let random = self.random(origin, towards);
        let sample = |number| self.follow(first, towards, &mut random.of_sample(number));
        let samples = (0..self.quality.samples.max(1)).map(sample);
        Estimate::of(samples, first.map_or(f32::INFINITY, |hit| hit.t))
    }

    /// The random numbers of a ray. Adding zero makes −0 and 0 the same.
    fn random(&self, origin: Vec3, towards: Vec3) -> Random {
        let places = [origin * self.bvh.scale(), towards].map(|v| (v + 0.0).to_array().map(f32::to_bits));
        let words = places.into_iter().flatten().map(u64::from);
        Random::of(std::iter::once(self.quality.seed).chain(words))
    }

    /// The nearest hit of a ray, which may start on a surface.
    pub(crate) fn nearest(&self, origin: Vec3, direction: Vec3, from: Option<&RoundedPoint>) -> Option<Hit> {
        let stops = |triangle, shares| !self.may_hold(triangle, from) && self.stops(triangle, shares);
        self.bvh.nearest(origin, direction, stops)
    }

    /// Whether anything is between a lit point and the farthest point in a direction, which may be one of a surface.
    pub(crate) fn shadowed(
        &self,
        lit: &SurfacePoint,
        direction: Vec3,
        farthest: f32,
        end: Option<&RoundedPoint>,
    ) -> bool {
        let at_an_end = |triangle| self.may_hold(triangle, Some(&lit.place)) || self.may_hold(triangle, end);
        let stops = |triangle, shares| !at_an_end(triangle) && self.stops(triangle, shares);
        self.bvh.occluded(lit.launch(direction), direction, farthest, stops)
    }

    /// Whether a ray's end may lie in a triangle.
    fn may_hold(&self, triangle: usize, end: Option<&RoundedPoint>) -> bool {
        end.is_some_and(|end| end.may_lie_in(self.scene.triangles()[triangle].0.map(|v| v.position)))
    }

    /// Whether a point of a triangle is none of its material's holes.
    fn stops(&self, triangle: usize, shares: Vec3) -> bool {
        let is_hole = || self.scene.material(triangle).is_hole(uv_on(&self.scene.triangles()[triangle].0, shares));
        !(self.has_holes && is_hole())
    }
}

/// What has to be looked for; the ambient term, if there is one, stands for the environment.
fn emitters(scene: &Scene, quality: &Quality) -> Emitters {
    let ambient = quality.illumination == Illumination::Direct && scene.lighting().ambient != Vec3::ZERO;
    Emitters::new(scene, !ambient)
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use glam::Vec2;

    use super::*;
    use crate::{Environment, Light, Lighting, Material, SceneBuilder};

    fn lit_floor(lights: Vec<Light>, environment: Environment) -> Tracer {
        let mut builder = SceneBuilder::default();
        let white = builder.material(Material::diffuse(Vec3::ONE));
        let corner = Vec3::new(-50.0, 0.0, -50.0);
        builder.parallelogram(corner, Vec3::Z * 100.0, Vec3::X * 100.0, Vec2::ONE, white);
        builder.cuboid(Vec3::new(4.0, 1.0, -1.0), Vec3::new(6.0, 2.0, 1.0), white);
        let lighting = Lighting { lights, ambient: Vec3::ZERO, environment };
        Tracer::new(builder.build("floor", lighting).unwrap())
    }

    #[test]
    fn point_light_follows_the_cosine_and_inverse_square_laws() {
        let lamp = Light::Point { position: Vec3::new(0.0, 3.0, 0.0), intensity: Vec3::splat(9.0 * PI) };
        let tracer = lit_floor(vec![lamp], Environment::BLACK);
        for x in [0.0f32, 1.0, 2.5] {
            let traced = tracer.trace(Vec3::new(x, 0.5, 0.1), Vec3::new(0.0, -2.0, 0.0));
            let r2 = f64::from(x * x) + 9.0 + 0.01;
            let exact = 9.0 / r2 * 3.0 / r2.sqrt();
            assert!((f64::from(traced.radiance.x) - exact).abs() < 1e-4 * exact, "{x}: {traced:?} {exact}");
            assert!((traced.distance - 0.25).abs() < 1e-6);
        }
    }

    #[test]
    fn randomness_is_known() {
        let lamp = Light::Point { position: Vec3::Y, intensity: Vec3::ONE };
        let mut tracer = lit_floor(vec![lamp], Environment::BLACK);
        assert!(!tracer.is_random());
        let quality = Quality { illumination: Illumination::Global { max_bounces: 1 }, ..Quality::default() };
        tracer.set_quality(quality);
        assert!(tracer.is_random() && *tracer.quality() == quality);
        assert!(Tracer::new(crate::mirror_box::scene()).is_random());
        assert!(!Tracer::new(crate::museum::scene()).is_random());
    }

    #[test]
    fn a_box_casts_a_shadow_of_the_sun() {
        let tracer = lit_floor(vec![Light::Sun { towards: Vec3::Y, irradiance: Vec3::splat(PI) }], Environment::BLACK);
        let below = |x: f32| tracer.trace(Vec3::new(x, 0.5, 0.0), Vec3::NEG_Y).radiance.x;
        assert_eq!((below(3.9), below(5.0), below(6.1)), (1.0, 0.0, 1.0));
    }

    #[test]
    fn rays_that_leave_see_the_sky_and_broken_rays_hit_nothing() {
        let tracer = lit_floor(vec![], Environment::Sky(Vec3::new(0.2, 0.4, 0.8)));
        let up = tracer.trace(Vec3::Y, Vec3::Y);
        assert_eq!(up, Traced { radiance: Vec3::new(0.2, 0.4, 0.8), distance: f32::INFINITY });
        assert_eq!(tracer.distance(Vec3::Y, Vec3::ZERO), None);
        assert_eq!(tracer.distance(Vec3::NAN, Vec3::Y), None);
        assert_eq!(tracer.distance(Vec3::Y, Vec3::new(f32::INFINITY, 0.0, 0.0)), None);
        assert_eq!(tracer.distance(Vec3::Y, Vec3::NEG_Y), Some(1.0));
    }
}

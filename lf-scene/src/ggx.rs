//! glTF 2.0's metallic-roughness model (Appendix B of its specification).
//!
//! A dielectric mixes Lambert and GGX by Schlick's reflectance of 0.04, a metal is GGX with Schlick's reflectance of the base
//! colour; `metallic` mixes the two. Masking and shadowing are Smith's, separable. Light that is reflected between
//! facets is lost, as in the specification: a rough white metal is darker than its surroundings. And as there, a white dielectric
//! seen at a grazing angle returns more than it gets: Lambert's part is reduced by the half vector, not by the viewer.
//!
//! Directions are picked by the cosine or by the normals that the viewer sees (Heitz: Sampling the GGX Distribution of Visible
//! Normals, JCGT 2018).

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use crate::bsdf::{Evaluated, cosine_hemisphere, schlick};
use crate::random::Random;

/// Roughness below this is treated as this. The peak of GGX is about α = roughness² wide in slope; half vectors are known to
/// about 1e-7, so that at 1e-3 its density has four good digits. Smooth metals become mirrors instead.
pub(crate) const MIN_ROUGHNESS: f32 = 0.03;

/// Reflectance of a dielectric at normal incidence (index of refraction 1.5).
const DIELECTRIC: f32 = 0.04;

/// The model at one point of a surface, in the local frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Glossy {
    base: Vec3,
    metallic: f32,
    /// GGX's width: roughness squared.
    alpha: f32,
}

impl Glossy {
    /// `metallic` and `roughness` are brought into 0 … 1.
    pub(crate) fn new(base: Vec3, metallic: f32, roughness: f32) -> Self {
        let roughness = roughness.clamp(MIN_ROUGHNESS, 1.0);
        Self { base, metallic: metallic.clamp(0.0, 1.0), alpha: roughness * roughness }
    }

    /// BSDF times cosine, and the density of [`Self::sample`]; both directions above the surface.
    pub(crate) fn evaluate(&self, viewer: Vec3, light: Vec3) -> Evaluated {
        let half = lf_math::normalized(viewer + light).unwrap_or(Vec3::Z);
        let cosine = viewer.dot(half);
        let facets = self.facets(half);
        // The cosine of the viewer cancels: a viewer in the plane of the surface has one of 0.
        let by_facets = 0.25 * facets * self.visible_by_cosine(viewer);
        let specular = by_facets * self.visible_by_cosine(light) * light.z;
        let diffuse = self.base * (light.z / PI);
        let dielectric = diffuse.lerp(Vec3::splat(specular), schlick(Vec3::splat(DIELECTRIC), cosine).x);
        let metal = specular * schlick(self.base, cosine);
        let share = self.facet_share(viewer);
        let pdf = share * by_facets + (1.0 - share) * light.z / PI;
        Evaluated { value: dielectric.lerp(metal, self.metallic), pdf }
    }

    /// A direction, possibly below the surface.
    pub(crate) fn sample(&self, viewer: Vec3, random: &mut Random) -> Vec3 {
        let Vec2 { x, y } = random.pair();
        let share = self.facet_share(viewer);
        // What is left of the number that chose.
        if x >= share {
            return cosine_hemisphere(Vec2::new((x - share) / (1.0 - share), y));
        }
        let half = self.visible_normal(viewer, Vec2::new(x / share, y));
        2.0 * viewer.dot(half) * half - viewer
    }

    /// How often a direction is picked by facets: about their share of the reflected light.
    fn facet_share(&self, viewer: Vec3) -> f32 {
        let shine = schlick(Vec3::splat(DIELECTRIC).lerp(self.base, self.metallic), viewer.z).max_element();
        let diffuse = (1.0 - self.metallic) * self.base.max_element();
        // Without Lambert's part there is nothing that facets do not reach.
        if diffuse > 0.0 { (shine / (shine + diffuse)).clamp(0.1, 0.9) } else { 1.0 }
    }

    /// GGX's density of facet normals, in slopes: near the peak 1 − z² would lose all digits.
    fn facets(&self, half: Vec3) -> f32 {
        let a2 = self.alpha * self.alpha;
        let stretched = (half.x * half.x + half.y * half.y) / a2 + half.z * half.z;
        1.0 / (PI * a2 * stretched * stretched)
    }

    /// Smith's share of the facets that are seen from a direction, over its cosine.
    fn visible_by_cosine(&self, direction: Vec3) -> f32 {
        let a2 = self.alpha * self.alpha;
        2.0 / (direction.z + (a2 + (1.0 - a2) * direction.z * direction.z).sqrt())
    }

    /// A facet normal that the viewer sees (Heitz, Appendix A).
    fn visible_normal(&self, viewer: Vec3, uniform: Vec2) -> Vec3 {
        let stretch = Vec3::new(self.alpha, self.alpha, 1.0);
        let seen = (viewer * stretch).normalize();
        let across = lf_math::normalized(Vec3::new(-seen.y, seen.x, 0.0)).unwrap_or(Vec3::X);
        let (sin, cos) = (TAU * uniform.y).sin_cos();
        let (x, side) = (uniform.x.sqrt() * cos, uniform.x.sqrt() * sin);
        let s = 0.5 * (1.0 + seen.z);
        let y = (1.0 - s) * (1.0 - x * x).max(0.0).sqrt() + s * side;
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        let normal = x * across + y * seen.cross(across) + z * seen;
        (normal.max(Vec3::new(f32::NEG_INFINITY, f32::NEG_INFINITY, 0.0)) * stretch).normalize()
    }
}

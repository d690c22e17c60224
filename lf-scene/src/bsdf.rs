//! How a point of a surface scatters light.
//!
//! Directions are unit vectors in the local frame whose +Z is the shading normal; the viewer is at z > 0.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use crate::ggx::Glossy;
use crate::random::Random;

/// The bidirectional scattering distribution function (BSDF) of one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Bsdf {
    /// Lambert's law with an albedo.
    Lambert(Vec3),
    /// GGX over Lambert.
    Glossy(Glossy),
    /// Perfectly smooth: only one direction, or two, gets light.
    Smooth(Smooth),
}

/// Surfaces that scatter to single directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Smooth {
    /// Reflects everything, times a colour.
    Mirror(Vec3),
    /// Reflects by Schlick's approximation from a colour at normal incidence.
    Metal(Vec3),
    /// The surface of a solid.
    Glass {
        /// Factor of what passes.
        tint: Vec3,
        /// Index of refraction on the other side over that on the viewer's.
        eta: f32,
    },
    /// Two parallel surfaces with no distance, light going to and fro in between.
    Pane {
        /// Factor of what passes.
        tint: Vec3,
        /// Index of refraction.
        ior: f32,
    },
}

/// A value of a BSDF that is not [`Smooth`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Evaluated {
    /// BSDF times cosine, 1/sr.
    pub(crate) value: Vec3,
    /// How densely [`Bsdf::sample`] picks the direction, 1/sr.
    pub(crate) pdf: f32,
}

/// A direction picked to look for light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scattered {
    /// Where light may come from.
    pub(crate) towards: Vec3,
    /// BSDF times cosine over density; for single directions the share of the radiance that reaches the viewer.
    pub(crate) weight: Vec3,
    /// Density, 1/sr; `None` for a single direction.
    pub(crate) pdf: Option<f32>,
    /// Index of refraction on the side of the direction over that on the viewer's.
    pub(crate) eta: f32,
}

impl Bsdf {
    /// BSDF and density for light from a direction; `None` where both are zero.
    pub(crate) fn evaluate(&self, viewer: Vec3, light: Vec3) -> Option<Evaluated> {
        if light.z <= 0.0 {
            return None;
        }
        match self {
            Self::Lambert(albedo) => Some(Evaluated { value: albedo * (light.z / PI), pdf: light.z / PI }),
            Self::Glossy(glossy) => Some(glossy.evaluate(viewer, light)),
            Self::Smooth(_) => None,
        }
    }

    /// Picks a direction, more often one that matters.
    pub(crate) fn sample(&self, viewer: Vec3, random: &mut Random) -> Option<Scattered> {
        let towards = match self {
            Self::Lambert(_) => cosine_hemisphere(Vec2::new(random.uniform(), random.uniform())),
            Self::Glossy(glossy) => glossy.sample(viewer, random),
            Self::Smooth(smooth) => return Some(smooth.scatter(viewer, random.uniform())),
        };
        let Evaluated { value, pdf } = self.evaluate(viewer, towards).filter(|evaluated| evaluated.pdf > 0.0)?;
        Some(Scattered { towards, weight: value / pdf, pdf: Some(pdf), eta: 1.0 })
    }
}

impl Smooth {
    /// The direction, or one of the two: reflected light if `uniform`, in 0 … 1, is below its share.
    pub(crate) fn scatter(&self, viewer: Vec3, uniform: f32) -> Scattered {
        let reflected = |weight: Vec3| {
            let towards = Vec3::new(-viewer.x, -viewer.y, viewer.z);
            Scattered { towards, weight, pdf: None, eta: 1.0 }
        };
        match *self {
            Self::Mirror(color) => reflected(color),
            Self::Metal(color) => reflected(schlick(color, viewer.z)),
            Self::Pane { tint, ior } => {
                let (once, _) = fresnel(viewer.z, ior);
                if uniform < 2.0 * once / (1.0 + once) {
                    return reflected(Vec3::ONE);
                }
                Scattered { towards: -viewer, weight: tint, pdf: None, eta: 1.0 }
            }
            Self::Glass { tint, eta } => {
                let (share, cosine) = fresnel(viewer.z, eta);
                if uniform < share {
                    return reflected(Vec3::ONE);
                }
                let towards = Vec3::new(-viewer.x / eta, -viewer.y / eta, -cosine);
                // Radiance that leaves the denser medium spreads over a larger solid angle.
                Scattered { towards, weight: tint / (eta * eta), pdf: None, eta }
            }
        }
    }
}

/// Reflected share of unpolarised light, and the cosine of the refracted direction (0 if all is reflected). `eta` is the index
/// of refraction on the other side over that on the side of the light.
pub(crate) fn fresnel(cosine: f32, eta: f32) -> (f32, f32) {
    let sine2 = (1.0 - cosine * cosine).max(0.0) / (eta * eta);
    if sine2 >= 1.0 {
        return (1.0, 0.0);
    }
    let inside = (1.0 - sine2).sqrt();
    let perpendicular = (cosine - eta * inside) / (cosine + eta * inside);
    let parallel = (eta * cosine - inside) / (eta * cosine + inside);
    (0.5 * (perpendicular * perpendicular + parallel * parallel), inside)
}

/// Schlick's approximation of Fresnel reflectance from that at normal incidence.
pub(crate) fn schlick(normal: Vec3, cosine: f32) -> Vec3 {
    normal + (1.0 - normal) * (1.0 - cosine.clamp(0.0, 1.0)).powi(5)
}

/// A direction with density cosine/π from a point of the unit square (Malley's method).
pub(crate) fn cosine_hemisphere(uniform: Vec2) -> Vec3 {
    let (sin, cos) = (TAU * uniform.y).sin_cos();
    let radius = uniform.x.sqrt();
    Vec3::new(radius * cos, radius * sin, (1.0 - uniform.x).sqrt())
}

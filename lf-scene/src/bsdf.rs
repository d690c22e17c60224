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
            Self::Lambert(_) => cosine_hemisphere(random.pair()),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chi_square::assert_picks;

    /// To the frame of the test, whose bins are narrow along +Y.
    fn upright(v: Vec3) -> Vec3 {
        Vec3::new(v.x, v.z, v.y)
    }

    fn models() -> Vec<Bsdf> {
        let base = Vec3::new(0.9, 0.5, 0.1);
        let glossy = [(1.0, 1.0), (1.0, 0.6), (1.0, 0.4), (0.0, 0.5), (0.5, 0.7), (0.0, 1.0)];
        let glossy = glossy.map(|(metallic, roughness)| Bsdf::Glossy(Glossy::new(base, metallic, roughness)));
        [vec![Bsdf::Lambert(base)], glossy.to_vec()].concat()
    }

    fn viewers() -> [Vec3; 3] {
        [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.5, 0.8, 0.2).normalize()]
    }

    #[test]
    fn directions_are_picked_as_densely_as_told() {
        for (bsdf, viewer) in models().iter().flat_map(|bsdf| viewers().map(|viewer| (bsdf, viewer))) {
            let mut random = Random::of([11]);
            let sample = || bsdf.sample(viewer, &mut random).map(|scattered| upright(scattered.towards));
            let pdf = |l: Vec3| bsdf.evaluate(viewer, upright(l)).map_or(0.0, |evaluated| evaluated.pdf);
            let total = assert_picks(&format!("{bsdf:?} from {viewer}"), sample, pdf);
            // Facets may reflect into the surface.
            let least = if matches!(bsdf, Bsdf::Lambert(_)) { 0.999 } else { 0.45 };
            assert!((least..1.001).contains(&total), "{bsdf:?} from {viewer}: {total}");
        }
    }

    #[test]
    fn scattering_is_reciprocal() {
        let mut random = Random::of([3]);
        let mut direction = || cosine_hemisphere(random.pair());
        for bsdf in models() {
            for _ in 0..1000 {
                let (a, b) = (direction(), direction());
                let forth = bsdf.evaluate(a, b).unwrap().value / b.z;
                let back = bsdf.evaluate(b, a).unwrap().value / a.z;
                assert!((forth - back).length() <= 1e-3 * forth.length(), "{bsdf:?}, {a}, {b}: {forth} {back}");
            }
        }
    }

    /// No metal returns more light than it gets, however narrow its peak; a dielectric at most its reflection more, which is how
    /// glTF's model adds the two.
    #[test]
    fn no_light_is_made() {
        for roughness in [0.0, 0.03, 0.05, 0.1, 0.3, 1.0] {
            for metallic in [0.0, 0.5, 1.0] {
                let bsdf = Bsdf::Glossy(Glossy::new(Vec3::ONE, metallic, roughness));
                for viewer in viewers() {
                    let mut random = Random::of([5]);
                    let sum: Vec3 = (0..20_000)
                        .filter_map(|_| bsdf.sample(viewer, &mut random))
                        .map(|scattered| scattered.weight)
                        .sum();
                    let albedo = sum / 20_000.0;
                    let most = 1.01 + (1.0 - metallic) * schlick(Vec3::splat(0.04), viewer.z).x;
                    assert!(
                        albedo.max_element() < most,
                        "metallic {metallic}, roughness {roughness}, {viewer}: {albedo}"
                    );
                    assert!(
                        albedo.min_element() > 0.25,
                        "metallic {metallic}, roughness {roughness}, {viewer}: {albedo}"
                    );
                }
            }
        }
    }

    /// Shading normals may lie at right angles to the viewer.
    #[test]
    fn grazing_viewers_have_numbers() {
        let mut random = Random::of([7]);
        for bsdf in models() {
            for _ in 0..1000 {
                let light = cosine_hemisphere(Vec2::new(random.uniform(), random.uniform()));
                let grazing = bsdf.evaluate(Vec3::X, light).unwrap();
                let almost = bsdf.evaluate(Vec3::new(1.0, 0.0, 1e-6), light).unwrap();
                assert!(grazing.value.is_finite() && grazing.pdf.is_finite(), "{bsdf:?}, {light}: {grazing:?}");
                let (apart, pdf) = ((grazing.value - almost.value).length(), (grazing.pdf - almost.pdf).abs());
                assert!(apart <= 1e-3 * almost.value.length() && pdf <= 1e-3 * almost.pdf, "{bsdf:?}, {light}");
                let sample = bsdf.sample(Vec3::X, &mut random);
                assert!(sample.is_none_or(|s| s.towards.is_finite() && s.weight.is_finite()), "{bsdf:?}: {sample:?}");
            }
        }
    }

    /// Known values: normal incidence, Brewster's angle, the critical angle.
    #[test]
    fn fresnel_at_special_angles() {
        assert!((fresnel(1.0, 1.5).0 - 0.04).abs() < 1e-6);
        let brewster = (1.0f32 / (1.0 + 1.5 * 1.5)).sqrt();
        let (share, inside) = fresnel(brewster, 1.5);
        // Only light polarised across the plane is reflected, ((n² − 1)/(n² + 1))² of it.
        assert!((share - 0.5 * (1.25f32 / 3.25).powi(2)).abs() < 1e-6);
        // Reflected and refracted light are at right angles.
        assert!((inside - (1.0 - brewster * brewster).sqrt()).abs() < 1e-6);
        assert_eq!(fresnel(0.74, 1.0 / 1.5), (1.0, 0.0));
        assert!(fresnel(0.75, 1.0 / 1.5).0 < 1.0);
        assert_eq!(fresnel(0.0, 1.5).0, 1.0);
    }
}

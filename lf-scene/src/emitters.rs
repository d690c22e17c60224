//! Picking light with extent: glowing triangles and the environment.

use glam::{DVec3, Vec3};

use crate::bvh::plane_normal;
use crate::distribution::Distribution;
use crate::environment::Environment;
use crate::material::luminance;
use crate::random::Random;
use crate::rounded::RoundedPoint;
use crate::scene::Scene;
use crate::surface_point::{SurfacePoint, uv_on};

/// How often light is looked for where. The environment and the glowing triangles get half of the picks each, if there are
/// both; a triangle in proportion to its area times the mean luminance of its material; a point on it uniformly.
pub(crate) struct Emitters {
    /// Share of the environment.
    environment: f32,
    /// Numbers of the triangles that glow, and how often each is chosen.
    triangles: Vec<usize>,
    choice: Option<Distribution>,
    /// How densely points are picked on triangles of each material, 1/m².
    density: Vec<f32>,
}

/// A place that may send light.
pub(crate) struct Place {
    /// Unit vector from the lit point.
    pub(crate) towards: Vec3,
    /// Radiance, if nothing is in between.
    pub(crate) radiance: Vec3,
    /// How densely the direction is picked, 1/sr.
    pub(crate) pdf: f32,
    /// The point, and where a ray to it may end; `None` is infinitely far.
    pub(crate) point: Option<(RoundedPoint, Vec3)>,
}

impl Emitters {
    /// All that glows, and the environment if asked for.
    pub(crate) fn new(scene: &Scene, with_environment: bool) -> Self {
        let mean: Vec<_> = scene.materials().iter().map(|m| f64::from(luminance(m.emission.mean()))).collect();
        let glow = |i: usize| mean[scene.triangles()[i].1 as usize] * area(scene, i);
        let triangles: Vec<_> = (0..scene.triangles().len()).filter(|&i| glow(i) > 0.0).collect();
        let choice = Distribution::new(triangles.iter().map(|&i| glow(i)));
        let environment = match (with_environment && scene.lighting().environment.shines(), &choice) {
            (false, _) => 0.0,
            (true, Some(_)) => 0.5,
            (true, None) => 1.0,
        };
        let total = choice.as_ref().map_or(f64::INFINITY, Distribution::total);
        let density = mean.iter().map(|mean| ((1.0 - f64::from(environment)) * mean / total) as f32).collect();
        Self { environment, triangles, choice, density }
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.environment == 0.0 && self.choice.is_none()
    }

    /// Whether the environment is among them.
    pub(crate) fn has_environment(&self) -> bool {
        self.environment > 0.0
    }

    /// How densely [`Self::pick`] picks the direction to a point of a surface that is met at a distance, 1/sr.
    pub(crate) fn pdf_of_surface(&self, point: &SurfacePoint, distance: f32) -> f32 {
        let density = self.density[point.material_number as usize];
        density * distance * distance / point.cosine_to_viewer()
    }

    /// How densely [`Self::pick`] picks a unit direction into the environment, 1/sr.
    pub(crate) fn pdf_of_environment(&self, environment: &Environment, direction: Vec3) -> f32 {
        self.environment * environment.pdf(direction)
    }

    /// A place that may light a point.
    pub(crate) fn pick(&self, scene: &Scene, lit: Vec3, random: &mut Random) -> Option<Place> {
        // Each choice goes on with what is left of the number that made the one before.
        let ([x, y], share) = (random.fine(), f64::from(self.environment));
        if x < share {
            return self.pick_direction(&scene.lighting().environment, [x / share, y]);
        }
        let (number, x) = self.choice.as_ref()?.choose((x - share) / (1.0 - share));
        self.pick_point(scene, self.triangles[number], lit, [x, y])
    }

    fn pick_direction(&self, environment: &Environment, uniform: [f64; 2]) -> Option<Place> {
        let (towards, pdf) = environment.sample(uniform)?;
        Some(Place { towards, radiance: environment.towards(towards), pdf: self.environment * pdf, point: None })
    }

    fn pick_point(&self, scene: &Scene, triangle: usize, lit: Vec3, uniform: [f64; 2]) -> Option<Place> {
        let (corners, material) = &scene.triangles()[triangle];
        let shares = uniform_shares(uniform);
        let (uv, positions) = (uv_on(corners, shares), corners.map(|v| v.position));
        let surface = scene.material(triangle);
        if surface.is_hole(uv) {
            return None;
        }
        let point = RoundedPoint::new(positions, shares);
        let (normal, to) = (plane_normal(positions), point.position - lit);
        let (distance, towards) = (to.length(), lf_math::normalized(to)?);
        let cosine = -normal.dot(towards);
        if cosine == 0.0 || (cosine < 0.0 && !surface.double_sided) {
            return None;
        }
        let pdf = self.density[*material as usize] * distance * distance / cosine.abs();
        let end = point.lifted(if cosine < 0.0 { -normal } else { normal });
        Some(Place { towards, radiance: surface.emission.color(uv), pdf, point: Some((point, end)) })
    }
}

/// Shares of a triangle's corners for a point of the unit square, evenly (Heitz: A Low-Distortion Map Between Triangle and
/// Square, 2019).
fn uniform_shares([x, y]: [f64; 2]) -> Vec3 {
    let (first, second) = if y > x { (0.5 * x, y - 0.5 * x) } else { (x - 0.5 * y, 0.5 * y) };
    DVec3::new(1.0 - first - second, first, second).as_vec3()
}

/// In `f64`, so that triangles of a micrometre have an area too.
fn area(scene: &Scene, triangle: usize) -> f64 {
    let [a, b, c]: [DVec3; 3] = scene.triangles()[triangle].0.map(|v| v.position.as_dvec3());
    0.5 * (b - a).cross(c - a).length()
}

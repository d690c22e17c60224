//! Following light backwards.
//!
//! Path tracing (Kajiya 1986) with next-event estimation: at each point that is not smooth every light without extent
//! is looked at, and one place on the glowing triangles or in the environment. Such places are also met by chance, by rays picked
//! by the BSDF; the power heuristic (Veach 1997, §9.2.4) weighs the two. Paths end by Russian roulette, which keeps the mean.

use std::f32::consts::PI;

use glam::Vec3;

use crate::bsdf::Scattered;
use crate::bvh::Hit;
use crate::emitters::Place;
use crate::light::Illuminant;
use crate::quality::Illumination;
use crate::random::Random;
use crate::surface_point::SurfacePoint;
use crate::tracer::Tracer;

/// How many smooth surfaces in a row are followed where only direct light is traced.
const SMOOTH_LIMIT: u32 = 16;
/// Paths of this many bounces and more may end by chance.
const ROULETTE_FROM: u32 = 5;
/// Even light paths end with this chance less than 1: between white walls they would else go on for ever.
const MAX_SURVIVAL: f32 = 0.95;
/// Shadow rays to a light without extent stop this share short of it: it may hang in the plane of a ceiling.
const SHORT_OF_LIGHT: f32 = 1.0 - 1e-4;

/// A path on its way from the eye.
struct Path {
    /// Share of the radiance at the path's end that reaches the eye.
    throughput: Vec3,
    /// Density with which the last direction was picked; `None` if it was the only one.
    pdf: Option<f32>,
    /// Index of refraction where the path is, over that where it began.
    eta: f32,
}

impl Tracer {
    /// One sample of the radiance along a ray of a unit direction whose first hit is known.
    pub(crate) fn follow(&self, first: Option<Hit>, mut direction: Vec3, random: &mut Random) -> Vec3 {
        let direct = self.quality().illumination == Illumination::Direct;
        let mut limit = match self.quality().illumination {
            Illumination::Direct => SMOOTH_LIMIT,
            Illumination::Global { max_bounces } => max_bounces,
        };
        let mut path = Path { throughput: Vec3::ONE, pdf: None, eta: 1.0 };
        let (mut radiance, mut next, mut bounces) = (Vec3::ZERO, first, 0);
        while let Some(hit) = next {
            let point = SurfacePoint::new(self.scene(), &hit, direction);
            radiance += path.throughput * self.glow(&point, hit.t, path.pdf);
            if bounces == limit {
                return radiance;
            }
            if !point.is_smooth() {
                radiance += path.throughput * self.direct_light(&point, random);
                if direct {
                    radiance += path.throughput * self.ambient(&point);
                    limit = bounces + 1;
                }
            }
            bounces += 1;
            let worthwhile = bounces < limit || point.is_smooth() || !self.emitters().is_empty();
            let Some(scattered) = worthwhile.then(|| point.scatter(random)).flatten() else { return radiance };
            if !path.go_on(&scattered) || (!direct && bounces >= ROULETTE_FROM && !path.survives(random)) {
                return radiance;
            }
            direction = scattered.towards;
            next = self.nearest(point.launch(direction), direction, Some(&point.place));
        }
        radiance + path.throughput * self.background(direction, path.pdf)
    }

    /// What a surface met at a distance emits, less what was found by looking for it.
    fn glow(&self, point: &SurfacePoint, distance: f32, pdf: Option<f32>) -> Vec3 {
        let emission = point.emission();
        match pdf {
            Some(pdf) if emission != Vec3::ZERO => {
                emission * heuristic(pdf, self.emitters().pdf_of_surface(point, distance))
            }
            _ => emission,
        }
    }

    /// What the environment sends along a unit direction, less what was found by looking for it.
    fn background(&self, direction: Vec3, pdf: Option<f32>) -> Vec3 {
        let environment = &self.scene().lighting().environment;
        match pdf {
            None => environment.towards(direction),
            Some(_) if !self.emitters().has_environment() => Vec3::ZERO,
            Some(pdf) => {
                let other = self.emitters().pdf_of_environment(environment, direction);
                environment.towards(direction) * heuristic(pdf, other)
            }
        }
    }

    fn ambient(&self, point: &SurfacePoint) -> Vec3 {
        point.base() / PI * self.scene().lighting().ambient_on(point.normal())
    }

    /// Radiance towards the viewer by light that comes straight from its source.
    fn direct_light(&self, point: &SurfacePoint, random: &mut Random) -> Vec3 {
        let lights = self.scene().lighting().lights.iter();
        let from_lights: Vec3 =
            lights.filter_map(|light| light.at(point.place.position)).map(|light| self.light_from(&light, point)).sum();
        if self.emitters().is_empty() {
            return from_lights;
        }
        let place = self.emitters().pick(self.scene(), point.place.position, random);
        from_lights + place.map_or(Vec3::ZERO, |place| self.light_from_place(&place, point))
    }

    fn light_from(&self, light: &Illuminant, point: &SurfacePoint) -> Vec3 {
        let Some(evaluated) = point.evaluate(light.towards) else { return Vec3::ZERO };
        let reach = light.distance * SHORT_OF_LIGHT;
        let dark = light.irradiance == Vec3::ZERO || self.shadowed(point, light.towards, reach, None);
        if dark { Vec3::ZERO } else { evaluated.value * light.irradiance }
    }

    fn light_from_place(&self, place: &Place, point: &SurfacePoint) -> Vec3 {
        let Some(evaluated) = point.evaluate(place.towards).filter(|_| place.pdf > 0.0) else { return Vec3::ZERO };
        let shadowed = match &place.point {
            None => self.shadowed(point, place.towards, f32::INFINITY, None),
            Some((target, end)) => self.shadowed(point, *end - point.launch(place.towards), 1.0, Some(target)),
        };
        if shadowed {
            return Vec3::ZERO;
        }
        evaluated.value * place.radiance * (heuristic(place.pdf, evaluated.pdf) / place.pdf)
    }
}

impl Path {
    /// Takes a direction; whether any light would come back.
    fn go_on(&mut self, scattered: &Scattered) -> bool {
        self.throughput *= scattered.weight;
        self.pdf = scattered.pdf;
        self.eta *= scattered.eta;
        self.throughput.max_element() > 0.0
    }

    /// Russian roulette: paths that survive stand for those that do not.
    fn survives(&mut self, random: &mut Random) -> bool {
        // Refraction scales radiance by 1/η² on the way in, and back on the way out.
        let survival = (self.throughput.max_element() * self.eta * self.eta).min(MAX_SURVIVAL);
        self.throughput /= survival;
        random.uniform() < survival
    }
}

/// Weight of a place found by the first of two ways that pick it with these densities, `found` being positive: the
/// power heuristic with exponent 2.
fn heuristic(found: f32, other: f32) -> f32 {
    let ratio = other / found;
    1.0 / (1.0 + ratio * ratio)
}

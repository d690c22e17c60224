//! Reflections from a few sharp distance cubes, found by a light field of depths: the method with the least error per byte here.
//!
//! The slabs of the paper answer a ray at once, but store each place of the scene many times over, and so few texels of it each time.
//! A few cubes store it sharply, but do not know which of their texels a ray asks for. Here slabs that hold nothing but
//! inverse depth, and little of that, say where the ray ends to within a bracket ([`guide_ends`]). Within it the ray meets planes that
//! the cubes show, in closed form; the cubes vote on where it ends; and the texels around that place, of all cubes, are blended
//! by how near to it on the surface they lie ([`crate::samples`]), for a vector of rays at once. Rays that end on mirrors go on
//! ([`crate::mirrors`]).

use fearless_simd::{Level, Simd, dispatch};
use glam::Vec3;
use lf_compress::{DepthGuide, GuidedCubes};
use lf_math::{Ray, normalized};

use crate::frame::{Environment, decoded, encoded};
use crate::guide::guide_ends;
use crate::lanes::{Lanes, MAX_LANES, lanes};
use crate::mirrors::{MAX_MIRRORS, MIRROR_STEPS, Mirror, START};
use crate::samples::colors;
use crate::surface::SurfaceCube;

/// The bracket reaches this share of the distance from the cell's centre beyond what the guide's texels say: the surface goes on
/// between them. Less misses surfaces seen at grazing angles, more takes steps.
const MARGIN: f32 = 0.06;
/// Where the direction from the cubes farthest apart to a point changes by less than this over the bracket (a tangent), one surface is
/// expected in it: the plane that is seen from its near end is tried at once. More is faster and passes by the rims of things.
const SHORT: f32 = 0.35;
/// So many cubes must see the place that is tried at once: two may agree on what lies behind a thing that is seen edge-on.
const WITNESSES: i32 = 3;
/// Texels of parallax between the cubes that one step of the search may cross: thinner things can be stepped over.
const STEP_TEXELS: f32 = 6.0;
/// Bounds of the number of steps.
const STEPS: [f32; 2] = [2.0, 64.0];
/// Steps where the guide's bracket holds no end.
const BLIND_STEPS: u32 = 32;
/// Times that the step in which something is hidden is halved while no place is agreed on.
const HALVINGS: u32 = 5;
/// A place is in front of what a cube sees if its relative depth is below 1 by this much: what is closer may be the rounding of depths.
const IN_FRONT: f32 = 3e-3;
/// Cubes whose relative depths of a place differ from 1 by this much in all agree on it at once.
const EXACT: f32 = 1e-3;
/// A cube sees a place if it is within this share of what it shows there; if it is in front by more, the cube sees past it.
const SEEN: f32 = 0.01;
/// A second cube that does not see the place costs no more than this: few places are seen by all.
const ALONE: f32 = 0.02;
/// At most the discord that is accepted at last: one cube must see the place well.
const DISCORD: f32 = ALONE + 5e-3;

/// Reflections from distance cubes and a guide.
#[derive(Debug, Clone)]
pub struct GuidedField {
    cubes: Vec<SurfaceCube>,
    guide: DepthGuide,
    /// The largest distance of a cube from where a ray may start.
    apart: f32,
    /// Half of the texels along an edge: those that a tangent of 1 covers.
    texels: f32,
    far: f32,
    /// Whether any cube shows a mirror.
    mirrors: bool,
    level: Level,
}

/// Where a ray ends.
struct End {
    /// Cell space.
    place: Vec3,
    /// The share of the light there that mirrors on the way leave; none if there are none.
    reflected: Option<Vec3>,
}

impl GuidedField {
    /// Reflections from these cubes, found by their guide.
    #[must_use]
    pub fn new(data: &GuidedCubes) -> Self {
        let cubes: Vec<SurfaceCube> = data.cubes().iter().map(SurfaceCube::new).collect();
        Self {
            mirrors: cubes.iter().any(SurfaceCube::has_mirrors),
            cubes,
            guide: data.guide().clone(),
            apart: data.reach(),
            texels: 0.5 * data.size() as f32,
            far: data.far(),
            level: Level::new(),
        }
    }

    /// Where a ray ends, over mirrors; none for one without a direction or an origin.
    #[inline(always)]
    fn end(&self, ray: &Ray) -> Option<End> {
        let ray = Ray { origin: ray.origin, direction: normalized(ray.direction)? };
        let place = ray.origin.is_finite().then(|| self.first_end(&ray))?;
        Some(if self.mirrors { self.over_mirrors(&ray, place) } else { End { place, reflected: None } })
    }

    /// Where a ray that first ends at a place ends over mirrors.
    fn over_mirrors(&self, ray: &Ray, mut place: Vec3) -> End {
        let (mut direction, mut reflected) = (ray.direction, None);
        for _ in 0..MAX_MIRRORS {
            let Some(mirror) = Mirror::at(place, &self.cubes, SEEN) else { break };
            let Some(ray) = mirror.reflected(place, direction) else { break };
            reflected = Some(reflected.unwrap_or(Vec3::ONE) * mirror.reflectance);
            direction = ray.direction;
            place = self.end_beyond(&ray);
        }
        End { place, reflected }
    }

    /// Where a ray that starts at a mirror ends.
    fn end_beyond(&self, ray: &Ray) -> Vec3 {
        let distance = (ray.origin - self.cubes[0].position()).length();
        let span = [START * distance, self.far.max(distance)];
        let mut search = Search { field: self, ray, seeing: 0, ahead: distance };
        ray.at(search.steps(span, MIRROR_STEPS).unwrap_or(span[1]))
    }

    /// Where a ray of unit direction first ends, cell space.
    fn first_end(&self, ray: &Ray) -> Vec3 {
        let cell = self.guide.geometry().cell();
        let leave = cell.exit(ray).unwrap_or(0.0).max(1e-3 * cell.half_extent().min_element());
        let far = self.far.max(2.0 * leave);
        let mut search = Search { field: self, ray, seeing: 0, ahead: 0.0 };
        let mut from = leave;
        if let Some([near, end]) = guide_ends(&self.guide, ray) {
            let margin = |t: f32| MARGIN * (t + leave);
            let bracket = [(near - margin(near)).clamp(leave, far), (end + margin(end)).clamp(leave, far)];
            // If its near end is not free, what the guide saw is not the first thing on the way.
            if bracket[0] < bracket[1] && search.is_free(bracket[0]) {
                if let Some(found) = search.within(bracket) {
                    return ray.at(found);
                }
                from = bracket[1];
            }
        }
        let blind = (from < far).then(|| search.steps([from, far], BLIND_STEPS)).flatten();
        ray.at(blind.unwrap_or(far))
    }
}

/// The search for a ray's end.
struct Search<'a> {
    field: &'a GuidedField,
    ray: &'a Ray,
    /// The cube that saw past the last point.
    seeing: usize,
    /// How far from the cubes the ray starts, about, if not among them.
    ahead: f32,
}

impl Search<'_> {
    /// Whether some cube sees past a point of the ray. By the nearest thing around: of several cubes one is enough to call a place free,
    /// so that things would shrink by the rounding of all.
    fn is_free(&mut self, t: f32) -> bool {
        let (place, cubes) = (self.ray.at(t), &self.field.cubes);
        let sees = |cube: usize| cubes[cube].largest_relative_depth(place) < 1.0 - IN_FRONT;
        let seeing = if sees(self.seeing) {
            Some(self.seeing)
        } else {
            (0..cubes.len()).find(|&cube| cube != self.seeing && sees(cube))
        };
        self.seeing = seeing.unwrap_or(self.seeing);
        seeing.is_some()
    }

    /// The first end in a bracket whose near end is free.
    fn within(&mut self, [near, far]: [f32; 2]) -> Option<f32> {
        let parallax = self.field.apart * (near.recip() - far.recip());
        if parallax < SHORT {
            let met = self.field.cubes[self.seeing].meets(self.ray, self.ray.at(near));
            if met > near && met < far {
                let Witnesses { discord, seeing } = self.witnesses(met);
                if discord < EXACT && seeing >= WITNESSES {
                    return Some(met);
                }
            }
        }
        self.steps([near, far], (parallax * self.field.texels / STEP_TEXELS).ceil().clamp(STEPS[0], STEPS[1]) as u32)
    }

    /// Steps even in the inverse of the distance from the cubes, as the pictures are (Umenhoffer, Patow & Szirmay-Kalos 2007).
    fn steps(&mut self, [near, far]: [f32; 2], count: u32) -> Option<f32> {
        let [first, end] = [near, far].map(|t| (t + self.ahead).recip());
        let step = (first - end) / count as f32;
        let mut last = near;
        for i in 1..=count {
            // The last of many small steps may round to beyond infinity.
            let next = (first - i as f32 * step).max(end).recip() - self.ahead;
            if !self.is_free(next)
                && let Some(found) = self.agreed([last, next])
            {
                return Some(found);
            }
            last = next;
        }
        None
    }

    /// The place in a step on which the cubes agree best; none if it is hidden from all, but nothing is there.
    fn agreed(&mut self, [mut free, mut hidden]: [f32; 2]) -> Option<f32> {
        let slack = 0.5 * (hidden - free);
        let span = [(free - slack).max(0.0), hidden + slack];
        let (mut best, mut least) = (hidden, f32::INFINITY);
        let mut tried = f32::NAN;
        for _ in 0..HALVINGS {
            // The same planes are seen from a point that has been tried.
            let cubes = if hidden == tried { &[] } else { &self.field.cubes[..] };
            tried = hidden;
            for cube in cubes {
                let met = cube.meets(self.ray, self.ray.at(hidden));
                if met >= span[0] && met <= span[1] {
                    let discord = self.witnesses(met).discord;
                    if discord < EXACT {
                        return Some(met);
                    }
                    if discord < least {
                        (best, least) = (met, discord);
                    }
                }
            }
            let middle = 2.0 / (free.recip() + hidden.recip());
            *(if self.is_free(middle) { &mut free } else { &mut hidden }) = middle;
        }
        (least < DISCORD).then_some(best)
    }

    /// What the cubes say of a point: whether the ray ends there.
    #[inline(always)]
    fn witnesses(&self, t: f32) -> Witnesses {
        let place = self.ray.at(t);
        let (mut first, mut second, mut seeing, mut past) = (f32::INFINITY, f32::INFINITY, 0, 0);
        for cube in &self.field.cubes {
            let off = cube.relative_depth(place) - 1.0;
            seeing += i32::from(off.abs() < SEEN);
            past += i32::from(off <= -SEEN);
            second = second.min(first.max(off.abs()));
            first = first.min(off.abs());
        }
        Witnesses { discord: if past > seeing { f32::INFINITY } else { first + second.min(ALONE) }, seeing }
    }
}

/// What cubes say of a point.
struct Witnesses {
    /// How far the two that come nearest to agreeing that the ray ends there are from it; infinite if more see past it than see it.
    discord: f32,
    /// How many see it.
    seeing: i32,
}

impl Environment for GuidedField {
    fn look_up(&self, ray: &Ray) -> Option<Vec3> {
        let mut answer = [None];
        self.look_up_all(std::slice::from_ref(ray), &mut answer);
        answer[0]
    }

    fn look_up_all(&self, rays: &[Ray], answers: &mut [Option<Vec3>]) {
        dispatch!(self.level, simd => look_up(simd, self, rays, answers));
    }
}

/// Answers a vector of rays after the other.
#[inline(always)]
fn look_up<S: Simd>(simd: S, field: &GuidedField, rays: &[Ray], answers: &mut [Option<Vec3>]) {
    for (rays, answers) in rays.chunks(lanes::<S>()).zip(answers.chunks_mut(lanes::<S>())) {
        // What is not a number has no colour.
        let mut places: [Lanes<f32>; 3] = [[f32::NAN; MAX_LANES]; 3];
        let mut reflected: [Option<Vec3>; MAX_LANES] = [None; MAX_LANES];
        for (lane, ray) in rays.iter().enumerate() {
            if let Some(end) = field.end(ray) {
                [places[0][lane], places[1][lane], places[2][lane]] = end.place.to_array();
                reflected[lane] = end.reflected;
            }
        }
        let (colors, known) = colors(simd, &field.cubes, &places, field.far);
        for (lane, answer) in answers.iter_mut().enumerate() {
            let color = Vec3::new(colors[0][lane], colors[1][lane], colors[2][lane]);
            let color = reflected[lane].map_or(color, |share| encoded(share * decoded(color)));
            *answer = (known >> lane & 1 == 1).then_some(color);
        }
    }
}

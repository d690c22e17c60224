//! Reflections from a few sharp distance cubes, found by a light field of depths: the method with the least error per byte here.
//!
//! The slabs of the paper answer a ray at once, but store each place of the scene many times over, and so few texels of it each time.
//! A few cubes store it sharply, but do not know which of their texels a ray asks for. Here slabs that hold nothing but
//! inverse depth, and little of that, say where the ray ends to within a bracket ([`DepthGuide`]); the cubes' own distances narrow it
//! down to a texel; all cubes that saw the place are blended, each by how near to one of its texels' middles the place falls.

use glam::Vec3;
use lf_math::{DistanceCube, GeometryError, Ray, normalized};

use crate::distance::{LitCube, span};
use crate::frame::Environment;
use crate::guide::DepthGuide;
use crate::march::{IN_FRONT, crossing};

/// The bracket reaches this share of the distance from the cell's centre beyond what the guide's texels say: the surface goes on
/// between them. Less misses surfaces seen at grazing angles, more takes steps.
const MARGIN: f32 = 0.06;
/// Texels of parallax between the cubes that one step of the search may cross: thinner things can be stepped over.
const STEP_TEXELS: f32 = 4.0;
/// Bounds of the number of steps.
const STEPS: [f32; 2] = [2.0, 64.0];
/// Steps where the guide's bracket holds no end.
const BLIND_STEPS: u32 = 32;
/// The search ends when the place moves by less than this, texels.
const PRECISION_TEXELS: f32 = 0.5;
/// A cube saw a place if its depth agrees with what the cube shows there within this share. Less loses surfaces at grazing
/// angles, more blends what is behind edges.
const AGREEMENT: f32 = 0.02;
/// Weight of a cube that did not see the place, or of one half way between texels, against 1: something must answer.
const UNSEEN: f32 = 1e-5;
const BETWEEN: f32 = 1e-3;

/// Reflections from distance cubes and a guide.
#[derive(Debug, Clone)]
pub struct GuidedField {
    cubes: Vec<LitCube>,
    guide: DepthGuide,
    /// Texels of distance per unit of inverse metres that the cubes farthest apart see a point move.
    parallax: f32,
    far: f32,
}

impl LitCube {
    /// Whether it sees past a place. By the nearest thing around: of several cubes one is enough to call a place free, so that things
    /// would shrink by the rounding of all.
    fn sees_past(&self, place: Vec3) -> bool {
        self.distances.largest_relative_depth(place - self.distances.position()) < IN_FRONT
    }
}

impl GuidedField {
    /// Reflections from these cubes, found by the guide.
    ///
    /// # Errors
    /// There must be at least one cube.
    pub fn new(cubes: Vec<DistanceCube>, guide: DepthGuide) -> Result<Self, GeometryError> {
        let sizes = cubes.iter().map(DistanceCube::depth_size);
        let texels = sizes.max().ok_or(GeometryError::ZeroCount { what: "number of cubes" })?;
        // Rays start anywhere in the cell, at most this far from a cube.
        let reach = |cube: &DistanceCube| (cube.position().abs() + guide.geometry().cell().half_extent()).length();
        let apart = cubes.iter().map(reach).fold(0.0, f32::max);
        let [_, far] = span(cubes.iter());
        Ok(Self {
            parallax: 0.5 * apart * texels as f32,
            far,
            cubes: cubes.into_iter().map(LitCube::new).collect(),
            guide,
        })
    }

    /// Where a ray of unit direction ends, cell space.
    fn end(&self, ray: &Ray) -> Vec3 {
        let cell = self.guide.geometry().cell();
        let leave = cell.exit(ray).unwrap_or(0.0).max(1e-3 * cell.half_extent().min_element());
        let far = self.far.max(2.0 * leave);
        let mut last = 0;
        let mut free = |point: Vec3| {
            let count = self.cubes.len();
            let seeing = (0..count).map(|i| (last + i) % count).find(|&i| self.cubes[i].sees_past(point));
            last = seeing.unwrap_or(last);
            seeing.is_some()
        };
        let mut from = leave;
        if let Some([near, end]) = self.guide.ends(ray) {
            let margin = |t: f32| MARGIN * (t + leave);
            let bracket = [(near - margin(near)).clamp(leave, far), (end + margin(end)).clamp(leave, far)];
            // If its near end is not free, what the guide saw is not the first thing on the way.
            if bracket[0] < bracket[1] && free(ray.at(bracket[0])) {
                if let Some(found) = self.search(ray, bracket, &mut free) {
                    return ray.at(found);
                }
                from = bracket[1];
            }
        }
        let blind = [from, far];
        let halvings = self.halvings(blind, BLIND_STEPS);
        let found = (from < far).then(|| crossing(ray, blind, BLIND_STEPS, halvings, free)).flatten();
        ray.at(found.map_or(far, |found| found.hidden))
    }

    fn search(&self, ray: &Ray, bracket: [f32; 2], free: impl FnMut(Vec3) -> bool) -> Option<f32> {
        let texels = self.parallax * (bracket[0].recip() - bracket[1].recip());
        let steps = (texels / STEP_TEXELS).ceil().clamp(STEPS[0], STEPS[1]) as u32;
        crossing(ray, bracket, steps, self.halvings(bracket, steps), free)
            .map(|found| 0.5 * (found.free + found.hidden))
    }

    fn halvings(&self, bracket: [f32; 2], steps: u32) -> u32 {
        let texels = self.parallax * (bracket[0].recip() - bracket[1].recip()) / steps as f32;
        (texels / PRECISION_TEXELS).max(1.0).log2().ceil().min(16.0) as u32
    }

    /// The colour of a place by all cubes that saw it.
    fn color(&self, place: Vec3) -> Option<Vec3> {
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for cube in &self.cubes {
            let away = place - cube.distances.position();
            let Some((color, nearness)) = cube.colors.sharp(away) else { continue };
            let off = (cube.distances.relative_depth(away) - 1.0).abs();
            let agrees = if off < AGREEMENT { 1.0 } else { UNSEEN };
            let weight = agrees * (nearness * nearness + BETWEEN);
            sum += weight * color;
            weights += weight;
        }
        (weights > 0.0).then(|| sum / weights)
    }
}

impl Environment for GuidedField {
    fn look_up(&self, ray: &Ray) -> Option<Vec3> {
        let ray = Ray { origin: ray.origin, direction: normalized(ray.direction)? };
        if !ray.origin.is_finite() {
            return None;
        }
        self.color(self.end(&ray))
    }
}

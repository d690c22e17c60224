//! One axis of the question which texels rays through the cell ask for.

use core::ops::Range;

use glam::Vec3;

use crate::{SampledAxis, Slab, Windows};

/// Relative rounding error of `f32`, 2⁻²⁴.
const UNIT_ROUNDOFF: f64 = f32::EPSILON as f64 / 2.0;

/// What the cell's points see of the cameras along s (or t) and their slopes u (or v).
#[derive(Debug, Clone)]
pub(crate) struct Shadow {
    pub(crate) cameras: SampledAxis,
    pub(crate) slopes: SampledAxis,
    /// Texels per camera.
    pub(crate) disparity: f64,
    /// Distance along the face from a point of the cell to the camera plane: least and greatest. Negative behind it.
    pub(crate) run: [f64; 2],
    /// The least and the greatest coordinate of the box along the axis.
    pub(crate) extent: [f64; 2],
    /// Bounds on the rounding error of [`Slab::index_ray`] and [`Slab::taps`], in cameras and in texels.
    pub(crate) slack: [f64; 2],
}

impl Shadow {
    pub(crate) fn new(slab: &Slab, corners: [Vec3; 2], i: usize) -> Self {
        let face = slab.face();
        let (cameras, slopes) = (slab.st()[i], slab.uv()[i]);
        let sign = f64::from(face.sign());
        let along = |axis: usize| corners.map(|corner| f64::from(corner[axis]));
        let (extent, depths) = (along(face.tangents()[i]), along(face.axis()));
        let runs = depths.map(|depth| sign * (f64::from(slab.plane()) - depth));
        let disparity = f64::from(slab.disparity()[i]);
        let reach = |ends: [f64; 2]| ends[0].abs().max(ends[1].abs());
        let ends = |axis: &SampledAxis| f64::from(axis.first().abs()) + f64::from(axis.last().abs());
        let positions = reach(extent) + f64::from(slab.plane().abs()) + reach(depths) + ends(&cameras);
        let texels = (1.0 + ends(&slopes)) / f64::from(slopes.step()) + f64::from(slopes.count());
        let slack = [
            positions / f64::from(cameras.step()) + f64::from(cameras.count()),
            texels + disparity * f64::from(cameras.count() + 2),
        ];
        Self {
            cameras,
            slopes,
            disparity,
            run: [runs[0].min(runs[1]), runs[0].max(runs[1])],
            extent,
            slack: slack.map(|sum| 8.0 * UNIT_ROUNDOFF * sum),
        }
    }

    pub(crate) fn windows(&self) -> Windows {
        Windows::new((0..self.cameras.count()).map(|i| self.window(i)), self.slopes.count())
    }

    /// The texels of camera `i` that rays use. It serves the rays that cross the plane less than one camera away, and the
    /// outermost cameras those beyond them, too.
    fn window(&self, i: u32) -> Range<u32> {
        let last = self.cameras.count() - 1;
        let at = |index: f64| f64::from(self.cameras.first()) + index * f64::from(self.cameras.step());
        let low = if i == 0 { f64::NEG_INFINITY } else { at(f64::from(i) - 1.0 - self.slack[0]) };
        let high = if i == last { f64::INFINITY } else { at(f64::from(i) + 1.0 + self.slack[0]) };
        let Some([least, most]) = self.slopes_between(low, high) else { return 0..0 };
        let index = |slope: f64| (slope - f64::from(self.slopes.first())) / f64::from(self.slopes.step());
        // Cameras are asked for other slopes than the ray's own: by one disparity at most, and none beyond the ends.
        let before = if i == 0 { 0.0 } else { self.disparity };
        let after = if i == last { 0.0 } else { self.disparity };
        let end = f64::from(self.slopes.count() - 1);
        let first = libm::floor((index(least) - before - self.slack[1]).clamp(0.0, end));
        let last = libm::ceil((index(most) + after + self.slack[1]).clamp(0.0, end));
        first as u32..last as u32 + 1
    }

    /// Least and greatest slope of the rays from the cell that cross the plane between `low` and `high`: all slopes w
    /// from −1 to 1 for which a run r and a point x of the cell exist with x + r·w between the two.
    fn slopes_between(&self, low: f64, high: f64) -> Option<[f64; 2]> {
        let reach = [low - self.extent[1], high - self.extent[0]];
        let up = slopes_from_zero(self.run, reach);
        let down = slopes_from_zero([-self.run[1], -self.run[0]], reach).map(|[least, most]| [-most, -least]);
        match (up, down) {
            (Some([_, most]), Some([least, _])) => Some([least, most]),
            (one, other) => one.or(other),
        }
    }
}

/// The slopes w from 0 to 1 for which r·w lies in `reach` for some r in `run`.
fn slopes_from_zero([nearest, farthest]: [f64; 2], [low, high]: [f64; 2]) -> Option<[f64; 2]> {
    let [least, most] = at_most(at_most([0.0, 1.0], nearest, high), -farthest, -low);
    (least <= most).then_some([least, most])
}

/// The part of an interval of w in which factor·w ≤ bound; least above most if there is none.
fn at_most([least, most]: [f64; 2], factor: f64, bound: f64) -> [f64; 2] {
    if factor > 0.0 {
        [least, most.min(bound / factor)]
    } else if factor < 0.0 {
        [least.max(bound / factor), most]
    } else if bound >= 0.0 {
        [least, most]
    } else {
        [1.0, 0.0]
    }
}

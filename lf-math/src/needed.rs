//! Which texels of a slab are needed, one by one: the exact set that the windows of a [`Coverage`](crate::Coverage) enclose.
//!
//! A ray through the cell is given by the place where it starts in the cell: by its run r, the distance along the face from
//! there to the camera plane, and on each of the two axes by a coordinate x within the cell and a slope w. It crosses the
//! plane at p = x + r·w. A texel of a camera serves the rays whose (p, w) lies in the texel's *support* on both axes: less
//! than one camera from the camera, less than one texel from the texel, the position in the image being moved by the
//! disparity. On one axis the support is a polygon, and some ray with run r falls into it if p − r·w meets the cell's extent
//! there:
//!
//! > max over the corners of p − r·w ≥ x₀, min over the corners of p − r·w ≤ x₁.
//!
//! Each of the two fails in one open interval of r, found from the corners. A texel is needed if some r within the cell's
//! depth lies in none of the four intervals of its two axes: the axes share r and nothing else.
//!
//! In the limit of fine sampling that is 2/9 of the samples of a cube cell with planes on its faces, and half with planes
//! through its centre, where no window helps.
//!
//! Supports are widened by the rounding error of a look-up in `f32` and by 1/256 of a texel, the step to which graphics
//! devices round a position between texels; the rest is in `f64`. What is left out is thus never looked up.

use alloc::vec::Vec;
use core::ops::Range;

use glam::Vec3;

use crate::shadow::Shadow;
use crate::{Cell, Slab};

/// How far devices may round a position in an image, texels.
const DEVICE_STEP: f64 = 1.0 / 256.0;

/// The texels of a slab that [`Slab::taps`] and bilinear interpolation use, with a weight greater than 0, for any ray whose
/// dominant face is the slab's and whose origin lies in the cell.
#[derive(Debug, Clone)]
pub struct NeededTexels {
    axes: [Shadow; 2],
}

/// Which texels of one camera's image are needed.
#[derive(Debug, Clone)]
pub struct NeededImage {
    run: [f64; 2],
    window: [Range<u32>; 2],
    /// For each texel along u and along v of the window.
    idle: [Vec<Idle>; 2],
}

/// The runs from which no ray reaches a support on one axis: those that all pass below, and those that all pass above the
/// cell's extent. Open intervals; empty ones end before they begin.
type Idle = [[f64; 2]; 2];

const NEVER: [f64; 2] = [0.0, 0.0];
const ALWAYS: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// Where a ray crosses the camera plane on one axis, metres, and its slope.
type Crossing = [f64; 2];

impl NeededTexels {
    /// What rays from the cell need.
    #[must_use]
    pub fn of_cell(slab: &Slab, cell: &Cell) -> Self {
        Self::of_box(slab, [-cell.half_extent(), cell.half_extent()])
    }

    /// What rays from a box need, given by its least and greatest corner, cell space.
    #[must_use]
    pub fn of_box(slab: &Slab, corners: [Vec3; 2]) -> Self {
        Self { axes: [0, 1].map(|i| Shadow::new(slab, corners, i)) }
    }

    /// Which texels are needed of a window of a camera's image. Takes time by the sum of the window's sides.
    #[must_use]
    pub fn image(&self, camera: [u32; 2], window: [Range<u32>; 2]) -> NeededImage {
        let idle = [0, 1].map(|i| window[i].clone().map(|texel| self.axes[i].idle(camera[i], texel)).collect());
        // Both axes have the same run.
        NeededImage { run: self.axes[0].run, window, idle }
    }

    /// Whether one texel of one camera is needed.
    #[must_use]
    pub fn contains(&self, camera: [u32; 2], [u, v]: [u32; 2]) -> bool {
        self.image(camera, [u..u.saturating_add(1), v..v.saturating_add(1)]).contains([u, v])
    }
}

impl NeededImage {
    /// Whether a texel is needed; none outside the window is.
    #[must_use]
    pub fn contains(&self, texel: [u32; 2]) -> bool {
        let [u, v] = [0, 1].map(|i| {
            let place = texel[i].checked_sub(self.window[i].start);
            place.and_then(|place| self.idle[i].get(place as usize))
        });
        let (Some(u), Some(v)) = (u, v) else { return false };
        let [mut run, last] = self.run;
        // The least run that no interval holds, if it lies within the cell.
        while let Some([_, end]) = u.iter().chain(v).find(|[start, end]| *start < run && run < *end) {
            run = *end;
        }
        run <= last
    }
}

impl Shadow {
    fn idle(&self, camera: u32, texel: u32) -> Idle {
        let support = self.support(camera, texel);
        if support.is_empty() {
            return [ALWAYS; 2];
        }
        let mirrored = support.iter().map(|[p, w]| [-p, -w]);
        [runs_below(support.iter().copied(), self.extent[0]), runs_below(mirrored, -self.extent[1])]
    }

    /// The corners of the support of a texel: what [`Slab::taps`] clamps to the slab reaches as far as rays do.
    fn support(&self, camera: u32, texel: u32) -> Vec<Crossing> {
        let last = self.slopes.count() - 1;
        let reach = 1.0 + self.slack[1] + DEVICE_STEP;
        let slope =
            |place: f64| f64::from(self.slopes.first()) + (f64::from(texel) + place) * f64::from(self.slopes.step());
        // Beyond the slopes that rays have.
        let least = |offset: f64| if texel == 0 { -2.0 } else { slope(-reach - self.disparity * offset) };
        let most = |offset: f64| if texel == last { 2.0 } else { slope(reach - self.disparity * offset) };
        let below = self.edges(camera);
        let above = below.iter().rev();
        let corners = below.iter().map(|&(p, offset)| [p, least(offset)]);
        let corners: Vec<Crossing> = corners.chain(above.map(|&(p, offset)| [p, most(offset)])).collect();
        no_steeper(&no_steeper(&corners, 1.0), -1.0)
    }

    /// Where the disparity's effect bends on the camera plane, from the least crossing that a camera serves to the greatest:
    /// the crossing, and its offset from the camera as [`Slab::taps`] sees it, in cameras.
    fn edges(&self, camera: u32) -> Vec<(f64, f64)> {
        let last = self.cameras.count() - 1;
        let at = |index: f64| f64::from(self.cameras.first()) + index * f64::from(self.cameras.step());
        let (here, reach) = (f64::from(camera), 1.0 + self.slack[0]);
        let far = 1.0
            + self.run.map(f64::abs).into_iter().fold(0.0, f64::max)
            + self.extent.map(f64::abs).into_iter().fold(0.0, f64::max)
            + at(0.0).abs().max(at(f64::from(last)).abs());
        let mut edges = Vec::new();
        match camera {
            0 => edges.extend([(-far, 0.0), (at(0.0), 0.0)]),
            _ => edges.push((at(here - reach), -reach)),
        }
        if camera == last {
            edges.extend([(at(here), 0.0), (far, 0.0)]);
        } else {
            edges.push((at(here + reach), reach));
        }
        edges
    }
}

/// The part of a polygon whose slopes are at most 1 (`sign` 1) or at least −1 (`sign` −1): Sutherland & Hodgman 1974.
fn no_steeper(corners: &[Crossing], sign: f64) -> Vec<Crossing> {
    let mut kept = Vec::new();
    for (i, &to) in corners.iter().enumerate() {
        let from = corners[(i + corners.len() - 1) % corners.len()];
        let [before, after] = [from, to].map(|[_, w]| 1.0 - sign * w);
        if (before < 0.0) != (after < 0.0) {
            let share = before / (before - after);
            kept.push([from[0] + share * (to[0] - from[0]), sign]);
        }
        if after >= 0.0 {
            kept.push(to);
        }
    }
    kept
}

/// The open interval of runs r for which p − r·w is less than `bound` at every corner.
fn runs_below(corners: impl Iterator<Item = Crossing>, bound: f64) -> [f64; 2] {
    let [mut start, mut end] = ALWAYS;
    for [p, w] in corners {
        if w > 0.0 {
            start = start.max((p - bound) / w);
        } else if w < 0.0 {
            end = end.min((p - bound) / w);
        } else if p >= bound {
            return NEVER;
        }
    }
    [start, end]
}

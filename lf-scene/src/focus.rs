//! Where the focal planes stand, found before anything is captured.

use glam::Vec2;
use lf_math::{Cell, GeometryError, LightFieldGeometry, Ray, Slab};
use rayon::prelude::*;

use crate::capture::inverse_depth;
use crate::tracer::Tracer;

/// Rays cast for one slab: the median's rank is then off by a seventh of a per cent.
const RAYS: usize = 1 << 17;
/// Samples tried for them, if few pass through the cell.
const TRIES: u32 = 1 << 23;

/// How often each inverse depth was seen from the camera plane.
///
/// Bins are `1/z = i·4/(BINS·h)`, h being the cell's smallest half extent: up to a quarter of h, in steps that shift the
/// paper's 128 texels by 0.01 texel per camera. What is nearer, or behind the plane, only counts as being beyond an end.
#[derive(Debug, Clone)]
struct Depths {
    bin: f64,
    counts: Vec<u64>,
}

/// Number of bins of inverse depth.
const BINS: usize = 4096;

/// Which focal plane suits the depths z that a slab's rays meet. Errors grow with how far disparities are from that of the focal plane,
/// and those are as 1/z: each rule is a middle of 1/z.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum FocusRule {
    /// `1 / median(1/z)`: the least mean absolute error of disparity. A few near things do not move it.
    #[default]
    Median,
    /// `1 / mean(1/z)`: the least mean squared error of disparity.
    LeastSquares,
    /// `2 / (1/min z + 1/max z)`: the least largest error of disparity (Chai et al., *Plenoptic Sampling*, SIGGRAPH 2000). What is nearer
    /// than a quarter of the cell's smallest half extent counts as being there.
    Minimax,
    /// No focal plane: infinity.
    Infinity,
    /// This far from the camera planes, metres, whatever there is.
    At(f32),
}

/// [`focus_by`] the default rule.
///
/// # Errors
/// As there.
pub fn focus(tracer: &Tracer, geometry: &LightFieldGeometry) -> Result<LightFieldGeometry, GeometryError> {
    focus_by(tracer, geometry, FocusRule::default())
}

/// The same slabs, each with the focal plane that suits the scene: a survey by distances alone, without shading.
///
/// Cast are the rays of 131,072 samples that pass through the cell, spread evenly over the slab, or of all if there are
/// fewer: for the paper's set-up 3.5 % of what is captured. The result does not depend on the number of threads.
///
/// # Errors
/// If a focal plane is so near that the disparity is not finite.
pub fn focus_by(
    tracer: &Tracer,
    geometry: &LightFieldGeometry,
    rule: FocusRule,
) -> Result<LightFieldGeometry, GeometryError> {
    let focused = geometry.slabs().iter().enumerate().map(|(number, slab)| {
        slab.with_focal_depth(match rule {
            FocusRule::Infinity => None,
            FocusRule::At(depth) => Some(depth),
            FocusRule::Median => survey(tracer, geometry, number).depth_at(Depths::median),
            FocusRule::LeastSquares => survey(tracer, geometry, number).depth_at(Depths::mean),
            FocusRule::Minimax => survey(tracer, geometry, number).depth_at(Depths::middle),
        })
    });
    LightFieldGeometry::new(*geometry.cell(), focused.collect::<Result<_, _>>()?)
}

/// What the rays of a slab meet.
fn survey(tracer: &Tracer, geometry: &LightFieldGeometry, number: usize) -> Depths {
    let none = || Depths::new(geometry.cell());
    let seen = through_cell(geometry, number).into_par_iter().fold(none, |mut depths, ray| {
        depths.add(inverse_depth(tracer, geometry, number, &ray));
        depths
    });
    seen.reduce(none, Depths::plus)
}

/// Stored rays of a slab that pass through the cell, evenly spread.
fn through_cell(geometry: &LightFieldGeometry, number: usize) -> Vec<Ray> {
    let slab = &geometry.slabs()[number];
    let passing = |[camera, texel]: [Vec2; 2]| {
        // It starts where it leaves the cell, or beside the cell if it misses.
        let ray = geometry.capture_ray(number, camera, texel);
        geometry.cell().contains(ray.origin * (1.0 - 1e-4)).then_some(ray)
    };
    let all = slab.cameras().into_iter().chain(slab.resolution()).map(u64::from).product::<u64>();
    if all <= RAYS as u64 {
        (0..all as u32).map(|n| nth_sample(slab, n)).filter_map(passing).collect()
    } else {
        (0..TRIES).map(|n| spread_sample(slab, n)).filter_map(passing).take(RAYS).collect()
    }
}

/// The sample of number `n` in storage order: camera and texel.
fn nth_sample(slab: &Slab, n: u32) -> [Vec2; 2] {
    let ([across, _], [width, height]) = (slab.cameras(), slab.resolution());
    let (texel, camera) = (n % (width * height), n / (width * height));
    let at = |n: u32, width: u32| Vec2::new((n % width) as f32, (n / width) as f32);
    [at(camera, across), at(texel, width)]
}

/// The sample of number `n` of those spread evenly: camera and texel.
fn spread_sample(slab: &Slab, n: u32) -> [Vec2; 2] {
    slab.spread_sample(n).map(|[first, second]| Vec2::new(first as f32, second as f32))
}

impl Depths {
    fn new(cell: &Cell) -> Self {
        let nearest = 0.25 * f64::from(cell.half_extent().min_element());
        Self { bin: 1.0 / (nearest * BINS as f64), counts: vec![0; BINS] }
    }

    /// Counts an inverse depth; what lies behind the plane has a negative one: below all others.
    fn add(&mut self, inverse: f32) {
        self.counts[((f64::from(inverse) / self.bin) as usize).min(BINS - 1)] += 1;
    }

    fn plus(mut self, other: Self) -> Self {
        for (count, more) in self.counts.iter_mut().zip(other.counts) {
            *count += more;
        }
        self
    }

    /// The depth of a middle bin; none (infinity) if nothing was seen, or that is too far for the first bin.
    fn depth_at(&self, middle: impl Fn(&Self) -> Option<f64>) -> Option<f32> {
        middle(self).filter(|&i| i >= 1.0).map(|i| (1.0 / (self.bin * (i + 0.5))) as f32)
    }

    fn median(&self) -> Option<f64> {
        let half = self.counts.iter().sum::<u64>().div_ceil(2);
        let mut below = 0;
        let median = self.counts.iter().position(|count| {
            below += count;
            below >= half
        });
        median.map(|i| i as f64)
    }

    fn mean(&self) -> Option<f64> {
        let total: u64 = self.counts.iter().sum();
        let sum: f64 = (0u32..).zip(&self.counts).map(|(i, &count)| f64::from(i) * count as f64).sum();
        (total > 0).then(|| sum / total as f64)
    }

    /// Between the nearest and the farthest.
    fn middle(&self) -> Option<f64> {
        let seen = |count: &u64| *count > 0;
        Some(0.5 * (self.counts.iter().position(seen)? + self.counts.iter().rposition(seen)?) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::museum;
    use lf_math::PlanePlacement;

    /// All rays through the cell give nearly the median of the few.
    #[test]
    fn few_rays_find_the_median_of_all() {
        let tracer = Tracer::new(museum::scene());
        for placement in [PlanePlacement::CellFaces, PlanePlacement::CellCenter] {
            let geometry = LightFieldGeometry::around(museum::cell(), placement, 16, 40).unwrap();
            let focused = focus(&tracer, &geometry).unwrap();
            for (number, slab) in geometry.slabs().iter().enumerate() {
                let mut all: Vec<f32> = (0..16 * 16 * 40 * 40)
                    .map(|n| nth_sample(slab, n))
                    .map(|[camera, texel]| geometry.capture_ray(number, camera, texel))
                    .filter(|ray| geometry.cell().contains(ray.origin * (1.0 - 1e-4)))
                    .map(|ray| inverse_depth(&tracer, &geometry, number, &ray))
                    .collect();
                assert!(all.len() > 50_000);
                all.sort_by(f32::total_cmp);
                let rank = |share: f64| all[(share * all.len() as f64) as usize];
                let found = 1.0 / focused.slabs()[number].focal_depth().unwrap();
                // Half a bin is 1/512 m⁻¹ here.
                let bin = 1.0 / 512.0;
                assert!((rank(0.49) - bin..=rank(0.51) + bin).contains(&found), "{placement:?} {number}: {found}");
            }
        }
    }

    /// Three depths in known shares: closed forms.
    #[test]
    fn each_rule_has_its_middle() {
        let mut depths = Depths::new(&museum::cell());
        for (inverse, times) in [(0.2, 5), (0.5, 4), (1.4, 1)] {
            (0..times).for_each(|_| depths.add(inverse));
        }
        let bin = depths.bin;
        let near = |depth: Option<f32>, inverse: f64| (1.0 / f64::from(depth.unwrap()) - inverse).abs() <= bin;
        assert!(near(depths.depth_at(Depths::median), 0.2));
        assert!(near(depths.depth_at(Depths::mean), 0.44));
        // The harmonic mean of 1/0.2 and 1/1.4 is 1/0.8.
        assert!(near(depths.depth_at(Depths::middle), 0.8));
        let nothing = Depths::new(&museum::cell());
        for rule in [Depths::median, Depths::mean, Depths::middle] {
            assert_eq!(nothing.depth_at(rule), None);
        }
    }

    #[test]
    fn planes_that_are_given_are_taken() {
        let tracer = Tracer::new(museum::scene());
        let geometry = LightFieldGeometry::around(museum::cell(), PlanePlacement::CellCenter, 3, 4).unwrap();
        for (rule, depth) in [(FocusRule::Infinity, None), (FocusRule::At(1.5), Some(1.5))] {
            let focused = focus_by(&tracer, &geometry, rule).unwrap();
            assert!(focused.slabs().iter().all(|slab| slab.focal_depth() == depth));
        }
        assert!(focus_by(&tracer, &geometry, FocusRule::At(0.0)).is_err());
    }

    #[test]
    fn few_samples_are_all_taken() {
        let geometry =
            LightFieldGeometry::around_with(museum::cell(), PlanePlacement::CellCenter, [3, 2], [5, 4]).unwrap();
        let slab = &geometry.slabs()[0];
        let all: std::collections::HashSet<String> = (0..120).map(|n| format!("{:?}", nth_sample(slab, n))).collect();
        assert_eq!(all.len(), 120);
        let within = |[camera, texel]: [Vec2; 2]| {
            camera.cmplt(Vec2::new(3.0, 2.0)).all() && texel.cmplt(Vec2::new(5.0, 4.0)).all()
        };
        assert!((0..120).all(|n| within(nth_sample(slab, n))) && (0..10_000).all(|n| within(spread_sample(slab, n))));
        assert!(through_cell(&geometry, 0).len() > 8);
    }
}

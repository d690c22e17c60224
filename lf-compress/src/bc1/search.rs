//! Which fits are tried for a group of blocks at which quality.

use fearless_simd::prelude::*;

use super::axis::{principal_axis, range_moments};
use super::cluster::{Ordered, best_rounded};
use super::fit::{Ends, Fit};
use super::lanes::{Group, I, M, Packed, Rgb};
use super::least_squares::Moments;
use super::options::Quality;
use super::palette::{FourColor, Metric, Palette};
use super::walk::descend;

/// How far a search goes.
#[derive(Clone, Copy)]
pub(super) struct Plan {
    /// Power iterations for the principal axis.
    pub(super) power_steps: usize,
    /// Least-squares rounds after the first.
    pub(super) rounds: usize,
    /// Sweeps of the descent over the channels, at most.
    pub(super) sweeps: usize,
    pub(super) clusters: Option<Clusters>,
}

/// What is made of the cluster fit's candidates.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Clusters {
    /// The best one once endpoints are rounded is refined.
    Best,
    /// Each is refined.
    All,
}

impl Plan {
    /// The plan of a quality. The two fastest have none; they get that of [`Quality::Fast`] where they do not apply.
    pub(super) const fn of(quality: Quality) -> Self {
        // More sweeps than twenty are never needed; most groups stop after four.
        match quality {
            Quality::Realtime | Quality::VeryFast | Quality::Fast => {
                Self { power_steps: 2, rounds: 0, sweeps: 0, clusters: None }
            }
            Quality::Standard => Self { power_steps: 4, rounds: 1, sweeps: 0, clusters: None },
            Quality::High => Self { power_steps: 4, rounds: 1, sweeps: 1, clusters: None },
            Quality::Best => Self { power_steps: 4, rounds: 1, sweeps: 20, clusters: Some(Clusters::Best) },
            Quality::Exhaustive => Self { power_steps: 4, rounds: 2, sweeps: 20, clusters: Some(Clusters::All) },
        }
    }
}

/// The palette entries over which a range fit lays the texels.
const WHOLE: (f32, f32) = (0.0, 3.0);

/// The best 4-colour fit found.
#[inline(always)]
pub(super) fn four_color<S: Simd>(
    simd: S,
    texels: &Packed<S>,
    metric: &Metric,
    plan: &Plan,
    seed: Option<&(Ends<S>, M<S>)>,
) -> Fit<S> {
    if plan.rounds == 0 {
        return refined_once(simd, texels, metric, plan);
    }
    let group = Group::new(simd, texels);
    let axis = principal_axis(&group, metric, plan.power_steps);
    let start = range_moments(&group, metric, &FourColor, &axis, WHOLE);
    let mut fit = settle(&group, metric, &FourColor, &start, plan.rounds);
    if let Some((ends, has_seed)) = seed {
        fit = fit.or_better(&seeded(&group, metric, *ends, *has_seed));
    }
    let Some(clusters) = plan.clusters else {
        return descend(&group, metric, &FourColor, &fit, plan.sweeps);
    };
    let ordered = ordered(&group, metric, texels, &axis);
    let cuts = ordered.best_cuts(&group);
    if clusters == Clusters::Best {
        let moments = best_rounded(&group, metric, &ordered, &cuts);
        let fit = fit.or_better(&settle(&group, metric, &FourColor, &moments, plan.rounds));
        return descend(&group, metric, &FourColor, &fit, plan.sweeps);
    }
    let mut best = descend(&group, metric, &FourColor, &fit, plan.sweeps);
    for cut in &cuts {
        let moments = ordered.moments(&group, metric, cut);
        let fit = settle(&group, metric, &FourColor, &moments, plan.rounds);
        best = best.or_better(&descend(&group, metric, &FourColor, &fit, plan.sweeps));
    }
    best
}

/// A range fit and one refinement: the short way, kept apart so that it is compiled without what it does not need.
#[inline(always)]
fn refined_once<S: Simd>(simd: S, texels: &Packed<S>, metric: &Metric, plan: &Plan) -> Fit<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            let group = Group::new(simd, texels);
            let axis = principal_axis(&group, metric, plan.power_steps);
            let start = range_moments(&group, metric, &FourColor, &axis, WHOLE);
            Fit::new(&group, metric, &FourColor, start.solve::<FourColor>(simd)).0
        },
    )
}

/// What seeds make of the blocks, after one refinement; lanes without a seed get an error that nobody takes.
#[inline(always)]
fn seeded<S: Simd>(group: &Group<S>, metric: &Metric, ends: Ends<S>, has_seed: M<S>) -> Fit<S> {
    group.simd.vectorize(
        #[inline(always)]
        || {
            let (fit, moments) = Fit::new(group, metric, &FourColor, ends);
            let (refined, _) = Fit::new(group, metric, &FourColor, moments.solve::<FourColor>(group.simd));
            let mut best = fit.or_better(&refined);
            best.error = has_seed.select(best.error, I::<S>::splat(group.simd, i32::MAX));
            best
        },
    )
}

#[inline(always)]
fn ordered<S: Simd>(group: &Group<S>, metric: &Metric, texels: &Packed<S>, axis: &Rgb<S>) -> Ordered<S> {
    group.simd.vectorize(
        #[inline(always)]
        || Ordered::new(group, metric, texels, axis),
    )
}

/// Alternates between the best endpoints for the shares and the best shares for the endpoints (Lloyd, *Least squares
/// quantization in PCM*, 1982), keeping the best fit on the way.
#[inline(always)]
pub(super) fn settle<S: Simd, P: Palette<S>>(
    group: &Group<S>,
    metric: &Metric,
    palette: &P,
    start: &Moments<S>,
    rounds: usize,
) -> Fit<S> {
    group.simd.vectorize(
        #[inline(always)]
        || {
            let (mut best, mut moments) = Fit::new(group, metric, palette, start.solve::<P>(group.simd));
            for _ in 0..rounds {
                let (fit, next) = Fit::new(group, metric, palette, moments.solve::<P>(group.simd));
                best = best.or_better(&fit);
                moments = next;
            }
            best
        },
    )
}

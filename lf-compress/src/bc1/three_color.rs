//! Fits in 3-colour mode, for callers that allow it and for texels that must be transparent.
//!
//! The palette has one entry between the endpoints instead of two, and black, which most hardware reads as transparent
//! black. Black helps blocks with a dark part: the endpoints are then free for the rest.

use fearless_simd::prelude::*;

use super::axis::{principal_axis, range_moments};
use super::fit::Fit;
use super::lanes::{F, Group, M, Packed, U};
use super::palette::{BLACK_BARRED, BLACK_FORCED, BLACK_FREE, Metric, ThreeColor};
use super::search::{Plan, settle};
use super::walk::descend;

/// Palette entries over which the texels' range is laid to begin with.
const WHOLE: (f32, f32) = (0.0, 2.0);
/// The same for the qualities that try more: one endpoint is then outside the texels.
const HALVES: [(f32, f32); 2] = [(0.0, 1.0), (1.0, 2.0)];

/// Texels with no channel above this are left to black to begin with, where black is allowed.
const DARK: u32 = 15;

/// The best fit found. `transparent` texels get entry 3, others only where `black` is free.
#[inline(always)]
pub(super) fn three_color<S: Simd>(
    simd: S,
    texels: &Packed<S>,
    transparent: &[M<S>; 16],
    black: bool,
    metric: &Metric,
    plan: &Plan,
) -> Fit<S> {
    let zero = U::<S>::splat(simd, 0);
    let others = F::<S>::splat(simd, if black { BLACK_FREE } else { BLACK_BARRED });
    let mut palette = ThreeColor { black: [others; 16] };
    let mut cleared = *texels;
    for i in 0..16 {
        palette.black[i] = transparent[i].select(F::<S>::splat(simd, BLACK_FORCED), others);
        cleared[i] = transparent[i].select(zero, texels[i]);
    }
    let group = Group::new(simd, &cleared);
    let mut best = seeded(&group, texels, transparent, &palette, metric, plan);
    if black {
        let mut left_out = *transparent;
        for (out, texel) in left_out.iter_mut().zip(texels) {
            let (r, g, b) = (*texel & 255, (*texel >> 8) & 255, (*texel >> 16) & 255);
            *out |= r.max(g).max(b).simd_le(DARK);
        }
        best = best.or_better(&seeded(&group, texels, &left_out, &palette, metric, plan));
    }
    best
}

/// The best of the fits that start from range fits of the texels not left out.
#[inline(always)]
fn seeded<S: Simd>(
    group: &Group<S>,
    texels: &Packed<S>,
    left_out: &[M<S>; 16],
    palette: &ThreeColor<S>,
    metric: &Metric,
    plan: &Plan,
) -> Fit<S> {
    group.simd.vectorize(
        #[inline(always)]
        || {
            let seeds = Group::new(group.simd, &stand_ins::<S>(texels, left_out));
            let axis = principal_axis(&seeds, metric, plan.power_steps);
            let start = range_moments(&seeds, metric, palette, &axis, WHOLE);
            let fit = settle(group, metric, palette, &start, plan.rounds);
            let mut best = descend(group, metric, palette, &fit, plan.sweeps);
            let halves: &[_] = if plan.clusters.is_some() { &HALVES } else { &[] };
            for half in halves {
                let start = range_moments(&seeds, metric, palette, &axis, *half);
                let fit = settle(group, metric, palette, &start, plan.rounds);
                best = best.or_better(&descend(group, metric, palette, &fit, plan.sweeps));
            }
            best
        },
    )
}

/// The texels with those left out replaced by one that is not, so that they do not widen the range.
#[inline(always)]
fn stand_ins<S: Simd>(texels: &Packed<S>, left_out: &[M<S>; 16]) -> Packed<S> {
    let mut stand_in = texels[0];
    for i in 1..16 {
        stand_in = left_out[i].select(stand_in, texels[i]);
    }
    let mut seeds = *texels;
    for i in 0..16 {
        seeds[i] = left_out[i].select(stand_in, texels[i]);
    }
    seeds
}

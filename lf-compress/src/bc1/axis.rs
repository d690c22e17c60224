//! The principal axis, and the shares that a range fit along it gives the texels.

use fearless_simd::prelude::*;

use super::lanes::{F, Group, Rgb, dot};
use super::least_squares::Moments;
use super::palette::{Metric, Palette};

/// By how much a range fit draws each end in from the outermost texel, as a share of the range.
///
/// The outermost texel is one of sixteen; ending on it leaves the outer quarters of the palette half empty. The optimum
/// is flat around a fourteenth, as the shares are refined afterwards.
const INSET: f32 = 0.07;

/// The block's principal axis under the metric, by power iteration on the covariance; its largest component is ±1.
///
/// The start is a row of the covariance, one step along already. A block of one colour gets an axis of zeros.
#[inline(always)]
pub(super) fn principal_axis<S: Simd>(group: &Group<S>, metric: &Metric, steps: usize) -> Rgb<S> {
    let [rr, rg, rb] = [group.covariance(0, 0), group.covariance(0, 1), group.covariance(0, 2)];
    let [gg, gb, bb] = [group.covariance(1, 1), group.covariance(1, 2), group.covariance(2, 2)];
    let red = rr.simd_gt(gg) & rr.simd_gt(bb);
    let blue = bb.simd_gt(gg);
    let mut axis =
        [red.select(rr, blue.select(rb, rg)), red.select(rg, blue.select(gb, gg)), red.select(rb, blue.select(bb, gb))];
    let [wr, wg, wb] = metric.weights;
    for _ in 0..steps {
        let [r, g, b] = unit(group, &axis);
        let [r, g, b] = [r * wr, g * wg, b * wb];
        axis = [rr * r + rg * g + rb * b, rg * r + gg * g + gb * b, rb * r + gb * g + bb * b];
    }
    unit(group, &axis)
}

/// Scales a vector so that its largest component is ±1; zero stays zero.
#[inline(always)]
fn unit<S: Simd>(group: &Group<S>, axis: &Rgb<S>) -> Rgb<S> {
    let largest = axis[0].abs().max(axis[1].abs()).max(axis[2].abs());
    let scale = group.splat(1.0) / largest.max(group.splat(1e-6));
    [axis[0] * scale, axis[1] * scale, axis[2] * scale]
}

/// Where the texels lie along an axis, under the metric.
#[inline(always)]
pub(super) fn projections<S: Simd>(group: &Group<S>, metric: &Metric, axis: &Rgb<S>) -> [F<S>; 16] {
    let [wr, wg, wb] = metric.weights;
    let axis = [axis[0] * wr, axis[1] * wg, axis[2] * wb];
    let mut along = [axis[0]; 16];
    for (i, t) in along.iter_mut().enumerate() {
        *t = dot::<S>(&axis, &group.texel(i));
    }
    along
}

/// The least and the greatest of sixteen values.
#[inline(always)]
pub(super) fn extremes<S: Simd>(values: &[F<S>; 16]) -> (F<S>, F<S>) {
    let (mut lo, mut hi) = (values[0], values[0]);
    for v in &values[1..] {
        lo = lo.min(*v);
        hi = hi.max(*v);
    }
    (lo, hi)
}

/// The moments of a range fit: the range of the texels along an axis, drawn in by [`INSET`], is laid over the palette
/// entries from `window.0` to `window.1`, counted from the second endpoint.
///
/// A window short of the whole palette puts an endpoint outside the texels, which lets the entries between lie where the
/// coarse endpoints cannot.
#[inline(always)]
pub(super) fn range_moments<S: Simd, P: Palette<S>>(
    group: &Group<S>,
    metric: &Metric,
    palette: &P,
    axis: &Rgb<S>,
    window: (f32, f32),
) -> Moments<S> {
    let along = projections(group, metric, axis);
    let (lo, hi) = extremes::<S>(&along);
    let width = (window.1 - window.0) / (1.0 - 2.0 * INSET);
    let scale = group.splat(width) / (hi - lo).max(group.splat(1e-6));
    let start = group.splat(0.5 + window.0 - width * INSET) - lo * scale;
    let (least, most) = (group.splat(window.0), group.splat(window.1 + 0.5));
    let mut moments = Moments::new(group, palette);
    for (i, t) in along.iter().enumerate() {
        let share = (*t * scale + start).max(least).min(most).floor();
        palette.count(&mut moments, group, i, share);
    }
    moments
}

//! Fits: a pair of endpoints, the palette entry each texel takes, and the squared error that leaves.
//!
//! A range fit lays an axis through the mean colour and puts the endpoints near the outermost projections. Two axes
//! are offered: the diagonal of the bounding box, which costs a few comparisons, and the principal axis.

use super::block::{Block, Lanes, Rgb, dot, extremes, lanes, sum};
use super::decode::{third, unpack565};

/// By how much a range fit draws each endpoint from the outermost texel towards the mean, of that distance.
///
/// The outermost texel is one of sixteen; ending on it leaves the two outer quarters of the palette half empty.
/// The optimum is flat around a tenth. Larger values soften blocks of two colours more, which only `Standard` repairs.
const INSET: f32 = 0.1;

/// Endpoints in 4-colour order, and how the block fares under them.
pub(super) struct Fit {
    pub(super) color0: u16,
    /// Less than `color0`, or equal to it with all `thirds` 3.
    pub(super) color1: u16,
    /// Squared error summed over texels and channels: an exact integer, at most 48·255².
    pub(super) error: f32,
    /// Per texel, the share of `color0` in its palette entry, in thirds: 3, 0, 2, 1 for the indices 0 to 3.
    pub(super) thirds: Lanes,
}

impl Fit {
    /// Gives every texel the nearest of the four entries between two 565 colours, passed in any order.
    ///
    /// The nearest minimises `|p|² − 2·p·x`; `|x|²` is the same for all entries and joins at the end. Ties go to the
    /// lower index, so equal endpoints give all texels index 0, which means the same in 3-colour mode.
    pub(super) fn new(block: &Block, a: u16, b: u16) -> Self {
        let (color0, color1) = (a.max(b), a.min(b));
        let (e0, e1) = (unpack565(color0), unpack565(color1));
        let mix = |p: [u8; 3], q: [u8; 3]| [third(p[0], q[0]), third(p[1], q[1]), third(p[2], q[2])];
        let (s0, s1) = (scores(block, e0), scores(block, e1));
        let (s2, s3) = (scores(block, mix(e0, e1)), scores(block, mix(e1, e0)));
        let (mut thirds, mut best) = ([0.0; 16], [0.0; 16]);
        for (i, (third, best)) in thirds.iter_mut().zip(&mut best).enumerate() {
            let (end, at_end) = if s1[i] < s0[i] { (s1[i], 0.0) } else { (s0[i], 3.0) };
            let (inner, between) = if s3[i] < s2[i] { (s3[i], 1.0) } else { (s2[i], 2.0) };
            (*best, *third) = if inner < end { (inner, between) } else { (end, at_end) };
        }
        Self { color0, color1, error: block.energy + sum(&best), thirds }
    }

    /// The fit with the smaller error, `self` where they tie.
    pub(super) fn or_better(self, other: Self) -> Self {
        if other.error < self.error { other } else { self }
    }
}

/// `|p|² − 2·p·x` for every texel `x` and one palette entry `p`; between −3·255² and 3·255².
#[inline(always)]
fn scores(block: &Block, entry: [u8; 3]) -> Lanes {
    let [r, g, b] = entry.map(f32::from);
    let square = r * r + g * g + b * b;
    let products = block.project([2.0 * r, 2.0 * g, 2.0 * b]);
    lanes(|i| square - products[i])
}

/// Range fit along the diagonal of the bounding box, the one that runs with the correlation of the channels.
pub(super) fn bounding_fit(block: &Block) -> Fit {
    let range = |c: usize| {
        let (lo, hi) = extremes(&block.channels[c]);
        hi - lo
    };
    let ranges = [range(0), range(1), range(2)];
    let widest = [0, 2].into_iter().fold(1, |best, c| if ranges[c] > ranges[best] { c } else { best });
    let signed = |c: usize| if block.covariance(widest, c) < 0.0 { -ranges[c] } else { ranges[c] };
    range_fit(block, [signed(0), signed(1), signed(2)])
}

/// Range fit along the direction of greatest variance.
pub(super) fn principal_fit(block: &Block) -> Fit {
    range_fit(block, principal_axis(block))
}

/// The block's principal axis, of any length, by power iteration on the covariance.
fn principal_axis(block: &Block) -> Rgb {
    // The quantised endpoints do not tell more steps apart; the start is already one step along.
    const STEPS: usize = 4;
    let [rr, rg, rb] = [block.covariance(0, 0), block.covariance(0, 1), block.covariance(0, 2)];
    let [gg, gb, bb] = [block.covariance(1, 1), block.covariance(1, 2), block.covariance(2, 2)];
    let mut axis = match (rr >= gg && rr >= bb, gg >= bb) {
        (true, _) => [rr, rg, rb],
        (false, true) => [rg, gg, gb],
        (false, false) => [rb, gb, bb],
    };
    for _ in 0..STEPS {
        // The matrix is positive semidefinite with a positive trace here, so no step can reach the zero vector.
        let scale = 1.0 / axis.iter().fold(0.0, |most: f32, x| most.max(x.abs()));
        let [r, g, b] = axis.map(|x| x * scale);
        axis = [rr * r + rg * g + rb * b, rg * r + gg * g + gb * b, rb * r + gb * g + bb * b];
    }
    axis
}

/// Endpoints at the outermost projections on an axis through the mean, drawn in by [`INSET`].
///
/// The axis may have any length but zero.
fn range_fit(block: &Block, axis: Rgb) -> Fit {
    let along = |v: Rgb| axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
    let mean = block.sums.map(|sum| sum / 16.0);
    let (lo, hi) = extremes(&block.project(axis));
    let scale = (1.0 - INSET) / along(axis);
    let at = |t: f32| {
        let s = (t - along(mean)) * scale;
        quantize([mean[0] + s * axis[0], mean[1] + s * axis[1], mean[2] + s * axis[2]])
    };
    Fit::new(block, at(hi), at(lo))
}

/// The 565 colour nearest to an 8-bit one, which may lie outside the cube.
fn quantize([r, g, b]: Rgb) -> u16 {
    let level = |value: f32, max: f32| (value * (max / 255.0) + 0.5).clamp(0.0, max) as u16;
    level(r, 31.0) << 11 | level(g, 63.0) << 5 | level(b, 31.0)
}

/// The fit whose endpoints solve the least-squares problem for the entries that the texels now take.
///
/// `None` where all texels take the same entry, which leaves one endpoint free. The new fit chooses the entries
/// anew and may be better or worse than the old one: see [`Fit::or_better`].
pub(super) fn refit(block: &Block, thirds: &Lanes) -> Option<Fit> {
    let normal = Normal::new(thirds)?;
    let channel = |c: usize, max: f32| normal.solve(dot(thirds, &block.channels[c]), block.sums[c], max);
    let (r, g, b) = (channel(0, 31.0), channel(1, 63.0), channel(2, 31.0));
    let color = |end: usize| r[end] << 11 | g[end] << 5 | b[end];
    Some(Fit::new(block, color(0), color(1)))
}

/// The normal matrix of the least-squares problem, which all channels share.
///
/// With the shares `a` of the first and `b = 3 − a` of the second endpoint, in thirds, a channel's endpoints `e` and
/// texels `x` make the error `Σ ((a·e0 + b·e1)/3 − x)²`. It is least where
///
/// ```text
/// | Σaa  Σab | | e0 |       | Σax |
/// | Σab  Σbb | | e1 |  = 3 · | Σbx |
/// ```
struct Normal {
    aa: f32,
    ab: f32,
    bb: f32,
    /// `3 / det`.
    scale: f32,
    /// What truncation adds to `Σax` and `Σbx`: see [`Normal::solve`].
    bias: [f32; 2],
}

impl Normal {
    fn new(thirds: &Lanes) -> Option<Self> {
        let (a, aa) = (sum(thirds), dot(thirds, thirds));
        let (ab, bb) = (3.0 * a - aa, 144.0 - 6.0 * a + aa);
        let det = aa * bb - ab * ab;
        // a·b is 2 at interpolated entries and 0 at the ends.
        let aab = dot(thirds, &lanes(|i| thirds[i] * (3.0 - thirds[i])));
        let bias = [aab / 6.0, (3.0 * ab - aab) / 6.0];
        (det > 0.0).then(|| Self { aa, ab, bb, scale: 3.0 / det, bias })
    }

    /// One channel's levels, given `Σax`, `Σx` and the greatest level.
    ///
    /// Interpolated entries are truncated, a third of a unit on average, so their texels are taken as that much
    /// larger. Rounding each endpoint for itself would ignore that they trade against each other, so of the four
    /// grid points around the solution the one with the least error is taken.
    fn solve(&self, ax: f32, x: f32, max: f32) -> [u16; 2] {
        let (ax, bx) = (ax + self.bias[0], 3.0 * x - ax + self.bias[1]);
        let e0 = (self.bb * ax - self.ab * bx) * self.scale;
        let e1 = (self.aa * bx - self.ab * ax) * self.scale;
        let step = 255.0 / max;
        let floor = |e: f32| f32::from((e * (max / 255.0)).clamp(0.0, max - 1.0) as u16);
        let (low0, low1) = (floor(e0), floor(e1));
        let mut best = (f32::INFINITY, [0, 0]);
        for [up0, up1] in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]] {
            let (d0, d1) = ((low0 + up0) * step - e0, (low1 + up1) * step - e1);
            let excess = self.aa * d0 * d0 + 2.0 * self.ab * d0 * d1 + self.bb * d1 * d1;
            if excess < best.0 {
                best = (excess, [(low0 + up0) as u16, (low1 + up1) as u16]);
            }
        }
        best.1
    }
}

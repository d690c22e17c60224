//! The fast fits: the diagonal of the bounding box, in 16-bit integers, with or without one least-squares refinement.
//!
//! Of the box's four diagonals the one is taken that runs with the covariance of red and blue with green, its ends drawn
//! in. Each texel goes to the palette entry nearest in projection. Errors are not measured.

use fearless_simd::prelude::*;

use super::lanes::{F, I, Packed, U};
use super::least_squares::Moments;
use super::palette::FourColor;

/// Pairs of 16-bit integers: red below blue, or green below something else.
type Pairs<S> = <S as Simd>::i16s;

/// By how much the box is drawn in at each end: a sixteenth where its ends are the endpoints.
const INSET_SHIFT: u32 = 4;
/// An eighth where they only assign texels for the refinement, which extends the line again.
const REFINED_INSET_SHIFT: u32 = 3;

/// Endpoints as 565 bits, and the share of the first in each texel's entry: two bits a texel, texel 0 lowest.
pub(super) struct QuickFit<S: Simd> {
    pub(super) colors: [U<S>; 2],
    pub(super) shares: U<S>,
}

/// The ends of the box's diagonal, rounded to levels.
#[inline(always)]
pub(super) fn box_fit<S: Simd>(simd: S, texels: &Packed<S>) -> QuickFit<S> {
    let ends = diagonal(simd, texels, INSET_SHIFT);
    let red_blue = [quantize::<S>(red_blue::<S>(ends[0]), 31), quantize::<S>(red_blue::<S>(ends[1]), 31)];
    let green = [quantize::<S>(green::<S>(ends[0]), 63), quantize::<S>(green::<S>(ends[1]), 63)];
    assign(simd, texels, red_blue, green)
}

/// The endpoints that are best for the shares that the box's diagonal gives the texels.
#[inline(always)]
pub(super) fn refined_box_fit<S: Simd>(simd: S, texels: &Packed<S>) -> QuickFit<S> {
    let ends = diagonal(simd, texels, REFINED_INSET_SHIFT);
    let line =
        Line::<S>::new([red_blue::<S>(ends[0]), red_blue::<S>(ends[1])], [green::<S>(ends[0]), green::<S>(ends[1])]);
    let zero = Pairs::<S>::splat(simd, 0);
    // Sums of the pairs (r, b), (g, a), and of a times each; with shares a ≤ 3 none exceeds 16·3·255.
    let (mut rb, mut ga, mut a_rb, mut a_ga) = (zero, zero, zero, zero);
    for texel in texels {
        let (x_rb, x_g) = (red_blue::<S>(*texel), green::<S>(*texel));
        let share = line.share(x_rb, x_g);
        let above: Pairs<S> = (share << 16).bitcast();
        let both = above | share.bitcast::<Pairs<S>>();
        let x_ga = x_g | above;
        rb += x_rb;
        ga += x_ga;
        a_rb += x_rb * both;
        a_ga += x_ga * both;
    }
    let moments = Moments {
        n: F::<S>::splat(simd, 16.0),
        x: [low::<S>(rb), low::<S>(ga), high::<S>(rb)],
        a: high::<S>(ga),
        aa: high::<S>(a_ga),
        ax: [low::<S>(a_rb), low::<S>(a_ga), high::<S>(a_rb)],
    };
    let [e0, e1] = moments.solve::<FourColor>(simd).levels;
    let none = F::<S>::splat(simd, 0.0);
    let red_blue = [pair::<S>(e0[0], e0[2]), pair::<S>(e1[0], e1[2])];
    assign(simd, texels, red_blue, [pair::<S>(e0[1], none), pair::<S>(e1[1], none)])
}

/// The ends of the diagonal of the texels' bounding box, packed like texels.
#[inline(always)]
fn diagonal<S: Simd>(simd: S, texels: &Packed<S>, inset_shift: u32) -> [U<S>; 2] {
    let first: S::u8s = texels[0].bitcast();
    let (mut lo, mut hi) = (first, first);
    for texel in &texels[1..] {
        let texel: S::u8s = texel.bitcast();
        lo = lo.min(texel);
        hi = hi.max(texel);
    }
    let inset = (hi - lo) >> inset_shift;
    let (lo, hi): (U<S>, U<S>) = ((lo + inset).bitcast(), (hi - inset).bitcast());
    let falling = falling(simd, texels, lo, hi);
    let exchanged = (lo ^ hi) & falling & 0x00ff_00ff;
    [hi ^ exchanged, lo ^ exchanged]
}

/// All ones in the 16 bits of red and of blue, where the channel falls as green rises.
#[inline(always)]
fn falling<S: Simd>(simd: S, texels: &Packed<S>, lo: U<S>, hi: U<S>) -> U<S> {
    let middle = (lo & hi) + (((lo ^ hi) >> 1) & 0x7f7f_7f7f);
    let (middle_rb, middle_gg) = (red_blue::<S>(middle), green_twice::<S>(middle));
    let mut covariance = Pairs::<S>::splat(simd, 0);
    for texel in texels {
        // At most 128² / 16 a texel.
        covariance += ((red_blue::<S>(*texel) - middle_rb) * (green_twice::<S>(*texel) - middle_gg)) >> 4;
    }
    (covariance >> 15).bitcast()
}

/// Rounds both endpoints to 565 bits and gives every texel the entry that is nearest in projection.
#[inline(always)]
fn assign<S: Simd>(simd: S, texels: &Packed<S>, red_blue5: [Pairs<S>; 2], green6: [Pairs<S>; 2]) -> QuickFit<S> {
    let mut colors = [texels[0]; 2];
    let (mut rb, mut g) = (red_blue5, green6);
    for e in 0..2 {
        let (packed, green): (U<S>, U<S>) = (red_blue5[e].bitcast(), green6[e].bitcast());
        colors[e] = ((packed << 11) | (green << 5) | (packed >> 16)) & 0xffff;
        rb[e] = (rb[e] << 3) | (rb[e] >> 2);
        g[e] = (g[e] << 2) | (g[e] >> 4);
    }
    let line = Line::<S>::new(rb, g);
    let mut shares = I::<S>::splat(simd, 0);
    for texel in texels.iter().rev() {
        shares = (shares << 2) | line.share(red_blue::<S>(*texel), green::<S>(*texel));
    }
    QuickFit { colors, shares: shares.bitcast() }
}

/// The line between two colours, cut where palette entries meet.
struct Line<S: Simd> {
    red_blue: Pairs<S>,
    green: Pairs<S>,
    /// A sixth, a half and five sixths of the way, as scalar products with the direction.
    cuts: [I<S>; 3],
}

impl<S: Simd> Line<S> {
    #[inline(always)]
    fn new(rb: [Pairs<S>; 2], g: [Pairs<S>; 2]) -> Self {
        let (red_blue, green) = (rb[0] - rb[1], g[0] - g[1]);
        let length = red_blue.pairwise_dot_product(red_blue) + green.pairwise_dot_product(green);
        let start = rb[1].pairwise_dot_product(red_blue) + g[1].pairwise_dot_product(green);
        // 3·255² · 10923 is just below 2³¹.
        let sixth = (length * 10923) >> 16;
        Self { red_blue, green, cuts: [start + sixth, start + (length >> 1), start + length - sixth] }
    }

    /// Thirds of the way from the second colour to the first, rounded.
    #[inline(always)]
    fn share(&self, red_blue: Pairs<S>, green: Pairs<S>) -> I<S> {
        let along = red_blue.pairwise_dot_product(self.red_blue) + green.pairwise_dot_product(self.green);
        let [a, b, c] = self.cuts;
        // A true lane is −1.
        -(along.simd_gt(a).to_vector() + along.simd_gt(b).to_vector() + along.simd_gt(c).to_vector())
    }
}

/// Red and blue of packed texels.
#[inline(always)]
fn red_blue<S: Simd>(texels: U<S>) -> Pairs<S> {
    (texels & 0x00ff_00ff).bitcast()
}

/// Green of packed texels, and zero.
#[inline(always)]
fn green<S: Simd>(texels: U<S>) -> Pairs<S> {
    ((texels >> 8) & 0xff).bitcast()
}

/// Green of packed texels, in both of a pair.
#[inline(always)]
fn green_twice<S: Simd>(texels: U<S>) -> Pairs<S> {
    let green = (texels >> 8) & 0xff;
    (green | green << 16).bitcast()
}

/// The level nearest to an 8-bit value: `v · max / 255`, rounded.
#[inline(always)]
fn quantize<S: Simd>(v: Pairs<S>, max: i16) -> Pairs<S> {
    let scaled = v * max + 128;
    (scaled + (scaled >> 8)) >> 8
}

/// The lower of a pair, which must not be negative.
#[inline(always)]
fn low<S: Simd>(pairs: Pairs<S>) -> F<S> {
    let pairs: I<S> = pairs.bitcast();
    (pairs & 0xffff).to_float()
}

/// The upper of a pair.
#[inline(always)]
fn high<S: Simd>(pairs: Pairs<S>) -> F<S> {
    let pairs: I<S> = pairs.bitcast();
    (pairs >> 16).to_float()
}

/// Two integers as a pair.
#[inline(always)]
fn pair<S: Simd>(low: F<S>, high: F<S>) -> Pairs<S> {
    let (low, high): (I<S>, I<S>) = (low.to_int(), high.to_int());
    (low | high << 16).bitcast()
}

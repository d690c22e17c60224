//! One ray per lane: the vectors of the machine, whatever their width.
//!
//! Functions on vectors are `#[inline(always)]` and closures do not hold vectors: code that is not inlined into the
//! dispatched function would be compiled without the machine's vector instructions.

use fearless_simd::prelude::*;

pub(crate) type F<S> = <S as Simd>::f32s;
pub(crate) type I<S> = <S as Simd>::i32s;
pub(crate) type U<S> = <S as Simd>::u32s;
/// Two 16-bit numbers per ray, the first in the low half.
pub(crate) type Pairs<S> = <S as Simd>::u16s;
/// The same, signed.
pub(crate) type Shorts<S> = <S as Simd>::i16s;
pub(crate) type M<S> = <S as Simd>::mask32s;

/// The most lanes that any machine has.
pub(crate) const MAX_LANES: usize = 16;

/// A number for each lane.
pub(crate) type Lanes<T> = [T; MAX_LANES];

/// Rays that are answered together.
pub(crate) const fn lanes<S: Simd>() -> usize {
    <F<S> as SimdBase<S>>::LEN
}

#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, values: &Lanes<f32>) -> F<S> {
    F::<S>::from_slice(simd, &values[..lanes::<S>()])
}

#[inline(always)]
pub(crate) fn load_u32<S: Simd>(simd: S, values: &Lanes<u32>) -> U<S> {
    U::<S>::from_slice(simd, &values[..lanes::<S>()])
}

#[inline(always)]
pub(crate) fn to_lanes<S: Simd>(values: U<S>) -> Lanes<u32> {
    let mut out = [0; MAX_LANES];
    values.store_slice(&mut out[..lanes::<S>()]);
    out
}

/// Where the four numbers of a lane go for [`transpose`], so that none has to leave its 128 bits, which would take twice the shuffles.
pub(crate) const fn slot<S: Simd>(lane: usize) -> usize {
    lane % 4 * (lanes::<S>() / 4) + lane / 4
}

/// Four numbers of each lane, from one [`slot`] each (Eklundh 1972: 1×1, then 2×2 numbers change places).
#[inline(always)]
pub(crate) fn transpose<S: Simd>(simd: S, values: &[[u32; 2]]) -> [U<S>; 4] {
    let n = lanes::<S>();
    let values = values.as_flattened();
    let a = U::<S>::from_slice(simd, &values[..n]);
    let b = U::<S>::from_slice(simd, &values[n..2 * n]);
    let c = U::<S>::from_slice(simd, &values[2 * n..3 * n]);
    let d = U::<S>::from_slice(simd, &values[3 * n..4 * n]);
    let (odd, upper) = (M::<S>::from_bitmask(simd, 0xaaaa), M::<S>::from_bitmask(simd, 0xcccc));
    let ([a, b], [c, d]) = (exchange::<S, 1, 3>(a, b, odd), exchange::<S, 1, 3>(c, d, odd));
    let ([a, c], [b, d]) = (exchange::<S, 2, 2>(a, c, upper), exchange::<S, 2, 2>(b, d, upper));
    [a, b, c, d]
}

/// Exchanges the masked numbers of `a` with those of `b` that are `NEAR` places before, within 128 bits. `BACK` is 4 − `NEAR`.
#[inline(always)]
fn exchange<S: Simd, const NEAR: usize, const BACK: usize>(a: U<S>, b: U<S>, mask: M<S>) -> [U<S>; 2] {
    [mask.select(b.slide_within_blocks::<BACK>(b), a), mask.select(b, a.slide_within_blocks::<NEAR>(a))]
}

/// Non-negative integers below 2²⁴ as such.
#[inline(always)]
pub(crate) fn whole<S: Simd>(values: F<S>) -> U<S> {
    values.to_int::<I<S>>().bitcast()
}

/// The other way.
#[inline(always)]
pub(crate) fn real<S: Simd>(values: U<S>) -> F<S> {
    let values: I<S> = values.bitcast();
    values.to_float()
}

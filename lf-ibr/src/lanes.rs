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

/// Four numbers of each lane, from lanes of twice two.
#[inline(always)]
pub(crate) fn transpose<S: Simd>(simd: S, values: &[[u32; 2]]) -> [U<S>; 4] {
    let n = lanes::<S>();
    let values = values.as_flattened();
    let a = U::<S>::from_slice(simd, &values[..n]);
    let b = U::<S>::from_slice(simd, &values[n..2 * n]);
    let c = U::<S>::from_slice(simd, &values[2 * n..3 * n]);
    let d = U::<S>::from_slice(simd, &values[3 * n..4 * n]);
    let (even, odd) = ([a.unzip_low(b), c.unzip_low(d)], [a.unzip_high(b), c.unzip_high(d)]);
    [even[0].unzip_low(even[1]), odd[0].unzip_low(odd[1]), even[0].unzip_high(even[1]), odd[0].unzip_high(odd[1])]
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

//! The SIMD form of a group of blocks: one block per lane, one vector per texel and channel.
//!
//! All searches compute on a whole group at once. A lane never looks at another lane, so the number of lanes that a
//! machine has does not change any block. Neither does fused multiplication: `mul_add` is used only on integers whose
//! results stay below 2²⁴, where it rounds nowhere. What is not an integer, an axis say, is computed with
//! `+ − × ÷` and square roots, which IEEE 754 fixes to the bit.
//!
//! Functions on vectors are `#[inline(always)]` and closures do not hold vectors: code that is not inlined into the
//! dispatched function would be compiled without the machine's vector instructions.

use fearless_simd::prelude::*;

use super::Texel;

pub(super) type F<S> = <S as Simd>::f32s;
pub(super) type I<S> = <S as Simd>::i32s;
pub(super) type U<S> = <S as Simd>::u32s;
pub(super) type M<S> = <S as Simd>::mask32s;

/// A colour, or a direction in RGB, for every lane.
pub(super) type Rgb<S> = [F<S>; 3];

/// Packed RGBA texels, red lowest: vector `4y + x` holds the texel in column `x` and row `y` of every block.
pub(super) type Packed<S> = [U<S>; 16];

/// The most blocks that any machine groups.
pub(super) const MAX_LANES: usize = 16;

/// Four rows of `4 · lanes` texels: a group as it lies in the image.
pub(super) type Rows<'a> = [&'a [Texel]; 4];

/// Blocks in a group.
pub(super) const fn lanes<S: Simd>() -> usize {
    <U<S> as SimdBase<S>>::LEN
}

/// Gathers the texels of a group.
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, rows: Rows<'_>) -> Packed<S> {
    let n = lanes::<S>();
    let mut texels = [U::<S>::splat(simd, 0); 16];
    for (y, row) in rows.iter().enumerate() {
        let [a, b] = [vector(simd, &row[..n]), vector(simd, &row[n..2 * n])];
        let [c, d] = [vector(simd, &row[2 * n..3 * n]), vector(simd, &row[3 * n..4 * n])];
        let (even, odd) = ([a.unzip_low(b), c.unzip_low(d)], [a.unzip_high(b), c.unzip_high(d)]);
        texels[4 * y] = even[0].unzip_low(even[1]);
        texels[4 * y + 1] = odd[0].unzip_low(odd[1]);
        texels[4 * y + 2] = even[0].unzip_high(even[1]);
        texels[4 * y + 3] = odd[0].unzip_high(odd[1]);
    }
    texels
}

/// Loads one texel per lane, as they lie.
#[inline(always)]
fn vector<S: Simd>(simd: S, texels: &[Texel]) -> U<S> {
    if cfg!(target_endian = "little") {
        S::u8s::from_slice(simd, texels.as_flattened()).bitcast()
    } else {
        let mut words = [0; MAX_LANES];
        for (word, texel) in words.iter_mut().zip(texels) {
            *word = u32::from_le_bytes(*texel);
        }
        U::<S>::from_slice(simd, &words[..lanes::<S>()])
    }
}

/// A group's texels, channel by channel: integers from 0 to 255.
pub(super) struct Group<S: Simd> {
    pub(super) simd: S,
    pub(super) channels: [[F<S>; 16]; 3],
    /// Per channel, the sum over a block's texels: at most 16·255.
    pub(super) sums: Rgb<S>,
}

impl<S: Simd> Group<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, texels: &Packed<S>) -> Self {
        let zero = F::<S>::splat(simd, 0.0);
        let mut channels = [[zero; 16]; 3];
        for (i, texel) in texels.iter().enumerate() {
            let rgb = unpack::<S>(*texel);
            for c in 0..3 {
                channels[c][i] = rgb[c];
            }
        }
        Self { simd, sums: [sum::<S>(&channels[0]), sum::<S>(&channels[1]), sum::<S>(&channels[2])], channels }
    }

    #[inline(always)]
    pub(super) fn splat(&self, value: f32) -> F<S> {
        F::<S>::splat(self.simd, value)
    }

    /// Red, green and blue of texel `i`.
    #[inline(always)]
    pub(super) fn texel(&self, i: usize) -> Rgb<S> {
        [self.channels[0][i], self.channels[1][i], self.channels[2][i]]
    }

    /// 256 times the covariance of two channels, `16·Σxy − Σx·Σy`: exact, as both terms are at most 256·255² < 2²⁴.
    #[inline(always)]
    pub(super) fn covariance(&self, a: usize, b: usize) -> F<S> {
        let mut products = self.channels[a][0] * self.channels[b][0];
        for i in 1..16 {
            products = self.channels[a][i].mul_add(self.channels[b][i], products);
        }
        products * 16.0 - self.sums[a] * self.sums[b]
    }
}

/// Red, green and blue of packed texels.
#[inline(always)]
pub(super) fn unpack<S: Simd>(texel: U<S>) -> Rgb<S> {
    let texel: I<S> = texel.bitcast();
    [(texel & 255).to_float(), ((texel >> 8) & 255).to_float(), ((texel >> 16) & 255).to_float()]
}

/// Four partial sums, so that additions need not wait for each other; of integers, hence exact in any order.
#[inline(always)]
fn sum<S: Simd>(values: &[F<S>; 16]) -> F<S> {
    let mut sums = [values[0], values[1], values[2], values[3]];
    for i in 4..16 {
        sums[i % 4] += values[i];
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// Scalar product.
#[inline(always)]
pub(super) fn dot<S: Simd>(a: &Rgb<S>, b: &Rgb<S>) -> F<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

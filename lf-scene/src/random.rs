//! Random numbers that are a function of what is asked, and evenly spread over the samples of one question.
//!
//! Each decision on a path takes a point of the unit square. All samples of a ray together take points of Sobol's sequence in two
//! dimensions: of 2ᵐ points every dyadic rectangle of area 2⁻ᵐ has one. Each decision flips digits of its own in all points
//! (Kollig & Keller: Efficient Multidimensional Sampling, Eurographics 2002), so that one point alone is uniform; and has an
//! order of its own, so that no two decisions are related (Burley: Practical Hash-based Owen Scrambling, JCGT 9(4), 2020, which calls
//! it padding). The error of a mean over n points falls faster than n⁻¹ᐟ² where it depends on few decisions; n need not be a
//! power of two. Owen's scrambling, which flips each digit by those before it, is dearer and leaves larger errors with 4 to 16 samples.
//!
//! What is not done: points of different decisions are not spread together, nor are those of different rays.

use glam::Vec2;

/// Where bits beyond the sequence's begin in numbers of 53 bits.
const BEYOND: u32 = 53 - 32;

/// The points of one sample, a decision after the other.
#[derive(Clone, Copy)]
pub(crate) struct Random {
    /// The sample's number among those of the ray.
    sample: u32,
    /// The state of SplitMix64 (Steele, Lea & Flood 2014). It deals flips and orders, the same to all samples of the ray.
    state: u64,
}

impl Random {
    /// The first sample of what some words ask for.
    pub(crate) fn of(words: impl IntoIterator<Item = u64>) -> Self {
        Self { sample: 0, state: words.into_iter().fold(0, |hash, word| mixed(hash.wrapping_add(GAMMA) ^ word)) }
    }

    /// Another sample of the same.
    pub(crate) fn of_sample(self, number: u32) -> Self {
        Self { sample: number, ..self }
    }

    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GAMMA);
        mixed(self.state)
    }

    /// The next point, as fractions of 2³².
    fn next(&mut self) -> [u32; 2] {
        let (order, flips) = (self.bits(), self.bits());
        let index = shuffled(self.sample, order);
        [index.reverse_bits() ^ flips as u32, binomial(index).reverse_bits() ^ (flips >> 32) as u32]
    }

    /// A number in 0 … 1, never 1, in steps of 2⁻²⁴.
    pub(crate) fn uniform(&mut self) -> f32 {
        self.pair().x
    }

    /// A point of the unit square, in steps of 2⁻²⁴, never 1.
    pub(crate) fn pair(&mut self) -> Vec2 {
        self.next().map(|bits| (bits >> 8) as f32 / (1 << 24) as f32).into()
    }

    /// A point of the unit square, in steps of 2⁻⁵³, never 1: to choose among many, and then with what is left.
    pub(crate) fn fine(&mut self) -> [f64; 2] {
        let [x, y] = self.next();
        let beyond = self.bits();
        let number = |bits: u32, beyond: u64| (u64::from(bits) << BEYOND | beyond & ((1 << BEYOND) - 1)) as f64;
        [number(x, beyond), number(y, beyond >> BEYOND)].map(|number| number / (1u64 << 53) as f64)
    }
}

/// Odd, near the golden ratio of 2⁶⁴.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// Every bit depends on all (the finaliser of SplitMix64 with David Stafford's constants).
fn mixed(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A number's place in an order that keeps each aligned block of 2ᵐ numbers together: whether a bit is flipped is a hash of the higher ones
/// (Laine & Karras: Stratified Sampling for Stochastic Transparency, EGSR 2011; constants by Nathan Vegdahl).
fn shuffled(number: u32, key: u64) -> u32 {
    let x = number.reverse_bits();
    let x = x ^ x.wrapping_mul(0x3d20_adea);
    let x = x.wrapping_add(key as u32).wrapping_mul((key >> 32) as u32 | 1);
    let x = x ^ x.wrapping_mul(0x0552_6c56);
    (x ^ x.wrapping_mul(0x53a2_2864)).reverse_bits()
}

/// The second dimension of Sobol's sequence from the index, first digit lowest: digit j is the sum of the index's bits k with odd
/// binomial coefficients (k over j), which are those where k has all bits of j.
fn binomial(index: u32) -> u32 {
    let masks = [0x5555_5555, 0x3333_3333, 0x0f0f_0f0f, 0x00ff_00ff, 0x0000_ffff];
    masks.into_iter().enumerate().fold(index, |x, (level, mask)| x ^ ((x >> (1 << level)) & mask))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pearson's statistic of `COUNT` points in 16 × 16 cells, for what is made of neighbouring seeds.
    fn assert_even(what: &str, point: impl Fn(Random) -> [f64; 2]) {
        const COUNT: u64 = 1 << 16;
        let mut cells = [0u32; 256];
        for seed in 0..COUNT {
            let [x, y] = point(Random::of([seed, 7]));
            cells[(x * 16.0) as usize * 16 + (y * 16.0) as usize] += 1;
        }
        let expected = COUNT as f64 / 256.0;
        let chi2: f64 = cells.iter().map(|&n| (f64::from(n) - expected).powi(2) / expected).sum();
        // 255 degrees of freedom: five standard deviations of √510.
        assert!((chi2 - 255.0).abs() < 5.0 * 510f64.sqrt(), "{what}: {chi2}");
    }

    /// A decision of a sample, some decisions having been taken.
    fn decision(random: Random, sample: u32, before: u32) -> [f64; 2] {
        let mut random = random.of_sample(sample);
        for _ in 0..before {
            random.next();
        }
        random.fine()
    }

    /// Whatever the sample's number, all its points are uniform over rays, to their last bits, and independent of each other.
    #[test]
    fn each_sample_is_uniform() {
        for sample in [0, 1, 2, 3, 5, 15, 16, 1000, u32::MAX] {
            for before in 0..4 {
                let point = |random| decision(random, sample, before);
                assert_even(&format!("point {before} of sample {sample}"), point);
                for scale in [16u64, 1 << 12, 1 << 20, 1 << 30, 1 << 49].map(|scale| scale as f64) {
                    let end = |random| point(random).map(|x| (x * scale).fract());
                    assert_even(&format!("end from 1/{scale} of point {before} of sample {sample}"), end);
                }
                let next = |random| [point(random)[0], decision(random, sample, before + 1)[0]];
                assert_even(&format!("points {before} and after of sample {sample}"), next);
            }
        }
    }

    /// How two samples differ in one decision tells nothing of how they differ in another: without orders of their own it would be alike.
    #[test]
    fn decisions_are_shuffled() {
        // Numbers that differ in bit 5: the five digits before that one are free.
        for (one, other) in [(0, 32), (3, 47), (17, 50), (64, 96)] {
            for (first, second) in [(0, 1), (1, 3)] {
                let differ = |random, before| {
                    let bits = |sample| (decision(random, sample, before)[0] * 2f64.powi(32)) as u32;
                    f64::from(bits(one) ^ bits(other)) / 2f64.powi(32)
                };
                let across = |random| [differ(random, first), differ(random, second)];
                assert_even(&format!("samples {one} and {other} in decisions {first} and {second}"), across);
            }
        }
    }

    /// The first 2ᵐ samples, and each 2ᵐ after them, have one point in every rectangle of area 2⁻ᵐ: a (0, 2)-sequence.
    #[test]
    fn samples_are_spread_evenly() {
        for (seed, m, block) in [(1, 2, 0), (2, 4, 0), (3, 4, 5), (4, 7, 1), (5, 10, 0)] {
            for before in 0..3 {
                let samples = (block << m)..((block + 1) << m);
                let points: Vec<_> = samples.map(|i| decision(Random::of([seed]), i, before)).collect();
                for wide in 0..=m {
                    let cell = |[x, y]: [f64; 2]| {
                        (x * f64::from(1 << wide)) as usize + ((y * f64::from(1 << (m - wide))) as usize * (1 << wide))
                    };
                    let mut seen: Vec<_> = points.iter().copied().map(cell).collect();
                    seen.sort_unstable();
                    assert!(seen.into_iter().eq(0..1 << m), "seed {seed}, 2^{m} samples, columns: 2^{wide}");
                }
            }
        }
    }
}

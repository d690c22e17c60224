//! Random numbers that are a function of what is asked.

/// Melissa O'Neill's PCG-XSH-RR 64/32 (PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for
/// Random Number Generation, 2014).
pub(crate) struct Random {
    state: u64,
    increment: u64,
}

impl Random {
    /// The generator that belongs to some words.
    pub(crate) fn of(words: impl IntoIterator<Item = u64>) -> Self {
        let hash = words.into_iter().fold(0, |hash: u64, word| mixed(hash.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ word));
        Self { state: hash, increment: mixed(hash) | 1 }
    }

    fn bits(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(self.increment);
        let xored = (((old >> 18) ^ old) >> 27) as u32;
        xored.rotate_right((old >> 59) as u32)
    }

    /// A number in 0 … 1, never 1, in steps of 2⁻²⁴.
    pub(crate) fn uniform(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / (1 << 24) as f32
    }

    /// A number in 0 … 1, never 1, in steps of 2⁻⁵³: to choose among many.
    pub(crate) fn fine(&mut self) -> f64 {
        let bits = (u64::from(self.bits()) << 32) | u64::from(self.bits());
        (bits >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Every bit depends on all (the finaliser of SplitMix64: Steele, Lea & Flood 2014, with David Stafford's constants).
fn mixed(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first numbers of neighbouring seeds are as good as independent: what the tracer takes for each sample.
    #[test]
    fn first_numbers_of_neighbouring_seeds_are_spread_evenly() {
        const COUNT: u64 = 1 << 16;
        let mut cells = [0u32; 256];
        for seed in 0..COUNT {
            let mut random = Random::of([seed, 7]);
            let (x, y) = (random.uniform(), random.fine());
            cells[(x * 16.0) as usize * 16 + (y * 16.0) as usize] += 1;
        }
        let expected = COUNT as f64 / 256.0;
        let chi2: f64 = cells.iter().map(|&n| (f64::from(n) - expected).powi(2) / expected).sum();
        // 255 degrees of freedom: five standard deviations of √510.
        assert!((chi2 - 255.0).abs() < 5.0 * 510f64.sqrt(), "{chi2}");
    }
}

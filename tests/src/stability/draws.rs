//! Inputs: spread evenly over their exponents, close to where things change, and those that are hardly numbers.

use glam::Vec3;

/// A fixed sequence of numbers (SplitMix64; Steele et al. 2014).
#[derive(Debug, Clone)]
pub struct Draws(u64);

/// Numbers that break what was not thought of.
pub const ODD: [f32; 16] = [
    0.0,
    -0.0,
    1e-45,
    -1e-45,
    1e-40,
    -1e-39,
    f32::MIN_POSITIVE,
    1e-30,
    -1e-30,
    1e30,
    -1e30,
    f32::MAX,
    f32::MIN,
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
];

impl Draws {
    /// A sequence by its seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Evenly from 0 to `count` − 1.
    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    /// Evenly within 0 … 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Evenly within a range.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Evenly in the logarithm, greater than 0.
    pub fn log(&mut self, low: f64, high: f64) -> f64 {
        (low.ln() + (high / low).ln() * self.unit()).exp()
    }

    /// −1 or 1.
    pub fn sign(&mut self) -> f64 {
        if self.bits() & 1 == 0 { 1.0 } else { -1.0 }
    }

    /// Of either sign, evenly in the logarithm of its size.
    pub fn number(&mut self, low: f64, high: f64) -> f32 {
        (self.sign() * self.log(low, high)) as f32
    }

    /// Three of [`Self::number`].
    pub fn vector(&mut self, low: f64, high: f64) -> Vec3 {
        Vec3::new(self.number(low, high), self.number(low, high), self.number(low, high))
    }

    /// As [`Self::vector`], one in eight with a component of [`ODD`], some with more.
    pub fn odd_vector(&mut self, low: f64, high: f64) -> Vec3 {
        let mut v = self.vector(low, high);
        for _ in 0..[0, 0, 0, 0, 0, 0, 1, 3][self.below(8)] {
            v[self.below(3)] = ODD[self.below(ODD.len())];
        }
        v
    }

    /// Evenly in the box from −`half` to `half`; one in four on its surface.
    pub fn in_box(&mut self, half: Vec3) -> Vec3 {
        let mut p = Vec3::from_array([0, 1, 2].map(|i| (self.between(-1.0, 1.0) * f64::from(half[i])) as f32));
        if self.below(4) == 0 {
            let axis = self.below(3);
            p[axis] = half[axis].copysign(p[axis]);
        }
        p
    }

    /// A unit vector in `f64`, evenly over the sphere.
    pub fn direction(&mut self) -> glam::DVec3 {
        let (y, angle) = (self.between(-1.0, 1.0), self.between(0.0, std::f64::consts::TAU));
        let r = (1.0 - y * y).sqrt();
        glam::DVec3::new(r * angle.cos(), y, r * angle.sin())
    }

    /// A few steps of the last place away.
    pub fn nudged(&mut self, value: f32) -> f32 {
        let steps = self.below(9) as i32 - 4;
        (0..steps.abs()).fold(value, |value, _| if steps > 0 { value.next_up() } else { value.next_down() })
    }
}

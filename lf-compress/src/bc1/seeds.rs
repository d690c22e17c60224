//! Endpoints of blocks further left, as starting points for blocks that show nearly the same.
//!
//! In a slice of a light field the same block of the neighbouring camera is a near-copy. What its search found, often far
//! from where the principal axis would start, is tried beside the block's own start.

use fearless_simd::prelude::*;

use super::fit::Ends;
use super::lanes::{F, M, MAX_LANES, lanes};

/// The endpoints found along one row of blocks.
pub(super) struct Seeds {
    /// Blocks from a seed to the block that uses it: at least [`MAX_LANES`], so that every machine has the seed by then.
    distance: usize,
    /// By endpoint and channel: the levels of block `b` at `distance + b`.
    levels: [[Vec<f32>; 3]; 2],
}

impl Seeds {
    /// For a row of `blocks` that repeats itself every `repeat` blocks.
    pub(super) fn new(repeat: usize, blocks: usize) -> Self {
        let distance = repeat * MAX_LANES.div_ceil(repeat);
        Self {
            distance,
            levels: std::array::from_fn(|_| std::array::from_fn(|_| vec![0.0; distance + blocks + MAX_LANES])),
        }
    }

    /// The seeds of a group, and which lanes have one.
    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, first: usize) -> (Ends<S>, M<S>) {
        let none = F::<S>::splat(simd, 0.0);
        let mut ends = Ends { levels: [[none; 3]; 2] };
        for e in 0..2 {
            for c in 0..3 {
                ends.levels[e][c] = F::<S>::from_slice(simd, &self.levels[e][c][first..first + lanes::<S>()]);
            }
        }
        let mut has_seed = [0; MAX_LANES];
        for (lane, has_seed) in has_seed.iter_mut().enumerate() {
            *has_seed = -i32::from(first + lane >= self.distance);
        }
        (ends, M::<S>::from_slice(simd, &has_seed[..lanes::<S>()]))
    }

    /// Keeps what was found for a group.
    #[inline(always)]
    pub(super) fn store<S: Simd>(&mut self, first: usize, ends: &Ends<S>) {
        let at = self.distance + first;
        for e in 0..2 {
            for c in 0..3 {
                ends.levels[e][c].store_slice(&mut self.levels[e][c][at..at + lanes::<S>()]);
            }
        }
    }
}

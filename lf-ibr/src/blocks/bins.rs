//! Rays sorted by slab, a vector's worth at a time.

use fearless_simd::prelude::*;
use glam::Vec3;
use lf_math::{Face, Ray};

use super::kernel::{Fetched, answer};
use super::storage::SlabBlocks;
use crate::lanes::{Lanes, MAX_LANES, lanes};

/// Rays of one slab that wait for company.
#[derive(Clone, Copy)]
pub(super) struct Bin {
    /// By axis.
    pub(super) origins: [Lanes<f32>; 3],
    pub(super) directions: [Lanes<f32>; 3],
    numbers: Lanes<usize>,
    len: usize,
}

impl Bin {
    const EMPTY: Self = Self {
        origins: [[0.0; MAX_LANES]; 3],
        // Lanes without a ray compute like the others.
        directions: [[1.0; MAX_LANES]; 3],
        numbers: [0; MAX_LANES],
        len: 0,
    };

    #[inline(always)]
    fn push(&mut self, number: usize, ray: &Ray) {
        let at = self.len % MAX_LANES;
        let Vec3 { x, y, z } = ray.origin;
        [self.origins[0][at], self.origins[1][at], self.origins[2][at]] = [x, y, z];
        let Vec3 { x, y, z } = ray.direction;
        [self.directions[0][at], self.directions[1][at], self.directions[2][at]] = [x, y, z];
        self.numbers[at] = number;
        self.len += 1;
    }
}

/// Answers rays, each in its place.
#[inline(always)]
pub(super) fn look_up<S: Simd>(simd: S, slabs: &[SlabBlocks], rays: &[Ray], answers: &mut [Option<Vec3>]) {
    let (mut bins, mut fetched) = ([Bin::EMPTY; 6], Fetched::default());
    let by_face = Face::ALL.map(|face| slabs.iter().find(|slab| slab.face == face));
    for number in 0..rays.len().min(answers.len()) {
        let Some(face) = Face::dominant(rays[number].direction) else {
            answers[number] = None;
            continue;
        };
        let bin = &mut bins[usize::from(face.index())];
        bin.push(number, &rays[number]);
        if bin.len == lanes::<S>() {
            flush(simd, by_face[usize::from(face.index())], bin, &mut fetched, answers);
        }
    }
    for (bin, slab) in bins.iter_mut().zip(by_face).filter(|(bin, _)| bin.len > 0) {
        flush(simd, slab, bin, &mut fetched, answers);
    }
}

/// Answers the rays of a bin, and empties it.
#[inline(always)]
fn flush<S: Simd>(
    simd: S,
    slab: Option<&SlabBlocks>,
    bin: &mut Bin,
    fetched: &mut Fetched,
    answers: &mut [Option<Vec3>],
) {
    let numbers = bin.numbers.iter().take(bin.len);
    match slab {
        Some(slab) => {
            let (colors, known) = answer(simd, slab, bin, fetched);
            for (i, &number) in numbers.enumerate() {
                let color = Vec3::new(colors[0][i], colors[1][i], colors[2][i]);
                answers[number] = (known >> i & 1 == 1).then_some(color);
            }
        }
        None => numbers.for_each(|&number| answers[number] = None),
    }
    bin.len = 0;
}

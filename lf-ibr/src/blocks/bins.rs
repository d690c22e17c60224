//! Rays in groups of one slab, a vector's worth at a time. Neighbours mostly are one already; others are sorted into bins.

use fearless_simd::prelude::*;
use glam::Vec3;
use lf_math::Ray;

use super::kernel::{Colors, Fetched, answer};
use super::storage::SlabBlocks;
use crate::lanes::{Lanes, MAX_LANES, U, lanes, load, to_lanes};

/// In place of the number of a face: there is none.
const NO_FACE: usize = 6;

/// As many rays as there are lanes, by axis.
#[derive(Clone, Copy)]
pub(super) struct Rays {
    pub(super) origins: [Lanes<f32>; 3],
    pub(super) directions: [Lanes<f32>; 3],
}

impl Rays {
    /// Lanes without a ray compute like the others.
    const EMPTY: Self = Self { origins: [[0.0; MAX_LANES]; 3], directions: [[1.0; MAX_LANES]; 3] };

    #[inline(always)]
    fn set(&mut self, lane: usize, ray: &Ray) {
        let Vec3 { x, y, z } = ray.origin;
        [self.origins[0][lane], self.origins[1][lane], self.origins[2][lane]] = [x, y, z];
        let Vec3 { x, y, z } = ray.direction;
        [self.directions[0][lane], self.directions[1][lane], self.directions[2][lane]] = [x, y, z];
    }

    /// Takes the next rays, if there are any, off the front of others.
    #[inline(always)]
    fn take<S: Simd>(&mut self, rays: &mut &[Ray]) {
        let (group, rest) = rays.split_at(rays.len().min(lanes::<S>()));
        for (lane, ray) in group.iter().enumerate() {
            self.set(lane, ray);
        }
        *rays = rest;
    }
}

/// Rays of one slab that wait for company.
#[derive(Clone, Copy)]
struct Bin {
    rays: Rays,
    numbers: Lanes<usize>,
    len: usize,
}

impl Bin {
    const EMPTY: Self = Self { rays: Rays::EMPTY, numbers: [0; MAX_LANES], len: 0 };

    #[inline(always)]
    fn push(&mut self, number: usize, ray: &Ray) {
        let lane = self.len % MAX_LANES;
        self.rays.set(lane, ray);
        self.numbers[lane] = number;
        self.len += 1;
    }
}

/// Answers rays, each in its place.
#[inline(always)]
pub(super) fn look_up<S: Simd>(simd: S, slabs: &[SlabBlocks], rays: &[Ray], answers: &mut [Option<Vec3>]) {
    let (mut bins, mut fetched) = ([Bin::EMPTY; NO_FACE + 1], Fetched::default());
    let by_face: [_; NO_FACE + 1] =
        std::array::from_fn(|face| slabs.iter().find(|slab| usize::from(slab.face.index()) == face));
    let rays = &rays[..rays.len().min(answers.len())];
    // One group is read while another is answered: vectors of what has just been written lane by lane have to wait.
    let (mut ahead, mut groups) = (rays, [Rays::EMPTY; 2]);
    groups[0].take::<S>(&mut ahead);
    for (n, rays) in rays.chunks(lanes::<S>()).enumerate() {
        groups[(n + 1) % 2].take::<S>(&mut ahead);
        let (first, group) = (n * lanes::<S>(), &groups[n % 2]);
        let faces = faces(simd, group);
        if rays.len() == lanes::<S>() && faces[..lanes::<S>()].iter().all(|&face| face == faces[0]) {
            let colors = answer_group(simd, by_face[faces[0] as usize], group, &mut fetched);
            for (lane, answer) in answers[first..][..lanes::<S>()].iter_mut().enumerate() {
                *answer = colors.of(lane);
            }
            continue;
        }
        for (lane, ray) in rays.iter().enumerate() {
            let face = faces[lane] as usize;
            let bin = &mut bins[face];
            bin.push(first + lane, ray);
            if bin.len == lanes::<S>() {
                flush(simd, by_face[face], bin, &mut fetched, answers);
            }
        }
    }
    for (bin, slab) in bins.iter_mut().zip(by_face).filter(|(bin, _)| bin.len > 0) {
        flush(simd, slab, bin, &mut fetched, answers);
    }
}

#[inline(always)]
fn answer_group<S: Simd>(simd: S, slab: Option<&SlabBlocks>, rays: &Rays, fetched: &mut Fetched) -> Colors {
    // One copy of the code, that every caller calls.
    simd.vectorize(
        #[inline(always)]
        || match slab {
            Some(slab) => answer(simd, slab, rays, fetched),
            None => Colors::NONE,
        },
    )
}

/// The faces that the rays of a bin leave through, and whether they are all the same. 6 is none. (`Face::dominant`)
#[inline(always)]
fn faces<S: Simd>(simd: S, group: &Rays) -> Lanes<u32> {
    let [x, y, z] =
        [load(simd, &group.directions[0]), load(simd, &group.directions[1]), load(simd, &group.directions[2])];
    let [a, b, c] = [x.abs(), y.abs(), z.abs()];
    let (first, second) = (a.simd_ge(b) & a.simd_ge(c), b.simd_ge(c));
    let along = first.select(x, second.select(y, z));
    let number = |n| U::<S>::splat(simd, n);
    let axis = first.select(number(0), second.select(number(2), number(4)));
    let face = along.simd_lt(0.0).select(axis + 1, axis);
    let finite = a.simd_le(f32::MAX) & b.simd_le(f32::MAX) & c.simd_le(f32::MAX);
    let known = finite & along.abs().simd_gt(0.0);
    let face = known.select(face, number(NO_FACE as u32));
    to_lanes::<S>(face)
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
    let colors = answer_group(simd, slab, &bin.rays, fetched);
    for (lane, &number) in bin.numbers.iter().take(bin.len).enumerate() {
        answers[number] = colors.of(lane);
    }
    bin.len = 0;
}

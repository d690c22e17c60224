//! A group of rays for one slab: places, then blocks, then colours.

use fearless_simd::prelude::*;
use glam::Vec3;

use super::axis::Neighbour;
use super::bins::Rays;
use super::storage::{ABSENT, BAND, SlabBlocks};
use crate::lanes::{F, Lanes, MAX_LANES, U, lanes, load, load_u32, slot, to_lanes, transpose};
use crate::palette::{Block, Ends};

/// Two blocks side by side, for each lane.
type Row = Lanes<[Block; 2]>;

/// The blocks around the rays of a group: by camera, upper and lower.
#[derive(Default)]
pub(super) struct Fetched([[Row; 2]; 4]);

/// One of the four cameras around each lane's ray.
#[derive(Clone, Copy)]
struct Tap<S: Simd> {
    weight: F<S>,
    /// Where the upper blocks of the neighbourhood lie, and the lower ones.
    blocks: [Lanes<u32>; 2],
}

/// The colours of the rays in a group, by channel and lane, 0 … 1.
pub(super) struct Colors {
    colors: [Lanes<f32>; 3],
    /// Which lanes have one, by bit.
    known: u64,
}

impl Colors {
    pub(super) const NONE: Self = Self { colors: [[0.0; MAX_LANES]; 3], known: 0 };

    #[inline(always)]
    pub(super) fn of(&self, lane: usize) -> Option<Vec3> {
        let [red, green, blue] = &self.colors;
        (self.known >> lane & 1 == 1).then_some(Vec3::new(red[lane], green[lane], blue[lane]))
    }
}

/// Looks rays up in their slab. `fetched` is scratch.
#[inline(always)]
pub(super) fn answer<S: Simd>(simd: S, slab: &SlabBlocks, rays: &Rays, fetched: &mut Fetched) -> Colors {
    let [columns, rows] = neighbours(simd, slab, rays);
    let taps = [
        tap(simd, slab, &columns[0], &rows[0]),
        tap(simd, slab, &columns[1], &rows[0]),
        tap(simd, slab, &columns[0], &rows[1]),
        tap(simd, slab, &columns[1], &rows[1]),
    ];
    for (tap, fetched) in taps.iter().zip(&mut fetched.0) {
        fetch::<S>(&slab.blocks, &tap.blocks[0], &mut fetched[0]);
        fetch::<S>(&slab.blocks, &tap.blocks[1], &mut fetched[1]);
    }
    let mut sums = [F::<S>::splat(simd, 0.0); 3];
    let mut found = F::<S>::splat(simd, 0.0);
    for (i, (tap, fetched)) in taps.iter().zip(&fetched.0).enumerate() {
        let (column, row) = (&columns[i % 2], &rows[i / 2]);
        found += tap.weight;
        let lower = tap.weight * row.fraction;
        add(simd, column, row.bits[0], slab.three, tap.weight - lower, &fetched[0], &mut sums);
        add(simd, column, row.bits[1], slab.three, lower, &fetched[1], &mut sums);
    }
    let scale = if slab.starts.is_empty() { F::<S>::splat(simd, 1.0) } else { found.max(f32::MIN_POSITIVE) };
    let scale = F::<S>::splat(simd, 1.0 / 255.0) / scale;
    let known = found.simd_gt(0.0);
    let mut colors = [[0.0; MAX_LANES]; 3];
    for (sum, color) in sums.into_iter().zip(&mut colors) {
        (sum * scale).store_slice(&mut color[..lanes::<S>()]);
    }
    Colors { colors, known: known.to_bitmask() }
}

/// The cameras around each ray along both axes (Eqs. 1, 3 and 4 of the paper).
#[inline(always)]
fn neighbours<S: Simd>(simd: S, slab: &SlabBlocks, rays: &Rays) -> [[Neighbour<S>; 2]; 2] {
    let (k, [s, t]) = (slab.face.axis(), slab.face.tangents());
    let depth = load(simd, &rays.directions[k]).abs();
    let slopes = [load(simd, &rays.directions[s]) / depth, load(simd, &rays.directions[t]) / depth];
    let run = (F::<S>::splat(simd, slab.plane) - load(simd, &rays.origins[k])) * slab.face.sign();
    let positions = [load(simd, &rays.origins[s]) + run * slopes[0], load(simd, &rays.origins[t]) + run * slopes[1]];
    [slab.axes[0].neighbours(simd, positions[0], slopes[0]), slab.axes[1].neighbours(simd, positions[1], slopes[1])]
}

#[inline(always)]
fn tap<S: Simd>(simd: S, slab: &SlabBlocks, column: &Neighbour<S>, row: &Neighbour<S>) -> Tap<S> {
    let [columns, rows] = &slab.axes;
    let mut weight = column.share * row.share;
    let (start, stride) = if slab.starts.is_empty() {
        let (across, down) = (U::<S>::splat(simd, columns.cameras()), rows.cameras());
        let band = row.camera & !(BAND - 1);
        let together = (U::<S>::splat(simd, down) - band).min(BAND) * columns.blocks();
        let first = band * across * (columns.blocks() * rows.blocks()) + (row.camera - band) * columns.blocks();
        (first + column.camera * together, together * across)
    } else {
        let start = starts(simd, slab, row.camera * columns.cameras() + column.camera);
        weight = start.simd_eq(ABSENT).select(F::<S>::splat(simd, 0.0), weight);
        (start, column.blocks)
    };
    let upper = start + row.block * stride + column.block;
    let lower = row.crosses.select(upper + stride, upper);
    // An absent camera's blocks may lie anywhere. What is read for it does not count.
    let last = slab.blocks.len() as u32 - 2;
    Tap { weight, blocks: [to_lanes::<S>(upper.min(last)), to_lanes::<S>(lower.min(last))] }
}

/// Where the blocks of each lane's camera begin.
#[inline(always)]
fn starts<S: Simd>(simd: S, slab: &SlabBlocks, camera: U<S>) -> U<S> {
    let mut starts = to_lanes::<S>(camera);
    for start in starts.iter_mut().take(lanes::<S>()) {
        *start = slab.starts.get(*start as usize).copied().unwrap_or(ABSENT);
    }
    load_u32(simd, &starts)
}

/// Reads the block at each place and the one after it. All places exist.
#[inline(always)]
fn fetch<S: Simd>(blocks: &[Block], places: &Lanes<u32>, out: &mut Row) {
    for (lane, &place) in places.iter().enumerate().take(lanes::<S>()) {
        let place = place as usize;
        out[slot::<S>(lane)].copy_from_slice(&blocks[place..place + 2]);
    }
}

/// Adds two texels side by side, of a weight together, in the row whose place in the block is half of `above`.
#[inline(always)]
fn add<S: Simd>(
    simd: S,
    column: &Neighbour<S>,
    above: U<S>,
    three: bool,
    weight: F<S>,
    blocks: &Row,
    sums: &mut [F<S>; 3],
) {
    let [ends, codes, next_ends, next_codes] = transpose(simd, blocks.as_flattened());
    let (next_ends, next_codes) = (column.crosses.select(next_ends, ends), column.crosses.select(next_codes, codes));
    // Known to be less than 32, the shifts need no check.
    let left = codes >> (((above << 2) + column.bits[0]) & 31) & 3;
    let right = next_codes >> (((above << 2) + column.bits[1]) & 31) & 3;
    let far = weight * column.fraction;
    Ends::new(ends).accumulate(simd, left, three, weight - far, sums);
    Ends::new(next_ends).accumulate(simd, right, three, far, sums);
}

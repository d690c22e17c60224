//! A bin of rays: places, then blocks, then colours.

use fearless_simd::prelude::*;

use super::axis::Neighbour;
use super::bins::Bin;
use super::storage::{ABSENT, Block, SlabBlocks};
use crate::lanes::{F, Lanes, MAX_LANES, U, lanes, load, load_u32, to_lanes, transpose};
use crate::palette::Pair;

/// Two blocks side by side, for each lane.
type Row = Lanes<[Block; 2]>;

/// The blocks around the rays of a bin: by camera, upper and lower.
#[derive(Default)]
pub(super) struct Fetched([[Row; 2]; 4]);

/// One of the four cameras around each lane's ray.
#[derive(Clone, Copy)]
struct Tap<S: Simd> {
    column: Neighbour<S>,
    row: Neighbour<S>,
    weight: F<S>,
    /// Where the upper blocks of the neighbourhood lie, and the lower ones.
    blocks: [U<S>; 2],
}

/// The colours of the rays in a bin, by channel and lane, 0 … 1, and which lanes have one, by bit. `fetched` is scratch.
#[inline(always)]
pub(super) fn answer<S: Simd>(simd: S, slab: &SlabBlocks, bin: &Bin, fetched: &mut Fetched) -> ([Lanes<f32>; 3], u64) {
    let [columns, rows] = neighbours(simd, slab, bin);
    let taps = [
        tap(simd, slab, columns[0], rows[0]),
        tap(simd, slab, columns[1], rows[0]),
        tap(simd, slab, columns[0], rows[1]),
        tap(simd, slab, columns[1], rows[1]),
    ];
    for (tap, fetched) in taps.iter().zip(&mut fetched.0) {
        fetch::<S>(slab, tap.blocks[0], &mut fetched[0]);
        fetch::<S>(slab, tap.blocks[1], &mut fetched[1]);
    }
    let mut sums = [F::<S>::splat(simd, 0.0); 3];
    let mut found = F::<S>::splat(simd, 0.0);
    for (tap, fetched) in taps.iter().zip(&fetched.0) {
        found += tap.weight;
        let lower = tap.weight * tap.row.fraction;
        add(simd, tap, 0, tap.weight - lower, &fetched[0], &mut sums);
        add(simd, tap, 1, lower, &fetched[1], &mut sums);
    }
    let scale = if slab.starts.is_empty() { F::<S>::splat(simd, 1.0) } else { found.max(f32::MIN_POSITIVE) };
    let scale = F::<S>::splat(simd, 1.0 / 255.0) / scale;
    let known = found.simd_gt(0.0);
    let mut colors = [[0.0; MAX_LANES]; 3];
    for (sum, color) in sums.into_iter().zip(&mut colors) {
        (sum * scale).store_slice(&mut color[..lanes::<S>()]);
    }
    (colors, known.to_bitmask())
}

/// The cameras around each ray along both axes (Eqs. 1, 3 and 4 of the paper).
#[inline(always)]
fn neighbours<S: Simd>(simd: S, slab: &SlabBlocks, bin: &Bin) -> [[Neighbour<S>; 2]; 2] {
    let (k, [s, t]) = (slab.face.axis(), slab.face.tangents());
    let depth = load(simd, &bin.directions[k]).abs();
    let slopes = [load(simd, &bin.directions[s]) / depth, load(simd, &bin.directions[t]) / depth];
    let run = (F::<S>::splat(simd, slab.plane) - load(simd, &bin.origins[k])) * slab.face.sign();
    let positions = [load(simd, &bin.origins[s]) + run * slopes[0], load(simd, &bin.origins[t]) + run * slopes[1]];
    [slab.axes[0].neighbours(simd, positions[0], slopes[0]), slab.axes[1].neighbours(simd, positions[1], slopes[1])]
}

#[inline(always)]
fn tap<S: Simd>(simd: S, slab: &SlabBlocks, column: Neighbour<S>, row: Neighbour<S>) -> Tap<S> {
    let [columns, rows] = &slab.axes;
    let camera = row.camera * columns.cameras() + column.camera;
    let mut weight = column.share * row.share;
    let start = if slab.starts.is_empty() {
        camera * (columns.blocks() * rows.blocks())
    } else {
        let start = starts(simd, slab, camera);
        weight = start.simd_eq(ABSENT).select(F::<S>::splat(simd, 0.0), weight);
        start
    };
    let upper = start + row.block * column.blocks + column.block;
    let lower = row.crosses.select(upper + column.blocks, upper);
    Tap { column, row, weight, blocks: [upper, lower] }
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

/// Reads the block at each place and the one after it.
#[inline(always)]
fn fetch<S: Simd>(slab: &SlabBlocks, places: U<S>, out: &mut Row) {
    let places = to_lanes::<S>(places);
    for (out, place) in out.iter_mut().zip(places).take(lanes::<S>()) {
        // Always there; a lane without a place reads anything.
        if let Some([left, right]) = slab.blocks.get(place as usize..).and_then(|blocks| blocks.first_chunk()) {
            *out = [*left, *right];
        }
    }
}

/// Adds two texels side by side in one row, of a weight together.
#[inline(always)]
fn add<S: Simd>(simd: S, tap: &Tap<S>, row: usize, weight: F<S>, blocks: &Row, sums: &mut [F<S>; 3]) {
    let [ends, indices, next_ends, next_indices] = transpose(simd, blocks.as_flattened());
    let crosses = tap.column.crosses;
    let ends = [ends, crosses.select(next_ends, ends)];
    let places = [tap.column.places[0], tap.column.places[1]];
    let above = tap.row.places[row] << 3;
    let left = indices >> (above + (places[0] << 1));
    let right = crosses.select(next_indices, indices) >> (above + (places[1] << 1));
    let pair = Pair::new(simd, ends, [left & 3, right & 3]);
    let far = weight * tap.column.fraction;
    pair.accumulate([weight - far, far], sums);
}

//! One axis of a slab: (s, u) or (t, v). A ray's place along one does not depend on the other.

use std::ops::Range;

use fearless_simd::prelude::*;
use lf_math::{SampledAxis, Windows};

use crate::lanes::{F, Lanes, M, MAX_LANES, U, lanes, real, slot, to_lanes, transpose, whole};

/// Cameras, slopes and windows along an axis.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    positions: SampledAxis,
    slopes: SampledAxis,
    disparity: f32,
    /// That of whole images.
    whole: Window,
    /// By camera; empty if all images are whole.
    windows: Vec<Window>,
}

/// What there is of a camera's image along the axis.
#[derive(Debug, Clone, Copy, Default)]
struct Window {
    /// First and last texel.
    texels: [u32; 2],
    first_block: u32,
    blocks: u32,
}

impl Window {
    fn new(texels: &Range<u32>) -> Self {
        let first_block = texels.start / 4;
        let blocks = texels.end.div_ceil(4) - first_block;
        Self { texels: [texels.start, texels.end.saturating_sub(1)], first_block, blocks }
    }
}

/// Windows of every lane.
struct WindowLanes<S: Simd> {
    first: F<S>,
    last: F<S>,
    first_block: U<S>,
    blocks: U<S>,
}

/// A camera beside each lane's ray, and where to look in its image, along one axis.
#[derive(Clone, Copy)]
pub(super) struct Neighbour<S: Simd> {
    pub(super) camera: U<S>,
    /// The weight, 0 … 1, of the camera.
    pub(super) share: F<S>,
    /// The weight, 0 … 1, of the further of the two texels.
    pub(super) fraction: F<S>,
    /// The block of the nearer texel, counted from the window's first.
    pub(super) block: U<S>,
    /// Blocks in the window.
    pub(super) blocks: U<S>,
    /// Whether the further texel is in the next block.
    pub(super) crosses: M<S>,
    /// Twice the texels' places in their blocks: 0, 2, 4 or 6.
    pub(super) bits: [U<S>; 2],
}

impl Axis {
    pub(super) fn new(positions: SampledAxis, slopes: SampledAxis, disparity: f32, windows: &Windows) -> Self {
        let each =
            if windows.is_whole() { Vec::new() } else { windows.iter().map(|window| Window::new(&window)).collect() };
        Self { positions, slopes, disparity, whole: Window::new(&(0..slopes.count())), windows: each }
    }

    /// Number of cameras.
    pub(super) fn cameras(&self) -> u32 {
        self.positions.count()
    }

    /// Blocks of whole images.
    pub(super) fn blocks(&self) -> u32 {
        self.whole.blocks
    }

    /// The two cameras beside a ray that meets the camera plane at `position` with `slope`. The same steps as
    /// `Slab::index_ray` and `Slab::taps` take, to the bit.
    #[inline(always)]
    pub(super) fn neighbours<S: Simd>(&self, simd: S, position: F<S>, slope: F<S>) -> [Neighbour<S>; 2] {
        let index = (position - self.positions.first()) / self.positions.step();
        let last = self.positions.last_index();
        let st = index.max_precise(0.0).min(last);
        let base = st.floor().min((last - 1.0).max(0.0));
        let uv = (slope - self.slopes.first()) / self.slopes.step();
        // Adds 0, or makes the shares no numbers where an index is not finite: such a ray has no answer.
        let fraction = st - base + (index * 0.0 + uv * 0.0);
        let near = self.neighbour(simd, base, F::<S>::splat(simd, 1.0) - fraction, st, uv);
        let far = self.neighbour(simd, (base + 1.0).min(last), fraction, st, uv);
        [near, far]
    }

    #[inline(always)]
    fn neighbour<S: Simd>(&self, simd: S, camera: F<S>, share: F<S>, st: F<S>, uv: F<S>) -> Neighbour<S> {
        let seen = (uv + (st - camera) * self.disparity).max(0.0).min(self.slopes.last_index());
        let camera = whole::<S>(camera);
        let window = self.window(simd, camera);
        let place = seen.max(window.first).min(window.last);
        let low = place.floor();
        let texel = whole::<S>(low);
        let next = whole::<S>((low + 1.0).min(window.last));
        Neighbour {
            camera,
            share,
            fraction: place - low,
            block: (texel >> 2) - window.first_block,
            blocks: window.blocks,
            crosses: (next >> 2).simd_gt(texel >> 2),
            bits: [(texel & 3) << 1, (next & 3) << 1],
        }
    }

    #[inline(always)]
    fn window<S: Simd>(&self, simd: S, camera: U<S>) -> WindowLanes<S> {
        if self.windows.is_empty() {
            let Window { texels: [first, last], first_block, blocks } = self.whole;
            return WindowLanes {
                first: F::<S>::splat(simd, first as f32),
                last: F::<S>::splat(simd, last as f32),
                first_block: U::<S>::splat(simd, first_block),
                blocks: U::<S>::splat(simd, blocks),
            };
        }
        let camera = to_lanes::<S>(camera);
        let mut windows: Lanes<[[u32; 2]; 2]> = [[[0; 2]; 2]; MAX_LANES];
        for (lane, camera) in camera.into_iter().enumerate().take(lanes::<S>()) {
            let Window { texels, first_block, blocks } = self.windows.get(camera as usize).copied().unwrap_or_default();
            windows[slot::<S>(lane)] = [texels, [first_block, blocks]];
        }
        let [first, last, first_block, blocks] = transpose(simd, windows.as_flattened());
        WindowLanes { first: real::<S>(first), last: real::<S>(last), first_block, blocks }
    }
}

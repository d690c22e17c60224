//! Tracing what is kept of one camera's image.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use half::f16;
use lf_math::{ImageWindow, NeededImage};
use lf_scene::TexelSampler;

use crate::fill::sources;

/// Largest number of a half float: where an inverse depth ends.
const MOST: f32 = 65504.0;

/// What is kept of one camera's image, row after row.
#[derive(Debug, Clone)]
pub(crate) struct CameraImage {
    pub(crate) window: [Range<u32>; 2],
    /// Alpha is 255 where a texel was traced, 0 where it repeats another.
    pub(crate) texels: Vec<[u8; 4]>,
    /// Inverse depths; empty if they were not asked for.
    pub(crate) depths: Vec<[f16; 3]>,
}

/// What to trace of a camera's image.
pub(crate) struct ImageJob<'a> {
    pub(crate) sampler: TexelSampler<'a>,
    pub(crate) slab: usize,
    pub(crate) camera: [u32; 2],
    pub(crate) window: [Range<u32>; 2],
    /// Everything if `None`.
    pub(crate) needed: Option<NeededImage>,
    pub(crate) depth: bool,
}

impl ImageJob<'_> {
    /// Traces what is needed and fills in the rest; `None` if `stop` is set before the end.
    pub(crate) fn run(self, stop: &AtomicBool) -> Option<CameraImage> {
        let [u, v] = self.window.clone();
        let (mut texels, mut depths) = (Vec::new(), Vec::new());
        for v in v {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            for texel in u.clone().map(|u| [u, v]) {
                let needed = self.needed.as_ref().is_none_or(|needed| needed.contains(texel));
                texels.push(if needed { self.sampler.texel(self.slab, self.camera, texel) } else { [0; 4] });
                if self.depth {
                    depths.push(if needed { self.inverse_depth(texel) } else { [f16::ZERO; 3] });
                }
            }
        }
        Some(CameraImage { window: self.window, texels, depths }.filled())
    }

    fn inverse_depth(&self, texel: [u32; 2]) -> [f16; 3] {
        let inverse = self.sampler.inverse_depth(self.slab, self.camera, texel);
        [f16::from_f32(inverse.clamp(-MOST, MOST)); 3]
    }
}

impl CameraImage {
    fn filled(mut self) -> Self {
        let traced: Vec<bool> = self.texels.iter().map(is_traced).collect();
        if traced.contains(&false) {
            let sources = sources(&traced, self.window[0].len());
            let opaque = sources.iter().map(|&source| self.texels[source]);
            let marked = opaque.zip(traced).map(|([r, g, b, _], traced)| [r, g, b, if traced { 255 } else { 0 }]);
            self.texels = marked.collect();
            if !self.depths.is_empty() {
                self.depths = sources.iter().map(|&source| self.depths[source]).collect();
            }
        }
        self
    }

    pub(crate) fn texel_window(&self) -> ImageWindow<'_> {
        let [u, v] = self.window.clone();
        ImageWindow { u, v, texels: &self.texels }
    }

    pub(crate) fn depth_window(&self) -> ImageWindow<'_, [f16; 3]> {
        let [u, v] = self.window.clone();
        ImageWindow { u, v, texels: &self.depths }
    }
}

/// Whether a texel of a [`CameraImage`] was traced.
pub(crate) fn is_traced(texel: &[u8; 4]) -> bool {
    texel[3] != 0
}

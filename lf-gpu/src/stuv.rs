//! The buffer between two passes.

use lf_math::Image;

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::storage::slice_bytes;
use crate::target::{Target, attachment, plain, read_back, view};

/// What each pixel asks of the slabs, (s′, t′, u′, v′) and the slab (§7 and Fig. 5c of the paper): 17 bytes a pixel, and a depth
/// buffer.
pub struct StuvBuffer {
    pub(crate) depth: wgpu::TextureView,
    pub(crate) stuv: wgpu::TextureView,
    pub(crate) faces: wgpu::TextureView,
    texture: wgpu::Texture,
}

impl StuvBuffer {
    const STUV: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
    const FACES: wgpu::TextureFormat = wgpu::TextureFormat::R8Uint;
    pub(crate) const TARGETS: [Option<wgpu::ColorTargetState>; 2] = [Some(plain(Self::STUV)), Some(plain(Self::FACES))];

    /// A buffer for pictures of `width × height` pixels.
    ///
    /// # Errors
    /// If the device cannot make it.
    pub fn new(gpu: &Gpu, width: u32, height: u32) -> Result<Self, GpuError> {
        let (what, size) = ("the stuv buffer", [width, height]);
        gpu.affords(what, slice_bytes(Self::STUV, size))?;
        gpu.checked(what, || {
            let make = |format, usage| attachment(gpu, size, format, usage);
            let bound = wgpu::TextureUsages::TEXTURE_BINDING;
            let texture = make(Self::STUV, bound | wgpu::TextureUsages::COPY_SRC);
            let depth = make(Target::DEPTH, wgpu::TextureUsages::empty());
            let faces = make(Self::FACES, bound);
            Self { depth: view(&depth), stuv: view(&texture), faces: view(&faces), texture }
        })
    }

    /// Copies (s′, t′, u′, v′) of each pixel back to memory, waiting for the device; 0 where nothing was asked.
    ///
    /// # Errors
    /// If the device was lost or is out of memory.
    pub fn read(&self, gpu: &Gpu) -> Result<Image<[f32; 4]>, GpuError> {
        read_back(gpu, &self.texture)
    }
}

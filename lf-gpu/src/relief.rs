//! Normal maps on the device.

use lf_math::NormalMap;
use wgpu::util::DeviceExt;

use crate::error::GpuError;
use crate::gpu::Gpu;

/// A normal map on the device: [`NormalMap`] says how it lies on a mesh.
pub struct NormalMapTexture {
    view: wgpu::TextureView,
    repeats: f32,
}

impl NormalMapTexture {
    /// Uploads a map, 4 bytes a texel.
    ///
    /// # Errors
    /// If it is too large for the device.
    pub fn new(gpu: &Gpu, map: &NormalMap) -> Result<Self, GpuError> {
        gpu.checked("the normal map", || {
            let image = map.texels();
            let descriptor = wgpu::TextureDescriptor {
                label: Some("normal map"),
                size: wgpu::Extent3d { width: image.width(), height: image.height(), depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8Unorm,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            };
            let (order, bytes) = (wgpu::util::TextureDataOrder::LayerMajor, bytemuck::cast_slice(image.texels()));
            let texture = gpu.device.create_texture_with_data(&gpu.queue, &descriptor, order, bytes);
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            Self { view, repeats: map.repeats() }
        })
    }

    pub(crate) fn repeats(&self) -> f32 {
        self.repeats
    }

    /// The resource that relief.wgsl asks for.
    pub(crate) fn binding(&self) -> (u32, wgpu::BindingResource<'_>) {
        (9, wgpu::BindingResource::TextureView(&self.view))
    }
}

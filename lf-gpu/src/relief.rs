//! Normal maps on the device.

use lf_math::NormalMap;

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::upload::write_image;

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
        let (what, image) = ("the normal map", map.texels());
        gpu.affords(what, size_of_val(image.texels()) as u64)?;
        let [width, height] = [image.width(), image.height()];
        let descriptor = wgpu::TextureDescriptor {
            label: Some(what),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        let texture = gpu.checked(what, || gpu.device.create_texture(&descriptor))?;
        write_image(gpu, what, &texture, [0; 3], [width, height], image.texels().as_flattened())?;
        let view = gpu.checked(what, || texture.create_view(&wgpu::TextureViewDescriptor::default()))?;
        Ok(Self { view, repeats: map.repeats() })
    }

    pub(crate) fn repeats(&self) -> f32 {
        self.repeats
    }

    /// The resource that relief.wgsl asks for.
    pub(crate) fn binding(&self) -> (u32, wgpu::BindingResource<'_>) {
        (9, wgpu::BindingResource::TextureView(&self.view))
    }
}

//! Where frames are drawn, and how they come back.

use lf_math::Image;

use crate::error::GpuError;
use crate::gpu::Gpu;

/// An offscreen colour target of 8-bit RGBA with a depth buffer.
pub struct Target {
    pub(crate) color: wgpu::TextureView,
    pub(crate) depth: wgpu::TextureView,
    texture: wgpu::Texture,
    width: u32,
    height: u32,
}

impl Target {
    /// Format of the colour target.
    pub(crate) const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
    /// Format of the depth buffer.
    pub(crate) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

    /// A target of `width × height` pixels.
    ///
    /// # Errors
    /// If the device cannot make it.
    pub fn new(gpu: &Gpu, width: u32, height: u32) -> Result<Self, GpuError> {
        let make = |format, usage| {
            let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("target"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            });
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            (texture, view)
        };
        gpu.checked("the render target", || {
            let (texture, color) = make(Self::COLOR, wgpu::TextureUsages::COPY_SRC);
            let (_, depth) = make(Self::DEPTH, wgpu::TextureUsages::empty());
            Self { color, depth, texture, width, height }
        })
    }

    /// Copies the picture back to memory, waiting for the device.
    ///
    /// # Errors
    /// If the device was lost or is out of memory.
    pub fn read(&self, gpu: &Gpu) -> Result<Image<[u8; 4]>, GpuError> {
        let pitch = (4 * self.width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let refused = |why: String| GpuError::Refused { what: "to give a picture back", why };
        let buffer = gpu.checked("the read-back buffer", || self.copy_to_buffer(gpu, pitch))?;
        let (sender, receiver) = std::sync::mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| drop(sender.send(result)));
        gpu.wait()?;
        match receiver.try_recv() {
            Ok(Ok(())) => {}
            Ok(Err(e)) => return Err(refused(e.to_string())),
            Err(e) => return Err(refused(e.to_string())),
        }
        let bytes = buffer.get_mapped_range(..).map_err(|e| refused(e.to_string()))?;
        let rows = bytes.chunks_exact(pitch as usize).map(|row| &row[..4 * self.width as usize]);
        let texels = rows.flat_map(|row| row.chunks_exact(4).map(|t| [t[0], t[1], t[2], t[3]])).collect();
        Image::new(self.width, self.height, texels).map_err(|e| refused(e.to_string()))
    }

    fn copy_to_buffer(&self, gpu: &Gpu, pitch: u32) -> wgpu::Buffer {
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read-back"),
            size: u64::from(pitch) * u64::from(self.height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            self.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch), rows_per_image: None },
            },
            self.texture.size(),
        );
        gpu.queue.submit([encoder.finish()]);
        buffer
    }
}

//! Where frames are drawn, and how they come back.

use bytemuck::Pod;
use lf_math::Image;

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::storage::slice_bytes;
use crate::upload::pitch;

/// An offscreen colour target of 8-bit RGBA with a depth buffer.
pub struct Target {
    pub(crate) color: wgpu::TextureView,
    pub(crate) depth: wgpu::TextureView,
    texture: wgpu::Texture,
}

impl Target {
    /// Format of the colour target.
    pub(crate) const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
    pub(crate) const TARGETS: [Option<wgpu::ColorTargetState>; 1] = [Some(plain(Self::COLOR))];
    /// Format of the depth buffer.
    pub(crate) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

    /// A target of `width × height` pixels.
    ///
    /// # Errors
    /// If the device cannot make it.
    pub fn new(gpu: &Gpu, width: u32, height: u32) -> Result<Self, GpuError> {
        let (what, size) = ("the render target", [width, height]);
        gpu.affords(what, slice_bytes(Self::COLOR, size))?;
        gpu.checked(what, || {
            let texture = attachment(gpu, size, Self::COLOR, wgpu::TextureUsages::COPY_SRC);
            let depth = attachment(gpu, size, Self::DEPTH, wgpu::TextureUsages::empty());
            Self { color: view(&texture), depth: view(&depth), texture }
        })
    }

    /// Copies the picture back to memory, waiting for the device.
    ///
    /// # Errors
    /// If the device was lost or is out of memory.
    pub fn read(&self, gpu: &Gpu) -> Result<Image<[u8; 4]>, GpuError> {
        read_back(gpu, &self.texture)
    }
}

/// A colour target that is overwritten.
pub(crate) const fn plain(format: wgpu::TextureFormat) -> wgpu::ColorTargetState {
    wgpu::ColorTargetState { format, blend: None, write_mask: wgpu::ColorWrites::ALL }
}

/// A texture to draw into; must run in [`Gpu::checked`].
pub(crate) fn attachment(
    gpu: &Gpu,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("target"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
        view_formats: &[],
    })
}

pub(crate) fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// A texture's texels, which `T` lays out as its format does; waits for the device.
pub(crate) fn read_back<T: Pod>(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Image<T>, GpuError> {
    let row_bytes = size_of::<T>() * texture.width() as usize;
    let pitch = pitch(row_bytes);
    let refused = |why: String| GpuError::Refused { what: "to give a picture back", why };
    let buffer = gpu.checked("the read-back buffer", || copy_to_buffer(gpu, texture, pitch))?;
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| drop(sender.send(result)));
    gpu.wait()?;
    match receiver.try_recv() {
        Ok(Ok(())) => {}
        Ok(Err(e)) => return Err(refused(e.to_string())),
        Err(e) => return Err(refused(e.to_string())),
    }
    let bytes = buffer.get_mapped_range(..).map_err(|e| refused(e.to_string()))?;
    let rows = bytes.chunks_exact(pitch).map(|row| &row[..row_bytes]);
    let texels = rows.flat_map(|row| row.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned)).collect();
    Image::new(texture.width(), texture.height(), texels).map_err(|e| refused(e.to_string()))
}

fn copy_to_buffer(gpu: &Gpu, texture: &wgpu::Texture, pitch: usize) -> wgpu::Buffer {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read-back"),
        size: pitch as u64 * u64::from(texture.height()),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch as u32), rows_per_image: None },
        },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    buffer
}

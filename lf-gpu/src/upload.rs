//! Bytes on their way to the device.
//!
//! wgpu's own writes (`Queue::write_texture`, `Queue::write_buffer`) take memory for their copies for granted: where it lacks, the device is
//! lost with everything on it. Here the copy is a buffer like any other: where it lacks, the call fails and the device goes on. Cost: a
//! submission for each image. Uniforms of some hundred bytes are still written by wgpu.

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::storage::slice_bytes;

/// A buffer with the given contents, which may be large; their length must be a multiple of 4.
pub(crate) fn large_buffer(
    gpu: &Gpu,
    what: &'static str,
    contents: &[u8],
    usage: wgpu::BufferUsages,
) -> Result<wgpu::Buffer, GpuError> {
    let (size, usage) = (contents.len() as u64, usage | wgpu::BufferUsages::COPY_DST);
    let descriptor = wgpu::BufferDescriptor { label: Some(what), size, usage, mapped_at_creation: false };
    let buffer = gpu.checked(what, || gpu.device.create_buffer(&descriptor))?;
    if !contents.is_empty() {
        let copy = staging(gpu, what, contents, contents.len())?;
        submit(gpu, what, |encoder| encoder.copy_buffer_to_buffer(&copy, 0, &buffer, 0, size))?;
    }
    Ok(buffer)
}

/// Fills a rectangle of a layer or slice, whole blocks wide and high, that begins at (x, y, layer).
pub(crate) fn write_image(
    gpu: &Gpu,
    what: &'static str,
    texture: &wgpu::Texture,
    [x, y, z]: [u32; 3],
    [width, height]: [u32; 2],
    bytes: &[u8],
) -> Result<(), GpuError> {
    // A row of texels, or of blocks.
    let row = slice_bytes(texture.format(), [width, 1]) as usize;
    let copy = staging(gpu, what, bytes, row)?;
    submit(gpu, what, |encoder| {
        encoder.copy_buffer_to_texture(
            wgpu::TexelCopyBufferInfo {
                buffer: &copy,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(pitch(row) as u32),
                    rows_per_image: None,
                },
            },
            wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: 0,
                origin: wgpu::Origin3d { x, y, z },
                aspect: wgpu::TextureAspect::All,
            },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
    })
}

/// Bytes from one row of a buffer that textures are filled from to the next.
pub(crate) fn pitch(row: usize) -> usize {
    row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize)
}

/// A buffer to copy from, with rows of so many of the bytes.
fn staging(gpu: &Gpu, what: &'static str, bytes: &[u8], row: usize) -> Result<wgpu::Buffer, GpuError> {
    let pitch = pitch(row);
    let size = bytes.len().div_ceil(row) * pitch;
    let usage = wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::MAP_WRITE;
    let descriptor =
        wgpu::BufferDescriptor { label: Some("staging"), size: size as u64, usage, mapped_at_creation: true };
    let buffer = gpu.checked(what, || gpu.device.create_buffer(&descriptor))?;
    let mut mapped = buffer.get_mapped_range_mut(..).map_err(|e| GpuError::Refused { what, why: e.to_string() })?;
    for (number, row) in bytes.chunks(row).enumerate() {
        let begin = number * pitch;
        mapped.slice(begin..begin + row.len()).copy_from_slice(row);
    }
    drop(mapped);
    gpu.checked(what, || buffer.unmap())?;
    Ok(buffer)
}

fn submit(gpu: &Gpu, what: &'static str, copy: impl FnOnce(&mut wgpu::CommandEncoder)) -> Result<(), GpuError> {
    gpu.checked(what, || {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        copy(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
    })
}

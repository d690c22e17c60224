//! The pictures and depths of cubes on the device.

use half::f16;
use lf_compress::{PackedCube, bc1};
use lf_math::{CubeMap, Image};

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::plane_blocks::PlaneBlocks;
use crate::storage::slice_bytes;
use crate::upload::write_image;

/// The pictures of a cube map, as they go to the device.
#[derive(Debug, Clone, Copy)]
pub enum CubePicture<'a> {
    /// Decoded texels.
    Texels(&'a CubeMap),
    /// BC1 blocks, which stay blocks where the device samples them and the faces are whole blocks wide; else they are decoded.
    Blocks(&'a PackedCube),
}

impl<'a> From<&'a CubeMap> for CubePicture<'a> {
    fn from(cube: &'a CubeMap) -> Self {
        Self::Texels(cube)
    }
}

impl<'a> From<&'a PackedCube> for CubePicture<'a> {
    fn from(cube: &'a PackedCube) -> Self {
        Self::Blocks(cube)
    }
}

impl CubePicture<'_> {
    /// Texels along the edge of a face.
    #[must_use]
    pub fn size(&self) -> u32 {
        match self {
            Self::Texels(cube) => cube.size(),
            Self::Blocks(cube) => cube.size(),
        }
    }

    /// Bytes of the texture on a device.
    #[must_use]
    pub fn bytes(&self, gpu: &Gpu) -> u64 {
        let texels = 6 * u64::from(self.size()).pow(2);
        if self.stays_blocks(gpu) { texels / 2 } else { 4 * texels }
    }

    /// Whether it stays BC1 blocks on a device.
    #[must_use]
    pub fn stays_blocks(&self, gpu: &Gpu) -> bool {
        matches!(self, Self::Blocks(cube) if keeps_blocks(gpu, cube.size()))
    }

    pub(crate) fn upload(&self, gpu: &Gpu) -> Result<wgpu::TextureView, GpuError> {
        let dimension = wgpu::TextureViewDimension::Cube;
        match self {
            Self::Blocks(cube) => upload_pictures(gpu, std::slice::from_ref(*cube), dimension),
            Self::Texels(cube) => {
                let texels = cube.faces().iter().flat_map(|face| face.texels().as_flattened());
                let bytes = &texels.copied().collect::<Vec<u8>>();
                let (size, format) = (cube.size(), wgpu::TextureFormat::Rgba8Unorm);
                Faces { what: PICTURES, size, count: 6, format, bytes, dimension }.upload(gpu)
            }
        }
    }
}

/// Name of colours in errors.
const PICTURES: &str = "the cube map";

/// Square images of one size and how a shader sees them: as cubes or as an array.
struct Faces<'a> {
    what: &'static str,
    size: u32,
    count: u32,
    format: wgpu::TextureFormat,
    bytes: &'a [u8],
    dimension: wgpu::TextureViewDimension,
}

/// Whether blocks of faces of so many texels along an edge can be sampled.
fn keeps_blocks(gpu: &Gpu, size: u32) -> bool {
    gpu.device.features().contains(wgpu::Features::TEXTURE_COMPRESSION_BC) && size.is_multiple_of(4)
}

/// The pictures of cubes of one size, of which there must be one, in a texture of six layers for each.
pub(crate) fn upload_pictures(
    gpu: &Gpu,
    cubes: &[PackedCube],
    dimension: wgpu::TextureViewDimension,
) -> Result<wgpu::TextureView, GpuError> {
    let (size, count) = (cubes[0].size(), 6 * cubes.len() as u32);
    let pictures = cubes.iter().flat_map(PackedCube::radiance);
    let mut bytes = Vec::new();
    let format = if keeps_blocks(gpu, size) {
        bytes.extend(pictures.flatten());
        wgpu::TextureFormat::Bc1RgbaUnorm
    } else {
        for blocks in pictures {
            let texels = bc1::decode_image(size, size, blocks).map_err(lf_compress::PackError::from)?;
            bytes.extend_from_slice(texels.as_flattened());
        }
        wgpu::TextureFormat::Rgba8Unorm
    };
    Faces { what: PICTURES, size, count, format, bytes: &bytes, dimension }.upload(gpu)
}

/// The inverse depths of a distance cube, as they go to the device.
#[derive(Clone, Copy)]
pub(crate) enum CubeDepths<'a> {
    /// As half floats in a cube texture.
    Values(&'a [Image<f32>; 6]),
    /// As blocks of two planes in a buffer.
    Planes(&'a PackedCube),
}

/// Depths on the device.
pub(crate) enum DeviceDepths {
    Texture(wgpu::TextureView),
    Blocks(PlaneBlocks),
}

impl CubeDepths<'_> {
    /// Texels along the edge of a face.
    pub(crate) fn size(&self) -> u32 {
        match self {
            Self::Values(faces) => faces[0].width(),
            Self::Planes(cube) => cube.inverse_depths()[0].width(),
        }
    }

    pub(crate) fn upload(&self, gpu: &Gpu) -> Result<DeviceDepths, GpuError> {
        match self {
            Self::Values(faces) => {
                let half = |inverse: &f32| f16::from_f32(inverse.min(f16::MAX.to_f32())).to_bits();
                let texels: Vec<u16> = faces.iter().flat_map(|face| face.texels().iter().map(half)).collect();
                let (format, bytes) = (wgpu::TextureFormat::R16Float, bytemuck::cast_slice(&texels));
                let (what, dimension) = ("the depths of a distance cube", wgpu::TextureViewDimension::Cube);
                let faces = Faces { what, size: self.size(), count: 6, format, bytes, dimension };
                Ok(DeviceDepths::Texture(faces.upload(gpu)?))
            }
            Self::Planes(cube) => Ok(DeviceDepths::Blocks(PlaneBlocks::upload(gpu, std::slice::from_ref(*cube))?)),
        }
    }
}

impl Faces<'_> {
    fn upload(&self, gpu: &Gpu) -> Result<wgpu::TextureView, GpuError> {
        gpu.affords(self.what, self.bytes.len() as u64)?;
        let descriptor = wgpu::TextureDescriptor {
            label: Some(self.what),
            size: wgpu::Extent3d { width: self.size, height: self.size, depth_or_array_layers: self.count },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        let view = wgpu::TextureViewDescriptor { dimension: Some(self.dimension), ..Default::default() };
        let texture = gpu.checked(self.what, || gpu.device.create_texture(&descriptor))?;
        let size = [self.size; 2];
        let faces = self.bytes.chunks(slice_bytes(self.format, size) as usize);
        for (layer, face) in (0..).zip(faces) {
            write_image(gpu, self.what, &texture, [0, 0, layer], size, face)?;
        }
        gpu.checked(self.what, || texture.create_view(&view))
    }
}

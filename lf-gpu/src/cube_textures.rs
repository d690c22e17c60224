//! What cube maps and distance cubes are made of on the device.

use half::f16;
use lf_compress::planes::{PlaneBlock, PlaneImage};
use lf_compress::{PackedCube, bc1};
use lf_math::{CubeMap, Image};
use wgpu::util::DeviceExt;

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::pass::buffer;

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
        let sampled = gpu.device.features().contains(wgpu::Features::TEXTURE_COMPRESSION_BC);
        matches!(self, Self::Blocks(cube) if sampled && cube.size().is_multiple_of(4))
    }

    pub(crate) fn upload(&self, gpu: &Gpu) -> Result<wgpu::TextureView, GpuError> {
        gpu.affords("the cube map".to_owned(), self.bytes(gpu))?;
        let (format, bytes) = match self {
            Self::Blocks(cube) if self.stays_blocks(gpu) => {
                (wgpu::TextureFormat::Bc1RgbaUnorm, cube.radiance().concat())
            }
            Self::Blocks(cube) => (wgpu::TextureFormat::Rgba8Unorm, decoded(cube)?),
            Self::Texels(cube) => {
                let texels = cube.faces().iter().flat_map(|face| face.texels().as_flattened());
                (wgpu::TextureFormat::Rgba8Unorm, texels.copied().collect())
            }
        };
        gpu.checked("the cube map", || texture(gpu, self.size(), format, &bytes))
    }
}

fn decoded(cube: &PackedCube) -> Result<Vec<u8>, GpuError> {
    let mut bytes = Vec::new();
    for blocks in cube.radiance() {
        let texels = bc1::decode_image(cube.size(), cube.size(), blocks).map_err(lf_compress::PackError::from)?;
        bytes.extend_from_slice(texels.as_flattened());
    }
    Ok(bytes)
}

/// The inverse depths of a distance cube, as they go to the device.
#[derive(Clone, Copy)]
pub(crate) enum CubeDepths<'a> {
    /// As half floats in a cube texture.
    Values(&'a [Image<f32>; 6]),
    /// As blocks of two planes in a buffer.
    Planes(&'a [PlaneImage; 6]),
}

/// Depths on the device.
pub(crate) enum DeviceDepths {
    Texture(wgpu::TextureView),
    Buffer(wgpu::Buffer),
}

impl CubeDepths<'_> {
    /// Texels along the edge of a face.
    pub(crate) fn size(&self) -> u32 {
        match self {
            Self::Values(faces) => faces[0].width(),
            Self::Planes(faces) => faces[0].width(),
        }
    }

    pub(crate) fn upload(&self, gpu: &Gpu) -> Result<DeviceDepths, GpuError> {
        gpu.checked("the depths of a distance cube", || match self {
            Self::Values(faces) => {
                let half = |inverse: &f32| f16::from_f32(inverse.min(f16::MAX.to_f32())).to_bits();
                let texels: Vec<u16> = faces.iter().flat_map(|face| face.texels().iter().map(half)).collect();
                let bytes = bytemuck::cast_slice(&texels);
                DeviceDepths::Texture(texture(gpu, self.size(), wgpu::TextureFormat::R16Float, bytes))
            }
            Self::Planes(faces) => {
                DeviceDepths::Buffer(buffer(gpu, "depths", &plane_words(faces), wgpu::BufferUsages::STORAGE))
            }
        })
    }
}

/// The scale of each face, then the blocks, face after face. Mirrored by depth_blocks.wgsl.
fn plane_words(faces: &[PlaneImage; 6]) -> Vec<u8> {
    let scales = faces.iter().flat_map(|face| face.scale().to_le_bytes());
    let blocks = faces.iter().flat_map(PlaneImage::blocks).flat_map(PlaneBlock::to_bytes);
    scales.chain(blocks).collect()
}

/// A cube texture of the faces in order.
fn texture(gpu: &Gpu, size: u32, format: wgpu::TextureFormat, bytes: &[u8]) -> wgpu::TextureView {
    let descriptor = wgpu::TextureDescriptor {
        label: Some("cube map"),
        size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 6 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    };
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    let texture = gpu.device.create_texture_with_data(&gpu.queue, &descriptor, order, bytes);
    let dimension = Some(wgpu::TextureViewDimension::Cube);
    texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() })
}

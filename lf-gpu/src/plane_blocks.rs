//! Inverse depths of distance cubes on the device, in blocks of two planes.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lf_compress::PackedCube;
use lf_compress::planes::{PlaneBlock, PlaneImage};

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::upload::large_buffer;

/// Distance cubes in blocks, for all shaders that ask them.
pub(crate) const PLANE_BLOCKS: &[&str] = &[
    include_str!("shaders/dominant_axis.wgsl"),
    include_str!("shaders/cube_faces.wgsl"),
    include_str!("shaders/plane_blocks.wgsl"),
];

/// Name of depths in errors.
const DEPTHS: &str = "the depths of distance cubes";

/// What plane_blocks.wgsl asks for: blocks as they are stored, and where those of each cube lie.
pub(crate) struct PlaneBlocks {
    blocks: wgpu::Buffer,
    cubes: wgpu::Buffer,
}

/// `DistanceCube` of plane_blocks.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct CubeEntry {
    pub(crate) position: Vec3,
    pub(crate) size: u32,
    pub(crate) scales: [f32; 6],
    pub(crate) first_block: u32,
    pub(crate) padding: u32,
}

impl PlaneBlocks {
    pub(crate) fn upload(gpu: &Gpu, cubes: &[PackedCube]) -> Result<Self, GpuError> {
        let images = cubes.iter().flat_map(PackedCube::inverse_depths);
        let blocks: Vec<u8> = images.flat_map(PlaneImage::blocks).flat_map(PlaneBlock::to_bytes).collect();
        let entries = entries(cubes);
        gpu.affords(DEPTHS, blocks.len() as u64)?;
        let buffer = |bytes| large_buffer(gpu, DEPTHS, bytes, wgpu::BufferUsages::STORAGE);
        Ok(Self { blocks: buffer(&blocks)?, cubes: buffer(bytemuck::cast_slice(&entries))? })
    }

    pub(crate) fn bindings(&self) -> [(u32, wgpu::BindingResource<'_>); 2] {
        [(4, self.blocks.as_entire_binding()), (5, self.cubes.as_entire_binding())]
    }
}

/// Which planes of all blocks are mirrors, two bits a block, the first block's lowest: mirrors.wgsl.
pub(crate) fn mirror_words(cubes: &[PackedCube]) -> Vec<u32> {
    let blocks = |cube: &PackedCube| cube.inverse_depths().iter().map(|image| image.blocks().len()).sum::<usize>();
    let marks = cubes.iter().flat_map(|cube| (0..blocks(cube)).map(|block| cube.mirrors(block)));
    let marks: Vec<u32> = marks.map(|[first, second]| u32::from(first) | u32::from(second) << 1).collect();
    marks.chunks(16).map(|marks| marks.iter().rev().fold(0, |word, mark| word << 2 | mark)).collect()
}

fn entries(cubes: &[PackedCube]) -> Vec<CubeEntry> {
    let mut first_block = 0;
    let entry = |cube: &PackedCube| {
        let (position, images) = (cube.position(), cube.inverse_depths());
        let scales = images.each_ref().map(PlaneImage::scale);
        let entry = CubeEntry { position, size: images[0].width(), scales, first_block, padding: 0 };
        first_block += images.iter().map(|image| image.blocks().len() as u32).sum::<u32>();
        entry
    };
    cubes.iter().map(entry).collect()
}

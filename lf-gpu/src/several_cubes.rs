//! Several distance cubes: light field probes, and guided cubes.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use half::f16;
use lf_compress::{DepthGuide, GuidedCubes, PackedCube};
use lf_math::{DistanceCube, GeometryError};

use crate::cube_textures::upload_pictures;
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::pass::{ReflectionPass, bilinear_sampler, buffer};
use crate::plane_blocks::{PLANE_BLOCKS, PlaneBlocks, mirror_words};
use crate::shader::Shader;
use crate::uniforms::SlabsUniform;
use crate::upload::large_buffer;

/// Name of the guide in errors.
const GUIDE: &str = "the guide of distance cubes";
/// Name of what says which planes are mirrors.
const MIRRORS: &str = "the mirrors of guided cubes";

/// `March` of probes.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct MarchUniform {
    pub(crate) near: f32,
    pub(crate) far: f32,
    pub(crate) steps: u32,
    pub(crate) halvings: u32,
}

/// `Guided` of guided.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct GuidedUniform {
    pub(crate) half_extent: Vec3,
    pub(crate) reach: f32,
    pub(crate) far: f32,
    pub(crate) padding_x: f32,
    pub(crate) padding_y: f32,
    pub(crate) padding_z: f32,
}

impl ReflectionPass {
    /// Reflections from several distance cubes, by so many steps and halvings in each: the first, in the order of nearness to the ray, that saw
    /// where the ray ends gives the colour. Twin of `lf_ibr::ProbeField`. Depths stay blocks, colours where the device samples those.
    ///
    /// # Errors
    /// There must be at least one cube, and their pictures of one size. If the device refuses the texture, the buffers or the pipeline; it
    /// must have arrays of cube textures.
    pub fn probes(gpu: &Gpu, cubes: &[PackedCube], steps: u32, halvings: u32) -> Result<Self, GpuError> {
        let size = cubes.first().ok_or(GeometryError::ZeroCount { what: "number of probes" })?.size();
        if let Some(other) = cubes.iter().map(PackedCube::size).find(|&other| other != size) {
            return Err(GeometryError::Size { what: "face of a probe", have: [other; 2], want: [size; 2] }.into());
        }
        let decoded = cubes.iter().map(PackedCube::decode).collect::<Result<Vec<_>, _>>()?;
        let [near, far] = DistanceCube::search_span(&decoded);
        let march = MarchUniform { near, far, steps, halvings };
        let pictures = upload_pictures(gpu, cubes, wgpu::TextureViewDimension::CubeArray)?;
        let depths = PlaneBlocks::upload(gpu, cubes)?;
        gpu.checked("the pipeline of several cubes", || {
            let sampler = bilinear_sampler(gpu);
            let march = buffer(gpu, "march", bytemuck::bytes_of(&march), wgpu::BufferUsages::UNIFORM);
            let mut resources = vec![
                (1, wgpu::BindingResource::TextureView(&pictures)),
                (2, wgpu::BindingResource::Sampler(&sampler)),
                (3, march.as_entire_binding()),
            ];
            resources.extend(depths.bindings());
            Self::new(gpu, Shader::Probes, &resources)
        })
    }

    /// Reflections from a few sharp distance cubes and the slabs of depth that say where to look in them. Twin of `lf_ibr::GuidedField`.
    /// Depths stay blocks and half floats, colours blocks where the device samples those.
    ///
    /// # Errors
    /// If the device refuses the texture, the buffers or the pipeline.
    pub fn guided(gpu: &Gpu, data: &GuidedCubes) -> Result<Self, GpuError> {
        let pictures = upload_pictures(gpu, data.cubes(), wgpu::TextureViewDimension::D2Array)?;
        let depths = PlaneBlocks::upload(gpu, data.cubes())?;
        let half_extent = data.guide().geometry().cell().half_extent();
        let guided = GuidedUniform { half_extent, reach: data.reach(), far: data.far(), ..GuidedUniform::zeroed() };
        let (slabs, words) = (SlabsUniform::of_guide(data.guide()), guide_words(data.guide()));
        gpu.affords(GUIDE, 4 * words.len() as u64)?;
        let words = large_buffer(gpu, GUIDE, bytemuck::cast_slice(&words), wgpu::BufferUsages::STORAGE)?;
        let marks = data.cubes().iter().any(PackedCube::has_mirrors).then(|| mirror_words(data.cubes()));
        let marks =
            marks.map(|marks| large_buffer(gpu, MIRRORS, bytemuck::cast_slice(&marks), wgpu::BufferUsages::STORAGE));
        let marks = marks.transpose()?;
        gpu.checked("the pipeline of guided cubes", || {
            let slabs = buffer(gpu, "slabs", bytemuck::bytes_of(&slabs), wgpu::BufferUsages::UNIFORM);
            let guided = buffer(gpu, "guided", bytemuck::bytes_of(&guided), wgpu::BufferUsages::UNIFORM);
            let mut resources = vec![
                (1, slabs.as_entire_binding()),
                (3, wgpu::BindingResource::TextureView(&pictures)),
                (7, words.as_entire_binding()),
                (8, guided.as_entire_binding()),
            ];
            resources.extend(depths.bindings());
            resources.extend(marks.iter().map(|marks| (9, marks.as_entire_binding())));
            Self::new(gpu, Shader::Guided { mirrors: marks.is_some() }, &resources)
        })
    }
}

/// The half floats of all slabs, two to a word, the first in the low half. Mirrored by guide.wgsl.
fn guide_words(guide: &DepthGuide) -> Vec<u32> {
    let slabs = 0..guide.geometry().slabs().len();
    let mut halves: Vec<u16> =
        slabs.flat_map(|slab| guide.inverse_depths(slab)).map(|half: &f16| half.to_bits()).collect();
    halves.resize(halves.len().next_multiple_of(2), 0);
    halves.as_chunks().0.iter().map(|[low, high]: &[u16; 2]| u32::from(*low) | u32::from(*high) << 16).collect()
}

/// The shader of probes.
pub(crate) fn probes_source() -> String {
    [PLANE_BLOCKS, &[include_str!("shaders/crossing.wgsl"), include_str!("shaders/probes.wgsl")]].concat().concat()
}

/// The shader of guided cubes, of which some show mirrors or none do.
pub(crate) fn guided_source(mirrors: bool) -> String {
    let answer = if mirrors { include_str!("shaders/mirrors.wgsl") } else { include_str!("shaders/no_mirrors.wgsl") };
    let slabs = [include_str!("shaders/slab_geometry.wgsl"), include_str!("shaders/faces.wgsl")];
    let guided = [include_str!("shaders/guide.wgsl"), include_str!("shaders/guided.wgsl"), answer];
    [PLANE_BLOCKS, &[include_str!("shaders/surface.wgsl")], &slabs, &guided].concat().concat()
}

//! Cube maps that know where they were taken.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lf_compress::PackedCube;
use lf_math::{DistanceCube, Search};

use crate::cube_textures::{CubeDepths, CubePicture, DeviceDepths};
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::pass::{ReflectionPass, bilinear_sampler, buffer};
use crate::plane_blocks::PLANE_BLOCKS;
use crate::shader::Shader;

/// What a cube map is projected on, cell space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Proxy {
    /// The sphere of this radius around the map's centre, metres.
    Sphere(f32),
    /// The box between its least and greatest corner.
    Box([Vec3; 2]),
}

/// A variant of the cube shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CubeShader {
    Infinite,
    Sphere,
    Box,
    FixedPoint(Depths),
    March(Depths),
}

/// How the shader gets at depths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Depths {
    Texture,
    Blocks,
}

/// `Cube` of cube.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct CubeUniform {
    pub(crate) center: Vec3,
    pub(crate) radius: f32,
    pub(crate) low: Vec3,
    pub(crate) near: f32,
    pub(crate) high: Vec3,
    pub(crate) far: f32,
    pub(crate) steps: u32,
    pub(crate) halvings: u32,
    pub(crate) depth_size: u32,
    pub(crate) padding: u32,
}

impl Depths {
    fn source(self) -> String {
        let stored = match self {
            Self::Texture => include_str!("shaders/depth_texture.wgsl").to_owned(),
            Self::Blocks => PLANE_BLOCKS.concat() + include_str!("shaders/depth_blocks.wgsl"),
        };
        stored + include_str!("shaders/depths.wgsl")
    }
}

impl CubeShader {
    #[cfg(test)]
    pub(crate) const ALL: [Self; 7] = [
        Self::Infinite,
        Self::Sphere,
        Self::Box,
        Self::FixedPoint(Depths::Texture),
        Self::FixedPoint(Depths::Blocks),
        Self::March(Depths::Texture),
        Self::March(Depths::Blocks),
    ];

    pub(crate) fn source(self) -> String {
        let cube = include_str!("shaders/cube.wgsl");
        match self {
            Self::Infinite => include_str!("shaders/environment.wgsl").to_owned(),
            Self::Sphere => [cube, include_str!("shaders/sphere.wgsl")].concat(),
            Self::Box => [cube, include_str!("shaders/box.wgsl")].concat(),
            Self::FixedPoint(depths) => [cube, &depths.source(), include_str!("shaders/fixed_point.wgsl")].concat(),
            Self::March(depths) => {
                let march = [include_str!("shaders/crossing.wgsl"), include_str!("shaders/march.wgsl")];
                [cube, &depths.source(), &march.concat()].concat()
            }
        }
    }
}

impl ReflectionPass {
    /// Reflections from an environment map, by direction alone.
    ///
    /// # Errors
    /// If the device refuses the cube texture or the pipeline.
    pub fn environment<'a>(gpu: &Gpu, picture: impl Into<CubePicture<'a>>) -> Result<Self, GpuError> {
        let view = picture.into().upload(gpu)?;
        gpu.checked("the environment pipeline", || {
            let sampler = bilinear_sampler(gpu);
            let resources =
                [(1, wgpu::BindingResource::TextureView(&view)), (2, wgpu::BindingResource::Sampler(&sampler))];
            Self::new(gpu, Shader::Cube(CubeShader::Infinite), &resources)
        })
    }

    /// Reflections from an environment map taken at `center`, cell space, and projected on a stand-in for the scene.
    ///
    /// # Errors
    /// If the device refuses the cube texture or the pipeline.
    pub fn proxy<'a>(
        gpu: &Gpu,
        picture: impl Into<CubePicture<'a>>,
        center: Vec3,
        proxy: Proxy,
    ) -> Result<Self, GpuError> {
        let mut uniform = CubeUniform { center, ..CubeUniform::zeroed() };
        let shader = match proxy {
            Proxy::Sphere(radius) => {
                uniform.radius = radius;
                CubeShader::Sphere
            }
            Proxy::Box([low, high]) => {
                (uniform.low, uniform.high) = (low, high);
                CubeShader::Box
            }
        };
        Self::cube(gpu, picture.into(), None, &uniform, shader)
    }

    /// Reflections from a distance cube. Its depths become half floats.
    ///
    /// # Errors
    /// If the device refuses the cube textures or the pipeline.
    pub fn distance_cube(gpu: &Gpu, cube: &DistanceCube, search: Search) -> Result<Self, GpuError> {
        let (picture, depths) = (cube.radiance().into(), CubeDepths::Values(cube.inverse_depths()));
        Self::searched(gpu, cube, picture, depths, search)
    }

    /// Reflections from a distance cube whose depths stay in blocks, its colours where the device samples those.
    ///
    /// # Errors
    /// If the device refuses the cube texture, the buffer or the pipeline.
    pub fn packed_distance_cube(gpu: &Gpu, cube: &PackedCube, search: Search) -> Result<Self, GpuError> {
        Self::searched(gpu, &cube.decode()?, cube.into(), CubeDepths::Planes(cube), search)
    }

    fn searched(
        gpu: &Gpu,
        cube: &DistanceCube,
        picture: CubePicture<'_>,
        depths: CubeDepths<'_>,
        search: Search,
    ) -> Result<Self, GpuError> {
        let [near, far] = DistanceCube::search_span([cube]);
        let radius = cube.median_distance().min(far);
        let from = if matches!(depths, CubeDepths::Planes(_)) { Depths::Blocks } else { Depths::Texture };
        let (shader, steps, halvings) = match search {
            Search::FixedPoint(steps) => (CubeShader::FixedPoint(from), steps, 0),
            Search::March { steps, halvings } => (CubeShader::March(from), steps, halvings),
        };
        let (zero, depth_size) = (CubeUniform::zeroed(), depths.size());
        let uniform = CubeUniform { center: cube.position(), radius, near, far, steps, halvings, depth_size, ..zero };
        Self::cube(gpu, picture, Some(depths), &uniform, shader)
    }

    fn cube(
        gpu: &Gpu,
        picture: CubePicture<'_>,
        depths: Option<CubeDepths<'_>>,
        uniform: &CubeUniform,
        shader: CubeShader,
    ) -> Result<Self, GpuError> {
        let view = picture.upload(gpu)?;
        let depths = depths.map(|depths| depths.upload(gpu)).transpose()?;
        gpu.checked("the cube map pipeline", || {
            let sampler = bilinear_sampler(gpu);
            let nearest = gpu.device.create_sampler(&wgpu::SamplerDescriptor::default());
            let uniform = buffer(gpu, "cube", bytemuck::bytes_of(uniform), wgpu::BufferUsages::UNIFORM);
            let mut resources = vec![
                (1, wgpu::BindingResource::TextureView(&view)),
                (2, wgpu::BindingResource::Sampler(&sampler)),
                (3, uniform.as_entire_binding()),
            ];
            match &depths {
                Some(DeviceDepths::Texture(depths)) => {
                    resources.push((4, wgpu::BindingResource::TextureView(depths)));
                    resources.push((5, wgpu::BindingResource::Sampler(&nearest)));
                }
                Some(DeviceDepths::Blocks(depths)) => resources.extend(depths.bindings()),
                None => {}
            }
            Self::new(gpu, Shader::Cube(shader), &resources)
        })
    }
}

//! Cube maps that know where they were taken.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use half::f16;
use lf_math::{CubeMap, DistanceCube, Image, Search};
use wgpu::util::DeviceExt;

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::pass::{ReflectionPass, bilinear_sampler, buffer};
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
    FixedPoint,
    March,
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
    pub(crate) padding: [u32; 2],
}

impl CubeShader {
    #[cfg(test)]
    pub(crate) const ALL: [Self; 5] = [Self::Infinite, Self::Sphere, Self::Box, Self::FixedPoint, Self::March];

    pub(crate) fn source(self) -> String {
        let cube = include_str!("shaders/cube.wgsl");
        let depths = include_str!("shaders/depths.wgsl");
        match self {
            Self::Infinite => include_str!("shaders/environment.wgsl").to_owned(),
            Self::Sphere => [cube, include_str!("shaders/sphere.wgsl")].concat(),
            Self::Box => [cube, include_str!("shaders/box.wgsl")].concat(),
            Self::FixedPoint => [cube, depths, include_str!("shaders/fixed_point.wgsl")].concat(),
            Self::March => [cube, depths, include_str!("shaders/march.wgsl")].concat(),
        }
    }
}

impl ReflectionPass {
    /// Reflections from an environment map, by direction alone.
    ///
    /// # Errors
    /// If the device refuses the cube texture or the pipeline.
    pub fn environment(gpu: &Gpu, cube: &CubeMap) -> Result<Self, GpuError> {
        gpu.checked("the environment pipeline", || {
            let view = picture(gpu, cube);
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
    pub fn proxy(gpu: &Gpu, cube: &CubeMap, center: Vec3, proxy: Proxy) -> Result<Self, GpuError> {
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
        Self::cube(gpu, cube, None, &uniform, shader)
    }

    /// Reflections from a distance cube. Its depths become half floats.
    ///
    /// # Errors
    /// If the device refuses the cube textures or the pipeline.
    pub fn distance_cube(gpu: &Gpu, cube: &DistanceCube, search: Search) -> Result<Self, GpuError> {
        let [least, largest] = cube.depth_range().unwrap_or([2.0, 0.5]);
        let (near, far) = (0.5 * least, 4.0 * largest);
        let radius = cube.median_distance().min(far);
        let (shader, steps, halvings) = match search {
            Search::FixedPoint(steps) => (CubeShader::FixedPoint, steps, 0),
            Search::March { steps, halvings } => (CubeShader::March, steps, halvings),
        };
        let zero = CubeUniform::zeroed();
        let uniform = CubeUniform { center: cube.position(), radius, near, far, steps, halvings, ..zero };
        Self::cube(gpu, cube.radiance(), Some(cube.inverse_depths()), &uniform, shader)
    }

    fn cube(
        gpu: &Gpu,
        cube: &CubeMap,
        depths: Option<&[Image<f32>; 6]>,
        uniform: &CubeUniform,
        shader: CubeShader,
    ) -> Result<Self, GpuError> {
        gpu.checked("the cube map pipeline", || {
            let (view, depths) = (picture(gpu, cube), depths.map(|depths| inverse_depths(gpu, depths)));
            let sampler = bilinear_sampler(gpu);
            let nearest = gpu.device.create_sampler(&wgpu::SamplerDescriptor::default());
            let uniform = buffer(gpu, "cube", bytemuck::bytes_of(uniform), wgpu::BufferUsages::UNIFORM);
            let mut resources = vec![
                (1, wgpu::BindingResource::TextureView(&view)),
                (2, wgpu::BindingResource::Sampler(&sampler)),
                (3, uniform.as_entire_binding()),
            ];
            if let Some(depths) = &depths {
                resources.push((4, wgpu::BindingResource::TextureView(depths)));
                resources.push((5, wgpu::BindingResource::Sampler(&nearest)));
            }
            Self::new(gpu, Shader::Cube(shader), &resources)
        })
    }
}

fn picture(gpu: &Gpu, cube: &CubeMap) -> wgpu::TextureView {
    let texels: Vec<[u8; 4]> = cube.faces().iter().flat_map(Image::texels).copied().collect();
    texture(gpu, cube.size(), wgpu::TextureFormat::Rgba8Unorm, bytemuck::cast_slice(&texels))
}

fn inverse_depths(gpu: &Gpu, faces: &[Image<f32>; 6]) -> wgpu::TextureView {
    let half = |inverse: &f32| f16::from_f32(inverse.min(f16::MAX.to_f32())).to_bits();
    let texels: Vec<u16> = faces.iter().flat_map(|face| face.texels().iter().map(half)).collect();
    texture(gpu, faces[0].width(), wgpu::TextureFormat::R16Float, bytemuck::cast_slice(&texels))
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

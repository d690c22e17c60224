//! The passes that draw a mirror.

use glam::Vec3;
use lf_math::{Pinhole, TriangleMesh, near_plane};

use crate::cubes::CubeShader;
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::slab_texture::SlabTexture;
use crate::storage::Storage;
use crate::target::Target;
use crate::uniforms::FrameUniform;

/// A reflective mesh on the device.
pub struct MirrorMesh {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    index_count: u32,
    /// The mesh's bounding box, cell space.
    bounds: (Vec3, Vec3),
}

/// A pipeline with the environment it reflects.
pub struct ReflectionPass {
    pipeline: wgpu::RenderPipeline,
    bindings: wgpu::BindGroup,
    frame: wgpu::Buffer,
}

/// A variant of the slab shader: only what a light field needs is compiled.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SlabShader {
    pub(crate) storage: Storage,
    /// Whether several slices share a layer of an array.
    pub(crate) shared: bool,
    pub(crate) windows: Windows,
}

/// What a light field leaves out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Windows {
    /// Nothing.
    Whole,
    /// Texels outside windows.
    Cropped,
    /// Single cameras, too.
    Masked,
}

impl Windows {
    #[cfg(test)]
    pub(crate) const ALL: [Self; 3] = [Self::Whole, Self::Cropped, Self::Masked];

    fn source(self) -> String {
        let cropped = include_str!("shaders/cropped.wgsl");
        match self {
            Self::Whole => include_str!("shaders/whole.wgsl").to_owned(),
            Self::Cropped => [cropped, include_str!("shaders/unmasked.wgsl")].concat(),
            Self::Masked => [cropped, include_str!("shaders/masked.wgsl")].concat(),
        }
    }
}

/// What a mirror shows.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Shader {
    Slabs(SlabShader),
    Cube(CubeShader),
    Flat,
}

impl SlabShader {
    fn source(self) -> String {
        let storage = match self.storage {
            Storage::Bc1Volume => include_str!("shaders/volume.wgsl"),
            _ if self.shared => include_str!("shaders/shared.wgsl"),
            Storage::Bc1Array | Storage::Rgba8Array | Storage::Rgba16FArray => include_str!("shaders/array.wgsl"),
        };
        let texels = match self.storage {
            Storage::Rgba16FArray => include_str!("shaders/linear.wgsl"),
            _ => include_str!("shaders/srgb.wgsl"),
        };
        [include_str!("shaders/slabs.wgsl"), storage, &self.windows.source(), texels].concat()
    }
}

/// The whole shader.
pub(crate) fn shader_source(shader: Shader, probe: bool) -> String {
    let mut source = match shader {
        Shader::Slabs(slabs) => slabs.source(),
        Shader::Cube(cube) => cube.source(),
        Shader::Flat => include_str!("shaders/flat.wgsl").to_owned(),
    };
    source += include_str!("shaders/reflect.wgsl");
    if probe {
        source += &format!("const PROBES_PER_ROW = {}u;\n", crate::probe::PER_ROW);
        source += include_str!("shaders/probe.wgsl");
    }
    source
}

/// Sampler of all passes: bilinear, clamped, no mip levels. Bilinear across depth too, where slices are met centrally.
pub(crate) fn bilinear_sampler(gpu: &Gpu) -> wgpu::Sampler {
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("bilinear"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}

/// A buffer with the given contents; must run in [`Gpu::checked`].
pub(crate) fn buffer(gpu: &Gpu, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    // Not mapped at creation: that panics where the device has too little memory.
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: contents.len() as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, contents);
    buffer
}

impl MirrorMesh {
    /// Uploads a mesh given in cell space.
    ///
    /// # Errors
    /// If the mesh is too large for the device.
    pub fn new(gpu: &Gpu, mesh: &TriangleMesh) -> Result<Self, GpuError> {
        let vertices: Vec<[Vec3; 2]> =
            mesh.positions().iter().copied().zip(mesh.normals().iter().copied()).map(Into::into).collect();
        gpu.checked("the mirror's buffers", || Self {
            vertices: buffer(gpu, "vertices", bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer(gpu, "indices", bytemuck::cast_slice(mesh.triangles()), wgpu::BufferUsages::INDEX),
            index_count: 3 * mesh.triangles().len() as u32,
            bounds: mesh.bounds(),
        })
    }
}

impl ReflectionPass {
    /// Reflections from light field slabs.
    ///
    /// # Errors
    /// If the device refuses the pipeline.
    pub fn slabs(gpu: &Gpu, texture: &SlabTexture) -> Result<Self, GpuError> {
        gpu.checked("the slab pipeline", || {
            let sampler = bilinear_sampler(gpu);
            let resources = texture.bindings(&sampler);
            Self::new(gpu, &shader_source(Shader::Slabs(texture.shader()), false), &resources)
        })
    }

    /// A white mirror, to tell what a frame costs beside its reflections.
    ///
    /// # Errors
    /// If the device refuses the pipeline.
    pub fn flat(gpu: &Gpu) -> Result<Self, GpuError> {
        gpu.checked("the white pipeline", || Self::new(gpu, &shader_source(Shader::Flat, false), &[]))
    }

    /// `resources` are the environment's, beside the frame's uniform at binding 0.
    pub(crate) fn new(gpu: &Gpu, source: &str, resources: &[(u32, wgpu::BindingResource<'_>)]) -> Self {
        let pipeline = mirror_pipeline(gpu, source);
        let frame = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size: size_of::<FrameUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let all = std::iter::once((0, frame.as_entire_binding())).chain(resources.iter().cloned());
        let bindings = bind_group(gpu, &pipeline, all);
        Self { pipeline, bindings, frame }
    }

    /// Submits one frame: clears the target to transparent black and draws the mirror as `camera` sees it. The target
    /// should have the camera's size. Returns before the frame is finished; see [`Gpu::wait`] and [`Target::read`].
    ///
    /// # Errors
    /// If the device refuses a command.
    pub fn draw(&self, gpu: &Gpu, target: &Target, mesh: &MirrorMesh, camera: &Pinhole) -> Result<(), GpuError> {
        gpu.checked("a frame", || {
            let frame = FrameUniform::new(camera, near_plane(camera.eye(), mesh.bounds));
            gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            self.encode(&mut encoder, target, mesh);
            gpu.queue.submit([encoder.finish()]);
        })
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder, target: &Target, mesh: &MirrorMesh) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("mirror"),
            color_attachments: &[Some(clear_color(&target.color))],
            depth_stencil_attachment: Some(clear_depth(&target.depth)),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.set_vertex_buffer(0, mesh.vertices.slice(..));
        pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..mesh.index_count, 0, 0..1);
    }
}

pub(crate) fn clear_color(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store };
    wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops }
}

/// Reversed depth: 0 is infinitely far.
fn clear_depth(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard };
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops: Some(ops), stencil_ops: None }
}

fn mirror_pipeline(gpu: &Gpu, source: &str) -> wgpu::RenderPipeline {
    let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
    let vertices = wgpu::VertexBufferLayout {
        array_stride: size_of::<[Vec3; 2]>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    };
    let depth = wgpu::DepthStencilState {
        format: Target::DEPTH,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Greater),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    };
    pipeline(gpu, source, "mirror", &[Some(vertices)], Some(depth))
}

/// A pipeline from the entry points `{name}_vertex` and `{name}_fragment` of a shader.
pub(crate) fn pipeline(
    gpu: &Gpu,
    source: &str,
    name: &str,
    buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
    depth_stencil: Option<wgpu::DepthStencilState>,
) -> wgpu::RenderPipeline {
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(name),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(name),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(&format!("{name}_vertex")),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers,
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(&format!("{name}_fragment")),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(Target::COLOR.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// The resources of a pipeline's only bind group, by binding number.
pub(crate) fn bind_group<'a>(
    gpu: &Gpu,
    pipeline: &wgpu::RenderPipeline,
    resources: impl IntoIterator<Item = (u32, wgpu::BindingResource<'a>)>,
) -> wgpu::BindGroup {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = resources.into_iter().map(entry).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    })
}

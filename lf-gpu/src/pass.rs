//! A pass that draws one mirror, and what all passes are made of.

use glam::Vec3;
use lf_math::{Pinhole, Placement, Reflectance, near_plane};

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::mesh::MirrorMesh;
use crate::shader::{Finish, Part, Relief, Shader, shader_source};
use crate::slab_texture::SlabTexture;
use crate::storage::slice_bytes;
use crate::stuv::StuvBuffer;
use crate::target::Target;
use crate::uniforms::{FrameUniform, InstanceUniform};

/// A pipeline with the environment it reflects.
pub struct ReflectionPass {
    pipeline: wgpu::RenderPipeline,
    bindings: wgpu::BindGroup,
    frame: wgpu::Buffer,
    bytes: u64,
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

/// A small buffer with the given contents; must run in [`Gpu::checked`]. Large ones are [`crate::upload::large_buffer`]s.
pub(crate) fn buffer(gpu: &Gpu, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: contents.len() as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, contents);
    buffer
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
            Self::new(gpu, Shader::Slabs(texture.shader()), &resources)
        })
    }

    /// A white mirror, to tell what a frame costs beside its reflections.
    ///
    /// # Errors
    /// If the device refuses the pipeline.
    pub fn flat(gpu: &Gpu) -> Result<Self, GpuError> {
        gpu.checked("the white pipeline", || Self::new(gpu, Shader::Flat, &[]))
    }

    /// `resources` are the environment's, beside the frame's uniform at binding 0 and its instances at 6.
    pub(crate) fn new(gpu: &Gpu, shader: Shader, resources: &[(u32, wgpu::BindingResource<'_>)]) -> Self {
        let pipeline = pipeline(gpu, shader, Part::Mirror(Finish::Bare, Relief::Smooth));
        let frame = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size: size_of::<FrameUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let instance = InstanceUniform::new(&Placement::IDENTITY, &Reflectance::MIRROR, 1.0);
        let instances = buffer(gpu, "instance", bytemuck::bytes_of(&instance), wgpu::BufferUsages::STORAGE);
        let own = [(0, frame.as_entire_binding()), (6, instances.as_entire_binding())];
        let all = own.into_iter().chain(resources.iter().cloned());
        let bindings = bind_group(gpu, &pipeline, all);
        let bytes = resources.iter().map(|(_, resource)| allocated(resource)).sum();
        Self { pipeline, bindings, frame, bytes }
    }

    /// Bytes of the textures and buffers on the device that hold what is reflected.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Submits one frame: clears the target to transparent black and draws the mirror as `camera` sees it. The target
    /// should have the camera's size. Returns before the frame is finished; see [`Gpu::wait`] and [`Target::read`].
    ///
    /// # Errors
    /// If the device refuses a command.
    pub fn draw(&self, gpu: &Gpu, target: &Target, mesh: &MirrorMesh, camera: &Pinhole) -> Result<(), GpuError> {
        gpu.checked("a frame", || {
            let frame = FrameUniform::new(camera, near_plane(camera.eye(), [mesh.bounds()]));
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
        mesh.draw(&mut pass, 0);
    }
}

/// Bytes of a texture or a buffer.
fn allocated(resource: &wgpu::BindingResource<'_>) -> u64 {
    match resource {
        wgpu::BindingResource::TextureView(view) => {
            let texture = view.texture();
            let slice = slice_bytes(texture.format(), [texture.width(), texture.height()]);
            slice * u64::from(texture.depth_or_array_layers())
        }
        wgpu::BindingResource::Buffer(binding) => binding.buffer.size(),
        _ => 0,
    }
}

pub(crate) fn clear_color(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store };
    wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops }
}

/// Reversed depth: 0 is infinitely far.
pub(crate) fn clear_depth(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard };
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops: Some(ops), stencil_ops: None }
}

/// The pipeline of a part. Bind groups hold what its shader uses and no more.
pub(crate) fn pipeline(gpu: &Gpu, shader: Shader, part: Part) -> wgpu::RenderPipeline {
    let source = shader_source(shader, part);
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("shader"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let [vertex, fragment] = part.entries();
    let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
    let vertices = wgpu::VertexBufferLayout {
        array_stride: size_of::<[Vec3; 2]>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    };
    let mesh = [Some(vertices)];
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(fragment),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some(vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: if part.is_mesh() { &mesh } else { &[] },
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: depth_test(part),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: match part {
                Part::StuvMirror(_) | Part::StuvBackground => &StuvBuffer::TARGETS,
                _ => &Target::TARGETS,
            },
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Meshes hide what is behind them; the background is infinitely far, at depth 0, where nothing was drawn.
fn depth_test(part: Part) -> Option<wgpu::DepthStencilState> {
    let compare = match part {
        Part::Mirror(..) | Part::StuvMirror(_) | Part::Scene => wgpu::CompareFunction::Greater,
        Part::Background(_) | Part::StuvBackground => wgpu::CompareFunction::GreaterEqual,
        Part::Resolve(_) | Part::Probe => return None,
    };
    Some(wgpu::DepthStencilState {
        format: Target::DEPTH,
        depth_write_enabled: Some(true),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
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

//! Whole frames from slabs: any number of reflectors that hide each other, and what is behind them.
//!
//! What is behind comes from the same slabs (§6 of the paper), or is the scene's own triangles (§7), drawn with the same depth test, so that
//! they and the reflectors hide each other.
//!
//! One pass (Figs. 6 and 8 of the paper) or the paper's own two (§7). Each combination of what a reflector, a background and a
//! light field need is a pipeline of its own, compiled when a frame first asks for it. CPU twin: lf-ibr/src/scene.rs. Reflectors do
//! not show each other.

use glam::Vec3;
use lf_math::{Pinhole, Placement, Reflectance, View, near_plane};

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::mesh::{MirrorMesh, SceneMesh};
use crate::pass::{bilinear_sampler, bind_group, buffer, clear_color, clear_depth, pipeline};
use crate::relief::NormalMapTexture;
use crate::shader::{Finish, Part, Relief, Shader};
use crate::slab_texture::SlabTexture;
use crate::stuv::StuvBuffer;
use crate::target::Target;
use crate::uniforms::{FrameUniform, InstanceUniform, SightUniform};

/// A mirror in a frame.
#[derive(Clone, Copy)]
pub struct Reflector<'a> {
    /// Its mesh.
    pub mesh: &'a MirrorMesh,
    /// Where it stands; inside the cell the paper's slabs hold every ray.
    pub placement: Placement,
    /// How much it reflects. Only [`View::Color`] heeds it.
    pub reflectance: Reflectance,
    /// What bends its normals.
    pub normal_map: Option<&'a NormalMapTexture>,
}

/// What is behind the reflectors.
#[derive(Clone, Copy)]
pub enum Behind<'a> {
    /// Nothing: transparent black.
    Nothing,
    /// What the slabs hold along the view rays. They hold every one if the eye is inside the cell.
    Slabs,
    /// The scene's triangles, behind the reflectors and in front of them, seen from anywhere; they show their light in every view. Nothing
    /// is where they are not.
    Scene(&'a SceneMesh),
}

/// What to draw.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    /// Who looks.
    pub camera: &'a Pinhole,
    /// What mirrors.
    pub reflectors: &'a [Reflector<'a>],
    /// What is behind the reflectors.
    pub behind: Behind<'a>,
    /// What is painted.
    pub view: View,
}

/// Draws frames from one light field.
pub struct SlabRenderer<'a> {
    gpu: &'a Gpu,
    texture: &'a SlabTexture,
    sampler: wgpu::Sampler,
    pipelines: Vec<(Part, wgpu::RenderPipeline)>,
}

/// What the shaders read, of one frame.
struct FrameBuffers {
    frame: wgpu::Buffer,
    instances: wgpu::Buffer,
    sight: wgpu::Buffer,
}

impl<'a> SlabRenderer<'a> {
    /// A renderer that has compiled nothing yet.
    ///
    /// # Errors
    /// If the device refuses the sampler.
    pub fn new(gpu: &'a Gpu, texture: &'a SlabTexture) -> Result<Self, GpuError> {
        let sampler = gpu.checked("a sampler", || bilinear_sampler(gpu))?;
        Ok(Self { gpu, texture, sampler, pipelines: vec![] })
    }

    /// Submits one frame in a single pass: clears the target to transparent black, draws the reflectors, then what is behind them.
    /// The target should have the camera's size. Returns before the frame is finished; see [`Gpu::wait`] and [`Target::read`].
    ///
    /// # Errors
    /// If the device refuses a pipeline or a command.
    pub fn draw(&mut self, target: &Target, frame: &Frame<'_>) -> Result<(), GpuError> {
        let mirrors: Vec<Part> =
            frame.reflectors.iter().map(|mirror| Part::Mirror(mirror.finish(frame.view), mirror.relief())).collect();
        let behind = match frame.behind {
            Behind::Nothing => None,
            Behind::Slabs => Some(Part::Background(frame.view)),
            Behind::Scene(_) => Some(Part::Scene),
        };
        let colors = [Some(clear_color(&target.color))];
        self.compile(mirrors.iter().copied().chain(behind))?;
        self.submit(|renderer, encoder| {
            renderer.encode(encoder, frame, &colors, &target.depth, &mirrors, behind);
        })
    }

    /// Submits the first of two passes: what each pixel of a frame asks, into `stuv`, which should have the camera's size. Its view does not
    /// matter.
    ///
    /// # Errors
    /// If the device refuses a pipeline or a command, or if a reflector is not a perfect mirror, or the scene's triangles are behind: the
    /// buffer holds neither how much is reflected nor light.
    pub fn ask(&mut self, stuv: &StuvBuffer, frame: &Frame<'_>) -> Result<(), GpuError> {
        if frame.reflectors.iter().any(|mirror| mirror.reflectance != Reflectance::MIRROR) {
            return Err(two_passes("only perfect mirrors are drawn so"));
        }
        let behind = match frame.behind {
            Behind::Nothing => None,
            Behind::Slabs => Some(Part::StuvBackground),
            Behind::Scene(_) => return Err(two_passes("the scene's triangles are drawn in one pass")),
        };
        let mirrors: Vec<Part> = frame.reflectors.iter().map(|mirror| Part::StuvMirror(mirror.relief())).collect();
        let colors = [Some(clear_color(&stuv.stuv)), Some(clear_color(&stuv.faces))];
        self.compile(mirrors.iter().copied().chain(behind))?;
        self.submit(|renderer, encoder| renderer.encode(encoder, frame, &colors, &stuv.depth, &mirrors, behind))
    }

    /// Submits the second pass: clears the target, of the same size, to transparent black and answers what is asked. After [`Self::ask`]
    /// the picture is that of [`Self::draw`]; every pixel is answered once, however small the triangles are.
    ///
    /// # Errors
    /// If the device refuses the pipeline or a command.
    pub fn answer(&mut self, stuv: &StuvBuffer, target: &Target, view: View) -> Result<(), GpuError> {
        let resolve = Part::Resolve(view);
        self.compile([resolve])?;
        self.submit(|renderer, encoder| {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("second pass"),
                color_attachments: &[Some(clear_color(&target.color))],
                ..Default::default()
            });
            let asked = [(7, &stuv.stuv), (8, &stuv.faces)];
            let asked = asked.map(|(number, view)| (number, wgpu::BindingResource::TextureView(view)));
            renderer.bind(&mut pass, resolve, &asked);
            pass.draw(0..3, 0..1);
        })
    }

    /// Compiles what is not compiled yet.
    fn compile(&mut self, parts: impl IntoIterator<Item = Part>) -> Result<(), GpuError> {
        for part in parts {
            if self.pipelines.iter().all(|(compiled, _)| *compiled != part) {
                let shader = Shader::Slabs(self.texture.shader());
                let made = self.gpu.checked("a pipeline", || pipeline(self.gpu, shader, part))?;
                self.pipelines.push((part, made));
            }
        }
        Ok(())
    }

    fn submit(&self, encode: impl FnOnce(&Self, &mut wgpu::CommandEncoder)) -> Result<(), GpuError> {
        self.gpu.checked("a frame", || {
            let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encode(self, &mut encoder);
            self.gpu.queue.submit([encoder.finish()]);
        })
    }

    /// Draws each reflector by its part, then what is behind.
    fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth: &wgpu::TextureView,
        mirrors: &[Part],
        behind: Option<Part>,
    ) {
        let buffers = FrameBuffers::new(self.gpu, frame);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("frame"),
            color_attachments: colors,
            depth_stencil_attachment: Some(clear_depth(depth)),
            ..Default::default()
        });
        for (number, (reflector, &part)) in (0..).zip(frame.reflectors.iter().zip(mirrors)) {
            let mut inputs = vec![(0, buffers.frame.as_entire_binding()), (6, buffers.instances.as_entire_binding())];
            inputs.extend(reflector.normal_map.map(NormalMapTexture::binding));
            self.bind(&mut pass, part, &inputs);
            reflector.mesh.draw(&mut pass, number);
        }
        let Some(part) = behind else { return };
        if let Behind::Scene(mesh) = frame.behind {
            self.bind(&mut pass, part, &[(0, buffers.frame.as_entire_binding())]);
            mesh.draw(&mut pass);
        } else {
            self.bind(&mut pass, part, &[(7, buffers.sight.as_entire_binding())]);
            pass.draw(0..3, 0..1);
        }
    }

    /// Sets a compiled part's pipeline, with the light field and `inputs` of its own.
    fn bind(&self, pass: &mut wgpu::RenderPass<'_>, part: Part, inputs: &[(u32, wgpu::BindingResource<'_>)]) {
        let Some((_, pipeline)) = self.pipelines.iter().find(|(compiled, _)| *compiled == part) else { return };
        let field = if part.fetches() {
            self.texture.bindings(&self.sampler)
        } else if part.asks() {
            vec![(1, self.texture.uniform().as_entire_binding())]
        } else {
            vec![]
        };
        let bindings = bind_group(self.gpu, pipeline, field.into_iter().chain(inputs.iter().cloned()));
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &bindings, &[]);
    }
}

/// Why there are no two passes.
fn two_passes(why: &str) -> GpuError {
    GpuError::Refused { what: "two passes", why: why.to_owned() }
}

impl Behind<'_> {
    /// The box around the scene's triangles.
    fn bounds(&self) -> Option<(Vec3, Vec3)> {
        if let Self::Scene(mesh) = self { Some(mesh.bounds()) } else { None }
    }
}

impl Reflector<'_> {
    fn finish(&self, view: View) -> Finish {
        match view {
            View::Color if self.reflectance == Reflectance::MIRROR => Finish::Bare,
            View::Color if self.reflectance.f0().is_some() => Finish::Fresnel,
            View::Color => Finish::Tint,
            view => Finish::Viewed(view),
        }
    }

    fn relief(&self) -> Relief {
        if self.normal_map.is_some() { Relief::Mapped } else { Relief::Smooth }
    }

    fn instance(&self) -> InstanceUniform {
        let repeats = self.normal_map.map_or(1.0, NormalMapTexture::repeats);
        InstanceUniform::new(&self.placement, &self.reflectance, repeats)
    }
}

impl FrameBuffers {
    fn new(gpu: &Gpu, frame: &Frame<'_>) -> Self {
        let uniform = |label, bytes: &[u8]| buffer(gpu, label, bytes, wgpu::BufferUsages::UNIFORM);
        let mut instances: Vec<_> = frame.reflectors.iter().map(Reflector::instance).collect();
        if instances.is_empty() {
            // A buffer must not be empty.
            instances.push(InstanceUniform::new(&Placement::IDENTITY, &Reflectance::MIRROR, 1.0));
        }
        let boxes = frame.reflectors.iter().map(|mirror| mirror.placement.bounds(mirror.mesh.bounds()));
        // The scene may be a thousand times as far as the reflectors.
        let scene = frame.behind.bounds().filter(|_| frame.reflectors.is_empty());
        let near = near_plane(frame.camera.eye(), boxes.chain(scene));
        Self {
            frame: uniform("frame", bytemuck::bytes_of(&FrameUniform::new(frame.camera, near))),
            sight: uniform("sight", bytemuck::bytes_of(&SightUniform::new(frame.camera))),
            instances: buffer(gpu, "instances", bytemuck::cast_slice(&instances), wgpu::BufferUsages::STORAGE),
        }
    }
}

//! Single samples read through the shader, for tests and tools.

use glam::Vec2;
use lf_math::Face;

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::pass::{bilinear_sampler, bind_group, clear_color, pipeline};
use crate::shader::{Part, Shader};
use crate::slab_texture::SlabTexture;
use crate::target::Target;
use crate::uniforms::ProbeUniform;
use crate::upload::large_buffer;

/// Probes in a row of the picture they are drawn into.
pub(crate) const PER_ROW: u32 = 512;

/// A bilinear fetch from one camera's image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probe {
    /// The slab's face; it must be present in the light field.
    pub face: Face,
    /// Camera indices (s, t).
    pub camera: [u32; 2],
    /// Texel position (u, v) in index units, within the image.
    pub uv: Vec2,
}

/// What the slab shader fetches for each probe, as 8-bit values, one pixel each. Transparent black where the camera is left
/// out; outside a window its nearest texel.
///
/// # Errors
/// If a probe lies outside the light field, if the device refuses the pass, or if there are more probes than its largest
/// picture has pixels.
pub fn read_probes(gpu: &Gpu, texture: &SlabTexture, probes: &[Probe]) -> Result<Vec<[u8; 4]>, GpuError> {
    if probes.is_empty() {
        return Ok(vec![]);
    }
    if let Some(outside) = probes.iter().find(|probe| !probe.is_inside(texture)) {
        return Err(GpuError::Refused { what: "a probe", why: format!("{outside:?} is outside the light field") });
    }
    let rows = probes.len().div_ceil(PER_ROW as usize);
    let height = u32::try_from(rows).unwrap_or(u32::MAX);
    let target = Target::new(gpu, PER_ROW, height)?;
    let raw = |p: &Probe| ProbeUniform { uv: p.uv, camera: p.camera, face: p.face.index().into(), padding: 0 };
    let list: Vec<_> = probes.iter().map(raw).collect();
    let list = large_buffer(gpu, "the probes", bytemuck::cast_slice(&list), wgpu::BufferUsages::STORAGE)?;
    gpu.checked("the probe pass", || draw(gpu, texture, &list, &target))?;
    let picture = target.read(gpu)?;
    Ok(picture.texels()[..probes.len()].to_vec())
}

impl Probe {
    fn is_inside(&self, texture: &SlabTexture) -> bool {
        let slab = texture.geometry().slabs().iter().find(|slab| slab.face() == self.face);
        slab.is_some_and(|slab| {
            let camera = (0..2).all(|i| self.camera[i] < slab.cameras()[i]);
            let last = Vec2::from(slab.uv().map(|axis| axis.last_index()));
            camera && self.uv.cmpge(Vec2::ZERO).all() && self.uv.cmple(last).all()
        })
    }
}

fn draw(gpu: &Gpu, texture: &SlabTexture, list: &wgpu::Buffer, target: &Target) {
    let pipeline = pipeline(gpu, Shader::Slabs(texture.shader()), Part::Probe);
    let sampler = bilinear_sampler(gpu);
    let resources = texture.bindings(&sampler).into_iter().chain([(4, list.as_entire_binding())]);
    let bindings = bind_group(gpu, &pipeline, resources);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("probe"),
            color_attachments: &[Some(clear_color(&target.color))],
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bindings, &[]);
        pass.draw(0..3, 0..1);
    }
    gpu.queue.submit([encoder.finish()]);
}

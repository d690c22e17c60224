//! A light field in a texture.

use std::borrow::Cow;

use lf_compress::format::TexelEncoding;
use lf_compress::{PackedLightField, bc1, rgba16f};
use lf_math::LightFieldGeometry;

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::pass::buffer;
use crate::shader::{SlabShader, Windows};
use crate::storage::{Plan, Storage};
use crate::uniforms::SlabsUniform;
use crate::upload::write_image;
use crate::windows::WindowTable;

/// Texture bytes handed to the device before it is waited for: until then it keeps a copy of each.
const UPLOAD_BATCH: usize = 64 << 20;

/// A light field on the device.
pub struct SlabTexture {
    view: wgpu::TextureView,
    uniform: wgpu::Buffer,
    /// Where the windows of cropped images lie; `None` if all images are whole.
    windows: Option<DeviceWindows>,
    plan: Plan,
    geometry: LightFieldGeometry,
}

/// A window table on the device.
struct DeviceWindows {
    rows: wgpu::Buffer,
    masked: bool,
}

impl SlabTexture {
    /// Uploads a light field in the first form that the device can hold, in the order of [`Storage`].
    ///
    /// # Errors
    /// If it can hold none. The error is that of the budget if that is all that is in the way of a form, else that of the form that needs
    /// least.
    pub fn new(gpu: &Gpu, field: &PackedLightField) -> Result<Self, GpuError> {
        Self::planned(gpu, field, Plan::first(gpu, field)?)
    }

    /// Uploads a light field in a given form, slice by slice. BC1 blocks go up as they are.
    ///
    /// # Errors
    /// If the device cannot hold it in this form.
    pub fn with_storage(gpu: &Gpu, field: &PackedLightField, storage: Storage) -> Result<Self, GpuError> {
        Self::planned(gpu, field, storage.plan(gpu, field)?)
    }

    fn planned(gpu: &Gpu, field: &PackedLightField, plan: Plan) -> Result<Self, GpuError> {
        let texture = gpu.checked("the slab texture", || gpu.device.create_texture(&plan.descriptor()))?;
        let mut waiting = 0;
        for (slab, layout) in field.layout().slabs().iter().enumerate() {
            let tiling = layout.tiling();
            for (number, tile) in tiling.stored_tiles().zip(field.tiles(slab)) {
                let Some(slice) = layout.slice(number) else { continue };
                let size = tiling.tile_size(number);
                let bytes = texture_bytes(plan.storage, tiling.encoding(), size, tile)?;
                // A slice may be larger than its tile; the rest stays zero and is never sampled.
                write_image(gpu, "a slice of the slab texture", &texture, plan.layers.place(slice), size, &bytes)?;
                waiting += bytes.len();
                if waiting >= UPLOAD_BATCH {
                    gpu.wait()?;
                    waiting = 0;
                }
            }
        }
        let dimension = Some(plan.storage.dimensions().1);
        let (view, uniform, windows) = gpu.checked("the slab texture's view", || {
            let table = WindowTable::new(field.layout());
            let slabs = SlabsUniform::new(field, &plan.layers, table.as_ref());
            let uniform = buffer(gpu, "slabs", bytemuck::bytes_of(&slabs), wgpu::BufferUsages::UNIFORM);
            let rows = |table: WindowTable| DeviceWindows {
                rows: buffer(gpu, "windows", bytemuck::cast_slice(table.rows()), wgpu::BufferUsages::STORAGE),
                masked: table.is_masked(),
            };
            let view = texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() });
            (view, uniform, table.map(rows))
        })?;
        Ok(Self { view, uniform, windows, plan, geometry: field.geometry().clone() })
    }

    /// Where slabs.wgsl finds the geometry.
    pub(crate) fn uniform(&self) -> &wgpu::Buffer {
        &self.uniform
    }

    /// The resources that slabs.wgsl asks for.
    pub(crate) fn bindings<'a>(&'a self, sampler: &'a wgpu::Sampler) -> Vec<(u32, wgpu::BindingResource<'a>)> {
        let mut all = vec![
            (1, self.uniform.as_entire_binding()),
            (2, wgpu::BindingResource::Sampler(sampler)),
            (3, wgpu::BindingResource::TextureView(&self.view)),
        ];
        all.extend(self.windows.as_ref().map(|windows| (5, windows.rows.as_entire_binding())));
        all
    }

    /// Which variant of the shader it needs.
    pub(crate) fn shader(&self) -> SlabShader {
        let shared = self.plan.layers.grid() != [1, 1];
        let windows = match &self.windows {
            None => Windows::Whole,
            Some(table) if table.masked => Windows::Masked,
            Some(_) => Windows::Cropped,
        };
        SlabShader::new(self.plan.storage, shared, windows, &self.geometry)
    }

    /// The cell and the slabs.
    #[must_use]
    pub fn geometry(&self) -> &LightFieldGeometry {
        &self.geometry
    }

    /// The form in which it lies on the device.
    #[must_use]
    pub fn storage(&self) -> Storage {
        self.plan.storage
    }

    /// Bytes of the texture on the device.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.plan.bytes
    }

    /// Width, height, and depth or layers of the texture, texels.
    #[must_use]
    pub fn size(&self) -> [u32; 3] {
        self.plan.layers.size()
    }
}

/// A tile's bytes as the texture wants them.
fn texture_bytes(
    storage: Storage,
    encoding: TexelEncoding,
    [width, height]: [u32; 2],
    tile: &[u8],
) -> Result<Cow<'_, [u8]>, GpuError> {
    match encoding {
        TexelEncoding::Bc1 if storage == Storage::Rgba8Array => {
            let texels = bc1::decode_image(width, height, tile).map_err(lf_compress::PackError::from)?;
            Ok(bytemuck::cast_slice(&texels).to_vec().into())
        }
        // No device samples three half floats.
        TexelEncoding::Rgb16F => Ok(rgba16f(tile).into()),
        _ => Ok(tile.into()),
    }
}

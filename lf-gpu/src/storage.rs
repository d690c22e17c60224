//! A light field in a texture.

use std::borrow::Cow;
use std::fmt;

use lf_compress::bc1;
use lf_compress::format::{SlabTiling, TexelEncoding};
use lf_compress::{PackedLightField, rgba16f};
use lf_math::LightFieldGeometry;

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::pass::buffer;
use crate::shader::SlabShader;
use crate::uniforms::SlabsUniform;
use crate::windows::WindowTable;

/// More texture bytes than this are refused: some drivers abort the program instead of reporting that memory is out.
const MAX_TEXTURE_BYTES: u64 = 4 << 30;

/// How the packed volume lies in device memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// BC1 blocks in a 3D texture, as in the paper. Needs `TEXTURE_COMPRESSION_BC_SLICED_3D`.
    Bc1Volume,
    /// BC1 blocks in a 2D array texture. Needs `TEXTURE_COMPRESSION_BC`.
    Bc1Array,
    /// Decoded texels in a 2D array texture, eight times the bytes. Any device.
    Rgba8Array,
    /// Linear half floats in a 2D array texture, 8 bytes a texel, for light fields that have them. Any device.
    Rgba16FArray,
}

impl fmt::Display for Storage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Bc1Volume => "BC1 volume texture",
            Self::Bc1Array => "BC1 array texture",
            Self::Rgba8Array => "RGBA8 array texture",
            Self::Rgba16FArray => "RGBA16F array texture",
        })
    }
}

/// Texture bytes handed to the queue before it is made to pass them on: until then it keeps a copy of each.
const UPLOAD_BATCH: usize = 64 << 20;

/// A light field on the device.
pub struct SlabTexture {
    view: wgpu::TextureView,
    uniform: wgpu::Buffer,
    /// Where the windows of cropped images lie; `None` if all images are whole.
    windows: Option<wgpu::Buffer>,
    storage: Storage,
    geometry: LightFieldGeometry,
    bytes: u64,
}

impl Storage {
    /// All forms, the preferred one first.
    pub const ALL: [Self; 4] = [Self::Bc1Volume, Self::Bc1Array, Self::Rgba8Array, Self::Rgba16FArray];

    /// Whether it keeps BC1 blocks as they are.
    fn has_blocks(self) -> bool {
        matches!(self, Self::Bc1Volume | Self::Bc1Array)
    }

    /// Bytes of a texel that is not in a block.
    fn texel_bytes(self) -> u32 {
        if self == Self::Rgba16FArray { 8 } else { 4 }
    }

    /// Whether texels of an encoding can be kept in this form.
    fn takes(self, encoding: TexelEncoding) -> bool {
        match encoding {
            TexelEncoding::Bc1 => self != Self::Rgba16FArray,
            TexelEncoding::Rgba8 => self == Self::Rgba8Array,
            TexelEncoding::Rgb16F => self == Self::Rgba16FArray,
            _ => false,
        }
    }

    /// Why a device cannot hold a light field in this form, if so.
    fn obstacle(self, gpu: &Gpu, field: &PackedLightField) -> Option<String> {
        let features = gpu.device.features();
        let limits = gpu.device.limits();
        let [width, height, depth] = field.layout().size();
        let (needed, edge, slices) = match self {
            Self::Bc1Volume => {
                let both = wgpu::Features::TEXTURE_COMPRESSION_BC | wgpu::Features::TEXTURE_COMPRESSION_BC_SLICED_3D;
                (both, limits.max_texture_dimension_3d, limits.max_texture_dimension_3d)
            }
            Self::Bc1Array => {
                let one = wgpu::Features::TEXTURE_COMPRESSION_BC;
                (one, limits.max_texture_dimension_2d, limits.max_texture_array_layers)
            }
            Self::Rgba8Array | Self::Rgba16FArray => {
                (wgpu::Features::empty(), limits.max_texture_dimension_2d, limits.max_texture_array_layers)
            }
        };
        if let Some(other) = field.tilings().iter().map(SlabTiling::encoding).find(|&encoding| !self.takes(encoding)) {
            return Some(format!("its texels are {other:?}"));
        }
        if !features.contains(needed) {
            return Some(format!("the device lacks {needed:?}"));
        }
        if width.max(height) > edge || depth > slices {
            return Some(format!("{width}×{height}×{depth} texels exceed the device's {edge}×{edge}×{slices}"));
        }
        let bytes = self.bytes(field);
        (bytes > MAX_TEXTURE_BYTES).then(|| format!("{bytes} bytes exceed the budget of {MAX_TEXTURE_BYTES}"))
    }

    /// Bytes of the texture on the device, spare slots of the power-of-two volume included.
    fn bytes(self, field: &PackedLightField) -> u64 {
        let texels: u64 = field.layout().size().map(u64::from).iter().product();
        match self {
            Self::Bc1Volume | Self::Bc1Array => texels / 2,
            Self::Rgba8Array | Self::Rgba16FArray => u64::from(self.texel_bytes()) * texels,
        }
    }

    fn descriptor(self, [width, height, depth]: [u32; 3]) -> wgpu::TextureDescriptor<'static> {
        let format = match self {
            Self::Bc1Volume | Self::Bc1Array => wgpu::TextureFormat::Bc1RgbaUnorm,
            Self::Rgba8Array => wgpu::TextureFormat::Rgba8Unorm,
            Self::Rgba16FArray => wgpu::TextureFormat::Rgba16Float,
        };
        wgpu::TextureDescriptor {
            label: Some("slabs"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: depth },
            mip_level_count: 1,
            sample_count: 1,
            dimension: if self == Self::Bc1Volume { wgpu::TextureDimension::D3 } else { wgpu::TextureDimension::D2 },
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        }
    }

    /// The dimension under which the shader sees the texture. A single layer must be asked for as an array, too.
    fn view_dimension(self) -> wgpu::TextureViewDimension {
        match self {
            Self::Bc1Volume => wgpu::TextureViewDimension::D3,
            Self::Bc1Array | Self::Rgba8Array | Self::Rgba16FArray => wgpu::TextureViewDimension::D2Array,
        }
    }
}

impl SlabTexture {
    /// Uploads a light field in the first form that the device can hold.
    ///
    /// # Errors
    /// If it can hold none; the reason given is that of the form that needs least.
    pub fn new(gpu: &Gpu, field: &PackedLightField) -> Result<Self, GpuError> {
        let possible = Storage::ALL.into_iter().find(|storage| storage.obstacle(gpu, field).is_none());
        let linear = field.tilings().iter().any(|tiling| tiling.encoding() == TexelEncoding::Rgb16F);
        let least = if linear { Storage::Rgba16FArray } else { Storage::Rgba8Array };
        Self::with_storage(gpu, field, possible.unwrap_or(least))
    }

    /// Uploads a light field in a given form, slice by slice. BC1 blocks go up as they are.
    ///
    /// # Errors
    /// If the device cannot hold it in this form.
    pub fn with_storage(gpu: &Gpu, field: &PackedLightField, storage: Storage) -> Result<Self, GpuError> {
        if let Some(why) = storage.obstacle(gpu, field) {
            return Err(GpuError::Storage { storage, adapter: gpu.name(), why });
        }
        let descriptor = storage.descriptor(field.layout().size());
        let texture = gpu.checked("the slab texture", || gpu.device.create_texture(&descriptor))?;
        let mut waiting = 0;
        for (slab, layout) in field.layout().slabs().iter().enumerate() {
            let tiling = layout.tiling();
            for (number, tile) in tiling.stored_tiles().zip(field.tiles(slab)) {
                let Some(slice) = layout.slice(number) else { continue };
                let size = tiling.tile_size(number);
                let bytes = texture_bytes(storage, tiling.encoding(), size, tile)?;
                gpu.checked("a slice of the slab texture", || upload(gpu, &texture, storage, slice, size, &bytes))?;
                waiting += bytes.len();
                if waiting >= UPLOAD_BATCH {
                    gpu.queue.submit([]);
                    waiting = 0;
                }
            }
        }
        let dimension = Some(storage.view_dimension());
        let (view, uniform, windows) = gpu.checked("the slab texture's view", || {
            let table = WindowTable::new(field.layout());
            let slabs = SlabsUniform::new(field, table.as_ref());
            let uniform = buffer(gpu, "slabs", bytemuck::bytes_of(&slabs), wgpu::BufferUsages::UNIFORM);
            let rows = |table: WindowTable| {
                buffer(gpu, "windows", bytemuck::cast_slice(table.rows()), wgpu::BufferUsages::STORAGE)
            };
            let view = texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() });
            (view, uniform, table.map(rows))
        })?;
        let (geometry, bytes) = (field.geometry().clone(), storage.bytes(field));
        Ok(Self { view, uniform, windows, storage, geometry, bytes })
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
        all.extend(self.windows.as_ref().map(|windows| (5, windows.as_entire_binding())));
        all
    }

    /// Which variant of the shader it needs.
    pub(crate) fn shader(&self) -> SlabShader {
        SlabShader::new(self.storage, self.windows.is_some(), &self.geometry)
    }

    /// The cell and the slabs.
    #[must_use]
    pub fn geometry(&self) -> &LightFieldGeometry {
        &self.geometry
    }

    /// The form in which it lies on the device.
    #[must_use]
    pub fn storage(&self) -> Storage {
        self.storage
    }

    /// Bytes of the texture on the device.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
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

/// Writes one slice. A slice may be larger than the tile; the rest stays zero and is never sampled.
fn upload(gpu: &Gpu, texture: &wgpu::Texture, storage: Storage, slice: u32, size: [u32; 2], bytes: &[u8]) {
    let [width, height] = size;
    // A row of BC1 blocks is 8 bytes for every 4 texels.
    let (bytes_per_row, rows_per_image) =
        if storage.has_blocks() { (2 * width, height / 4) } else { (storage.texel_bytes() * width, height) };
    gpu.queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: 0,
            origin: wgpu::Origin3d { x: 0, y: 0, z: slice },
            aspect: wgpu::TextureAspect::All,
        },
        bytes,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(bytes_per_row),
            rows_per_image: Some(rows_per_image),
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
}

//! The forms in which a device can hold a light field, and which it can.

use std::fmt;

use lf_compress::PackedLightField;
use lf_compress::format::{SlabTiling, TexelEncoding};

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::layers::Layers;

/// How the packed volume lies in device memory.
///
/// [`SlabTexture::new`](crate::SlabTexture::new) takes the first form that the device can hold: BC1 blocks as an array, which is
/// sampled faster (`docs/cost.md`) and has no spare slots, BC1 blocks as a volume, decoded texels as an array. An array with fewer layers than the light field has slices gets several slices to a
/// layer, as many as it must. Forms are passed over for missing features, for limits, and for a budget of bytes
/// ([`DeviceOptions`](crate::DeviceOptions)); all of this is decided before the device is asked for memory. The picture is the same in each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// BC1 blocks in a 2D array texture. Needs `TEXTURE_COMPRESSION_BC`.
    Bc1Array,
    /// BC1 blocks in a 3D texture, as in the paper. Needs `TEXTURE_COMPRESSION_BC_SLICED_3D`.
    Bc1Volume,
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

/// Bytes of a slice of a texture.
pub(crate) fn slice_bytes(format: wgpu::TextureFormat, [width, height]: [u32; 2]) -> u64 {
    let (across, down) = format.block_dimensions();
    let blocks = u64::from(width.div_ceil(across)) * u64::from(height.div_ceil(down));
    // None only of depth and stencil.
    blocks * u64::from(format.block_copy_size(None).unwrap_or(0))
}

/// A form that a device can hold a light field in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plan {
    pub(crate) storage: Storage,
    pub(crate) layers: Layers,
    /// Of the texture; a volume's spare slots are included.
    pub(crate) bytes: u64,
}

impl Storage {
    /// All forms, the preferred one first.
    pub const ALL: [Self; 4] = [Self::Bc1Array, Self::Bc1Volume, Self::Rgba8Array, Self::Rgba16FArray];

    /// Whether it keeps BC1 blocks as they are.
    pub(crate) fn has_blocks(self) -> bool {
        matches!(self, Self::Bc1Volume | Self::Bc1Array)
    }

    /// Bytes of a texel that is not in a block.
    pub(crate) fn texel_bytes(self) -> u32 {
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

    fn features(self) -> wgpu::Features {
        match self {
            Self::Bc1Volume => {
                wgpu::Features::TEXTURE_COMPRESSION_BC | wgpu::Features::TEXTURE_COMPRESSION_BC_SLICED_3D
            }
            Self::Bc1Array => wgpu::Features::TEXTURE_COMPRESSION_BC,
            Self::Rgba8Array | Self::Rgba16FArray => wgpu::Features::empty(),
        }
    }

    /// How a device can hold a light field in this form.
    ///
    /// # Errors
    /// [`GpuError::Storage`] or [`GpuError::OverBudget`] if it cannot.
    pub(crate) fn plan(self, gpu: &Gpu, field: &PackedLightField) -> Result<Plan, GpuError> {
        let obstacle = |why| GpuError::Storage { storage: self, adapter: gpu.name(), why };
        if let Some(other) = field.tilings().iter().map(SlabTiling::encoding).find(|&encoding| !self.takes(encoding)) {
            return Err(obstacle(format!("its texels are {other:?}")));
        }
        let missing = self.features() - gpu.device.features();
        if !missing.is_empty() {
            return Err(obstacle(format!("the device lacks {missing:?}")));
        }
        let [width, height, depth] = field.layout().size();
        // A texture of layers needs no power of two.
        let size = [width, height, if self == Self::Bc1Volume { depth } else { field.layout().slices() }];
        let layers = self.layers(&gpu.device.limits(), size).map_err(obstacle)?;
        let bytes = self.bytes(layers.size());
        gpu.affords(format!("the {self} of this light field"), bytes)?;
        Ok(Plan { storage: self, layers, bytes })
    }

    /// How slices lie in a texture that keeps a device's limits, or why they cannot.
    fn layers(self, limits: &wgpu::Limits, size: [u32; 3]) -> Result<Layers, String> {
        let [width, height, slices] = size;
        let (edge, most) = match self {
            Self::Bc1Volume => (limits.max_texture_dimension_3d, limits.max_texture_dimension_3d),
            _ => (limits.max_texture_dimension_2d, limits.max_texture_array_layers),
        };
        let exceeded = format!("{slices} slices of {width}×{height} texels exceed the device's {edge}×{edge}×{most}");
        let layers = if self == Self::Bc1Volume {
            Some(Layers::plain(size)).filter(|_| width.max(height) <= edge && slices <= most)
        } else {
            Layers::within(size, edge, most)
        };
        layers.ok_or(if width.max(height) > edge {
            format!("{exceeded}; capture images of at most {edge} texels, or crop them")
        } else {
            format!("{exceeded}; crop the light field, or capture fewer cameras or texels")
        })
    }

    fn bytes(self, size: [u32; 3]) -> u64 {
        let texels: u64 = size.map(u64::from).iter().product();
        if self.has_blocks() { texels / 2 } else { u64::from(self.texel_bytes()) * texels }
    }

    pub(crate) fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::Bc1Volume | Self::Bc1Array => wgpu::TextureFormat::Bc1RgbaUnorm,
            Self::Rgba8Array => wgpu::TextureFormat::Rgba8Unorm,
            Self::Rgba16FArray => wgpu::TextureFormat::Rgba16Float,
        }
    }

    /// The texture's dimension, and the one under which the shader sees it: a single layer must be asked for as an array, too.
    pub(crate) fn dimensions(self) -> (wgpu::TextureDimension, wgpu::TextureViewDimension) {
        match self {
            Self::Bc1Volume => (wgpu::TextureDimension::D3, wgpu::TextureViewDimension::D3),
            _ => (wgpu::TextureDimension::D2, wgpu::TextureViewDimension::D2Array),
        }
    }
}

impl Plan {
    /// The first form that a device can hold.
    ///
    /// # Errors
    /// If there is none: the budget if that is all that is in the way of a form, else what is in the way of the form that needs least.
    pub(crate) fn first(gpu: &Gpu, field: &PackedLightField) -> Result<Self, GpuError> {
        let encoding = field.tilings()[0].encoding();
        let mut found = None;
        for storage in Storage::ALL.into_iter().filter(|storage| storage.takes(encoding)) {
            match storage.plan(gpu, field) {
                Ok(plan) => return Ok(plan),
                Err(error) if !matches!(found, Some(GpuError::OverBudget { .. })) => found = Some(error),
                Err(_) => {}
            }
        }
        Err(found.unwrap_or_else(|| GpuError::Refused {
            what: "the light field",
            why: format!("no texture holds {encoding:?} texels"),
        }))
    }

    pub(crate) fn descriptor(&self) -> wgpu::TextureDescriptor<'static> {
        let [width, height, depth] = self.layers.size();
        wgpu::TextureDescriptor {
            label: Some("slabs"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: depth },
            mip_level_count: 1,
            sample_count: 1,
            dimension: self.storage.dimensions().0,
            format: self.storage.format(),
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        }
    }
}

//! The crate's one error type.

use thiserror::Error;

use crate::storage::Storage;

/// Why the GPU could not do what was asked.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No Vulkan, Metal or Direct3D 12 adapter was found.
    #[error("no GPU adapter found (Vulkan, Metal or Direct3D 12); on Debian, mesa-vulkan-drivers is a software one")]
    NoAdapter(#[from] wgpu::RequestAdapterError),
    /// The adapter gave no device.
    #[error("the GPU adapter gives no device")]
    NoDevice(#[from] wgpu::RequestDeviceError),
    /// The light field does not fit the device in this form.
    #[error("{storage} cannot hold this light field on {adapter}: {why}")]
    Storage {
        /// The form.
        storage: Storage,
        /// The device.
        adapter: String,
        /// What is missing, and what to do.
        why: String,
    },
    /// A texture, or a buffer in place of one, would take more than [`DeviceOptions::max_texture_bytes`](crate::DeviceOptions::max_texture_bytes).
    #[error(
        "{what} takes {bytes} bytes, more than the budget of {budget}: crop the light field, capture fewer cameras or texels, keep \
         BC1 blocks where the device samples them, draw fewer pixels, or allow more (max_texture_bytes)"
    )]
    OverBudget {
        /// The texture or buffer.
        what: String,
        /// Bytes that it takes on the device.
        bytes: u64,
        /// Bytes that it may take.
        budget: u64,
    },
    /// The device has no memory left.
    #[error(
        "the GPU is out of memory for {what}; close other programs that use it, or ask for fewer cameras, texels or \
         pixels"
    )]
    OutOfMemory {
        /// What was asked.
        what: &'static str,
    },
    /// The device is gone with everything on it: its driver was reset or had no memory for what it keeps itself, it was unplugged, or it
    /// was given back.
    #[error("the GPU device {device} was lost ({why}); open it again, or draw on the CPU")]
    Lost {
        /// Name and API of its adapter.
        device: String,
        /// What the driver says.
        why: String,
    },
    /// The device refused a resource or a command.
    #[error("the GPU refused {what}: {why}")]
    Refused {
        /// What was asked.
        what: &'static str,
        /// What the device says.
        why: String,
    },
    /// What was given has not the shape that is needed.
    #[error(transparent)]
    Geometry(#[from] lf_math::GeometryError),
    /// The texels of a light field could not be decoded for upload.
    #[error(transparent)]
    Decode(#[from] lf_compress::PackError),
}

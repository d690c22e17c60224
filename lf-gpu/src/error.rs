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
        /// What is missing.
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
    /// The texels of a light field could not be decoded for upload.
    #[error(transparent)]
    Decode(#[from] lf_compress::PackError),
}

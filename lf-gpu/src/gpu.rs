//! The device.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::GpuError;

/// An open GPU device.
pub struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    lost: Arc<AtomicBool>,
}

/// Vulkan, Metal and Direct3D 12. OpenGL is left out: a driver we tried claims BC1 in 3D textures and samples black.
fn instance() -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::PRIMARY;
    wgpu::Instance::new(descriptor)
}

/// One line about each adapter of this machine: name, kind (`DiscreteGpu`, `Cpu`, …), API and driver.
#[must_use]
pub fn adapter_lines() -> Vec<String> {
    let adapters = pollster::block_on(instance().enumerate_adapters(wgpu::Backends::PRIMARY));
    adapters.iter().map(|adapter| describe(&adapter.get_info())).collect()
}

fn describe(info: &wgpu::AdapterInfo) -> String {
    let driver = format!("{} {}", info.driver, info.driver_info);
    format!("{} ({:?}, {}, {})", info.name, info.device_type, info.backend, driver.trim())
}

impl Gpu {
    /// Opens the fastest adapter, with block compression if it has it and with its own limits.
    ///
    /// # Errors
    /// If there is no adapter or it gives no device.
    pub fn new() -> Result<Self, GpuError> {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance().request_adapter(&options))?;
        let wanted = wgpu::Features::TEXTURE_COMPRESSION_BC | wgpu::Features::TEXTURE_COMPRESSION_BC_SLICED_3D;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("lf-gpu"),
            required_features: adapter.features() & wanted,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))?;
        let lost = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&lost);
        device.set_device_lost_callback(move |_, _| flag.store(true, Ordering::Relaxed));
        Ok(Self { device, queue, info: adapter.get_info(), lost })
    }

    /// Name and API of the adapter, without what some drivers add in brackets.
    #[must_use]
    pub fn name(&self) -> String {
        let name = self.info.name.split(" (").next().unwrap_or_default();
        format!("{name}, {:?}", self.info.backend)
    }

    /// Name, kind, API and driver of the adapter.
    #[must_use]
    pub fn description(&self) -> String {
        describe(&self.info)
    }

    /// Waits until all submitted work is done.
    ///
    /// # Errors
    /// If the device is known to be lost.
    pub fn wait(&self) -> Result<(), GpuError> {
        if self.lost.load(Ordering::Relaxed) {
            return Err(GpuError::Refused { what: "to go on", why: "the device was lost".to_owned() });
        }
        let refused = |e: wgpu::PollError| GpuError::Refused { what: "to finish its work", why: e.to_string() };
        self.device.poll(wgpu::PollType::wait_indefinitely()).map(|_| ()).map_err(refused)
    }

    /// Runs `make` and turns the device's errors into a result.
    pub(crate) fn checked<T>(&self, what: &'static str, make: impl FnOnce() -> T) -> Result<T, GpuError> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let made = make();
        let errors = [internal, validation, memory].map(|scope| pollster::block_on(scope.pop()));
        match errors.into_iter().flatten().next() {
            Some(error) => Err(GpuError::Refused { what, why: error.to_string() }),
            None => Ok(made),
        }
    }
}

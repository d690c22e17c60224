//! The device.

use std::sync::{Arc, OnceLock};

use crate::error::GpuError;

/// How much of an adapter a device may use: by default all that it has, and 4 GiB a texture.
///
/// Every limit is the adapter's own where that is lower. A light field goes into the first [`Storage`](crate::Storage) that
/// fits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DeviceOptions {
    /// Whether textures keep BC1 blocks.
    pub blocks: bool,
    /// Whether volume textures do, too.
    pub block_volumes: bool,
    /// Texels along the edge of a 2D texture.
    pub max_texture_dimension_2d: u32,
    /// Texels along the edge of a volume texture.
    pub max_texture_dimension_3d: u32,
    /// Layers of an array texture.
    pub max_texture_array_layers: u32,
    /// A texture of more bytes, or a buffer of more in place of one, is refused before the device is asked for it: some drivers abort the
    /// program instead of reporting that memory is out.
    pub max_texture_bytes: u64,
}

/// An open GPU device.
pub struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    /// Why it was lost; empty while it is not.
    lost: Arc<OnceLock<String>>,
    max_texture_bytes: u64,
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

/// What the driver says of a loss, as a clause.
fn cause_of_loss(reason: wgpu::DeviceLostReason, said: &str) -> String {
    if said.is_empty() { format!("{reason:?}") } else { said.trim_end_matches('.').to_owned() }
}

impl Default for DeviceOptions {
    fn default() -> Self {
        Self {
            blocks: true,
            block_volumes: true,
            max_texture_dimension_2d: u32::MAX,
            max_texture_dimension_3d: u32::MAX,
            max_texture_array_layers: u32::MAX,
            max_texture_bytes: 4 << 30,
        }
    }
}

impl DeviceOptions {
    fn features(&self) -> wgpu::Features {
        let mut wanted = wgpu::Features::empty();
        wanted.set(wgpu::Features::TEXTURE_COMPRESSION_BC, self.blocks);
        wanted.set(wgpu::Features::TEXTURE_COMPRESSION_BC_SLICED_3D, self.blocks && self.block_volumes);
        wanted
    }

    fn limits(&self, adapter: &wgpu::Limits) -> wgpu::Limits {
        wgpu::Limits {
            max_texture_dimension_2d: self.max_texture_dimension_2d.min(adapter.max_texture_dimension_2d),
            max_texture_dimension_3d: self.max_texture_dimension_3d.min(adapter.max_texture_dimension_3d),
            max_texture_array_layers: self.max_texture_array_layers.min(adapter.max_texture_array_layers),
            ..adapter.clone()
        }
    }
}

impl Gpu {
    /// Opens the fastest adapter, with block compression if it has it and with its own limits.
    ///
    /// # Errors
    /// If there is no adapter or it gives no device.
    pub fn new() -> Result<Self, GpuError> {
        Self::with_options(&DeviceOptions::default())
    }

    /// Opens the fastest adapter and uses no more of it than the options say.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_options(options: &DeviceOptions) -> Result<Self, GpuError> {
        let fastest = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance().request_adapter(&fastest))?;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("lf-gpu"),
            required_features: adapter.features() & options.features(),
            required_limits: options.limits(&adapter.limits()),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))?;
        let lost = Arc::new(OnceLock::new());
        let cause = Arc::clone(&lost);
        // The first cause is kept.
        device.set_device_lost_callback(move |reason, said| drop(cause.set(cause_of_loss(reason, &said))));
        Ok(Self { device, queue, info: adapter.get_info(), lost, max_texture_bytes: options.max_texture_bytes })
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
        self.alive()?;
        let refused = |e: wgpu::PollError| GpuError::Refused { what: "to finish its work", why: e.to_string() };
        let waited = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.alive()?;
        waited.map(|_| ()).map_err(refused)
    }

    /// Gives the device back. It is lost from now on, as if its driver had been reset: every later call fails with
    /// [`GpuError::Lost`].
    pub fn destroy(&self) {
        // Later than a loss this changes nothing.
        let _ = self.lost.set("it was given back".to_owned());
        self.device.destroy();
    }

    /// Runs `make` and turns the device's errors into a result. Lack of memory goes before all else: what could not be made is invalid, and
    /// whatever `make` then does with it is an error, too.
    pub(crate) fn checked<T>(&self, what: &'static str, make: impl FnOnce() -> T) -> Result<T, GpuError> {
        self.alive()?;
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let made = make();
        let errors = [memory, validation, internal].map(|scope| pollster::block_on(scope.pop()));
        // The loss of a device goes by error scopes.
        self.alive()?;
        match errors.into_iter().flatten().next() {
            Some(wgpu::Error::OutOfMemory { .. }) => Err(GpuError::OutOfMemory { what }),
            Some(error) => Err(GpuError::Refused { what, why: error.to_string() }),
            None => Ok(made),
        }
    }

    /// Whether a texture, or a buffer in place of one, is within the budget.
    pub(crate) fn affords(&self, what: impl Into<String>, bytes: u64) -> Result<(), GpuError> {
        let budget = self.max_texture_bytes;
        if bytes > budget { Err(GpuError::OverBudget { what: what.into(), bytes, budget }) } else { Ok(()) }
    }

    fn alive(&self) -> Result<(), GpuError> {
        match self.lost.get() {
            Some(why) => Err(GpuError::Lost { device: self.name(), why: why.clone() }),
            None => Ok(()),
        }
    }
}

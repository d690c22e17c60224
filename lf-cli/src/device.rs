//! The device that draws: a GPU if there is one, else the CPU.

use anyhow::{Context, Result};
use lf_compress::PackedLightField;
use lf_gpu::{Gpu, MirrorMesh, ReflectionPass, SlabTexture, Target};
use lf_ibr::{CubeField, Environment, GBuffer, SlabField, reflect_frame};
use lf_math::{CubeMap, Image, Pinhole, TriangleMesh};

use crate::input::MAX_DECODED_BYTES;

/// Opens a GPU, or says why the CPU draws.
pub(crate) fn open_gpu(cpu_only: bool) -> Option<Gpu> {
    if cpu_only {
        eprintln!("device   CPU, as asked");
        return None;
    }
    match Gpu::new() {
        Ok(gpu) => {
            eprintln!("device   {}", gpu.description());
            Some(gpu)
        }
        Err(error) => {
            eprintln!("device   CPU: {:#}", anyhow::Error::from(error));
            None
        }
    }
}

/// What a GPU made, if there is one and it could; else says why the CPU draws.
pub(crate) fn or_cpu<T>(made: Option<Result<T>>) -> Option<T> {
    made?.inspect_err(|error| eprintln!("device   CPU after all: {error:#}")).ok()
}

/// One method on one device, ready to draw frames of a mirror.
pub(crate) trait Method {
    /// Draws a frame and waits until it is finished.
    fn draw(&mut self) -> Result<()>;
    /// The frame drawn last.
    fn picture(&mut self) -> Result<Image<[u8; 4]>>;
}

/// A pass on the GPU.
pub(crate) struct GpuMethod<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) pass: &'a ReflectionPass,
    pub(crate) target: &'a Target,
    pub(crate) mesh: &'a MirrorMesh,
    pub(crate) camera: &'a Pinhole,
}

impl Method for GpuMethod<'_> {
    fn draw(&mut self) -> Result<()> {
        self.pass.draw(self.gpu, self.target, self.mesh, self.camera)?;
        Ok(self.gpu.wait()?)
    }

    fn picture(&mut self) -> Result<Image<[u8; 4]>> {
        Ok(self.target.read(self.gpu)?)
    }
}

/// Its twin on the CPU.
pub(crate) struct CpuMethod<'a, E: ?Sized> {
    environment: &'a E,
    mesh: &'a TriangleMesh,
    camera: &'a Pinhole,
    drawn: Option<Image<[u8; 4]>>,
}

impl<'a, E: Environment + ?Sized> CpuMethod<'a, E> {
    pub(crate) fn new(environment: &'a E, mesh: &'a TriangleMesh, camera: &'a Pinhole) -> Self {
        Self { environment, mesh, camera, drawn: None }
    }
}

impl<E: Environment + ?Sized> Method for CpuMethod<'_, E> {
    fn draw(&mut self) -> Result<()> {
        self.drawn = Some(reflect_frame(&GBuffer::rasterize(self.mesh, self.camera), self.environment));
        Ok(())
    }

    fn picture(&mut self) -> Result<Image<[u8; 4]>> {
        self.drawn.take().context("nothing was drawn")
    }
}

/// Both environments on the GPU.
pub(crate) struct GpuSide {
    pub(crate) gpu: Gpu,
    pub(crate) target: Target,
    pub(crate) slabs: ReflectionPass,
    pub(crate) cube: ReflectionPass,
    /// What the slabs' texture is, for people.
    pub(crate) storage: String,
    pub(crate) slab_bytes: u64,
}

impl GpuSide {
    pub(crate) fn new(gpu: Gpu, field: &PackedLightField, cube: &CubeMap, size: u32) -> Result<Self> {
        let texture = SlabTexture::new(&gpu, field)?;
        let (slabs, cube) = (ReflectionPass::slabs(&gpu, &texture)?, ReflectionPass::environment(&gpu, cube)?);
        let target = Target::new(&gpu, size, size)?;
        let (storage, slab_bytes) = (texture.storage().to_string(), texture.bytes());
        Ok(Self { gpu, target, slabs, cube, storage, slab_bytes })
    }
}

/// Both environments on the CPU.
pub(crate) struct CpuSide {
    pub(crate) slabs: SlabField,
    pub(crate) cube: CubeField,
}

impl CpuSide {
    pub(crate) fn new(field: &PackedLightField, cube: &CubeMap) -> Result<Self> {
        Ok(Self {
            slabs: SlabField::new(field.geometry().clone(), field.decode(MAX_DECODED_BYTES)?)?,
            cube: CubeField::new(cube),
        })
    }
}

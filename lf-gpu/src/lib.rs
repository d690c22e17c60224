//! The GPU renderer, by `wgpu`: reflections from light field slabs and environment maps, offscreen.
//!
//! [`Gpu::new`] opens an adapter; [`SlabTexture`] uploads a packed light field without decoding it, as a 2D array
//! of BC1 blocks where the device samples those, else as a volume, else as plain RGBA ([`Storage`]); a
//! [`ReflectionPass`] draws a [`MirrorMesh`] into a [`Target`]; a [`SlabRenderer`] draws whole [`Frame`]s: any number of placed,
//! tinted [`Reflector`]s and what is [`Behind`] them, from the same slabs or as the scene's triangles ([`SceneMesh`]), in one pass or the paper's
//! two ([`StuvBuffer`]). One pass, four hardware-bilinear fetches a pixel, for the
//! slabs (Figs. 6 and 8 of Yu, Yang & McMillan); one fetch for the environment map, also where it is projected on a sphere or a box
//! ([`Proxy`]); a distance cube takes a fetch for each step of its [`lf_math::Search`], and so do several of them ([`ReflectionPass::probes`]);
//! guided cubes ([`ReflectionPass::guided`]) take few steps, each of several fetches.
//!
//! Every shader has a readable twin in `lf-ibr`, and holds only what a light field and a frame need. Cost is the shaded pixels times the
//! fetches: the scene does not matter, the mirror by its vertices, and by triangles so small that adapters shade pixels beside them.
//! Windows and animation are not this crate's job.

#![forbid(unsafe_code)]

mod cube_textures;
mod cubes;
mod error;
mod frame;
mod gpu;
mod layers;
mod mesh;
mod pass;
mod plane_blocks;
mod probe;
mod relief;
mod several_cubes;
mod shader;
mod slab_texture;
mod storage;
mod stuv;
mod target;
mod uniforms;
mod upload;
mod windows;

pub use cube_textures::CubePicture;
pub use cubes::Proxy;
pub use error::GpuError;
pub use frame::{Behind, Frame, Reflector, SlabRenderer};
pub use gpu::{DeviceOptions, Gpu, adapter_lines};
pub use mesh::{MirrorMesh, SceneMesh};
pub use pass::ReflectionPass;
pub use probe::{Probe, read_probes};
pub use relief::NormalMapTexture;
pub use slab_texture::SlabTexture;
pub use storage::Storage;
pub use stuv::StuvBuffer;
pub use target::Target;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

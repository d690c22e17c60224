//! Light fields in other people's formats, out and in.
//!
//! | format | out | in |
//! |---|---|---|
//! | KTX 2.0, 3D texture: BC1, RGBA8, RGBA16F, plain or zstd | [`ktx2::encode`] | – |
//! | DDS with the `DX10` header, volume or 2D array: the same | [`dds::encode`] | – |
//! | camera grid: PNG, or OpenEXR for linear texels; in also JPEG | [`write_grid`] | [`import_grid`] |
//! | 4D Light Field Benchmark (HCI) | [`write_hci`] | [`import_hci`] |
//! | Looking Glass quilt | [`write_quilt`] | [`import_quilt`] |
//! | `transforms.json` of NeRF tools, with pictures | [`write_transforms`] | – |
//! | pictures by POV-Ray, Mitsuba, Blender or any other renderer | the cameras: [`Plan::write`] | [`import_plan`] |
//!
//! **Pictures are true pictures.** A slab's images may be mirrored, upside down or transposed against what a camera sees;
//! all that leaves or enters here as pictures goes through [`PictureBasis`], which says how for each face.
//!
//! **Colours.** 8-bit texels are sRGB-encoded and stay so; floating-point texels are linear with Rec. 709 primaries.
//! Whatever is interpolated is interpolated as it is stored.
//!
//! **What a slab's pictures show** is what is seen from where each ray leaves the cell, not from the camera itself
//! (`spec/lfslab-1.0.md` §5.7). The two are the same as long as nothing stands between them; on import they are taken to be.
//!
//! Imports trust nothing: sizes are held to a limit before anything is decoded, and damaged files give errors. Not read are
//! LightPack's `.lif` and `.lid`, depth and disparity maps, lens distortion, and cameras that are turned towards each other.

#![forbid(unsafe_code)]

mod basis;
pub mod dds;
mod error;
mod field;
mod grid;
mod hci;
mod import;
pub mod ktx2;
mod plan;
mod quilt;
mod texel;
mod transforms;
mod volume;

pub use basis::{Intrinsics, PictureAxis, PictureBasis};
pub use error::ExchangeError;
pub use field::{LightField, SlabPictures};
pub use grid::{GridNaming, face_folder, write_grid, write_slab_grid};
pub use hci::{HciScene, write_hci};
pub use import::{ImportOptions, Imported, Lens, import, import_grid, import_hci, import_quilt};
pub use plan::{ImportedPlan, PictureFrame, Plan, PlanCamera, PlanImportOptions, PlanTexels, World, import_plan};
pub use quilt::{QuiltLayout, write_quilt};
pub use texel::{Texel, Texels};
pub use transforms::{transforms, write_transforms};
pub use volume::{Volume, VolumeFormat};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

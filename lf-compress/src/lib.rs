//! From decoded slabs to the bytes that a file stores and a GPU samples, and back.
//!
//! * [`bc1`]: BC1 (DXT1) blocks. Knows nothing of light fields; usable alone.
//! * [`volume`]: the place of every camera image in one volume texture.
//! * [`PackedLightField`]: a light field as encoded tiles, one per volume slice: made from texels or read from a
//!   container, uploaded to a GPU as it is or decoded again.
//! * [`planes`]: images of inverse depth, two planes a block; [`PackedCube`]: cubes of them and of BC1, and [`GuidedCubes`] with slabs of depth.
//! * [`tile`]: lossless packing of BC1 tiles for the file, and blocks that pack better.
//!
//! Tiles of other encodings are packed by zstd, one frame each. Light fields too large for memory are made tile by tile:
//! [`tile_picture`], [`encode_tile`] and [`pack_tile`] are the steps.

#![forbid(unsafe_code)]

pub mod bc1;
mod check;
mod error;
mod file;
mod guide;
mod packed;
mod packed_cube;
mod picture;
pub mod planes;
mod recut;
pub mod tile;
mod validate;
pub mod volume;
mod zstd_tile;

pub use check::check_tile;
pub use error::PackError;
pub use file::{decode_into, pack_tile, unpack_into};
pub use guide::{DepthGuide, GuidedCubes};
/// The container crate, whose types the packed light field speaks.
pub use lf_format as format;
pub use packed::{PackOptions, PackedLightField, encode_linear_tile, encode_tile};
pub use packed_cube::PackedCube;
pub use picture::{Texel, rgba16f, tile_picture};
pub use validate::{Finding, Severity, validate};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

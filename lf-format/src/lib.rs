//! The `.lfslab` container: one environment light field in one file.
//!
//! A file holds the geometry of a [`LightFieldGeometry`](lf_math::LightFieldGeometry), some metadata, and the camera
//! images of each slab, grouped into *tiles* that can be read one by one. The normative description is
//! `spec/lfslab-1.0.md`; every error names the [`Rule`] of it that a file breaks, and the byte where.
//!
//! [`Container`] reads a file in memory, [`FileReader`] one that stays where it is, [`Writer`] makes one tile by tile. Opening
//! a file validates its [`Structure`], all but the payloads of tiles; each tile is checked when it is asked for, and `verify`
//! checks them all. Memory is bounded by [`Limits`], whatever a file says.
//!
//! The crate knows no codec. It hands out tiles as they are stored and says how they are packed and how long they are
//! unpacked; it neither unpacks zstd frames nor decodes texels.
//!
//! Without the feature `std`, which is on by default, what reads from memory is left: [`Container`] and all that it returns.

#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]
#![cfg_attr(not(feature = "std"), expect(dead_code, reason = "what makes bytes is for the writer, which needs std"))]

extern crate alloc;

#[cfg(feature = "std")]
mod atomic;
mod bytes;
mod container;
mod coverage;
mod directory;
mod encoding;
mod error;
#[cfg(feature = "std")]
mod file;
mod geometry;
mod header;
mod limits;
mod metadata;
mod rule;
mod structure;
mod tiling;
#[cfg(feature = "std")]
mod writer;

#[cfg(feature = "std")]
pub use atomic::{AtomicFile, write_atomic};
pub use container::Container;
pub use directory::{ChunkEntry, Tag};
pub use encoding::{Packing, TexelEncoding};
pub use error::FormatError;
#[cfg(feature = "std")]
pub use file::FileReader;
pub use limits::{Budget, Limits};
pub use metadata::Metadata;
pub use rule::Rule;
pub use structure::{StoredTile, Structure};
pub use tiling::{CameraPlace, SlabTiling};
#[cfg(feature = "std")]
pub use writer::{Contents, ExtraChunk, Writer};

#[cfg(all(doctest, feature = "std"))]
#[doc = include_str!("../README.md")]
struct Readme;

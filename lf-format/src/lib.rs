//! The `.lfslab` container: one environment light field in one file.
//!
//! A file holds the geometry of a [`LightFieldGeometry`](lf_math::LightFieldGeometry), some metadata, and the camera
//! images of each slab, grouped into *tiles* that can be read one by one. The normative description is
//! `spec/lfslab-1.0.md`; every error names the clause of it that a file breaks, and the byte where.
//!
//! [`Writer`] builds a file, [`Container`] reads one. Reading validates everything first: after
//! [`Container::parse`] every byte of the file is accounted for and every checksum has been compared, so the accessors
//! cannot fail. That costs one pass of XXH64 over the file and a few hundred bytes of memory at most for each chunk,
//! however long it is; tiles are borrowed.
//!
//! The crate knows no codec. It hands out tiles as they are stored and says how they are packed and how long they are
//! unpacked; it neither unpacks zstd frames nor decodes texels.

#![forbid(unsafe_code)]

mod atomic;
mod bytes;
mod directory;
mod error;
mod geometry;
mod header;
mod limits;
mod metadata;
mod reader;
mod tiling;
mod writer;

pub use atomic::write_atomic;
pub use directory::{ChunkEntry, Packing, Tag};
pub use error::FormatError;
pub use limits::Limits;
pub use metadata::Metadata;
pub use reader::{Container, StoredTile};
pub use tiling::{SlabTiling, TexelEncoding};
pub use writer::Writer;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

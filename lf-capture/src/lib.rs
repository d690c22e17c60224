//! Captures the light field of a scene to disk, tile by tile.
//!
//! A [`Plan`] is everything that decides the bytes of the file, known before the first texel is traced: a survey by distances
//! has put the focal planes, so the windows of all images are fixed. The unit of work is a tile of the file. [`capture`]
//! traces its cameras' windows on all threads of the current rayon pool, encodes and packs it, and appends it to a
//! [`Journal`]; a killed process loses the tiles that it was working on and no other. [`write_files`] makes the `.lfslab` file of
//! the journal, or of the journals of several [`Shard`]s, and the bytes are always the same, on machines of one kind: where sines and
//! powers have other last bits, a journal is refused.
//!
//! Texels that no ray through the cell asks for are not traced ([`NeededTexels`](lf_math::NeededTexels)). Where they lie within
//! a window they repeat a traced neighbour, which costs next to nothing once encoded.
//!
//! Memory: the tiles that are being traced and encoded, at most two and a few camera images for each thread, beside the scene.
//!
//! What a texel is, is for [`lf_scene::TexelSampler`] to say; how it becomes bytes, for [`lf_compress`].

#![forbid(unsafe_code)]

mod error;
mod fill;
mod finish;
mod header;
mod identity;
mod image;
mod journal;
mod plan;
mod run;
mod shard;
mod tile;

pub use error::CaptureError;
pub use finish::write_files;
pub use journal::{Journal, Totals};
pub use plan::{Options, Plan, TileId};
pub use run::{Outcome, Progress, capture};
pub use shard::Shard;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

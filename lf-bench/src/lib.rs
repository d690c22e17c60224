//! BC1 encoders and decoders side by side: those of `lf-compress` and those of other crates.
//!
//! A codec is measured as a [`Codec`]: a name and a function that prepares one image for it. Preparing is not timed;
//! what is timed is a [`Job`], which does the same work as often as it is asked and can show its output. Every output
//! is checked by `texture2ddecoder`, which shares no code with any encoder here, before its time counts
//! ([`quality`]).
//!
//! [`measure`] runs the jobs of all codecs in turn, so that a machine that slows down slows all of them, and takes the
//! median of each one's thread CPU time. [`front`] then says which codecs no other beats in speed and PSNR.
//!
//! What is not measured: several threads, 1-bit alpha, perceptual error, decoding on a GPU.

#![forbid(unsafe_code)]

mod chart;
mod class;
mod codec;
mod decoders;
mod encoders;
mod error;
pub mod front;
pub mod measure;
mod ours;
mod picture;
pub mod quality;
mod recorded;
mod report;
mod run;
mod synthetic;

pub use class::{Class, Sources, gather};
pub use codec::{Codec, Encoded, Input, Job, Maker};
pub use decoders::{REFERENCE_DECODER, decoders};
pub use encoders::{UNIT_ENCODER, encoders};
pub use error::BenchError;
pub use picture::Picture;
pub use recorded::{RecordedPeer, Setting, recorded_peers};
pub use run::{Options, compare_decoders, compare_encoders};
pub use synthetic::{gradient, noise};

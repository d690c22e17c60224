//! Tests of the `.lfslab` container against its specification.

mod assemble;
#[cfg(feature = "std")]
mod atomic;
mod coverage;
mod damage;
mod directory;
mod geometry;
mod header;
mod layout;
mod limits;
mod metadata;
mod readers;
#[cfg(feature = "std")]
mod round_trip;
#[cfg(feature = "std")]
mod specification;
#[cfg(feature = "std")]
mod writer;

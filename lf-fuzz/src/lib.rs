//! What the fuzz targets hold: each module's `run` takes any bytes and panics only if something is wrong.

#![forbid(unsafe_code)]

#[path = "../../lf-format/tests/format/assemble.rs"]
#[expect(dead_code, reason = "it serves the tests of lf-format, too")]
mod assemble;
pub mod bc1_decode;
pub mod bc1_encode;
mod field;
pub mod gltf;
pub mod import;
pub mod parse;
pub mod round_trip;
pub mod tile;
pub mod unpack;

/// A target: from bytes to nothing.
pub type Target = fn(&[u8]);

/// All targets by name.
pub const TARGETS: [(&str, Target); 8] = [
    ("bc1_decode", bc1_decode::run),
    ("bc1_encode", bc1_encode::run),
    ("gltf", gltf::run),
    ("import", import::run),
    ("parse", parse::run),
    ("round_trip", round_trip::run),
    ("tile", tile::run),
    ("unpack", unpack::run),
];

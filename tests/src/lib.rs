//! What the cross-crate tests share: small captures, a GPU that must exist, and the test vectors of the file format.

#![forbid(unsafe_code)]

#[path = "../../lf-format/tests/format/assemble.rs"]
mod assemble;
#[path = "../../lf-format/tests/format/layout.rs"]
mod layout;
pub mod vectors;

use lf_compress::PackedLightField;
use lf_compress::bc1::Quality;
use lf_compress::format::TexelEncoding;
use lf_gpu::Gpu;
use lf_math::{LightFieldGeometry, PlanePlacement};
use lf_scene::{Capture, Tracer, capture_slabs, museum};

/// The museum, ready to be traced.
#[must_use]
pub fn museum() -> Tracer {
    Tracer::new(museum::scene())
}

/// A capture of the museum by `cameras²` cameras of `resolution²` texels per slab.
///
/// # Panics
/// If it cannot be captured.
#[must_use]
pub fn capture(tracer: &Tracer, cameras: u32, resolution: u32) -> Capture {
    let geometry = LightFieldGeometry::around(museum::cell(), PlanePlacement::CellFaces, cameras, resolution);
    capture_slabs(tracer, &geometry.expect("a light field"), 1, &|_| ()).expect("a capture")
}

/// A capture as BC1 tiles.
///
/// # Panics
/// If it cannot be encoded.
#[must_use]
pub fn packed(capture: &Capture) -> PackedLightField {
    PackedLightField::encode(capture.geometry.clone(), &capture.texels, TexelEncoding::Bc1, Quality::Standard)
        .expect("encodes")
}

/// The GPU. A machine without one needs a software driver: these tests are never skipped.
///
/// # Panics
/// If there is no adapter.
#[must_use]
pub fn gpu() -> Gpu {
    Gpu::new().unwrap_or_else(|e| panic!("the GPU tests need an adapter: {e}"))
}

//! What the cross-crate tests share: small captures, a GPU that must exist, and the test vectors of the file format.

#![forbid(unsafe_code)]

#[path = "../../lf-format/tests/format/assemble.rs"]
mod assemble;
#[path = "../../lf-format/tests/format/layout.rs"]
mod layout;
pub mod mitsuba;
pub mod stability;
pub mod vectors;

use glam::Vec3;
use lf_compress::PackedLightField;
use lf_compress::bc1::Quality;
use lf_compress::format::TexelEncoding;
use lf_gpu::Gpu;
use lf_math::{Cell, LightFieldGeometry, PlanePlacement};
use lf_scene::{Capture, Tracer, capture_slabs, museum};

/// The museum, ready to be traced.
#[must_use]
pub fn museum() -> Tracer {
    Tracer::new(museum::scene())
}

/// World-space rays through a cell, origin and unit direction, both spread evenly: a fixed sequence.
pub fn rays_in_cell(cell: &Cell, count: usize) -> impl Iterator<Item = (Vec3, Vec3)> {
    let cell = *cell;
    // The additive sequence of Roberts' generalised golden ratio in five dimensions: even in each, and no two alike.
    const STEP: [f64; 5] = [0.885_124_1, 0.783_444_7, 0.693_447_0, 0.613_786_7, 0.543_277_4];
    (0..count).map(move |i| {
        let x = STEP.map(|step| ((i as f64 + 0.5) * step).fract() as f32);
        let place = Vec3::new(x[0], x[1], x[2]) * 2.0 - 1.0;
        let origin = cell.world_from_cell(place * cell.half_extent()).as_vec3();
        let (y, (sin, cos)) = (2.0 * x[3] - 1.0, (std::f32::consts::TAU * x[4]).sin_cos());
        let r = (1.0 - y * y).max(0.0).sqrt();
        (origin, Vec3::new(r * cos, y, r * sin))
    })
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

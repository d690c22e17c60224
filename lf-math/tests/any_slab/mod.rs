//! Cells, planes and slabs of all kinds.

use glam::{DVec3, Vec3};
use lf_math::{Cell, Face, SampledAxis, Slab};
use proptest::prelude::*;

pub(crate) fn any_slab() -> impl Strategy<Value = (Cell, Slab)> {
    let half = prop::array::uniform3(between(0.05, 4.0));
    let plane = prop_oneof![Just(1.0f32), Just(0.0), Just(-1.0), between(-3.0, 3.0)];
    let counts = prop::array::uniform4(1u32..40);
    let reach = prop::array::uniform4(between(0.2, 3.0));
    let depth = prop::option::of(between(0.1, 30.0));
    (half, 0u8..6, plane, counts, reach, depth).prop_map(|(half, face, plane, counts, reach, depth)| {
        let cell = Cell::new(DVec3::ZERO, Vec3::from(half)).unwrap();
        let face = Face::from_index(face).unwrap();
        let axis =
            |i: usize, scale: f32| SampledAxis::spanning(-reach[i] * scale, reach[i] * scale * 0.9, counts[i]).unwrap();
        let [s, t] = face.tangents().map(|axis| half[axis] + half[face.axis()]);
        let plane = face.sign() * plane * half[face.axis()];
        (cell, Slab::new(face, plane, [axis(0, s), axis(1, t)], [axis(2, 1.0), axis(3, 1.0)], depth).unwrap())
    })
}

/// Evenly spread numbers. (Once in some million samples proptest's own ranges of floats fail an assertion of theirs.)
fn between(low: f32, high: f32) -> impl Strategy<Value = f32> {
    const STEPS: u32 = 1 << 20;
    (0..=STEPS).prop_map(move |step| low + (high - low) * (step as f32 / STEPS as f32))
}

//! What goes up to the device by way of padded rows comes down texel for texel.

use std::io::Write;

use glam::{DVec3, Vec2};
use lf_compress::PackedLightField;
use lf_compress::bc1::Quality;
use lf_compress::format::TexelEncoding;
use lf_gpu::{Gpu, Probe, SlabTexture, Storage, read_probes};
use lf_math::{Cell, Face, LightFieldGeometry, SampledAxis, Slab, SlabTexels};

/// Three cameras of 12 × 8 texels: a row of 144 bytes, or of 72 of blocks, where devices want 256.
const CAMERAS: u32 = 3;
const SIZE: [u32; 2] = [12, 8];

fn field(encoding: TexelEncoding) -> PackedLightField {
    let axis = |count| SampledAxis::spanning(-1.0, 1.0, count).expect("an axis");
    let slab = Slab::new(Face::PosX, 0.5, [axis(CAMERAS), axis(1)], SIZE.map(axis), None).expect("a slab");
    let texels: Vec<_> = places().map(|(camera, u, v)| [40 * camera as u8, 20 * u as u8, 30 * v as u8, 255]).collect();
    let texels = SlabTexels::new(&slab, texels).expect("texels");
    let cell = Cell::cube(DVec3::ZERO, 1.0).expect("a cell");
    let geometry = LightFieldGeometry::new(cell, vec![slab]).expect("a light field");
    PackedLightField::encode(geometry, &[texels], encoding, Quality::Standard).expect("encodes")
}

/// Camera, column and row of every texel.
fn places() -> impl Iterator<Item = (u32, u32, u32)> {
    let [width, height] = SIZE;
    (0..CAMERAS * width * height).map(move |i| (i / (width * height), i % width, i / width % height))
}

#[test]
fn rows_of_any_width_arrive() {
    let gpu = match Gpu::new() {
        Ok(gpu) => gpu,
        Err(e) => return drop(writeln!(std::io::stderr(), "NOT TESTED: {e}")),
    };
    let at = |u: u32, v: u32| Vec2::new(u as f32, v as f32);
    let probes: Vec<_> = places().map(|(s, u, v)| Probe { face: Face::PosX, camera: [s, 0], uv: at(u, v) }).collect();
    for (encoding, storage, tolerance) in [
        (TexelEncoding::Rgba8, Storage::Rgba8Array, 0),
        (TexelEncoding::Bc1, Storage::Rgba8Array, 0),
        // Devices round the colours between a block's two as they like.
        (TexelEncoding::Bc1, Storage::Bc1Array, 3),
        (TexelEncoding::Bc1, Storage::Bc1Volume, 3),
    ] {
        let field = field(encoding);
        let texture = match SlabTexture::with_storage(&gpu, &field, storage) {
            Ok(texture) => texture,
            Err(e) => {
                let _ = writeln!(std::io::stderr(), "NOT TESTED: {e}");
                continue;
            }
        };
        let decoded = field.decode(1 << 20).expect("decodes");
        let found = read_probes(&gpu, &texture, &probes).expect("reads");
        for ((place, found), expected) in places().zip(found).zip(decoded[0].texels()) {
            let off = (0..4).map(|c| found[c].abs_diff(expected[c])).max();
            assert!(off <= Some(tolerance), "{storage}, {place:?}: {found:?}, not {expected:?}");
        }
    }
}

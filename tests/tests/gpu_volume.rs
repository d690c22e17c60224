//! Volume round trip: a texel read through the shader is the texel that the CPU decodes, for every storage.

use glam::Vec2;
use lf_compress::PackedLightField;
use lf_compress::bc1::Quality;
use lf_compress::format::TexelEncoding;
use lf_gpu::{Gpu, Probe, SlabTexture, Storage, read_probes};
use lf_math::{Cell, Face, LightFieldGeometry, SampledAxis, Slab, SlabTexels};
use lf_tests::gpu;

/// Neighbouring cameras in strongly different colours, so that bleeding shows; all texels of an image alike but for a
/// ramp that BC1 holds.
fn field(encoding: TexelEncoding) -> (PackedLightField, Vec<SlabTexels>) {
    let axis = |count| SampledAxis::spanning(-1.0, 1.0, count).expect("an axis");
    let slab = |face, [s, t]: [u32; 2], [u, v]: [u32; 2]| {
        Slab::new(face, 0.5, [axis(s), axis(t)], [axis(u), axis(v)], None).expect("a slab")
    };
    // 9 cameras of 128 texels need two groups; 6 and 10 texels are no whole blocks.
    let slabs = vec![
        slab(Face::PosX, [9, 17], [128, 128]),
        slab(Face::NegY, [3, 2], [6, 10]),
        slab(Face::PosZ, [1, 1], [1, 1]),
    ];
    let cell = Cell::cube(glam::DVec3::ZERO, 1.0).expect("a cell");
    let geometry = LightFieldGeometry::new(cell, slabs).expect("a field");
    let texels = |slab: &Slab| {
        let ([cameras_s, cameras_t], [width, height]) = (slab.cameras(), slab.resolution());
        let mut all = Vec::new();
        for (t, s) in (0..cameras_t).flat_map(|t| (0..cameras_s).map(move |s| (t, s))) {
            for (v, u) in (0..height).flat_map(|v| (0..width).map(move |u| (v, u))) {
                let red = if (s + t) % 2 == 0 { 255 } else { 0 };
                let green = if s % 2 == 0 { 30 } else { 220 };
                let blue = ((u / 4 + v / 4) * 16 % 256) as u8;
                all.push([red, green, blue, 255]);
            }
        }
        SlabTexels::new(slab, all).expect("texels")
    };
    let texels: Vec<_> = geometry.slabs().iter().map(texels).collect();
    let packed = PackedLightField::encode(geometry, &texels, encoding, Quality::Standard).expect("encodes");
    let decoded = packed.decode().expect("decodes");
    (packed, decoded)
}

/// Corners, edges and the middle of an axis.
fn picks(count: u32) -> Vec<u32> {
    let mut picks: Vec<_> =
        [0, 1, 3, 4, count / 2, count.saturating_sub(2), count - 1].map(|i| i.min(count - 1)).into();
    picks.sort_unstable();
    picks.dedup();
    picks
}

fn check(gpu: &Gpu, packed: &PackedLightField, decoded: &[SlabTexels], storage: Storage) {
    let texture = SlabTexture::with_storage(gpu, packed, storage).expect("uploads");
    assert_eq!(texture.storage(), storage);
    let mut probes = Vec::new();
    let mut expected = Vec::new();
    for (slab, texels) in packed.geometry().slabs().iter().zip(decoded) {
        let ([cameras_s, cameras_t], [width, height]) = (slab.cameras(), slab.resolution());
        // Every camera, so that every slice and both sides of every image border are met.
        for camera in (0..cameras_t).flat_map(|t| (0..cameras_s).map(move |s| [s, t])) {
            for texel in picks(height).into_iter().flat_map(|v| picks(width).into_iter().map(move |u| [u, v])) {
                let uv = Vec2::new(texel[0] as f32, texel[1] as f32);
                probes.push(Probe { face: slab.face(), camera, uv });
                expected.push(texels.texel(camera, texel));
            }
        }
    }
    let found = read_probes(gpu, packed, &texture, &probes).expect("reads");
    for ((probe, found), expected) in probes.iter().zip(found).zip(expected) {
        // BC1 hardware may round interpolated palette entries by one step otherwise than our decoder.
        let tolerance = u8::from(storage != Storage::Rgba8Array);
        let worst = (0..3).map(|c| found[c].abs_diff(expected[c])).max().unwrap_or(0);
        assert!(worst <= tolerance, "{storage}, {probe:?}: {found:?} instead of {expected:?}");
    }
}

#[test]
fn every_storage_reads_every_texel_as_the_cpu_does() {
    let gpu = gpu();
    println!("adapter: {}", gpu.description());
    let (packed, decoded) = field(TexelEncoding::Bc1);
    for storage in Storage::ALL {
        check(&gpu, &packed, &decoded, storage);
    }
    let (plain, decoded) = field(TexelEncoding::Rgba8);
    check(&gpu, &plain, &decoded, Storage::Rgba8Array);
}

#[test]
fn the_volume_comes_first_and_plain_texels_never_go_into_blocks() {
    let gpu = gpu();
    let (packed, _) = field(TexelEncoding::Bc1);
    assert_eq!(SlabTexture::new(&gpu, &packed).expect("uploads").storage(), Storage::Bc1Volume);
    let (plain, _) = field(TexelEncoding::Rgba8);
    assert_eq!(SlabTexture::new(&gpu, &plain).expect("uploads").storage(), Storage::Rgba8Array);
    assert!(SlabTexture::with_storage(&gpu, &plain, Storage::Bc1Volume).is_err());
}

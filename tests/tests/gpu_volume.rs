//! Volume round trip: a texel read through the shader is the texel that the CPU decodes, for every storage.

use glam::Vec2;
use lf_compress::PackedLightField;
use lf_compress::bc1::Quality;
use lf_compress::format::TexelEncoding;
use lf_gpu::{Gpu, Probe, SlabTexture, Storage, read_probes};
use lf_math::{Cell, Face, LightFieldGeometry, SampledAxis, Slab, SlabTexels};
use lf_tests::gpu;

/// Every camera image in a colour of its own, far from its neighbours', with a gentle ramp that differs along u and v.
fn color(slab: usize, [s, t]: [u32; 2], [u, v]: [u32; 2]) -> [u8; 4] {
    let seed = (slab as u32).wrapping_mul(7919).wrapping_add(s.wrapping_mul(131)).wrapping_add(t.wrapping_mul(17));
    let [r, g, b, _] = seed.wrapping_mul(2_654_435_761).rotate_left(9).wrapping_mul(0x9E37_79B1).to_be_bytes();
    [r / 2 + (u / 4) as u8, g / 2 + (v / 4) as u8, b / 2 + (u / 8 + v / 16) as u8, 255]
}

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
    let texels = |(number, slab): (usize, &Slab)| {
        let ([cameras_s, cameras_t], [width, height]) = (slab.cameras(), slab.resolution());
        let mut all = Vec::new();
        for camera in (0..cameras_t).flat_map(|t| (0..cameras_s).map(move |s| [s, t])) {
            let texels = (0..height).flat_map(|v| (0..width).map(move |u| [u, v]));
            all.extend(texels.map(|texel| color(number, camera, texel)));
        }
        SlabTexels::new(slab, all).expect("texels")
    };
    let texels: Vec<_> = geometry.slabs().iter().enumerate().map(texels).collect();
    let packed = PackedLightField::encode(geometry, &texels, encoding, Quality::Standard).expect("encodes");
    (packed, texels)
}

/// Corners, edges and the middle of an axis.
fn picks(count: u32) -> Vec<u32> {
    let mut picks: Vec<_> =
        [0, 1, 3, 4, count / 2, count.saturating_sub(2), count - 1].map(|i| i.min(count - 1)).into();
    picks.sort_unstable();
    picks.dedup();
    picks
}

/// Reads through the shader and compares with what the CPU decodes, and with the texels that went in.
fn check(gpu: &Gpu, packed: &PackedLightField, original: &[SlabTexels], storage: Storage) {
    let texture = SlabTexture::with_storage(gpu, packed, storage).expect("uploads");
    assert_eq!(texture.storage(), storage);
    let decoded = packed.decode(1 << 30).expect("decodes");
    let (mut probes, mut expected) = (Vec::new(), Vec::new());
    for (number, slab) in packed.geometry().slabs().iter().enumerate() {
        let ([cameras_s, cameras_t], [width, height]) = (slab.cameras(), slab.resolution());
        // Every camera, so that every slice and both sides of every image border are met.
        for camera in (0..cameras_t).flat_map(|t| (0..cameras_s).map(move |s| [s, t])) {
            for texel in picks(height).into_iter().flat_map(|v| picks(width).into_iter().map(move |u| [u, v])) {
                probes.push(Probe { face: slab.face(), camera, uv: Vec2::from(texel.map(|i| i as f32)) });
                let texel_of = |texels: &SlabTexels| texels.texel(camera, texel).expect("kept");
                expected.push((texel_of(&decoded[number]), texel_of(&original[number])));
            }
        }
    }
    // BC1 hardware may round interpolated palette entries by one step otherwise than our decoder. Against the original
    // stands the loss of the blocks, small beside the difference from one camera to the next.
    let plain = packed.tilings()[0].encoding() == TexelEncoding::Rgba8;
    let tolerances = [u8::from(storage != Storage::Rgba8Array), if plain { 0 } else { 8 }];
    let found = read_probes(gpu, &texture, &probes).expect("reads");
    for ((probe, found), (decoded, original)) in probes.iter().zip(found).zip(expected) {
        for (expected, tolerance) in [decoded, original].into_iter().zip(tolerances) {
            let worst = (0..3).map(|c| found[c].abs_diff(expected[c])).max().unwrap_or(0);
            assert!(worst <= tolerance, "{storage}, {probe:?}: {found:?} instead of {expected:?}");
        }
    }
    let outside = Probe { face: Face::NegX, camera: [0, 0], uv: Vec2::ZERO };
    assert!(read_probes(gpu, &texture, &[outside]).is_err());
}

#[test]
fn every_storage_reads_every_texel_as_the_cpu_does() {
    let gpu = gpu();
    println!("adapter: {}", gpu.description());
    let (packed, original) = field(TexelEncoding::Bc1);
    for storage in [Storage::Bc1Volume, Storage::Bc1Array, Storage::Rgba8Array] {
        check(&gpu, &packed, &original, storage);
    }
    let (plain, original) = field(TexelEncoding::Rgba8);
    check(&gpu, &plain, &original, Storage::Rgba8Array);
}

#[test]
fn the_volume_comes_first_and_plain_texels_never_go_into_blocks() {
    let gpu = gpu();
    let (packed, _) = field(TexelEncoding::Bc1);
    assert_eq!(SlabTexture::new(&gpu, &packed).expect("uploads").storage(), Storage::Bc1Array);
    let (plain, _) = field(TexelEncoding::Rgba8);
    assert_eq!(SlabTexture::new(&gpu, &plain).expect("uploads").storage(), Storage::Rgba8Array);
    assert!(SlabTexture::with_storage(&gpu, &plain, Storage::Bc1Volume).is_err());
}

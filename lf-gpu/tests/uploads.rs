//! What goes up to the device by way of padded rows comes down texel for texel.

use std::io::Write;

use glam::{DVec3, Vec2, Vec3};
use lf_compress::bc1::Quality;
use lf_compress::format::TexelEncoding;
use lf_compress::{PackedCube, PackedLightField};
use lf_gpu::{Gpu, MirrorMesh, Probe, ReflectionPass, SlabTexture, Storage, Target, read_probes};
use lf_math::{
    Cell, CubeMap, DistanceCube, Face, Image, LightFieldGeometry, Pinhole, SampledAxis, Slab, SlabTexels, TriangleMesh,
};

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

/// `None` says so.
fn gpu() -> Option<Gpu> {
    Gpu::new().inspect_err(|e| drop(writeln!(std::io::stderr(), "NOT TESTED: {e}"))).ok()
}

#[test]
fn rows_of_any_width_arrive() {
    let Some(gpu) = gpu() else { return };
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

/// Faces of one colour each. A mirror that faces an axis, seen from there, shows the face of that axis.
#[test]
fn each_face_of_a_cube_arrives_in_its_layer() {
    let Some(gpu) = gpu() else { return };
    let color = |face: u8| [40 * face, 240 - 40 * face, 120, 255];
    let cube = |size| CubeMap::new([0, 1, 2, 3, 4, 5].map(|face| Image::filled(size, size, color(face))));
    let depths = [(); 6].map(|()| Image::filled(8, 8, 0.5));
    let distances = DistanceCube::new(Vec3::ZERO, cube(12).expect("a cube map"), depths).expect("a cube");
    let packed = PackedCube::encode(&distances, Quality::Standard).expect("encodes");
    let passes = [
        ("texels", ReflectionPass::environment(&gpu, &cube(5).expect("a cube map")).expect("a pass")),
        ("blocks", ReflectionPass::environment(&gpu, &packed).expect("a pass")),
    ];
    let target = Target::new(&gpu, 8, 8).expect("a target");
    let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    for (face, axis) in (0..).zip(axes) {
        let (a, b) = axis.any_orthonormal_pair();
        let triangle = vec![3.0 * a, -2.0 * a + 3.0 * b, -2.0 * a - 3.0 * b];
        let mesh = TriangleMesh::new(triangle, vec![axis; 3], vec![[0, 1, 2]]).expect("a mesh");
        let mesh = MirrorMesh::new(&gpu, &mesh).expect("uploads");
        // Not quite from the axis: the camera's up would be along it.
        let camera = Pinhole::look_at(2.0 * axis + Vec3::splat(0.1), Vec3::ZERO, 0.3, 8, 8).expect("a camera");
        for (what, pass) in &passes {
            pass.draw(&gpu, &target, &mesh, &camera).expect("draws");
            let seen = target.read(&gpu).expect("reads").texels()[4 * 8 + 4];
            // BC1 has 5 bits of red.
            let off = (0..4).map(|c| seen[c].abs_diff(color(face)[c])).max();
            assert!(off <= Some(8), "{what}, face {face}: {seen:?}, not {:?}", color(face));
        }
    }
}

//! What is written is read back, and written again gives the same bytes.

use glam::{DVec3, Vec3};
use lf_format::{Metadata, Packing, SlabTiling, Tag, TexelEncoding, Writer};
use lf_math::{Cell, Face, LightFieldGeometry, SampledAxis, Slab};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::subsequence;

use crate::assemble::{File, parse, smallest_writer};

fn axis(max_count: u32) -> impl Strategy<Value = SampledAxis> {
    (-10.0f32..10.0, 1e-3f32..2.0, 1..=max_count)
        .prop_map(|(first, step, count)| SampledAxis::new(first, step, count).unwrap())
}

fn slab(face: Face) -> impl Strategy<Value = (Slab, SlabTiling)> {
    let axes = ([axis(5), axis(5)], [axis(9), axis(9)]);
    let encoding = prop_oneof![Just(TexelEncoding::Bc1), Just(TexelEncoding::Rgba8)];
    let focal_depth = prop::option::of(0.1f32..100.0);
    (axes, -2.0f32..2.0, focal_depth, encoding, [1u32..4, 1u32..4]).prop_map(
        move |((st, uv), plane, focal_depth, encoding, per_tile)| {
            let slab = Slab::new(face, plane, st, uv, focal_depth).unwrap();
            (slab, SlabTiling::new(&slab, encoding, per_tile).unwrap())
        },
    )
}

fn field() -> impl Strategy<Value = (LightFieldGeometry, Vec<SlabTiling>)> {
    let cell = (prop::array::uniform3(-1e6f64..1e6), prop::array::uniform3(0.01f32..10.0))
        .prop_map(|(center, half)| Cell::new(DVec3::from(center), Vec3::from(half)).unwrap());
    let slabs =
        subsequence(Face::ALL.to_vec(), 1..=6).prop_flat_map(|faces| faces.into_iter().map(slab).collect::<Vec<_>>());
    (cell, slabs).prop_map(|(cell, slabs)| {
        let (slabs, tilings) = slabs.into_iter().unzip();
        (LightFieldGeometry::new(cell, slabs).unwrap(), tilings)
    })
}

fn metadata() -> impl Strategy<Value = Metadata> {
    vec(("[a-z0-9._-]{1,64}", "[^\x00-\x08\x0B-\x1F\x7F]{0,40}"), 0..5).prop_map(|pairs| {
        let mut metadata = Metadata::new();
        for (key, value) in pairs {
            metadata.insert(key, value).unwrap();
        }
        metadata
    })
}

/// Deterministic bytes for a tile: raw, or of a packed length that depends on the tile.
fn stored(tiling: &SlabTiling, slab: usize, tile: u32) -> (Packing, Vec<u8>) {
    let packing = if tile.is_multiple_of(2) { Packing::None } else { Packing::Zstd };
    let len = if packing == Packing::None { tiling.raw_len() as usize } else { 1 + 7 * tile as usize };
    (packing, (0..len).map(|i| (i * 31 + slab * 7 + tile as usize) as u8).collect())
}

fn all_tiles(tilings: &[SlabTiling]) -> Vec<(usize, u32)> {
    let of_slab = |(slab, tiling): (usize, &SlabTiling)| (0..tiling.tile_count()).map(move |tile| (slab, tile));
    tilings.iter().enumerate().flat_map(of_slab).collect()
}

fn write(
    geometry: &LightFieldGeometry,
    tilings: &[SlabTiling],
    metadata: &Metadata,
    order: impl Iterator<Item = (usize, u32)>,
) -> Vec<u8> {
    let mut writer = Writer::new(geometry.clone(), tilings.to_vec(), metadata.clone()).unwrap();
    for (slab, tile) in order {
        let (packing, bytes) = stored(&tilings[slab], slab, tile);
        writer.add_tile(slab, tile, packing, bytes).unwrap();
    }
    writer.to_bytes().unwrap()
}

proptest! {
    #[test]
    fn what_is_written_is_read((geometry, tilings) in field(), metadata in metadata()) {
        let tiles = all_tiles(&tilings);
        let bytes = write(&geometry, &tilings, &metadata, tiles.iter().copied());
        let file = parse(&bytes).unwrap();
        prop_assert_eq!(file.geometry(), &geometry);
        prop_assert_eq!(file.tilings(), &tilings[..]);
        prop_assert_eq!(file.metadata(), &metadata);
        prop_assert_eq!(file.version(), (1, 0));
        for &(slab, tile) in &tiles {
            let got = file.tile(slab, tile).unwrap();
            prop_assert_eq!((got.packing, got.bytes.to_vec()), stored(&tilings[slab], slab, tile));
            prop_assert_eq!(got.raw_len, tilings[slab].raw_len());
            prop_assert_eq!((got.bytes.as_ptr() as usize - bytes.as_ptr() as usize) % 64, 0);
        }
        prop_assert_eq!(file.chunks().filter(|chunk| chunk.tag == Tag::TILE).count(), tiles.len());
        // Reading back and adding in another order gives the same bytes.
        let again = write(file.geometry(), file.tilings(), file.metadata(), tiles.into_iter().rev());
        prop_assert_eq!(again, bytes);
    }

    #[test]
    fn tile_sizes_follow_the_formulas((geometry, tilings) in field()) {
        for (slab, tiling) in geometry.slabs().iter().zip(tilings) {
            let per_texel_x2 = if tiling.encoding() == TexelEncoding::Bc1 { 1 } else { 8 };
            for i in 0..2 {
                let (cameras, per) = (slab.cameras()[i], tiling.cameras_per_tile()[i]);
                prop_assert!(tiling.tiles()[i] * per >= cameras && (tiling.tiles()[i] - 1) * per < cameras);
                prop_assert!((slab.resolution()[i]..slab.resolution()[i] + 4).contains(&tiling.image_pitch()[i]));
                prop_assert_eq!(tiling.image_pitch()[i] % 4, 0);
                prop_assert_eq!(tiling.tile_size()[i], per * tiling.image_pitch()[i]);
            }
            let [width, height] = tiling.tile_size().map(u64::from);
            prop_assert_eq!(2 * tiling.raw_len(), width * height * per_texel_x2);
        }
    }
}

/// §7.6 the other way round: every place of every tile holds the camera that the formulas of §7.1 and §7.2 give, or none.
#[test]
fn every_camera_has_its_place() {
    let axis = |count| SampledAxis::new(0.0, 1.0, count).unwrap();
    let slab = Slab::new(Face::NegY, 0.0, [axis(7), axis(5)], [axis(6), axis(9)], None).unwrap();
    let tiling = SlabTiling::new(&slab, TexelEncoding::Bc1, [3, 2]).unwrap();
    assert_eq!((tiling.cameras(), tiling.resolution(), tiling.tiles()), ([7, 5], [6, 9], [3, 3]));
    let mut placed = 0;
    for (tile, t, s) in (0..9).flat_map(|tile| (0..2).flat_map(move |t| (0..3).map(move |s| (tile, t, s)))) {
        let camera = [tile % 3 * 3 + s, tile / 3 * 2 + t];
        let exists = camera[0] < 7 && camera[1] < 5;
        assert_eq!(tiling.place(camera), exists.then_some((tile, [8 * s, 12 * t])), "{camera:?}");
        placed += u32::from(exists);
    }
    assert_eq!(placed, 7 * 5);
    for outside in [[7, 0], [0, 5], [u32::MAX, 0], [0, u32::MAX]] {
        assert_eq!(tiling.place(outside), None);
    }
}

#[test]
fn two_writers_agree() {
    assert_eq!(smallest_writer().to_bytes().unwrap(), File::smallest().to_bytes());
}

#[test]
fn saving_writes_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.lfslab");
    let len = smallest_writer().save(&path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(len, bytes.len() as u64);
    assert_eq!(bytes, smallest_writer().to_bytes().unwrap());
}

#[test]
fn absent_tiles_are_none() {
    let bytes = File::smallest().to_bytes();
    let file = parse(&bytes).unwrap();
    assert!(file.tile(0, 0).is_some() && file.tile(0, 1).is_none() && file.tile(1, 0).is_none());
}

#[test]
fn chunks_name_themselves() {
    let bytes = File::smallest().to_bytes();
    let listed: Vec<String> = parse(&bytes).unwrap().chunks().map(ToString::to_string).collect();
    assert_eq!(listed, ["chunk GEOM", "chunk TILE (slab 0, tile 0)"]);
}

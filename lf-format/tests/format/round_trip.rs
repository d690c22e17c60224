//! What is written is read back, and both writers write the same.

use std::io::Cursor;

use glam::{DVec3, Vec3};
use lf_format::{CameraPlace, Contents, FileReader, Limits, Metadata, Packing, SlabTiling, TexelEncoding, Writer};
use lf_math::{Cell, Coverage, Face, LightFieldGeometry, SampledAxis, Slab};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::subsequence;

use crate::layout::{self, Axis, Field, Window};
use crate::readers::sound;

fn axis(max_count: u32) -> impl Strategy<Value = Axis> {
    (-10.0f32..10.0, 1e-3f32..2.0, 1..=max_count)
}

/// A window of an image of so many blocks, often empty or whole.
fn window(blocks: u32) -> impl Strategy<Value = Window> {
    prop_oneof![
        Just([0, 0]),
        Just([0, blocks]),
        (0..blocks).prop_flat_map(move |first| (Just(first), 1..=blocks - first)).prop_map(Into::into)
    ]
}

/// A slab without anything left out.
fn whole_slab(face: u8) -> impl Strategy<Value = layout::Slab> {
    let axes = ([axis(5), axis(5)], [axis(13), axis(9)]);
    let focal_depth = prop_oneof![Just(0.0), 0.1f32..100.0];
    (axes, -2.0f32..2.0, focal_depth, 1u8..=3, [1u32..4, 1u32..4]).prop_map(
        move |((st, uv), plane, focal_depth, encoding, per_tile)| {
            let per_tile = [0, 1].map(|i: usize| per_tile[i].min(st[i].2));
            layout::Slab { face, encoding, plane, st, uv, focal_depth, per_tile, crop: None, mask: None }
        },
    )
}

/// A slab with windows and a mask, or none; what stores nothing becomes whole.
fn slab(face: u8) -> impl Strategy<Value = layout::Slab> {
    let left_out = |slab: layout::Slab| {
        let windows = [0, 1].map(|i| {
            let (cameras, blocks) = (slab.cameras()[i] as usize, slab.resolution()[i].div_ceil(4));
            vec(window(blocks), cameras)
        });
        let cameras = slab.cameras().iter().product::<u32>() as usize;
        (Just(slab), prop::option::of(windows), prop::option::of(vec(prop::bool::weighted(0.6), cameras)))
    };
    whole_slab(face).prop_flat_map(left_out).prop_map(|(slab, crop, mask)| with_left_out(slab, crop, mask))
}

fn cameras_of(slab: &layout::Slab) -> impl Iterator<Item = [u32; 2]> + use<> {
    let [across, down] = slab.cameras();
    (0..down).flat_map(move |t| (0..across).map(move |s| [s, t]))
}

/// The slab with chunks only where they leave something out, and something stored.
fn with_left_out(slab: layout::Slab, crop: Option<[Vec<Window>; 2]>, mask: Option<Vec<bool>>) -> layout::Slab {
    let blocks = slab.resolution().map(|n| n.div_ceil(4));
    let whole = |windows: &[Vec<Window>; 2]| (0..2).all(|i| windows[i].iter().all(|window| *window == [0, blocks[i]]));
    let cropped = layout::Slab { crop: crop.filter(|windows| !whole(windows)), ..slab.clone() };
    let windowed: Vec<bool> = cameras_of(&slab).map(|camera| cropped.stores(camera)).collect();
    let mask = mask.map(|mask| mask.iter().zip(&windowed).map(|(&a, &b)| a && b).collect::<Vec<_>>());
    let masked = layout::Slab { mask: mask.filter(|mask| *mask != windowed), ..cropped };
    if cameras_of(&slab).any(|camera| masked.stores(camera)) { masked } else { slab }
}

fn metadata() -> impl Strategy<Value = Vec<(String, String)>> {
    let pair = ("[a-z0-9._-]{1,64}", "[^\x00-\x08\x0B-\x1F\x7F]{0,40}");
    prop::collection::btree_map(pair.0, pair.1, 0..5).prop_map(|map| map.into_iter().collect())
}

fn field() -> impl Strategy<Value = Field> {
    let cell = (prop::array::uniform3(-1e6f64..1e6), prop::array::uniform3(0.01f32..10.0));
    let slabs = subsequence((0..6).collect::<Vec<u8>>(), 1..=6)
        .prop_flat_map(|faces| faces.into_iter().map(slab).collect::<Vec<_>>());
    (cell, slabs, metadata()).prop_map(|((center, half_extent), slabs, metadata)| Field {
        center,
        half_extent,
        slabs,
        metadata,
    })
}

/// The slab in the library's terms.
fn library_slab(slab: &layout::Slab) -> (Slab, SlabTiling) {
    let axis = |(first, step, count): Axis| SampledAxis::new(first, step, count).unwrap();
    let focal_depth = Some(slab.focal_depth).filter(|&depth| depth > 0.0);
    let face = Face::from_index(slab.face).unwrap();
    let shape = Slab::new(face, slab.plane, slab.st.map(axis), slab.uv.map(axis), focal_depth).unwrap();
    let windows = |axis: usize| {
        let texels = slab.resolution()[axis];
        let window = |i| slab.window(axis, i);
        (0..slab.cameras()[axis]).map(window).map(|[a, n]| (4 * a).min(texels)..(4 * (a + n)).min(texels)).collect()
    };
    let mut coverage = Coverage::new(&shape, windows(0), windows(1)).unwrap();
    if let Some(mask) = &slab.mask {
        coverage = coverage.with_cameras(mask.clone()).unwrap();
    }
    let encoding = [TexelEncoding::Bc1, TexelEncoding::Rgba8, TexelEncoding::Rgb16F][usize::from(slab.encoding) - 1];
    (shape, SlabTiling::covering(&shape, encoding, slab.per_tile, coverage).unwrap())
}

/// The light field in the library's terms.
fn contents(field: &Field) -> Contents {
    let cell = Cell::new(DVec3::from(field.center), Vec3::from(field.half_extent)).unwrap();
    let (slabs, tilings) = field.slabs.iter().map(library_slab).unzip();
    let mut metadata = Metadata::new();
    for (key, value) in &field.metadata {
        metadata.insert(key, value).unwrap();
    }
    Contents::new(LightFieldGeometry::new(cell, slabs).unwrap(), tilings, metadata)
}

/// Deterministic bytes for a tile: raw, or of a packed length that depends on the tile.
fn stored(field: &Field, slab: usize, tile: u32) -> (u8, Vec<u8>) {
    let packing = (tile % 2) as u8;
    let len = if packing == 0 { field.slabs[slab].raw_len(tile) } else { 1 + 7 * tile as usize };
    (packing, (0..len).map(|i| (i * 31 + slab * 7 + tile as usize) as u8).collect())
}

const PACKINGS: [Packing; 2] = [Packing::None, Packing::Zstd];

proptest! {
    #[test]
    fn both_writers_write_the_same(field in field()) {
        let mut writer = Writer::new(Cursor::new(Vec::new()), contents(&field)).unwrap();
        while let Some((slab, tile)) = writer.next_tile() {
            let (packing, bytes) = stored(&field, slab, tile);
            writer.tile(PACKINGS[usize::from(packing)], &bytes).unwrap();
        }
        let bytes = writer.finish().unwrap().into_inner();
        prop_assert_eq!(field.file(|slab, tile| stored(&field, slab, tile)).to_bytes(), bytes);
    }

    #[test]
    fn what_is_written_is_read(field in field()) {
        let bytes = field.file(|slab, tile| stored(&field, slab, tile)).to_bytes();
        let (file, expected) = (sound(&bytes), contents(&field));
        prop_assert_eq!(file.geometry(), &expected.geometry);
        prop_assert_eq!(file.tilings(), &expected.tilings[..]);
        prop_assert_eq!(file.metadata(), &expected.metadata);
        prop_assert_eq!((file.version(), file.file_len()), ((1, 0), bytes.len() as u64));
        let (mut reader, mut buffer) = (FileReader::open(Cursor::new(&bytes), &Limits::default()).unwrap(), Vec::new());
        for (slab, tile) in (0..).zip(&field.slabs).flat_map(|(i, slab)| slab.tiles().into_iter().map(move |tile| (i, tile))) {
            let got = file.tile(slab, tile).unwrap();
            let (packing, payload) = stored(&field, slab, tile);
            prop_assert_eq!((got.packing, got.bytes), (PACKINGS[usize::from(packing)], &payload[..]));
            prop_assert_eq!(got.raw_len, field.slabs[slab].raw_len(tile) as u64);
            prop_assert_eq!((got.bytes.as_ptr() as usize - bytes.as_ptr() as usize) % 64, 0);
            prop_assert_eq!(reader.tile(slab, tile, &mut buffer).unwrap(), got);
        }
    }

    /// §7.1 and §7.2, by a second account of them.
    #[test]
    fn tiles_and_places_are_those_of_the_specification(field in field()) {
        for slab in &field.slabs {
            let (_, tiling) = library_slab(slab);
            prop_assert_eq!(tiling.stored_tiles().collect::<Vec<_>>(), slab.tiles());
            for tile in slab.tiles() {
                prop_assert_eq!(tiling.cameras_of(tile), slab.cameras_of(tile));
                prop_assert_eq!(tiling.tile_size(tile), slab.blocks(tile).map(|n| 4 * n));
                prop_assert_eq!(tiling.raw_len(tile), slab.raw_len(tile) as u64);
            }
            for camera in cameras_of(slab) {
                prop_assert_eq!(tiling.place(camera), place(slab, camera), "{:?}", camera);
            }
        }
    }
}

/// Where §7.2 puts a camera.
fn place(slab: &layout::Slab, camera: [u32; 2]) -> Option<CameraPlace> {
    slab.stores(camera).then(|| {
        let across = slab.cameras()[0].div_ceil(slab.per_tile[0]);
        let tile = camera[1] / slab.per_tile[1] * across + camera[0] / slab.per_tile[0];
        let corner = [0, 1].map(|axis| {
            let first = camera[axis] / slab.per_tile[axis] * slab.per_tile[axis];
            (first..camera[axis]).map(|i| 4 * slab.window(axis, i)[1]).sum()
        });
        let window = [0, 1].map(|axis| {
            let [first, number] = slab.window(axis, camera[axis]);
            4 * first..(4 * (first + number)).min(slab.resolution()[axis])
        });
        CameraPlace { tile, corner, window }
    })
}

#[test]
fn there_is_no_place_outside_the_grid() {
    let (_, tiling) = library_slab(&layout::Slab { st: [(0.0, 1.0, 7), (0.0, 1.0, 5)], ..layout::Slab::smallest() });
    for outside in [[7, 0], [0, 5], [u32::MAX, 0], [0, u32::MAX]] {
        assert_eq!(tiling.place(outside), None);
    }
}

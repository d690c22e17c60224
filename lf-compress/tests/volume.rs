//! Packing and its inverse, over every sample.

use std::collections::HashSet;

use glam::{DVec3, Vec3};
use lf_compress::format::{SlabTiling, TexelEncoding};
use lf_compress::volume::{Sample, VolumeLayout, VolumeTooLarge, cameras_per_tile};
use lf_math::{Cell, Coverage, Face, LightFieldGeometry, PlanePlacement, SampledAxis, Slab};

fn cell() -> Cell {
    Cell::new(DVec3::ZERO, Vec3::new(0.5, 0.5, 0.5)).expect("a cell")
}

fn uniform(cameras: u32, resolution: u32) -> LightFieldGeometry {
    LightFieldGeometry::around(cell(), PlanePlacement::CellFaces, cameras, resolution).expect("a light field")
}

/// Slabs that differ in everything, none of it a power of two.
fn uneven() -> LightFieldGeometry {
    let axis = |count| SampledAxis::spanning(-1.0, 1.0, count).expect("an axis");
    let slab = |face, [s, t]: [u32; 2], [u, v]: [u32; 2]| {
        Slab::new(face, 0.5, [axis(s), axis(t)], [axis(u), axis(v)], None).expect("a slab")
    };
    let slabs = vec![
        slab(Face::PosX, [3, 5], [7, 2]),
        slab(Face::NegY, [1, 1], [1, 1]),
        slab(Face::PosZ, [2, 33], [129, 65]),
        slab(Face::NegZ, [3, 1], [600, 5]),
    ];
    LightFieldGeometry::new(cell(), slabs).expect("a light field")
}

fn layout_of(
    geometry: &LightFieldGeometry,
    coverage: impl Fn(&Slab) -> Coverage,
) -> Result<VolumeLayout, VolumeTooLarge> {
    let tiling = |slab: &Slab| {
        let coverage = coverage(slab);
        SlabTiling::covering(slab, TexelEncoding::Bc1, cameras_per_tile(&coverage), coverage).expect("a tiling")
    };
    VolumeLayout::new(&geometry.slabs().iter().map(tiling).collect::<Vec<_>>())
}

fn whole(geometry: &LightFieldGeometry) -> VolumeLayout {
    layout_of(geometry, Coverage::whole).expect("fits")
}

fn samples(geometry: &LightFieldGeometry) -> impl Iterator<Item = Sample> {
    geometry.slabs().iter().enumerate().flat_map(|(slab, part)| {
        let ([cameras_s, cameras_t], [width, height]) = (part.cameras(), part.resolution());
        let cameras = (0..cameras_t).flat_map(move |t| (0..cameras_s).map(move |s| [s, t]));
        cameras.flat_map(move |camera| {
            (0..height).flat_map(move |v| (0..width).map(move |u| Sample { slab, camera, texel: [u, v] }))
        })
    })
}

/// Many cameras whose windows are whole in the middle: any number of them that fits wastes as little as one, and packs worse.
#[test]
fn cameras_share_tiles_where_it_costs_nothing() {
    let field = LightFieldGeometry::around(cell(), PlanePlacement::CellFaces, 64, 256).unwrap();
    let coverage = Coverage::of_cell(&field.slabs()[0], &cell()).aligned(4);
    assert_eq!(cameras_per_tile(&coverage), [8, 8]);
}

#[test]
fn the_papers_volume() {
    let layout = whole(&uniform(32, 128));
    assert_eq!((layout.size(), layout.slices()), ([1024, 1024, 128], 6 * 16));
    let bc1_bytes: u64 = layout.size().map(u64::from).iter().product::<u64>() / 2;
    assert_eq!(bc1_bytes, 64 << 20);
    for (number, slab) in (0..).zip(layout.slabs()) {
        assert_eq!((slab.tiling().cameras_per_tile(), slab.groups(), slab.slices()), ([8, 8], [4, 4], 16));
        assert_eq!(slab.first_slice(), 16 * number);
    }
    // Fig. 8: slice idx.y·4 + idx.x, image (s mod 8, t mod 8).
    let sample = Sample { slab: 2, camera: [13, 30], texel: [5, 127] };
    assert_eq!(layout.texel(&sample), Some([5 * 128 + 5, 6 * 128 + 127, 2 * 16 + 3 * 4 + 1]));
}

#[test]
fn every_sample_of_the_papers_volume_comes_back() {
    let geometry = uniform(32, 128);
    let layout = whole(&geometry);
    for sample in samples(&geometry) {
        let texel = layout.texel(&sample).expect("inside");
        assert_eq!(layout.sample(texel), Some(sample));
    }
}

#[test]
fn every_sample_has_a_texel_of_its_own_and_no_block_two_cameras() {
    for geometry in [uniform(3, 6), uniform(16, 8), uneven()] {
        let layout = whole(&geometry);
        assert!(layout.size().iter().all(|n| n.is_power_of_two()));
        let mut taken = HashSet::new();
        let mut blocks = std::collections::HashMap::new();
        for sample in samples(&geometry) {
            let texel = layout.texel(&sample).expect("inside");
            assert!((0..3).all(|i| texel[i] < layout.size()[i]), "{texel:?}");
            assert!(taken.insert(texel), "two samples at {texel:?}");
            assert_eq!(layout.sample(texel), Some(sample));
            let owner = (sample.slab, sample.camera);
            let block = [texel[0] / 4, texel[1] / 4, texel[2]];
            assert_eq!(*blocks.entry(block).or_insert(owner), owner, "a block of two cameras");
        }
    }
}

#[test]
fn texels_without_a_sample_have_none() {
    let geometry = uneven();
    let layout = whole(&geometry);
    let [width, height, depth] = layout.size();
    let mut found = 0;
    for z in 0..depth {
        for y in 0..height.min(64) {
            for x in 0..width {
                if let Some(sample) = layout.sample([x, y, z]) {
                    assert_eq!(layout.texel(&sample), Some([x, y, z]));
                    found += 1;
                }
            }
        }
    }
    assert!(found > 0);
    assert_eq!(layout.sample([0, 0, depth]), None);
    assert_eq!(layout.sample([u32::MAX; 3]), None);
    assert_eq!(layout.texel(&Sample { slab: 0, camera: [3, 0], texel: [0, 0] }), None);
    assert_eq!(layout.texel(&Sample { slab: 9, camera: [0, 0], texel: [0, 0] }), None);
}

#[test]
fn volumes_past_the_coordinates_are_refused() {
    let axis = |count| SampledAxis::new(-1.0, 1e-9, count).expect("an axis");
    let huge = Slab::new(Face::PosX, 0.5, [axis(1 << 16); 2], [axis(1 << 16); 2], None).expect("a slab");
    let tiling = SlabTiling::new(&huge, TexelEncoding::Bc1, [1 << 15, 1]).expect("a tiling");
    assert_eq!(VolumeLayout::new(&[tiling]), Err(VolumeTooLarge));
    let tiling = SlabTiling::new(&huge, TexelEncoding::Bc1, [2, 1]).expect("a tiling");
    assert_eq!(VolumeLayout::new(&[tiling]), Err(VolumeTooLarge));
}

/// The paper's set-up cropped: four slices a slab, balanced, and under a third of the texels.
#[test]
fn the_papers_volume_cropped() {
    let geometry = uniform(32, 128);
    let cell = *geometry.cell();
    let layout = layout_of(&geometry, |slab| Coverage::of_cell(slab, &cell)).expect("fits");
    let [width, height, depth] = layout.size().map(u64::from);
    assert_eq!((width, depth), (height, 24));
    let share = (width * height * depth) as f64 / (32.0f64 * 32.0 * 128.0 * 128.0 * 6.0);
    println!("{width}×{height}×{depth}: {share:.4} of the texels");
    assert!(share < 0.32, "{share}");
}

/// Cropped slabs, some columns empty, and cameras left out: every sample that is stored has a place of its own.
#[test]
fn every_sample_of_a_cropped_volume_comes_back() {
    let geometry = uneven();
    let cell = *geometry.cell();
    let coverage = |slab: &Slab| {
        let kept = (0..slab.cameras()[0] * slab.cameras()[1]).map(|camera| camera % 3 != 1).collect();
        let cropped = Coverage::of_cell(slab, &cell).with_cameras(kept).expect("a mask");
        if slab.face() == Face::PosZ {
            let mut columns = vec![0..129; 2];
            columns[0] = 0..0;
            return Coverage::new(slab, columns, (0..33).map(|t| t..t + 20).collect()).expect("windows");
        }
        cropped
    };
    let layout = layout_of(&geometry, coverage).expect("fits");
    let mut taken = HashSet::new();
    let mut stored = 0;
    for sample in samples(&geometry) {
        let tiling = layout.slabs()[sample.slab].tiling();
        let inside = |window: [std::ops::Range<u32>; 2]| (0..2).all(|i| window[i].contains(&sample.texel[i]));
        let texel = layout.texel(&sample);
        assert_eq!(texel.is_some(), tiling.coverage().window(sample.camera).is_some_and(inside));
        if let Some(texel) = texel {
            assert!((0..3).all(|i| texel[i] < layout.size()[i]), "{texel:?}");
            assert!(taken.insert(texel), "two samples at {texel:?}");
            assert_eq!(layout.sample(texel), Some(sample));
            stored += 1;
        }
    }
    let [width, height, depth] = layout.size();
    let texels = (0..depth).flat_map(|z| (0..height).flat_map(move |y| (0..width).map(move |x| [x, y, z])));
    assert_eq!(texels.filter(|&texel| layout.sample(texel).is_some()).count(), stored);
}

//! The separable crop: every ray through the cell finds the same colour, bit by bit, in the cropped and in the whole file.

use glam::{Vec2, Vec3};
use lf_compress::PackedLightField;
use lf_compress::bc1::Quality;
use lf_compress::format::{Container, Limits, Metadata, TexelEncoding};
use lf_ibr::{Environment, SlabField};
use lf_math::{Coverage, LightFieldGeometry, PlanePlacement, Ray, Slab, SlabTexels};
use lf_tests::{capture, museum, packed};

/// Numbers from 0 to 1, the ends among them.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let bits = (self.0 >> 33) as u32;
        match bits & 15 {
            0 => 0.0,
            1 => 1.0,
            _ => bits as f32 / (1u32 << 31) as f32,
        }
    }

    fn signed(&mut self) -> f32 {
        2.0 * self.next() - 1.0
    }

    /// A ray from a point of the cell: from inside, from faces, edges and corners; along faces and diagonals, too.
    fn ray(&mut self, half_extent: Vec3) -> Ray {
        let origin = half_extent * Vec3::new(self.signed(), self.signed(), self.signed());
        let direction = Vec3::new(self.signed(), self.signed(), self.signed());
        Ray { origin, direction: if direction == Vec3::ZERO { Vec3::X } else { direction } }
    }
}

/// Through a file and back.
fn stored(field: &PackedLightField) -> (usize, SlabField, PackedLightField) {
    let bytes = field.to_bytes(Metadata::new()).unwrap();
    let read = PackedLightField::read(&Container::parse(&bytes, &Limits::default()).unwrap()).unwrap();
    let texels = read.decode(1 << 30).unwrap();
    (bytes.len(), SlabField::new(read.geometry().clone(), texels).unwrap(), read)
}

fn assert_same(whole: &PackedLightField, cropped: &PackedLightField, rays: usize) {
    let ((_, a, _), (_, b, _)) = (stored(whole), stored(cropped));
    let half_extent = whole.geometry().cell().half_extent();
    let mut numbers = Numbers(1);
    for _ in 0..rays {
        let ray = numbers.ray(half_extent);
        let bits = |field: &SlabField| field.look_up(&ray).map(|color| color.to_array().map(f32::to_bits));
        assert_eq!(bits(&a), bits(&b), "{ray:?}");
    }
}

#[test]
fn rays_through_the_cell_find_the_same_bits_in_the_museum() {
    let tracer = museum();
    for (cameras, resolution) in [(10, 48), (9, 37)] {
        let whole = packed(&capture(&tracer, cameras, resolution));
        let cropped = whole.cropped().unwrap();
        assert_same(&whole, &cropped, 200_000);
        let (before, after) = (stored(&whole).0, stored(&cropped).0);
        println!("{cameras} cameras of {resolution} texels: {before} bytes, cropped {after}");
        assert!(4 * after < 3 * before, "{before} {after}");
    }
}

/// Texels that differ everywhere, so that one taken from the wrong place would show.
fn noise(slab: &Slab, seed: u32) -> SlabTexels {
    let count: usize = slab.cameras().into_iter().chain(slab.resolution()).map(|n| n as usize).product();
    let texel = |i: usize| {
        let [r, g, b, _] = (i as u32 ^ seed << 27).wrapping_mul(0x9E37_79B1).rotate_left(13).to_be_bytes();
        [r, g, b, 255]
    };
    SlabTexels::new(slab, (0..count).map(texel).collect()).unwrap()
}

#[test]
fn rays_through_the_cell_find_the_same_bits_with_focal_planes_and_flat_cells() {
    let cell = lf_math::Cell::new(glam::DVec3::ONE, Vec3::new(0.5, 1.7, 0.3)).unwrap();
    for (depth, cameras, resolution) in [(None, 7, 21), (Some(0.8), 7, 22), (Some(30.0), 12, 16), (Some(0.1), 3, 40)] {
        let field = LightFieldGeometry::around(cell, PlanePlacement::CellFaces, cameras, resolution).unwrap();
        let slabs = field.slabs().iter().map(|slab| slab.with_focal_depth(depth).unwrap()).collect();
        let field = LightFieldGeometry::new(cell, slabs).unwrap();
        let texels: Vec<_> = (0..).zip(field.slabs()).map(|(i, slab)| noise(slab, i)).collect();
        let whole = PackedLightField::encode(field, &texels, TexelEncoding::Rgba8, Quality::Fast).unwrap();
        let cropped = whole.cropped().unwrap();
        assert_same(&whole, &cropped, 50_000);
    }
}

/// Cutting texels before they are encoded and cutting the encoded blocks come to the same, but for what the encoder takes
/// from one camera to the next.
#[test]
fn texels_and_blocks_are_cut_alike() {
    let mut capture = capture(&museum(), 8, 64);
    let blocks = packed(&capture).cropped().unwrap();
    for (slab, texels) in capture.geometry.slabs().iter().zip(&mut capture.texels) {
        *texels = texels.crop(Coverage::of_cell(slab, capture.geometry.cell()).aligned(4)).unwrap();
    }
    let texels = packed(&capture);
    assert_eq!(texels.tilings(), blocks.tilings());
    let error = |field: &PackedLightField| {
        let decoded = field.decode(1 << 30).unwrap();
        let pairs = capture.texels.iter().zip(&decoded).flat_map(|(a, b)| a.texels().iter().zip(b.texels()));
        let squares = pairs.map(|(a, b)| (0..3).map(|c| f64::from(a[c].abs_diff(b[c])).powi(2)).sum::<f64>());
        10.0 * squares.sum::<f64>().log10()
    };
    let (before, after) = (error(&texels), error(&blocks));
    println!("{before:.3} dB of squared error cut before, {after:.3} dB after");
    assert!((before - after).abs() < 0.05, "{before} {after}");
}

/// What is left out is black again when whole images are asked for; the rest is where it was.
#[test]
fn whole_images_come_back() {
    let field = LightFieldGeometry::around(
        lf_math::Cell::cube(glam::DVec3::ZERO, 1.0).unwrap(),
        PlanePlacement::CellFaces,
        6,
        18,
    );
    let field = field.unwrap();
    let texels: Vec<_> = (0..).zip(field.slabs()).map(|(i, slab)| noise(slab, i)).collect();
    let whole = PackedLightField::encode(field, &texels, TexelEncoding::Rgba8, Quality::Fast).unwrap();
    let cropped = whole.cropped().unwrap();
    let back = cropped.whole(1 << 30).unwrap().decode(1 << 30).unwrap();
    for (slab, (before, after)) in texels.iter().zip(&back).enumerate() {
        let coverage = cropped.tilings()[slab].coverage();
        for camera in coverage.cameras() {
            for texel in (0..18).flat_map(|v| (0..18).map(move |u| [u, v])) {
                let kept =
                    coverage.window(camera).is_some_and(|w| w[0].contains(&texel[0]) && w[1].contains(&texel[1]));
                let expected = if kept { before.texel(camera, texel) } else { Some([0, 0, 0, 255]) };
                assert_eq!(after.texel(camera, texel), expected);
            }
        }
    }
    assert_eq!(cropped.cropped().unwrap().tilings(), cropped.tilings());
}

/// A camera that is left out is made up for by its neighbours; where none is left there is no answer.
#[test]
fn missing_cameras_are_made_up_for() {
    let capture = capture(&museum(), 8, 32);
    let masked = |kept: &dyn Fn(u32) -> bool| {
        let crop = |(slab, texels): (&Slab, &SlabTexels)| {
            let mask = (0..64).map(kept).collect();
            texels.crop(Coverage::whole(slab).with_cameras(mask).unwrap()).unwrap()
        };
        let texels: Vec<_> = capture.geometry.slabs().iter().zip(&capture.texels).map(crop).collect();
        PackedLightField::encode(capture.geometry.clone(), &texels, TexelEncoding::Rgba8, Quality::Fast).unwrap()
    };
    let (_, all, _) = stored(&masked(&|_| true));
    let (_, some, read) = stored(&masked(&|camera| camera != 27));
    assert!(read.tilings().iter().all(|tiling| tiling.coverage().window([3, 3]).is_none()));
    let mut numbers = Numbers(3);
    let (mut touched, mut same) = (0, 0);
    for _ in 0..20_000 {
        let ray = numbers.ray(capture.geometry.cell().half_extent());
        let indexed = capture.geometry.index_ray(&ray).unwrap();
        let taps = capture.geometry.slabs()[indexed.slab].taps(&indexed.coord);
        let weight: f32 = taps.iter().filter(|tap| tap.camera == [3, 3]).map(|tap| tap.weight).sum();
        let (full, part) = (all.look_up(&ray).unwrap(), some.look_up(&ray));
        if weight == 0.0 {
            assert_eq!(part, Some(full));
            same += 1;
        } else if weight < 0.9 {
            // The others' mean: all is that mean and the camera's own colour, by weight.
            let own = (full - (1.0 - weight) * part.unwrap()) / weight;
            assert!(own.cmpge(Vec3::splat(-1e-4)).all() && own.cmple(Vec3::splat(1.0 + 1e-4)).all(), "{own}");
            touched += 1;
        }
    }
    assert!(touched > 100 && same > 1000, "{touched} {same}");
    let (_, lone, _) = stored(&masked(&|camera| camera == 0));
    let slab = &capture.geometry.slabs()[4];
    let through = |camera: Vec2| slab.sample_ray(camera, Vec2::splat(16.0));
    assert_eq!(lone.look_up(&through(Vec2::splat(4.5))), None);
    assert!(lone.look_up(&through(Vec2::splat(0.5))).is_some());
}

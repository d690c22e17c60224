//! Reflections from light field slabs, straight from their BC1 blocks, many rays at a time.
//!
//! The same answers as [`SlabField`](crate::SlabField) gives from decoded texels (Figs. 6 and 8 of Yu, Yang & McMillan), but for the
//! rounding of interpolation, from an eighth of the memory. Rays are answered in groups of one for every lane of a vector, which all
//! do the same: find their place, read the blocks around it, decode the sixteen texels they need and blend them. Rays whose neighbours
//! need another slab wait in bins, one for each slab, until there are enough. The blocks are read in one go before anything is
//! decoded, so that the waits for memory overlap.
//!
//! `docs/fetch.md` has what it costs. A single ray is answered as slowly as a full group.

mod axis;
mod bins;
mod kernel;
mod storage;

use fearless_simd::{Level, dispatch};
use glam::Vec3;
use lf_compress::{PackError, PackedLightField};
use lf_math::{LightFieldGeometry, Ray};

use crate::frame::Environment;
use bins::look_up;
use storage::SlabBlocks;

/// Slabs as BC1 blocks, whole or cropped.
#[derive(Debug, Clone)]
pub struct BlockField {
    geometry: LightFieldGeometry,
    slabs: Vec<SlabBlocks>,
    level: Level,
}

impl BlockField {
    /// Copies the blocks of a packed light field: 8 bytes a block, and of one slab at a time twice as much until it is in place.
    ///
    /// # Errors
    /// [`PackError::Encoding`] unless all slabs are BC1, [`PackError::TooLarge`] if the blocks of a slab are 2³² or more.
    pub fn new(field: &PackedLightField) -> Result<Self, PackError> {
        let slabs = (0..field.tilings().len()).map(|slab| SlabBlocks::new(field, slab)).collect::<Result<_, _>>()?;
        Ok(Self { geometry: field.geometry().clone(), slabs, level: Level::new() })
    }

    /// The cell and the slabs.
    #[must_use]
    pub fn geometry(&self) -> &LightFieldGeometry {
        &self.geometry
    }
}

impl Environment for BlockField {
    fn look_up(&self, ray: &Ray) -> Option<Vec3> {
        let mut answer = [None];
        self.look_up_all(std::slice::from_ref(ray), &mut answer);
        answer[0]
    }

    fn look_up_all(&self, rays: &[Ray], answers: &mut [Option<Vec3>]) {
        dispatch!(self.level, simd => look_up(simd, &self.slabs, rays, answers));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SlabField;
    use glam::DVec3;
    use lf_compress::bc1::Quality;
    use lf_compress::format::TexelEncoding;
    use lf_math::{Cell, Coverage, Face, PlanePlacement, Slab, SlabTexels};

    fn hash(i: u32) -> u32 {
        let mixed = (i ^ 0x9E37_79B9).wrapping_mul(0x85EB_CA6B);
        let mixed = (mixed ^ mixed >> 15).wrapping_mul(0xC2B2_AE35);
        mixed ^ mixed >> 13
    }

    /// Noise, on some of the faces, of an odd number of texels and different numbers of cameras, as `keep` has it.
    fn packed(faces: &[Face], focal_depth: Option<f32>, keep: impl Fn(&Slab) -> Coverage) -> PackedLightField {
        let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
        let all = LightFieldGeometry::around_with(cell, PlanePlacement::CellFaces, [6, 5], [18, 23]).unwrap();
        let wanted = all.slabs().iter().filter(|slab| faces.contains(&slab.face()));
        let slabs = wanted.map(|slab| slab.with_focal_depth(focal_depth).unwrap()).collect();
        let geometry = LightFieldGeometry::new(cell, slabs).unwrap();
        let texels = |slab| {
            let noise = |i: u32| hash(i + 77 * u32::from(i.is_multiple_of(4))).to_le_bytes();
            let whole = SlabTexels::new(slab, (0..6 * 5 * 18 * 23).map(noise).collect()).unwrap();
            whole.crop(keep(slab)).unwrap()
        };
        let texels: Vec<_> = geometry.slabs().iter().map(texels).collect();
        PackedLightField::encode(geometry, &texels, TexelEncoding::Bc1, Quality::Realtime).unwrap()
    }

    /// Rays inside and far outside the range, along axes and diagonals, without an end or a direction.
    fn rays() -> Vec<Ray> {
        let odd = [0.0, 1.0, -1.0, 1e-40, 1e30, -1e30, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        let number = |i: u32| match hash(i) % 64 {
            special @ 0..9 if hash(i / 6 + 5).is_multiple_of(4) => odd[special as usize],
            _ => 1.6 * (hash(i + 1_000_000) as f32 / 2f32.powi(32) - 0.5),
        };
        let vector = |i: u32| Vec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2));
        let ray = |i: u32| Ray { origin: vector(2 * i), direction: vector(2 * i + 1) };
        let ties = [-1.0, 1.0].into_iter().flat_map(|x| [-1.0, 1.0].map(|y| Vec3::new(x, y, 1.0)));
        (0..20_000).map(ray).chain(ties.map(|direction| Ray { origin: Vec3::ZERO, direction })).collect()
    }

    fn check(what: &str, packed: &PackedLightField) {
        let texels = SlabField::new(packed.geometry().clone(), packed.decode(1 << 30).unwrap()).unwrap();
        let detected = BlockField::new(packed).unwrap();
        let plain = BlockField { level: Level::baseline(), ..detected.clone() };
        let rays = rays();
        for field in [detected, plain] {
            // What was there before must not stay.
            let mut answers = vec![Some(Vec3::NAN); rays.len()];
            field.look_up_all(&rays, &mut answers);
            let answered = answers.iter().flatten().count();
            assert!(answered > 1000 && answered < rays.len(), "{what}: {answered}");
            for (ray, found) in rays.iter().zip(answers) {
                match (texels.look_up(ray), found) {
                    (Some(expected), Some(found)) => {
                        let error = (expected - found).abs().max_element();
                        assert!(error < 2e-6, "{what}: {ray:?} {expected} {found}");
                    }
                    (expected, found) => assert_eq!(expected, found, "{what}: {ray:?}"),
                }
            }
            assert_eq!(field.look_up(&rays[7]).is_some(), texels.look_up(&rays[7]).is_some());
        }
    }

    #[test]
    fn whole_slabs_answer_as_decoded_ones_do() {
        check("whole", &packed(&Face::ALL, None, Coverage::whole));
        check("focused", &packed(&Face::ALL, Some(1.7), Coverage::whole));
        check("one slab", &packed(&[Face::NegY], Some(3.0), Coverage::whole));
    }

    #[test]
    fn windows_and_missing_cameras_answer_as_decoded_ones_do() {
        let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
        check("cropped", &packed(&Face::ALL, Some(1.7), |slab| Coverage::of_cell(slab, &cell)));
        let some = |slab: &Slab| {
            let kept = (0..30).map(|camera| !hash(camera).is_multiple_of(3)).collect();
            Coverage::of_cell(slab, &cell).with_cameras(kept).unwrap()
        };
        check("masked", &packed(&[Face::PosX, Face::NegX, Face::PosZ], None, some));
    }

    /// Three-colour blocks, which the encoder makes only when asked to, among others: every bit pattern is a block.
    #[test]
    fn every_index_of_every_kind_of_block_decodes() {
        let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
        let geometry = LightFieldGeometry::around(cell, PlanePlacement::CellFaces, 2, 4).unwrap();
        for i in 0..500u32 {
            let block: [u8; 8] = std::array::from_fn(|byte| hash(8 * i + byte as u32) as u8);
            let texels = lf_compress::bc1::decode_block(&block);
            let ends = u32::from_le_bytes([block[0], block[1], block[2], block[3]]);
            let indices = u32::from_le_bytes([block[4], block[5], block[6], block[7]]);
            let mut field = BlockField::new(&whole_zero(&geometry)).unwrap();
            field.slabs.iter_mut().for_each(|slab| {
                slab.blocks.fill(crate::palette::recode([ends, indices]));
                slab.three = slab.blocks.iter().any(crate::palette::has_three_colors);
            });
            let ray = |n: u32| {
                geometry.slabs()[0].sample_ray(glam::Vec2::ZERO, glam::Vec2::new((n % 4) as f32, (n / 4) as f32))
            };
            for n in 0..16 {
                let [r, g, b, _] = texels[n as usize].map(f32::from);
                let found = field.look_up(&ray(n)).unwrap() * 255.0;
                assert!((found - Vec3::new(r, g, b)).abs().max_element() < 1e-2, "{block:?} {n}: {found} {r} {g} {b}");
            }
        }
    }

    fn whole_zero(geometry: &LightFieldGeometry) -> PackedLightField {
        let zero = |slab| SlabTexels::new(slab, vec![[0; 4]; 2 * 2 * 4 * 4]).unwrap();
        let texels: Vec<_> = geometry.slabs().iter().map(zero).collect();
        PackedLightField::encode(geometry.clone(), &texels, TexelEncoding::Bc1, Quality::Realtime).unwrap()
    }

    #[test]
    fn other_texels_are_refused() {
        let field = packed(&[Face::PosX], None, Coverage::whole);
        let texels = field.decode(1 << 30).unwrap();
        let plain =
            PackedLightField::encode(field.geometry().clone(), &texels, TexelEncoding::Rgba8, Quality::Realtime)
                .unwrap();
        assert!(matches!(BlockField::new(&plain), Err(PackError::Encoding(TexelEncoding::Rgba8))));
    }
}

//! Pictures from between the cameras of a slab.
//!
//! A view at a real-valued camera index is blended from the images of the cameras around it, one bilinear fetch from each. What differs is
//! where they are fetched: [`Blend`]. Views have the slab's texels, row v = 0 first.
//!
//! [`Blend::Consensus`] is the method of Yang, Welch & Bishop, *Real-Time Consensus-Based Scene Reconstruction using Commodity Graphics
//! Hardware* (Computer Graphics Forum 22, 2003): for each plane the images are fetched as if all lay on it, and each texel takes the
//! colour of the plane on which its cameras differ least, differences being added up over a small window (the paper adds up
//! mipmap levels). It costs as many fetches as planes, and a window to add up for each: a look at what depth per texel would buy, not a
//! way to draw frames. It knows no occlusion: where a thing hides another from one camera only, no plane is right.

use glam::{Vec2, Vec3};
use lf_math::{Image, Slab, SlabCoord, SlabTexels};
use rayon::prelude::*;

use crate::focus::{Sample, Sweep};
use crate::frame::encode;
use crate::slabs::fetch;
use crate::texel::Texel;

/// Texels on each side of one over which differences are added up: fewer leave noise, more blur the outlines of things.
const WINDOW_REACH: u32 = 2;
/// Blocks of texels whose depths are looked for, to know the nearest and the farthest.
const BLOCKS: usize = 1 << 10;
/// Texels on each side of a block's middle.
const BLOCK_REACH: i32 = 2;
/// Share of the disparities that may be as good as the best if it is to count: its neighbours.
const ALIKE: f64 = 0.1;
/// Share of the blocks that may be nearer than the nearest plane, or farther than the farthest: false matches.
const OUTLIERS: f64 = 0.02;

/// Where the images of the cameras around a view are fetched. Planes are given by inverse depth, 1/m from the camera plane, 0 being
/// infinity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Blend<'a> {
    /// Nothing is blended: the image of the nearest camera as it is, of two as near the one with the lower index.
    Nearest,
    /// As if all lay on one plane, as the renderer does.
    Plane(f32),
    /// Each texel on that of these planes on which the cameras agree best there, of equal ones the first. Without planes as at infinity.
    Consensus(&'a [f32]),
}

/// The view of a slab from a real-valued camera index: opaque, 8 bits, sRGB-encoded. Where all cameras around are left out, it is black.
/// From the index of a camera, [`Blend::Nearest`] gives its own image.
///
/// # Panics
/// In debug builds, if the texels are not those of the slab.
#[must_use]
pub fn view<T: Texel>(slab: &Slab, texels: &SlabTexels<T>, camera: Vec2, blend: Blend<'_>) -> Image<[u8; 4]> {
    debug_assert!(texels.check(slab).is_ok());
    let from = |camera| View { slab, texels, camera };
    let blended = match blend {
        // Halves go down.
        Blend::Nearest => from((camera - 0.5).ceil()).on_plane(0.0),
        Blend::Plane(inverse_depth) => from(camera).on_plane(inverse_depth),
        Blend::Consensus(planes) => from(camera).consensus(planes),
    };
    blended.map(|blended| encode(blended.color.extend(1.0)))
}

/// So many planes, evenly spaced in inverse depth between the nearest and the farthest things that the images show, the farthest first.
///
/// As [`focus_from_images`](crate::focus_from_images) does it for all texels, blocks of 5×5 are predicted each for itself. A block counts
/// for as much as its best plane is better than the tenth best of a hundred: what has no texture, or the same again and again, is predicted
/// by many planes and does not count. Two per cent at each end are left out. Empty under the same conditions.
#[must_use]
pub fn depth_planes<T: Texel>(slab: &Slab, texels: &SlabTexels<T>, count: usize) -> Vec<f32> {
    let Some(sweep) = Sweep::new(slab, texels) else { return Vec::new() };
    let mut blocks: Vec<(f32, f64)> =
        sweep.samples.par_iter().take(BLOCKS).map(|sample| best_of_block(&sweep, sample)).collect();
    blocks.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let [far, near] = [OUTLIERS, 1.0 - OUTLIERS].map(|share| sweep.unit * weighted_quantile(&blocks, share));
    match count {
        1 => vec![0.5 * (far + near)],
        _ => (0..count).map(|i| far + (near - far) * i as f32 / (count - 1) as f32).collect(),
    }
}

/// The disparity that predicts a block best, and by how much it is better than all but [`ALIKE`] of them.
fn best_of_block<T: Texel>(sweep: &Sweep<'_, T>, middle: &Sample) -> (f32, f64) {
    let offsets = || (-BLOCK_REACH..=BLOCK_REACH).flat_map(|v| (-BLOCK_REACH..=BLOCK_REACH).map(move |u| [u, v]));
    let moved = |[u, v]: [i32; 2]| {
        let texel = [middle.texel[0].checked_add_signed(u)?, middle.texel[1].checked_add_signed(v)?];
        Some(Sample { texel, ..*middle })
    };
    let block: Vec<Sample> = offsets().filter_map(moved).filter(|sample| sweep.is_usable(sample)).collect();
    let error = |disparity: f32| block.iter().filter_map(|sample| sweep.residual(sample, disparity)).sum::<f64>();
    let mut errors: Vec<(f32, f64)> = sweep.disparities().map(|disparity| (disparity, error(disparity))).collect();
    errors.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    let (least, alike) = (errors[0], errors[(ALIKE * errors.len() as f64) as usize]);
    (least.0, alike.1 - least.1)
}

/// The first of sorted values, each with its weight, below which at least a share of the whole weight lies.
fn weighted_quantile(sorted: &[(f32, f64)], share: f64) -> f32 {
    let whole: f64 = sorted.iter().map(|(_, weight)| weight).sum();
    let mut below = 0.0;
    let found = sorted.iter().find(|(_, weight)| {
        below += weight;
        below >= share * whole
    });
    found.or(sorted.last()).map_or(0.0, |(value, _)| *value)
}

struct View<'a, T> {
    slab: &'a Slab,
    texels: &'a SlabTexels<T>,
    camera: Vec2,
}

/// What the cameras around say of a texel.
#[derive(Debug, Clone, Copy, Default)]
struct Blended {
    color: Vec3,
    /// Weighted variance of their colours.
    disagreement: f32,
}

impl<T: Texel> View<'_, T> {
    fn on_plane(&self, inverse_depth: f32) -> Image<Blended> {
        let disparity = self.slab.disparity_at(inverse_depth);
        let [width, height] = self.slab.resolution();
        let mut picture = Image::filled(width, height, Blended::default());
        picture.texels_mut().par_chunks_mut(width as usize).zip(0..height).for_each(|(row, v)| {
            for (texel, u) in row.iter_mut().zip(0u32..) {
                *texel = self.texel(Vec2::new(u as f32, v as f32), disparity);
            }
        });
        picture
    }

    fn texel(&self, uv: Vec2, disparity: Vec2) -> Blended {
        let (mut sum, mut squares, mut found) = (Vec3::ZERO, 0.0, 0.0);
        for tap in self.slab.taps_with(&SlabCoord { st: self.camera, uv }, disparity) {
            let Some(image) = self.texels.image(tap.camera).filter(|_| tap.weight > 0.0) else { continue };
            let color = T::color(fetch(&image, &tap));
            sum += tap.weight * color;
            squares += tap.weight * color.length_squared();
            found += tap.weight;
        }
        if found == 0.0 {
            return Blended::default();
        }
        let color = sum / found;
        Blended { color, disagreement: (squares / found - color.length_squared()).max(0.0) }
    }

    fn consensus(&self, planes: &[f32]) -> Image<Blended> {
        let Some((&first, others)) = planes.split_first() else { return self.on_plane(0.0) };
        let candidate = |plane| {
            let blended = self.on_plane(plane);
            let costs = windowed(&blended.map(|blended| blended.disagreement));
            let mut costs = costs.texels().iter();
            blended.map(|blended| Blended { disagreement: *costs.next().unwrap_or(&0.0), ..blended })
        };
        let mut best = candidate(first);
        for &plane in others {
            for (best, &other) in best.texels_mut().iter_mut().zip(candidate(plane).texels()) {
                if other.disagreement < best.disagreement {
                    *best = other;
                }
            }
        }
        best
    }
}

/// Each value replaced by the sum over the window around it, as much of it as lies in the image.
fn windowed(image: &Image<f32>) -> Image<f32> {
    transposed_sums(&transposed_sums(image))
}

/// The sums along rows, as an image whose rows are the columns of the other.
fn transposed_sums(image: &Image<f32>) -> Image<f32> {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let reach = WINDOW_REACH as usize;
    let mut sums = Image::filled(image.height(), image.width(), 0.0);
    sums.texels_mut().par_chunks_mut(height).enumerate().for_each(|(x, column)| {
        let window = x.saturating_sub(reach)..(x + reach + 1).min(width);
        for (sum, row) in column.iter_mut().zip(image.texels().chunks_exact(width)) {
            *sum = row[window.clone()].iter().sum();
        }
    });
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use lf_math::{Face, SampledAxis};

    /// Two walls side by side, the left one without disparity, the right one moving 4 texels a camera, each with a texture that no shift
    /// but its own fits. Between the walls lie texels that belong to neither.
    fn two_walls() -> (Slab, SlabTexels) {
        let st = SampledAxis::new(0.0, 0.1, 5).unwrap();
        let uv = SampledAxis::new(-0.5, 0.01, 96).unwrap();
        let slab = Slab::new(Face::NegZ, 0.0, [st, st], [uv, uv], None).unwrap();
        let noise = |x: u32, y: u32| (((x * 73 + y * 151 + 7) * (x * 31 + y * 17 + 3)) >> 3) as u8;
        let texel = |[s, t, u, v]: [u32; 4]| {
            let shift = if u < 48 { 0 } else { 4 };
            let value = noise((u + shift * s) / 2, (v + shift * t) / 2);
            [value, 255 - value, value / 2, 255]
        };
        let cameras = (0..5).flat_map(|t| (0..5).map(move |s| [s, t]));
        let all = cameras.flat_map(|[s, t]| (0..96).flat_map(move |v| (0..96).map(move |u| [s, t, u, v])));
        let texels = SlabTexels::new(&slab, all.map(texel).collect()).unwrap();
        (slab, texels)
    }

    /// Inverse depth of a plane that moves one texel a camera.
    const UNIT: f32 = 0.1;

    #[test]
    fn a_camera_s_own_view_is_its_image() {
        let (slab, texels) = two_walls();
        let image = texels.image([2, 3]).unwrap();
        for blend in [Blend::Nearest, Blend::Plane(0.3), Blend::Consensus(&[0.0, 0.4])] {
            assert_eq!(view(&slab, &texels, Vec2::new(2.0, 3.0), blend).texels(), image.texels, "{blend:?}");
        }
        assert_eq!(view(&slab, &texels, Vec2::new(2.5, 2.6), Blend::Nearest).texels(), image.texels);
    }

    #[test]
    fn a_plane_s_own_disparity_makes_no_error_and_consensus_chooses_it_by_texel() {
        let (slab, texels) = two_walls();
        let place = Vec2::new(1.5, 2.0);
        // What a camera there would see, well inside each wall.
        let noise = |x: u32, y: u32| (((x * 73 + y * 151 + 7) * (x * 31 + y * 17 + 3)) >> 3) as u8;
        let truth = |u: u32, v: u32| match u {
            0..48 => noise(u / 2, v / 2),
            _ => noise((u + 6) / 2, (v + 8) / 2),
        };
        let off = |picture: &Image<[u8; 4]>, u: std::ops::Range<u32>| {
            let texels = u.flat_map(|u| (12..84).map(move |v| (u, v)));
            texels.filter(|&(u, v)| picture.get(u, v)[0].abs_diff(truth(u, v)) > 1).count()
        };
        let [far, near] = [0.0, 4.0 * UNIT].map(|plane| view(&slab, &texels, place, Blend::Plane(plane)));
        assert_eq!((off(&far, 4..44), off(&near, 56..88)), (0, 0));
        assert!(off(&far, 56..88) > 500 && off(&near, 4..44) > 500);
        let chosen = view(&slab, &texels, place, Blend::Consensus(&[0.0, 2.0 * UNIT, 4.0 * UNIT]));
        assert_eq!((off(&chosen, 4..42), off(&chosen, 56..86)), (0, 0));
    }

    #[test]
    fn the_planes_reach_from_the_farthest_to_the_nearest() {
        let (slab, texels) = two_walls();
        let planes = depth_planes(&slab, &texels, 5);
        assert_eq!(planes.len(), 5);
        assert!(planes[0].abs() < 0.6 * UNIT && (planes[4] - 4.0 * UNIT).abs() < 0.6 * UNIT, "{planes:?}");
        assert!((planes[2] - 0.5 * (planes[0] + planes[4])).abs() < 1e-6);
        assert_eq!(depth_planes(&slab, &texels, 0), []);
    }

    #[test]
    fn windows_are_summed_as_far_as_there_is_image() {
        let image = Image::new(6, 3, (0..18).map(|i| i as f32).collect()).unwrap();
        let sums = windowed(&image);
        for (x, y) in (0..6u32).flat_map(|x| (0..3u32).map(move |y| (x, y))) {
            let near = |a: u32, b: u32| a.abs_diff(b) <= WINDOW_REACH;
            let all = (0..6).flat_map(|i| (0..3).map(move |j| (i, j)));
            let expected: f32 = all.filter(|&(i, j)| near(i, x) && near(j, y)).map(|(i, j)| image.get(i, j)).sum();
            assert_eq!(sums.get(x, y), expected);
        }
    }
}

//! Slabs of inverse depth that tell a ray roughly where it ends.

use glam::Vec2;
use half::f16;
use lf_compress::DepthGuide;
use lf_math::{Ray, Slab};

/// The nearest and the farthest end of the stored rays around one of unit direction that starts in the cell: how far along it, metres.
/// `None` if none of them ends in front of it.
///
/// From each of the four cameras around it: first the depth at the place that the focal plane says, then, at the place that
/// this depth says, the four texels around.
#[must_use]
pub fn guide_ends(guide: &DepthGuide, ray: &Ray) -> Option<[f32; 2]> {
    let indexed = guide.geometry().index_ray(ray)?;
    let (slab, texels) = (&guide.geometry().slabs()[indexed.slab], guide.inverse_depths(indexed.slab));
    let disparity = slab.disparity_at(1.0);
    let [width, height] = slab.resolution().map(|n| n as usize);
    let last = Vec2::new(width as f32 - 1.0, height as f32 - 1.0);
    let mut around = [0.0; 16];
    for (tap, around) in slab.taps(&indexed.coord).into_iter().zip(around.as_chunks_mut::<4>().0) {
        let camera = Vec2::new(tap.camera[0] as f32, tap.camera[1] as f32);
        let number = (tap.camera[1] * slab.cameras()[0] + tap.camera[0]) as usize;
        let image = &texels[number * width * height..][..width * height];
        let texel = |u: u32, v: u32| value(image[v as usize * width + u as usize]);
        let [u, v] = (tap.uv + 0.5).min(last).to_array().map(|at| at as u32);
        // What is not a number is cast to 0.
        let place = indexed.coord.uv + disparity * texel(u, v) * (indexed.coord.st - camera);
        let [u, v] = place.max(Vec2::ZERO).min(last).to_array().map(|at| at as u32);
        let [right, down] = [(u + 1).min(width as u32 - 1), (v + 1).min(height as u32 - 1)];
        *around = [texel(u, v), texel(right, v), texel(u, down), texel(right, down)];
    }
    let ends = ends(slab, ray, &around);
    (ends[0] <= ends[1]).then_some(ends)
}

/// A half float that is finite, in three operations: its bits as those of a float are too small by a power of two.
fn value(half: f16) -> f32 {
    let bits = u32::from(half.to_bits());
    let too_small = f32::from_bits((bits & 0x8000) << 16 | (bits & 0x7fff) << 13);
    too_small * 2f32.powi(127 - 15)
}

/// How far along a ray it reaches the nearest and the farthest of inverse depths, of those in front of it: infinite for 0.
fn ends(slab: &Slab, ray: &Ray, inverses: &[f32; 16]) -> [f32; 2] {
    let (axis, sign) = (slab.face().axis(), slab.face().sign());
    let (start, step) = ((slab.plane() - ray.origin[axis]) / ray.direction[axis], sign / ray.direction[axis]);
    let ends = inverses.map(|inverse| if inverse == 0.0 { f32::INFINITY } else { start + step / inverse });
    let near = ends.map(|end| if end > 0.0 { end } else { f32::INFINITY });
    let far = ends.map(|end| if end > 0.0 { end } else { f32::NEG_INFINITY });
    [fold(near, |a, b| if b < a { b } else { a }), fold(far, |a, b| if b > a { b } else { a })]
}

/// Sixteen numbers made one, by halves: in vectors.
fn fold(mut values: [f32; 16], of_two: impl Fn(f32, f32) -> f32) -> f32 {
    for half in [8, 4, 2, 1] {
        for i in 0..half {
            values[i] = of_two(values[i], values[i + half]);
        }
    }
    values[0]
}

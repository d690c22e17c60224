//! Slabs of inverse depth that tell a ray roughly where it ends.

use glam::Vec2;
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
    let last = slab.resolution().map(|n| n - 1);
    let mut ends = [f32::INFINITY, f32::NEG_INFINITY];
    for tap in slab.taps(&indexed.coord) {
        let camera = Vec2::new(tap.camera[0] as f32, tap.camera[1] as f32);
        let number = (tap.camera[1] * slab.cameras()[0] + tap.camera[0]) as usize;
        let size = slab.resolution().map(|n| n as usize);
        let image = &texels[number * size[0] * size[1]..];
        let texel = |u: u32, v: u32| image[v.min(last[1]) as usize * size[0] + u.min(last[0]) as usize].to_f32();
        let first = texel((tap.uv.x + 0.5) as u32, (tap.uv.y + 0.5) as u32);
        // Casts of what is out of range, or not a number, saturate.
        let place = indexed.coord.uv + disparity * first * (indexed.coord.st - camera);
        let [u, v] = [place.x.max(0.0) as u32, place.y.max(0.0) as u32];
        let around =
            [(u, v), (u.saturating_add(1), v), (u, v.saturating_add(1)), (u.saturating_add(1), v.saturating_add(1))];
        for inverse in around.map(|(u, v)| texel(u, v)) {
            let end = end(slab, ray, inverse);
            if end > 0.0 {
                ends = [ends[0].min(end), ends[1].max(end)];
            }
        }
    }
    (ends[0] <= ends[1]).then_some(ends)
}

/// How far along a ray it reaches an inverse depth: infinite for 0.
fn end(slab: &Slab, ray: &Ray, inverse: f32) -> f32 {
    let (axis, sign) = (slab.face().axis(), slab.face().sign());
    if inverse == 0.0 {
        return f32::INFINITY;
    }
    (slab.plane() + sign / inverse - ray.origin[axis]) / ray.direction[axis]
}

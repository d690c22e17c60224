//! Bilinear interpolation, as all fetches here do it.

use glam::{Vec2, Vec3};

/// The value at `position` (texel indices, at least 0), in 0 … 1. `texel` is asked for the four neighbours: column and row
/// of the texel below, and one more of each.
pub(crate) fn bilinear(position: Vec2, texel: impl Fn(usize, usize) -> [u8; 4]) -> Vec3 {
    let low = position.floor();
    let fraction = position - low;
    let (x, y) = (low.x as usize, low.y as usize);
    let color = |x: usize, y: usize| {
        let [r, g, b, _] = texel(x, y);
        Vec3::new(f32::from(r), f32::from(g), f32::from(b))
    };
    let row = |y: usize| color(x, y).lerp(color(x + 1, y), fraction.x);
    row(y).lerp(row(y + 1), fraction.y) / 255.0
}

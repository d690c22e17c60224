//! Bilinear interpolation, as all fetches here do it.

use glam::{Vec2, Vec3};

use crate::texel::Texel;

/// The interpolated value at `position` (texel indices, at least 0). `texel` is asked for the four neighbours: column and row of
/// the texel below, and one more of each.
pub(crate) fn bilinear<T: Texel>(position: Vec2, texel: impl Fn(usize, usize) -> T) -> Vec3 {
    let low = position.floor();
    let fraction = position - low;
    let (x, y) = (low.x as usize, low.y as usize);
    let row = |y: usize| texel(x, y).value().lerp(texel(x + 1, y).value(), fraction.x);
    row(y).lerp(row(y + 1), fraction.y)
}

//! What surfaces look like: a base colour from a constant, a picture or a procedural pattern.

use std::sync::{Arc, LazyLock};

use glam::{UVec2, Vec2, Vec3};
use lf_math::{Image, linear_from_srgb};

/// The linear value of each 8-bit sRGB value.
static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear_from_srgb(byte as f32 / 255.0)));

/// A surface: diffuse, or glowing by itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Base colour.
    pub surface: Surface,
    /// Emitted radiance, linear RGB; added to what is reflected.
    pub emission: Vec3,
}

/// The base colour of a material over texture coordinates.
#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    /// One colour, linear RGB.
    Uniform(Vec3),
    /// A picture, times a factor.
    Textured(Arc<Texture>, Vec3),
    /// A pattern computed in code.
    Procedural(Pattern),
}

/// A picture that repeats over texture coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// 8-bit sRGB texels; the first row is v = 0, as in glTF.
    pub image: Image<[u8; 3]>,
}

/// The museum's patterns, over texture coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pattern {
    /// Squares of edge 1 in two colours.
    Checker([Vec3; 2]),
    /// Diagonal stripes in two colours, `count` of them over the unit square.
    Stripes([Vec3; 2], f32),
    /// Rings around (½, ½) in two colours, `count` of them out to the corners.
    Rings([Vec3; 2], f32),
    /// A grid of coloured fields, chosen by position from four colours, with dark lines between.
    Fields([Vec3; 4], f32),
}

impl Material {
    /// A diffuse material of one colour.
    #[must_use]
    pub fn diffuse(color: Vec3) -> Self {
        Self { surface: Surface::Uniform(color), emission: Vec3::ZERO }
    }

    /// A diffuse material with a pattern.
    #[must_use]
    pub fn patterned(pattern: Pattern) -> Self {
        Self { surface: Surface::Procedural(pattern), emission: Vec3::ZERO }
    }

    /// A black material that glows.
    #[must_use]
    pub fn glowing(radiance: Vec3) -> Self {
        Self { surface: Surface::Uniform(Vec3::ZERO), emission: radiance }
    }
}

impl Surface {
    /// Memory of the texture, bytes; 0 without one.
    pub(crate) fn memory_bytes(&self) -> usize {
        match self {
            Self::Textured(texture, _) => size_of_val(texture.image.texels()),
            Self::Uniform(_) | Self::Procedural(_) => 0,
        }
    }

    /// Base colour at a texture coordinate, linear RGB.
    #[must_use]
    pub fn color(&self, uv: Vec2) -> Vec3 {
        match self {
            Self::Uniform(color) => *color,
            Self::Textured(texture, factor) => texture.sample(uv) * *factor,
            Self::Procedural(pattern) => pattern.color(uv),
        }
    }
}

impl Texture {
    /// Bilinear sample, repeating in both directions. Coordinates that are not finite give the first texel.
    #[must_use]
    pub fn sample(&self, uv: Vec2) -> Vec3 {
        let size = UVec2::new(self.image.width(), self.image.height());
        let wrapped = uv - uv.floor();
        let position = if wrapped.is_finite() { wrapped * size.as_vec2() - 0.5 } else { Vec2::ZERO };
        let base = position.floor();
        let fraction = position - base;
        let low = UVec2::new(wrap(base.x, size.x), wrap(base.y, size.y));
        let high = (low + 1) % size;
        let texel = |x: u32, y: u32| Vec3::from(self.image.get(x, y).map(|byte| LINEAR[usize::from(byte)]));
        let row = |y: u32| texel(low.x, y).lerp(texel(high.x, y), fraction.x);
        row(low.y).lerp(row(high.y), fraction.y)
    }
}

/// An index in −1 … size brought into 0 … size − 1.
fn wrap(index: f32, size: u32) -> u32 {
    if index < 0.0 { size - 1 } else { (index as u32) % size }
}

impl Pattern {
    fn color(self, uv: Vec2) -> Vec3 {
        let pick = |colors: [Vec3; 2], x: f32| colors[usize::from(x.rem_euclid(2.0) >= 1.0)];
        match self {
            Self::Checker(colors) => pick(colors, uv.x.floor() + uv.y.floor()),
            Self::Stripes(colors, count) => pick(colors, (uv.x + uv.y) * count),
            Self::Rings(colors, count) => pick(colors, (uv - 0.5).length() * 2.0 * count),
            Self::Fields(colors, count) => {
                let scaled = uv * count;
                let inside = scaled - scaled.floor();
                if inside.min_element() < 0.08 {
                    return Vec3::splat(0.02);
                }
                let field = scaled.floor();
                colors[(3.0 * field.x + 5.0 * field.y + (field.x * field.y)).rem_euclid(4.0) as usize]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textures_repeat_and_interpolate() {
        let texels = vec![[0; 3], [255; 3], [255; 3], [0; 3]];
        let texture = Texture { image: Image::new(2, 2, texels).unwrap() };
        assert_eq!(texture.sample(Vec2::new(0.25, 0.25)), Vec3::ZERO);
        assert_eq!(texture.sample(Vec2::new(0.75, 0.25)), Vec3::ONE);
        assert_eq!(texture.sample(Vec2::new(0.5, 0.25)), Vec3::splat(0.5));
        assert_eq!(texture.sample(Vec2::new(-0.75, 5.25)), Vec3::ZERO);
        assert_eq!(texture.sample(Vec2::new(0.0, 0.25)), Vec3::splat(0.5));
        assert!(texture.sample(Vec2::NAN).is_finite());
    }

    #[test]
    fn patterns_have_their_colours() {
        let checker = Pattern::Checker([Vec3::ZERO, Vec3::ONE]);
        assert_eq!(checker.color(Vec2::new(0.5, 0.5)), Vec3::ZERO);
        assert_eq!(checker.color(Vec2::new(1.5, 0.5)), Vec3::ONE);
        assert_eq!(checker.color(Vec2::new(-0.5, 0.5)), Vec3::ONE);
        assert_eq!(Pattern::Rings([Vec3::X, Vec3::Y], 4.0).color(Vec2::splat(0.5)), Vec3::X);
    }
}

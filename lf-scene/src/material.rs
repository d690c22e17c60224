//! What surfaces look like: base colour and emission from constants, pictures or patterns, and how light is scattered.

use std::sync::{Arc, LazyLock};

use glam::{DVec3, UVec2, Vec2, Vec3, Vec4};
use lf_math::{Image, linear_from_srgb};

/// The linear value of each 8-bit sRGB value.
static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear_from_srgb(byte as f32 / 255.0)));

/// What a surface looks like.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Base colour: the albedo of diffuse surfaces, the colour of metals, mirrors and glass.
    pub base: Surface,
    /// How light is scattered, on both sides.
    pub scattering: Scattering,
    /// Emitted radiance, linear RGB, in W/(m²·sr).
    pub emission: Surface,
    /// Whether the back emits too.
    pub double_sided: bool,
    /// Rays pass where the base colour's alpha is below this.
    pub alpha_cutoff: Option<f32>,
}

/// How a surface scatters light. Roughness is perceptual: GGX's α is its square.
#[derive(Debug, Clone, PartialEq)]
pub enum Scattering {
    /// Lambert's law.
    Diffuse,
    /// glTF 2.0's metallic-roughness model (its Appendix B): GGX over Lambert.
    MetallicRoughness {
        /// 0 is a dielectric, 1 a metal.
        metallic: f32,
        /// 0 is smooth, 1 rough.
        roughness: f32,
        /// Factors of both over texture coordinates: roughness in green, metallic in blue, linear.
        texture: Option<Arc<Texture>>,
    },
    /// Reflects everything, times the base colour.
    Mirror,
    /// Clear and smooth: reflects and lets through by Fresnel's equations; what passes is multiplied by the base colour.
    Glass {
        /// Index of refraction, more than 1.
        ior: f32,
        /// A pane without thickness, which does not bend rays; else the surface of a solid that the normal points out of.
        thin: bool,
    },
}

/// A colour over texture coordinates.
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
    /// RGBA texels; the first row is v = 0, as in glTF. Alpha is linear.
    pub image: Image<[u8; 4]>,
    /// How the colour channels are stored.
    pub encoding: ColorEncoding,
}

/// How 8-bit colour channels stand for amounts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ColorEncoding {
    /// By sRGB's transfer function.
    Srgb,
    /// In proportion.
    Linear,
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
    /// A diffuse material.
    #[must_use]
    pub fn of(base: Surface) -> Self {
        let emission = Surface::Uniform(Vec3::ZERO);
        Self { base, scattering: Scattering::Diffuse, emission, double_sided: false, alpha_cutoff: None }
    }

    /// A diffuse material of one colour.
    #[must_use]
    pub fn diffuse(color: Vec3) -> Self {
        Self::of(Surface::Uniform(color))
    }

    /// A diffuse material with a pattern.
    #[must_use]
    pub fn patterned(pattern: Pattern) -> Self {
        Self::of(Surface::Procedural(pattern))
    }

    /// A black material that glows on both sides.
    #[must_use]
    pub fn glowing(radiance: Vec3) -> Self {
        Self { emission: Surface::Uniform(radiance), double_sided: true, ..Self::diffuse(Vec3::ZERO) }
    }

    /// A perfect mirror of one colour.
    #[must_use]
    pub fn mirror(color: Vec3) -> Self {
        Self { scattering: Scattering::Mirror, ..Self::diffuse(color) }
    }

    /// Whether rays pass at a texture coordinate.
    pub(crate) fn is_hole(&self, uv: Vec2) -> bool {
        self.alpha_cutoff.is_some_and(|cutoff| self.base.alpha(uv) < cutoff)
    }

    /// Memory of the textures, bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        let scattering = match &self.scattering {
            Scattering::MetallicRoughness { texture: Some(texture), .. } => texture.memory_bytes(),
            _ => 0,
        };
        self.base.memory_bytes() + self.emission.memory_bytes() + scattering
    }
}

impl Surface {
    /// Memory of the texture, bytes; 0 without one.
    pub(crate) fn memory_bytes(&self) -> usize {
        match self {
            Self::Textured(texture, _) => texture.memory_bytes(),
            Self::Uniform(_) | Self::Procedural(_) => 0,
        }
    }

    /// Base colour at a texture coordinate, linear RGB.
    #[must_use]
    pub fn color(&self, uv: Vec2) -> Vec3 {
        match self {
            Self::Uniform(color) => *color,
            Self::Textured(texture, factor) => texture.sample(uv).truncate() * *factor,
            Self::Procedural(pattern) => pattern.color(uv),
        }
    }

    /// The mean colour of a picture or of a pattern's palette: positive if the colour is anywhere.
    pub(crate) fn mean(&self) -> Vec3 {
        let mean = |colors: &[Vec3]| colors.iter().sum::<Vec3>() / colors.len() as f32;
        match self {
            Self::Uniform(color) => *color,
            Self::Textured(texture, factor) => texture.mean() * *factor,
            Self::Procedural(Pattern::Fields(colors, _)) => mean(colors),
            Self::Procedural(Pattern::Checker(pair) | Pattern::Stripes(pair, _) | Pattern::Rings(pair, _)) => {
                mean(pair)
            }
        }
    }

    /// Alpha at a texture coordinate; 1 without a picture.
    #[must_use]
    pub fn alpha(&self, uv: Vec2) -> f32 {
        match self {
            Self::Textured(texture, _) => texture.sample(uv).w,
            Self::Uniform(_) | Self::Procedural(_) => 1.0,
        }
    }
}

impl Texture {
    /// Memory of the texels, bytes.
    fn memory_bytes(&self) -> usize {
        size_of_val(self.image.texels())
    }

    /// Mean of linear RGB.
    pub(crate) fn mean(&self) -> Vec3 {
        let texels = self.image.texels();
        let sum: DVec3 = texels.iter().map(|texel| self.linear(*texel).truncate().as_dvec3()).sum();
        (sum / texels.len() as f64).as_vec3()
    }

    /// Bilinear sample of linear RGB and alpha, repeating in both directions. Coordinates that are not finite give the first texel.
    #[must_use]
    pub fn sample(&self, uv: Vec2) -> Vec4 {
        let size = UVec2::new(self.image.width(), self.image.height());
        let wrapped = uv - uv.floor();
        let position = if wrapped.is_finite() { wrapped * size.as_vec2() - 0.5 } else { Vec2::ZERO };
        let base = position.floor();
        let fraction = position - base;
        let low = UVec2::new(wrap(base.x, size.x), wrap(base.y, size.y));
        let high = (low + 1) % size;
        let texel = |x: u32, y: u32| self.linear(self.image.get(x, y));
        let row = |y: u32| texel(low.x, y).lerp(texel(high.x, y), fraction.x);
        row(low.y).lerp(row(high.y), fraction.y)
    }

    fn linear(&self, [r, g, b, a]: [u8; 4]) -> Vec4 {
        let unit = |byte: u8| f32::from(byte) / 255.0;
        let color = match self.encoding {
            ColorEncoding::Srgb => [r, g, b].map(|byte| LINEAR[usize::from(byte)]),
            ColorEncoding::Linear => [r, g, b].map(unit),
        };
        Vec3::from(color).extend(unit(a))
    }
}

/// Luminance of linear RGB (Rec. 709).
pub(crate) fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
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
        let texels = vec![[0; 4], [255; 4], [255; 4], [0; 4]];
        let texture = Texture { image: Image::new(2, 2, texels).unwrap(), encoding: ColorEncoding::Srgb };
        assert_eq!(texture.sample(Vec2::new(0.25, 0.25)), Vec4::ZERO);
        assert_eq!(texture.sample(Vec2::new(0.75, 0.25)), Vec4::ONE);
        assert_eq!(texture.sample(Vec2::new(0.5, 0.25)), Vec4::splat(0.5));
        assert_eq!(texture.sample(Vec2::new(-0.75, 5.25)), Vec4::ZERO);
        assert_eq!(texture.sample(Vec2::new(0.0, 0.25)), Vec4::splat(0.5));
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

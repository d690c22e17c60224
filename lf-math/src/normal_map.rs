//! Small-scale relief of a surface, from a picture of normals.

use glam::{Vec2, Vec3};

use crate::error::{GeometryError, positive};
use crate::{Image, normalized};

/// A tangent-space normal map that is laid on a mesh from all three axes at once, and so needs no texture coordinates.
///
/// A texel holds the normal of a relief (x, y, z) = 2·texel/255 − 1 with x to the right, y along the rows and z out of the surface.
/// Along each axis of the mesh's own space the map is projected with the other two axes, in cyclic order, as its own; the three
/// count by the fourth power of the normal's component. Their slopes make one surface gradient, by which the normal is bent
/// (Mikkelsen 2020, *Surface Gradient–Based Bump Mapping Framework*, JCGT 9(4)). There is no tangent frame that could degenerate, and
/// a bent normal always leaves the surface on the side of the given one. The map repeats; it is interpolated bilinearly, without
/// mip levels, so a map finer than the picture's pixels flickers.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalMap {
    texels: Image<[u8; 4]>,
    repeats: f32,
}

/// Slopes steeper than this component out of the surface allows, 87°, are cut off.
const LEAST_Z: f32 = 0.05;

impl NormalMap {
    /// A map of which `repeats` fit into a metre of the mesh's own space. Alpha is ignored.
    ///
    /// # Errors
    /// `repeats` must be finite and greater than 0.
    pub fn new(texels: Image<[u8; 4]>, repeats: f32) -> Result<Self, GeometryError> {
        positive("repeats of the normal map", repeats)?;
        Ok(Self { texels, repeats })
    }

    /// The texels.
    #[must_use]
    pub fn texels(&self) -> &Image<[u8; 4]> {
        &self.texels
    }

    /// How many maps fit into a metre of the mesh's own space.
    #[must_use]
    pub fn repeats(&self) -> f32 {
        self.repeats
    }

    /// The unit normal at a place of the mesh, bent by the map; both in the mesh's own space, metres.
    #[must_use]
    pub fn bend(&self, position: Vec3, unit_normal: Vec3) -> Vec3 {
        let squared = unit_normal * unit_normal;
        let weights = squared * squared / (squared * squared).element_sum();
        let mut gradient = Vec3::ZERO;
        for axis in 0..3 {
            let (across, along) = ((axis + 1) % 3, (axis + 2) % 3);
            let slope = weights[axis] * self.slope(self.repeats * Vec2::new(position[across], position[along]));
            gradient[across] += slope.x;
            gradient[along] += slope.y;
        }
        // What the gradient has along the normal does not turn it.
        let bent = unit_normal + gradient - unit_normal.dot(gradient) * unit_normal;
        normalized(bent).unwrap_or(unit_normal)
    }

    /// What the relief's normal leans to either side, per unit out of the surface. `place` counts in maps.
    fn slope(&self, place: Vec2) -> Vec2 {
        let size = Vec2::new(self.texels.width() as f32, self.texels.height() as f32);
        let position = (place - place.floor()) * size - 0.5;
        let (low, fraction) = (position.floor(), position - position.floor());
        let texel = |dx: i32, dy: i32| {
            let x = (low.x as i32 + dx).rem_euclid(self.texels.width() as i32);
            let y = (low.y as i32 + dy).rem_euclid(self.texels.height() as i32);
            let [r, g, b, _] = self.texels.get(x as u32, y as u32);
            Vec3::new(f32::from(r), f32::from(g), f32::from(b)) / 255.0
        };
        let row = |dy| texel(0, dy).lerp(texel(1, dy), fraction.x);
        let normal = 2.0 * row(0).lerp(row(1), fraction.y) - 1.0;
        normal.truncate() / normal.z.max(LEAST_Z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use proptest::prelude::*;

    fn uniform(texel: [u8; 4]) -> NormalMap {
        NormalMap::new(Image::filled(2, 2, texel), 3.0).unwrap()
    }

    #[test]
    fn repeats_are_checked() {
        assert!(NormalMap::new(Image::filled(1, 1, [0; 4]), 0.0).is_err());
        assert!(NormalMap::new(Image::filled(1, 1, [0; 4]), f32::INFINITY).is_err());
    }

    /// On a wall perpendicular to z the map's x is the mesh's x: the closed form of one tangent frame.
    #[test]
    fn on_a_wall_it_is_the_maps_own_normal() {
        let texel = [200, 90, 230, 255];
        let exact = Vec3::new(200.0, 90.0, 230.0) / 255.0 * 2.0 - 1.0;
        for side in [1.0, -1.0] {
            let bent = uniform(texel).bend(Vec3::new(0.3, 0.9, 5.0), Vec3::Z * side);
            assert!((bent - (exact * Vec3::new(1.0, 1.0, side)).normalize()).length() < 1e-6, "{bent}");
        }
    }

    /// Bilinear between texel centres, across the seam of two maps.
    #[test]
    fn it_repeats_without_a_seam() {
        let texels = vec![[255, 128, 200, 255], [100, 128, 200, 255]];
        let map = NormalMap::new(Image::new(2, 1, texels).unwrap(), 1.0).unwrap();
        let red = |x: f32| {
            let slope = map.slope(Vec2::new(x, 0.2));
            (slope.x * (2.0 * 200.0 / 255.0 - 1.0) + 1.0) * 127.5
        };
        for (x, exact) in [(0.25, 255.0), (0.75, 100.0), (0.0, 177.5), (1.0, 177.5), (-0.25, 100.0), (7.25, 255.0)] {
            assert!((red(x) - exact).abs() < 1e-3, "{x}: {}", red(x));
        }
    }

    proptest! {
        #[test]
        fn bent_normals_stay_on_their_side(
            n in prop::array::uniform3(-1.0f32..1.0), p in prop::array::uniform3(-9.0f32..9.0), t in prop::array::uniform4(0u8..)
        ) {
            let normal = normalized(Vec3::from(n));
            prop_assume!(normal.is_some());
            let normal = normal.unwrap();
            let bent = uniform(t).bend(Vec3::from(p), normal);
            prop_assert!((bent.length() - 1.0).abs() < 1e-5 && bent.dot(normal) > 0.0, "{bent}");
        }
    }
}

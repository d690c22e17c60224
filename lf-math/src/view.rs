//! What a frame from slabs shows of its rays: their colours, or how they were answered.

use glam::{Vec2, Vec3};

use crate::{Face, IndexedRay, LightFieldGeometry};

/// What is painted where a ray asks the slabs. All but the first are for looking into the method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum View {
    /// The light along the ray.
    #[default]
    Color,
    /// Half of it, and half the colour of the slab that answers (Fig. 7d of the paper): [`View::face_color`].
    Slabs,
    /// The light along the ray, and [`View::OUTSIDE`] where the ray lies outside the slabs' 4D range, so that the nearest
    /// samples would be smeared there, or no slab serves it.
    Range,
    /// The indices (s′, t′, u′, v′), the camera in red and green, the texel in blue (after Fig. 5c of the paper):
    /// [`View::stuv_color`].
    Stuv,
}

impl View {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Color, Self::Slabs, Self::Range, Self::Stuv];
    /// What rays outside are painted with.
    pub const OUTSIDE: Vec3 = Vec3::new(1.0, 0.0, 1.0);

    /// The colour of a slab's face: red, green and blue towards +X, +Y and +Z, their complements on the other side.
    #[must_use]
    pub fn face_color(face: Face) -> Vec3 {
        let mut towards = [0.0; 3];
        towards[face.axis()] = 1.0;
        if face.sign() > 0.0 { Vec3::from(towards) } else { 1.0 - Vec3::from(towards) }
    }

    /// Shares of the last camera along s and t in red and green, the mean of those of the last texel along u and v in blue.
    #[must_use]
    pub fn stuv_color(geometry: &LightFieldGeometry, ray: &IndexedRay) -> Vec3 {
        let slab = &geometry.slabs()[ray.slab];
        let share = |index: Vec2, axes: [crate::SampledAxis; 2]| {
            let last = Vec2::from(axes.map(|axis| axis.last_index()));
            (index / last.max(Vec2::ONE)).clamp(Vec2::ZERO, Vec2::ONE)
        };
        let (st, uv) = (share(ray.coord.st, slab.st()), share(ray.coord.uv, slab.uv()));
        st.extend(0.5 * (uv.x + uv.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, PlanePlacement, Ray};
    use glam::DVec3;

    #[test]
    fn faces_have_six_colors() {
        let colors = Face::ALL.map(View::face_color);
        assert_eq!((colors[0], colors[3]), (Vec3::X, Vec3::new(1.0, 0.0, 1.0)));
        for (i, a) in colors.iter().enumerate() {
            assert!(colors[..i].iter().all(|b| a != b));
        }
    }

    #[test]
    fn the_middle_ray_is_grey_and_corners_are_not() {
        let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
        let geometry = LightFieldGeometry::around(cell, PlanePlacement::CellFaces, 4, 8).unwrap();
        let color =
            |origin, direction| View::stuv_color(&geometry, &geometry.index_ray(&Ray { origin, direction }).unwrap());
        assert!((color(Vec3::ZERO, Vec3::Z) - 0.5).abs().max_element() < 1e-6);
        let corner = color(Vec3::new(0.5, -0.5, -0.5), Vec3::new(1.0, -1.0, 1.0) * Vec3::new(0.999, 0.999, 1.0));
        assert!((corner - Vec3::new(1.0, 0.0, 0.5)).abs().max_element() < 2e-3, "{corner}");
    }
}

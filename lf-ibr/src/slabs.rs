//! Reflections from light field slabs.

use std::ops::Range;

use glam::{Vec2, Vec3};
use lf_math::{CameraTap, GeometryError, ImageWindow, LightFieldGeometry, Ray, SlabTexels, View};

use crate::bilinear::bilinear;
use crate::frame::{Environment, decoded};
use crate::texel::Texel;

/// Slabs with their decoded texels, whole or cropped: 8-bit ones by default, or linear half floats.
#[derive(Debug, Clone)]
pub struct SlabField<T = [u8; 4]> {
    geometry: LightFieldGeometry,
    texels: Vec<SlabTexels<T>>,
}

impl<T: Texel> SlabField<T> {
    /// A light field with the texels of each of its slabs.
    ///
    /// # Errors
    /// There must be texels for every slab, with its numbers of cameras and texels.
    pub fn new(geometry: LightFieldGeometry, texels: Vec<SlabTexels<T>>) -> Result<Self, GeometryError> {
        if texels.len() != geometry.slabs().len() {
            let expected = geometry.slabs().len();
            return Err(GeometryError::Length { what: "slab texels", len: texels.len(), expected });
        }
        for (slab, texels) in geometry.slabs().iter().zip(&texels) {
            texels.check(slab)?;
        }
        Ok(Self { geometry, texels })
    }

    /// The cell and the slabs.
    #[must_use]
    pub fn geometry(&self) -> &LightFieldGeometry {
        &self.geometry
    }

    /// The field as a view of it shows it.
    #[must_use]
    pub fn viewed(&self, view: View) -> ViewedSlabs<'_, T> {
        ViewedSlabs { field: self, view }
    }

    /// The interpolated texel value of a ray; `None` where no slab or no camera answers.
    ///
    /// Fig. 8 of the paper: four cameras, a bilinear fetch from each, blended by the ray's place between them. Rays
    /// outside the slab's range or the windows of its images are answered by the nearest samples that there are. Cameras
    /// that are left out are made up for by the others.
    fn value(&self, ray: &Ray) -> Option<Vec3> {
        let indexed = self.geometry.index_ray(ray)?;
        let (slab, texels) = (&self.geometry.slabs()[indexed.slab], &self.texels[indexed.slab]);
        let (mut sum, mut found, mut lost) = (Vec3::ZERO, 0.0, 0.0);
        for tap in slab.taps(&indexed.coord) {
            match texels.image(tap.camera) {
                Some(image) => {
                    sum += tap.weight * fetch(&image, &tap);
                    found += tap.weight;
                }
                None => lost += tap.weight,
            }
        }
        if lost > 0.0 {
            sum /= found;
        }
        (found > 0.0).then_some(sum)
    }
}

impl<T: Texel> Environment for SlabField<T> {
    fn look_up(&self, ray: &Ray) -> Option<Vec3> {
        self.value(ray).map(T::color)
    }

    fn radiance(&self, ray: &Ray) -> Option<Vec3> {
        self.value(ray).map(T::radiance)
    }
}

/// What a [`View`] paints where a ray asks a field.
#[derive(Debug, Clone, Copy)]
pub struct ViewedSlabs<'a, T = [u8; 4]> {
    field: &'a SlabField<T>,
    view: View,
}

impl<T: Texel> Environment for ViewedSlabs<'_, T> {
    fn look_up(&self, ray: &Ray) -> Option<Vec3> {
        let geometry = &self.field.geometry;
        let indexed = geometry.index_ray(ray);
        let slab = indexed.map(|indexed| &geometry.slabs()[indexed.slab]);
        let color = || self.field.look_up(ray);
        match self.view {
            View::Color => color(),
            View::Slabs => slab.map(|slab| 0.5 * (color().unwrap_or(Vec3::ZERO) + View::face_color(slab.face()))),
            View::Range if indexed.zip(slab).is_some_and(|(ray, slab)| slab.contains(&ray.coord)) => color(),
            View::Range => Some(View::OUTSIDE),
            View::Stuv => indexed.map(|indexed| View::stuv_color(geometry, &indexed)),
        }
    }

    fn radiance(&self, ray: &Ray) -> Option<Vec3> {
        if self.view == View::Color { self.field.radiance(ray) } else { self.look_up(ray).map(decoded) }
    }
}

/// Bilinear fetch from one camera's image, at a place of the whole image; `None` outside its window.
pub(crate) fn fetch_within<T: Texel>(image: &ImageWindow<'_, T>, uv: Vec2) -> Option<Vec3> {
    let inside = |at: f32, window: &Range<u32>| at >= window.start as f32 && at <= (window.end - 1) as f32;
    let tap = CameraTap { uv, ..CameraTap::default() };
    (inside(uv.x, &image.u) && inside(uv.y, &image.v)).then(|| fetch(image, &tap))
}

/// Bilinear fetch from one camera's image, at the nearest place of its window.
pub(crate) fn fetch<T: Texel>(image: &ImageWindow<'_, T>, tap: &CameraTap) -> Vec3 {
    let (width, height) = (image.u.len(), image.v.len());
    let first = Vec2::new(image.u.start as f32, image.v.start as f32);
    let last = Vec2::new((width - 1) as f32, (height - 1) as f32);
    // Indices are integers below 2¹⁶ and so is the difference of two: nothing is rounded that was not before.
    let place = tap.uv.clamp(first, first + last) - first;
    // A neighbour past the edge weighs nothing.
    bilinear(place, |x, y| image.texels[y.min(height - 1) * width + x.min(width - 1)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use lf_math::{Cell, PlanePlacement};
    use proptest::prelude::*;

    /// A field whose texel values are affine in all four indices, so that interpolation is exact.
    fn affine_field() -> SlabField {
        let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
        let geometry = LightFieldGeometry::around(cell, PlanePlacement::CellFaces, 5, 9).unwrap();
        let texels = |slab: &lf_math::Slab| {
            let mut all = Vec::new();
            for (t, s) in (0..5u8).flat_map(|t| (0..5u8).map(move |s| (t, s))) {
                for (v, u) in (0..9u8).flat_map(|v| (0..9u8).map(move |u| (v, u))) {
                    all.push([10 * s + 5 * u, 10 * t + 5 * v, 20 * slab.face().index(), 255]);
                }
            }
            SlabTexels::new(slab, all).unwrap()
        };
        let texels = geometry.slabs().iter().map(texels).collect();
        SlabField::new(geometry, texels).unwrap()
    }

    #[test]
    fn directions_without_a_face_have_no_answer() {
        let field = affine_field();
        assert_eq!(field.look_up(&Ray { origin: Vec3::ZERO, direction: Vec3::ZERO }), None);
        assert_eq!(field.look_up(&Ray { origin: Vec3::ZERO, direction: Vec3::NAN }), None);
    }

    #[test]
    fn texels_of_another_shape_are_refused() {
        let field = affine_field();
        let mut texels = field.texels.clone();
        texels.pop();
        assert!(SlabField::new(field.geometry.clone(), texels).is_err());
        let coarse = LightFieldGeometry::around(*field.geometry.cell(), PlanePlacement::CellFaces, 4, 9).unwrap();
        assert!(SlabField::new(coarse, field.texels).is_err());
    }

    proptest! {
        /// Quadrilinear interpolation reproduces affine functions of (s′, t′, u′, v′).
        #[test]
        fn interpolation_is_exact_on_affine_fields(
            o in prop::array::uniform3(-0.5f32..0.5), d in prop::array::uniform3(-1.0f32..1.0)
        ) {
            let ray = Ray { origin: Vec3::from(o), direction: Vec3::from(d) };
            prop_assume!(ray.direction.abs().max_element() > 1e-3);
            let field = affine_field();
            let indexed = field.geometry.index_ray(&ray).unwrap();
            let (st, uv) = (indexed.coord.st, indexed.coord.uv);
            let expected = (10.0 * st + 5.0 * uv).extend(20.0 * indexed.slab as f32) / 255.0;
            let found = field.look_up(&ray).unwrap();
            prop_assert!((found - expected).abs().max_element() < 1e-5, "{found} {expected}");
        }
    }
}

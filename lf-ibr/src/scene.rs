//! Whole frames: any number of reflectors that hide each other, and what is behind them.
//!
//! Cost is that of [`crate::reflect_frame`] for the pixels covered, and one look-up for each pixel of the background. Twin of
//! `SlabRenderer` in lf-gpu. Reflectors do not show each other.

use glam::Vec3;
use lf_math::{
    GeometryError, Image, NormalMap, Pinhole, Placement, Reflectance, TriangleMesh, length, srgb_from_linear,
};
use rayon::prelude::*;

use crate::frame::{Environment, encode};
use crate::gbuffer::{Fragment, GBuffer};

/// A mirror in a frame.
#[derive(Debug, Clone, Copy)]
pub struct Reflector<'a> {
    /// Its mesh, in a space of its own.
    pub mesh: &'a TriangleMesh,
    /// Where it stands.
    pub placement: Placement,
    /// How much it reflects.
    pub reflectance: Reflectance,
    /// What bends its normals.
    pub normal_map: Option<&'a NormalMap>,
}

impl Reflector<'_> {
    /// The unit normal at a fragment of it, cell space.
    fn normal(&self, fragment: &Fragment) -> Vec3 {
        let smooth = fragment.unit_normal();
        let Some(map) = self.normal_map else { return smooth };
        let position = self.placement.mesh_point(fragment.position);
        self.placement.direction(map.bend(position, self.placement.mesh_direction(smooth)))
    }
}

/// Draws reflectors as `camera` sees them, on all threads, and with `background` also the environment behind them (§6 of the
/// paper).
///
/// Pixels where nothing is drawn are transparent black (0, 0, 0, 0); the others are opaque, black where the environment has no
/// answer. Tints work on linear light ([`Environment::radiance`]); perfect mirrors show the environment's colours as they are.
///
/// # Errors
/// If a placed mesh is not finite.
pub fn draw_frame(
    reflectors: &[Reflector<'_>],
    background: bool,
    environment: &(impl Environment + ?Sized),
    camera: &Pinhole,
) -> Result<Image<[u8; 4]>, GeometryError> {
    let meshes =
        reflectors.iter().map(|mirror| mirror.mesh.placed(&mirror.placement)).collect::<Result<Vec<_>, _>>()?;
    let gbuffer = GBuffer::rasterize_all(&meshes, camera);
    let mut image = Image::filled(camera.width(), camera.height(), [0; 4]);
    let pixels = image.texels_mut().par_iter_mut().zip(gbuffer.fragments().texels());
    pixels.enumerate().for_each(|(index, (pixel, fragment))| {
        let color = match fragment {
            Some(fragment) => mirrored(fragment, camera.eye(), &reflectors[fragment.mesh as usize], environment),
            None if background => {
                let index = index as u32;
                environment.look_up(&camera.ray(index % camera.width(), index / camera.width()))
            }
            None => return,
        };
        *pixel = encode(color.unwrap_or(Vec3::ZERO).extend(1.0));
    });
    Ok(image)
}

/// The sRGB-encoded colour that a surface shows (Eqs. 2 to 6 of the paper).
fn mirrored(
    fragment: &Fragment,
    eye: Vec3,
    mirror: &Reflector<'_>,
    environment: &(impl Environment + ?Sized),
) -> Option<Vec3> {
    let normal = mirror.normal(fragment);
    let ray = fragment.reflected(eye, normal);
    if mirror.reflectance == Reflectance::MIRROR {
        return environment.look_up(&ray);
    }
    let shares = mirror.reflectance.at(ray.direction.dot(normal) / length(ray.direction));
    let light = shares * environment.radiance(&ray)?;
    Some(Vec3::from(light.to_array().map(srgb_from_linear)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;
    use lf_math::{Ray, srgb8_from_linear};

    /// Upwards bright, downwards dark, brighter than can be shown.
    struct Sky;

    const LIGHT: f32 = 2.0;

    impl Environment for Sky {
        fn look_up(&self, ray: &Ray) -> Option<Vec3> {
            self.radiance(ray).map(|light| Vec3::from(light.to_array().map(srgb_from_linear)))
        }

        fn radiance(&self, ray: &Ray) -> Option<Vec3> {
            Some(Vec3::splat(if ray.direction.y > 0.0 { LIGHT } else { 0.0 }))
        }
    }

    fn camera() -> Pinhole {
        Pinhole::look_at(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, 0.6, 64, 64).unwrap()
    }

    /// A square of 1 m, tilted by so much towards the sky.
    fn square(tilt: f32, z: f32, reflectance: Reflectance) -> (TriangleMesh, Placement, Reflectance) {
        let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let mesh = TriangleMesh::new(corners.to_vec(), vec![], vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        (mesh, Placement::new(1.0, Quat::from_rotation_x(-tilt), Vec3::Z * z).unwrap(), reflectance)
    }

    fn middle(squares: &[(TriangleMesh, Placement, Reflectance)], background: bool) -> [u8; 4] {
        let reflectors: Vec<_> = squares
            .iter()
            .map(|(mesh, placement, reflectance)| Reflector {
                mesh,
                placement: *placement,
                reflectance: *reflectance,
                normal_map: None,
            })
            .collect();
        draw_frame(&reflectors, background, &Sky, &camera()).unwrap().get(32, 31)
    }

    #[test]
    fn tints_and_fresnel_follow_their_formulas_before_light_is_clipped() {
        let tint = Vec3::new(0.4, 0.2, 0.0);
        for (tilt, f0) in [(0.3f32, None), (0.3, Some(0.04)), (1.3, Some(0.04)), (1.3, Some(0.5))] {
            let found = middle(&[square(tilt, 0.0, Reflectance::new(tint, f0).unwrap())], false);
            let away = (1.0 - tilt.cos()).powi(5);
            let share = f0.map_or(1.0, |f0| f0 + (1.0 - f0) * away);
            let expected = srgb8_from_linear(tint * share * LIGHT);
            // The pixel's ray is a hundredth of a radian off the middle.
            let near = (0..3).all(|c| found[c].abs_diff(expected[c]) <= 6);
            assert!(near && found[3] == 255, "{tilt} {f0:?}: {found:?} {expected:?}");
        }
    }

    #[test]
    fn the_nearer_reflector_is_seen_and_the_environment_behind() {
        let bright = square(0.3, 0.3, Reflectance::MIRROR);
        let dark = square(-0.3, -0.3, Reflectance::MIRROR);
        for order in [[&bright, &dark], [&dark, &bright]] {
            assert_eq!(middle(&order.map(Clone::clone), true), [255; 4]);
        }
        assert_eq!(middle(&[dark], true), [0, 0, 0, 255]);
        assert_eq!((middle(&[], true), middle(&[], false)), ([255; 4], [0; 4]));
    }
}

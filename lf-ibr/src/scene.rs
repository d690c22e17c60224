//! Whole frames: any number of reflectors that hide each other, and what is behind them.
//!
//! Cost is that of [`crate::reflect_frame`] for the pixels covered, and one look-up for each pixel of the background; the scene's own
//! triangles take the rasteriser's time instead. Twin of `SlabRenderer` in lf-gpu. Reflectors do not show each other.

use glam::Vec3;
use lf_math::{
    GeometryError, Image, LitMesh, NormalMap, Pinhole, Placement, Reflectance, TriangleMesh, length, near_plane,
};
use rayon::prelude::*;

use crate::frame::{Environment, encode, encoded};
use crate::gbuffer::{Fragment, GBuffer, LitBuffer};

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

/// What is behind the reflectors.
#[derive(Debug, Clone, Copy)]
pub enum Behind<'a> {
    /// Nothing: transparent black.
    Nothing,
    /// What the environment answers along the view rays (§6 of the paper).
    Environment,
    /// A scene's triangles, behind the reflectors and in front of them (§7 of the paper: "regular geometries"). Their linear light is
    /// interpolated, then encoded. Nothing is where they are not.
    Scene(&'a LitMesh),
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

/// Draws reflectors as `camera` sees them, on all threads, and what is behind them.
///
/// Pixels where nothing is drawn are transparent black (0, 0, 0, 0); the others are opaque, black where the environment has no
/// answer. Tints work on linear light ([`Environment::radiance`]); perfect mirrors show the environment's colours as they are.
///
/// # Errors
/// If a placed mesh is not finite.
pub fn draw_frame(
    reflectors: &[Reflector<'_>],
    behind: Behind<'_>,
    environment: &(impl Environment + ?Sized),
    camera: &Pinhole,
) -> Result<Image<[u8; 4]>, GeometryError> {
    let meshes =
        reflectors.iter().map(|mirror| mirror.mesh.placed(&mirror.placement)).collect::<Result<Vec<_>, _>>()?;
    let gbuffer = GBuffer::rasterize_all(&meshes, camera);
    let scene = if let Behind::Scene(scene) = behind { Some(drawn(scene, &meshes, camera)) } else { None };
    let mut image = Image::filled(camera.width(), camera.height(), [0; 4]);
    let pixels = image.texels_mut().par_iter_mut().zip(gbuffer.fragments().texels());
    pixels.enumerate().for_each(|(index, (pixel, fragment))| {
        let light = scene.as_ref().and_then(|scene| scene.before(index, gbuffer.inverse_depth(index)));
        let color = match (light, fragment, behind) {
            (Some(light), ..) => Some(encoded(light)),
            (None, Some(fragment), _) => {
                mirrored(fragment, camera.eye(), &reflectors[fragment.mesh as usize], environment)
            }
            (None, None, Behind::Environment) => {
                let index = index as u32;
                environment.look_up(&camera.ray(index % camera.width(), index / camera.width()))
            }
            (None, None, _) => return,
        };
        *pixel = encode(color.unwrap_or(Vec3::ZERO).extend(1.0));
    });
    Ok(image)
}

/// The scene beyond the near plane of what mirrors, or beyond its own where nothing does: it may be a thousand times as far.
fn drawn(scene: &LitMesh, mirrors: &[TriangleMesh], camera: &Pinhole) -> LitBuffer {
    let alone = Some(scene.bounds()).filter(|_| mirrors.is_empty());
    let near = near_plane(camera.eye(), mirrors.iter().map(TriangleMesh::bounds).chain(alone));
    LitBuffer::rasterize(scene, camera, near)
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
    Some(encoded(shares * environment.radiance(&ray)?))
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
            self.radiance(ray).map(encoded)
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

    fn middle(squares: &[(TriangleMesh, Placement, Reflectance)], behind: Behind<'_>) -> [u8; 4] {
        let reflectors: Vec<_> = squares
            .iter()
            .map(|(mesh, placement, reflectance)| Reflector {
                mesh,
                placement: *placement,
                reflectance: *reflectance,
                normal_map: None,
            })
            .collect();
        draw_frame(&reflectors, behind, &Sky, &camera()).unwrap().get(32, 31)
    }

    #[test]
    fn tints_and_fresnel_follow_their_formulas_before_light_is_clipped() {
        let tint = Vec3::new(0.4, 0.2, 0.0);
        for (tilt, f0) in [(0.3f32, None), (0.3, Some(0.04)), (1.3, Some(0.04)), (1.3, Some(0.5))] {
            let found = middle(&[square(tilt, 0.0, Reflectance::new(tint, f0).unwrap())], Behind::Nothing);
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
            assert_eq!(middle(&order.map(Clone::clone), Behind::Environment), [255; 4]);
        }
        assert_eq!(middle(&[dark], Behind::Environment), [0, 0, 0, 255]);
        assert_eq!((middle(&[], Behind::Environment), middle(&[], Behind::Nothing)), ([255; 4], [0; 4]));
    }

    /// A square of the scene at a depth, its light from 0 to 1 along x: in the middle a half, but for a fraction of a pixel.
    fn backdrop(z: f32) -> LitMesh {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, z));
        let light = corners.map(|corner| Vec3::splat(0.5 + 0.5 * corner.x));
        LitMesh::new(corners.to_vec(), light.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    }

    #[test]
    fn the_scene_and_the_reflectors_hide_each_other() {
        let dark = [square(-0.3, 0.0, Reflectance::MIRROR)];
        let (behind, before) = (backdrop(-0.5), backdrop(0.5));
        let [gray, ..] = srgb8_from_linear(Vec3::splat(0.5));
        let shows_light = |pixel: [u8; 4]| pixel[0].abs_diff(gray) <= 4 && pixel[3] == 255;
        assert_eq!(middle(&dark, Behind::Scene(&behind)), [0, 0, 0, 255]);
        assert!(shows_light(middle(&dark, Behind::Scene(&before))));
        assert!(shows_light(middle(&[], Behind::Scene(&behind))));
        // Behind the eye.
        assert_eq!(middle(&[], Behind::Scene(&backdrop(2.5))), [0; 4]);
    }
}

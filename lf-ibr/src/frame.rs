//! One frame of a reflector.

use glam::{Vec3, Vec4};
use lf_math::{Image, Ray, linear_from_srgb, normalized, reflect};
use rayon::prelude::*;

use crate::gbuffer::GBuffer;

/// Something that knows the light arriving along a ray.
pub trait Environment: Sync {
    /// The sRGB-encoded colour, 0 … 1, of the light that comes from where a cell-space ray leads. The direction may have
    /// any length. `None` where the environment holds no answer.
    fn look_up(&self, ray: &Ray) -> Option<Vec3>;

    /// The linear light along the same ray, not clipped where the environment knows better than 0 … 1.
    fn radiance(&self, ray: &Ray) -> Option<Vec3> {
        self.look_up(ray).map(decoded)
    }
}

/// The linear light of an sRGB-encoded colour.
pub(crate) fn decoded(color: Vec3) -> Vec3 {
    Vec3::from(color.to_array().map(linear_from_srgb))
}

/// Colours the pixels of a G-buffer by what they mirror (Eqs. 2 to 6 of the paper), on all threads.
///
/// Pixels without the reflector are transparent black (0, 0, 0, 0); the others are opaque, black where the environment
/// has no answer.
#[must_use]
pub fn reflect_frame(gbuffer: &GBuffer, environment: &(impl Environment + ?Sized)) -> Image<[u8; 4]> {
    let eye = gbuffer.eye();
    let mut image = Image::filled(gbuffer.fragments().width(), gbuffer.fragments().height(), [0; 4]);
    image.texels_mut().par_iter_mut().zip(gbuffer.fragments().texels()).for_each(|(pixel, fragment)| {
        let Some(fragment) = fragment else { return };
        let normal = normalized(fragment.normal).unwrap_or(Vec3::Y);
        let ray = Ray { origin: fragment.position, direction: reflect(fragment.position - eye, normal) };
        *pixel = encode(environment.look_up(&ray).unwrap_or(Vec3::ZERO).extend(1.0));
    });
    image
}

/// 8-bit values rounded to nearest, as a GPU writes an 8-bit target.
pub(crate) fn encode(color: Vec4) -> [u8; 4] {
    color.to_array().map(|c| (255.0 * c + 0.5) as u8)
}

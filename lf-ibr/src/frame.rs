//! One frame of a reflector.

use glam::{Vec3, Vec4};
use lf_math::{Image, Ray, linear_from_srgb, srgb_from_linear};
use rayon::prelude::*;

use crate::gbuffer::{Fragment, GBuffer};

/// Something that knows the light arriving along a ray.
pub trait Environment: Sync {
    /// The sRGB-encoded colour, 0 … 1, of the light that comes from where a cell-space ray leads. The direction may have
    /// any length. `None` where the environment holds no answer.
    fn look_up(&self, ray: &Ray) -> Option<Vec3>;

    /// The linear light along the same ray, not clipped where the environment knows better than 0 … 1.
    fn radiance(&self, ray: &Ray) -> Option<Vec3> {
        self.look_up(ray).map(decoded)
    }

    /// Answers many rays at once, which some environments do faster: of the shorter slice's length.
    fn look_up_all(&self, rays: &[Ray], answers: &mut [Option<Vec3>]) {
        for (ray, answer) in rays.iter().zip(answers) {
            *answer = self.look_up(ray);
        }
    }
}

/// The linear light of an sRGB-encoded colour.
pub(crate) fn decoded(color: Vec3) -> Vec3 {
    Vec3::from(color.to_array().map(linear_from_srgb))
}

/// The sRGB-encoded colour of light.
pub(crate) fn encoded(light: Vec3) -> Vec3 {
    Vec3::from(light.to_array().map(srgb_from_linear))
}

/// Colours the pixels of a G-buffer by what they mirror (Eqs. 2 to 6 of the paper), on all threads.
///
/// Pixels without the reflector are transparent black (0, 0, 0, 0); the others are opaque, black where the environment
/// has no answer.
#[must_use]
pub fn reflect_frame(gbuffer: &GBuffer, environment: &(impl Environment + ?Sized)) -> Image<[u8; 4]> {
    let eye = gbuffer.eye();
    let mut image = Image::filled(gbuffer.fragments().width(), gbuffer.fragments().height(), [0; 4]);
    let width = gbuffer.fragments().width() as usize;
    let rows = image.texels_mut().par_chunks_mut(width).zip(gbuffer.fragments().texels().par_chunks(width));
    rows.for_each(|(pixels, fragments)| reflect_row(eye, fragments, environment, pixels));
    image
}

/// The pixels of a row where the reflector is.
fn reflect_row(
    eye: Vec3,
    fragments: &[Option<Fragment>],
    environment: &(impl Environment + ?Sized),
    pixels: &mut [[u8; 4]],
) {
    let rays: Vec<Ray> = fragments.iter().flatten().map(|f| f.reflected(eye, f.unit_normal())).collect();
    let mut answers = vec![None; rays.len()];
    environment.look_up_all(&rays, &mut answers);
    let covered = pixels.iter_mut().zip(fragments).filter(|(_, fragment)| fragment.is_some());
    for ((pixel, _), answer) in covered.zip(answers) {
        *pixel = encode(answer.unwrap_or(Vec3::ZERO).extend(1.0));
    }
}

/// 8-bit values rounded to nearest, as a GPU writes an 8-bit target.
pub(crate) fn encode(color: Vec4) -> [u8; 4] {
    color.to_array().map(|c| (255.0 * c + 0.5) as u8)
}

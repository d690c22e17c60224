//! Pictures of a scene as one of its cameras sees it.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::Vec3;
use lf_math::{Image, Pinhole};
use rayon::prelude::*;

use crate::tracer::Tracer;

/// Traces one ray through the centre of each pixel, on all threads. The camera is in world space; the radiance is linear RGB.
///
/// `progress` is called with the number of rows that are done, from any thread.
#[must_use]
pub fn view(tracer: &Tracer, camera: &Pinhole, progress: &(dyn Fn(u64) + Sync)) -> Image<Vec3> {
    let width = camera.width();
    let mut image = Image::filled(width, camera.height(), Vec3::ZERO);
    let done = AtomicU64::new(0);
    image.texels_mut().par_chunks_mut(width as usize).enumerate().for_each(|(y, row)| {
        for (x, pixel) in (0..).zip(row) {
            let ray = camera.ray(x, y as u32);
            *pixel = tracer.trace(ray.origin, ray.direction).radiance;
        }
        progress(1 + done.fetch_add(1, Ordering::Relaxed));
    });
    image
}

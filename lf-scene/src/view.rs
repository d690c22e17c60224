//! Pictures of a scene as one of its cameras sees it.

use std::sync::atomic::{AtomicU64, Ordering};

use lf_math::{Image, Pinhole};
use rayon::prelude::*;

use crate::quality::Estimate;
use crate::tracer::Tracer;

/// Traces one ray through the centre of each pixel, on all threads. The camera is in world space; the radiance is linear RGB.
///
/// `progress` is called with the number of rows that are done, from any thread.
#[must_use]
pub fn view(tracer: &Tracer, camera: &Pinhole, progress: &(dyn Fn(u64) + Sync)) -> Image<Estimate> {
    let width = camera.width();
    let pixel = |x: u32, y: u32| {
        let ray = camera.ray(x, y);
        tracer.estimate(ray.origin, ray.direction)
    };
    let mut image = Image::filled(width, camera.height(), pixel(0, 0));
    let done = AtomicU64::new(0);
    image.texels_mut().par_chunks_mut(width as usize).zip(0..camera.height()).for_each(|(row, y)| {
        for (x, estimate) in (0..).zip(row) {
            *estimate = pixel(x, y);
        }
        progress(1 + done.fetch_add(1, Ordering::Relaxed));
    });
    image
}

//! What the samples of one ray are worth together, in soft light: the box of mirror spheres under its two glowing panels.

use glam::Vec3;
use lf_scene::{Illumination, Quality, Tracer, mirror_box};
use rayon::prelude::*;

/// Rays from the middle of the cell that end on the floor or on a wall, where light from the panels is looked for.
fn rays_to_floor_and_walls(tracer: &Tracer) -> Vec<(Vec3, Vec3)> {
    let eye = mirror_box::cell().center().as_vec3();
    let direction = |i: u32| {
        let (y, angle) = (1.0 - (2.0 * i as f32 + 1.0) / 5000.0, 2.399_963 * i as f32);
        let r = (1.0 - y * y).sqrt();
        Vec3::new(r * angle.cos(), y, r * angle.sin())
    };
    let ends_there = |direction: &Vec3| {
        let end = eye + *direction * tracer.distance(eye, *direction).expect("closed");
        end.y < 0.01 || (end.x.abs().max(end.z.abs()) > 2.99 && end.y < 2.9)
    };
    (0..5000).map(direction).filter(ends_there).map(|direction| (eye, direction)).collect()
}

/// Radiance along each ray.
fn seen(tracer: &mut Tracer, rays: &[(Vec3, Vec3)], samples: u32, seed: u64) -> Vec<Vec3> {
    tracer.set_quality(Quality { illumination: Illumination::Direct, samples, seed });
    rays.par_iter().map(|&(origin, direction)| tracer.trace(origin, direction).radiance).collect()
}

fn mean_squared_error(truth: &[Vec3], seen: &[Vec3]) -> f64 {
    let squares = truth.iter().zip(seen).map(|(a, b)| f64::from((*a - *b).length_squared()));
    squares.sum::<f64>() / truth.len() as f64
}

/// Samples of other seeds are independent. Of one seed, 4 are worth 10 of those, 16 are worth 84, here with margin.
#[test]
fn samples_of_one_ray_are_worth_several_times_as_many() {
    let mut tracer = Tracer::new(mirror_box::scene());
    let rays = rays_to_floor_and_walls(&tracer);
    assert!(rays.len() > 2500, "{}", rays.len());
    let truth = seen(&mut tracer, &rays, 1024, 1000);
    let independent = mean_squared_error(&truth, &seen(&mut tracer, &rays, 1, 0));
    for (samples, factor) in [(4, 2.0), (7, 2.1), (16, 4.2)] {
        let together = mean_squared_error(&truth, &seen(&mut tracer, &rays, samples, 0));
        let worth = independent / f64::from(samples) / together;
        assert!(worth > factor, "{samples} samples are worth {worth} times as many independent ones");
    }
    // And so are the seeds: the mean of four pictures of one sample.
    let four = [1, 2, 3, 4].map(|seed| seen(&mut tracer, &rays, 1, seed));
    let mean: Vec<_> = (0..rays.len()).map(|ray| four.iter().map(|picture| picture[ray]).sum::<Vec3>() / 4.0).collect();
    let ratio = independent / mean_squared_error(&truth, &mean);
    assert!((3.0..5.0).contains(&ratio), "{ratio}");
}

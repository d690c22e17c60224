//! What the method is for: two parallel rays from different places see different things.

use std::f32::consts::TAU;

use glam::Vec3;
use lf_ibr::{CubeField, Environment, SlabField};
use lf_math::{Ray, srgb_from_linear};
use lf_scene::{capture_cube, museum};
use lf_tests::{capture, museum};

/// Pairs of parallel rays, 0.6 m apart, around the horizon: columns stand before pictures there.
fn pairs() -> Vec<[Ray; 2]> {
    let ring = |i: u32| {
        let (sin, cos) = (TAU * i as f32 / 720.0).sin_cos();
        let aside = Vec3::new(-sin, 0.0, cos) * 0.3;
        let pair = move |rise: f32| [-aside, aside].map(|origin| Ray { origin, direction: Vec3::new(cos, rise, sin) });
        [-0.1, 0.0, 0.1, 0.2].map(pair)
    };
    (0..720).flat_map(ring).collect()
}

#[test]
fn slabs_follow_the_change_from_place_to_place_and_environment_maps_do_not() {
    let tracer = museum();
    let capture = capture(&tracer, 16, 48);
    let slabs = SlabField::new(capture.geometry, capture.texels).expect("a field");
    let cube = CubeField::new(&capture_cube(&tracer, &museum::cell(), 128, 1).expect("a cube map"));
    let traced = |ray: &Ray| {
        let seen = tracer.trace(museum::cell().world_from_cell(ray.origin).as_vec3(), ray.direction).radiance;
        Vec3::from(seen.to_array().map(srgb_from_linear))
    };
    let looked_up = |field: &dyn Environment, ray: &Ray| field.look_up(ray).expect("an answer");
    let (mut change, mut missed_by_slabs, mut change_in_map) = (0.0, 0.0, 0.0);
    for [a, b] in pairs() {
        let truth = traced(&a) - traced(&b);
        change += truth.length_squared();
        missed_by_slabs += (looked_up(&slabs, &a) - looked_up(&slabs, &b) - truth).length_squared();
        change_in_map += (looked_up(&cube, &a) - looked_up(&cube, &b)).length_squared();
    }
    println!("squared change {change:.1}, of which slabs miss {missed_by_slabs:.1}, change in the map {change_in_map}");
    assert!(change > 100.0, "the museum hardly changes: {change}");
    assert!(missed_by_slabs < 0.5 * change, "slabs miss {missed_by_slabs} of {change}");
    assert_eq!(change_in_map, 0.0);
}

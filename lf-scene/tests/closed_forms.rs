//! The tracer against what is known exactly, or by quadrature in `f64` of formulas written down here once more: within
//! three standard errors at 10⁵ samples, seeds being fixed.

mod oracle;

use std::f64::consts::PI;

use glam::{DVec3, Vec2, Vec3};
use lf_scene::{Illumination, Light, Material, Quality, Scene, SceneBuilder, Tracer, reflectors};
use oracle::{add_mesh, assert_agrees, dark, emitting, global, glossy, plate, room, uniform, with_samples};
use rayon::prelude::*;

const ALBEDO: Vec3 = Vec3::new(0.2, 0.5, 0.8);

fn build(builder: SceneBuilder, lights: Vec<Light>) -> Scene {
    builder.build("closed form", dark(lights)).unwrap()
}

/// Inside a closed body that emits E with albedo a, radiance is E·(1 + a + a² + …) everywhere, one term for each bounce.
#[test]
fn furnace() {
    let emission = Vec3::new(1.0, 0.5, 0.25);
    let mut cube = SceneBuilder::default();
    let wall = cube.material(emitting(emission, ALBEDO));
    room(&mut cube, 1.0, [wall; 6]);
    let mut ball = SceneBuilder::default();
    let wall = ball.material(emitting(emission, ALBEDO));
    add_mesh(&mut ball, &reflectors::sphere(2), true, true, wall);
    for (what, scene) in [("cube", build(cube, vec![])), ("ball", build(ball, vec![]))] {
        [0, 1, 2, 5, 64].into_par_iter().for_each(|bounces| {
            let tracer = global(scene.clone(), bounces);
            let (a, e) = (ALBEDO.as_dvec3(), emission.as_dvec3());
            let exact = e * (1.0 - a.powf(f64::from(bounces) + 1.0)) / (1.0 - a);
            for direction in [Vec3::new(0.3, -0.5, 0.2), Vec3::new(-0.9, 0.95, 1.0)] {
                let estimate = tracer.estimate(Vec3::new(0.2, 0.1, -0.3), direction);
                assert_agrees(&format!("{what}, {bounces} bounces"), &estimate, exact, 0.01);
            }
        });
    }
}

/// White things under uniform light cannot be told from it, whatever light goes to and fro between them.
#[test]
fn white_things_vanish_in_uniform_light() {
    let mut builder = SceneBuilder::default();
    let white = builder.material(Material::diffuse(Vec3::ONE));
    for x in [-1.1, 0.1] {
        builder.cuboid(Vec3::new(x, 0.0, 0.0), Vec3::new(x + 1.0, 1.0, 1.0), white);
    }
    let light = Vec3::new(0.7, 1.0, 1.3);
    let tracer = global(builder.build("white", uniform(light)).unwrap(), 1000);
    [Vec3::new(-0.1, 0.5, 0.6), Vec3::new(0.1, 0.2, 0.4), Vec3::new(-0.6, 1.0, 0.5)].into_par_iter().for_each(
        |target| {
            let eye = Vec3::new(0.0, 3.0, 4.0) * Vec3::new(-target.x.signum(), 1.0, 1.0);
            let estimate = tracer.estimate(eye, target - eye);
            assert_agrees("white", &estimate, light.as_dvec3(), 0.01);
        },
    );
}

/// Between endless plates of albedos a and b, the first of which emits E: the second has radiance bE/(1 − ab).
#[test]
fn parallel_plates() {
    let (a, b, e) = (0.6f32, 0.7f32, 2.0f32);
    let mut builder = SceneBuilder::default();
    let lamp = builder.material(emitting(Vec3::splat(e), Vec3::splat(a)));
    let grey = builder.material(Material::diffuse(Vec3::splat(b)));
    plate(&mut builder, 0.0, 1e4, true, lamp);
    plate(&mut builder, 1.0, 1e4, false, grey);
    let tracer = global(build(builder, vec![]), 200);
    let (a, b, e) = (f64::from(a), f64::from(b), f64::from(e));
    for direction in [Vec3::Y, Vec3::new(3.0, 1.0, -2.0)] {
        let estimate = tracer.estimate(Vec3::new(0.0, 0.5, 0.0), direction);
        assert_agrees("upper plate", &estimate, DVec3::splat(b * e / (1.0 - a * b)), 0.01);
        let estimate = tracer.estimate(Vec3::new(0.0, 0.5, 0.0), -direction);
        assert_agrees("lower plate", &estimate, DVec3::splat(e / (1.0 - a * b)), 0.01);
    }
}

/// An integrating sphere: what one patch of it emits arrives evenly everywhere, E·f·a/(1 − a), f being the patch's share of
/// the area. The sphere is a mesh of 20 480 triangles with the sphere's normals.
#[test]
fn integrating_sphere() {
    let mesh = reflectors::sphere(5);
    let mut builder = SceneBuilder::default();
    let white = builder.material(Material::diffuse(ALBEDO));
    let lamp = builder.material(emitting(Vec3::splat(10.0), ALBEDO));
    let (mut lit, mut all) = (0.0, 0.0);
    for &triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|i| mesh.positions()[i as usize]);
        let double_area = f64::from((c - a).cross(b - a).length());
        let shines = a.y > 0.8;
        all += double_area;
        lit += if shines { double_area } else { 0.0 };
        let corner = |position: Vec3| lf_scene::Vertex { position, normal: -position, uv: Vec2::ZERO };
        builder.triangle([corner(a), corner(c), corner(b)], if shines { lamp } else { white });
    }
    let a = ALBEDO.as_dvec3();
    let tracer = global(build(builder, vec![]), 200);
    [Vec3::NEG_Y, Vec3::new(1.0, -0.3, 0.2), Vec3::new(-0.5, 0.1, 0.6)].into_par_iter().for_each(|direction| {
        let estimate = tracer.estimate(Vec3::new(0.1, 0.2, 0.0), direction);
        assert_agrees("integrating sphere", &estimate, 10.0 * lit / all * a / (1.0 - a), 0.01);
    });
}

/// Lights without extent over a plane; nothing is random, in both kinds of illumination.
#[test]
fn point_spot_and_sun_over_a_plane() {
    let intensity = Vec3::new(3.0, 5.0, 7.0);
    let sun = Vec3::new(0.48, 0.6, 0.64);
    let (position, direction) = (Vec3::new(0.5, 2.0, -0.25), Vec3::new(0.6, -0.8, 0.0));
    let (inner, outer) = (0.2, 0.5);
    let lights = [
        Light::Point { position, intensity },
        Light::Spot { position, direction, intensity, inner, outer },
        Light::Sun { towards: sun, irradiance: intensity },
    ];
    for (number, light) in lights.into_iter().enumerate() {
        for x in [-1.0f32, 0.0, 1.5, 2.0, 2.5] {
            let to = (position - Vec3::new(x, 0.0, 0.3)).as_dvec3();
            let by_distance = to.y / to.length().powi(3);
            let angle = (-to.normalize().dot(direction.as_dvec3())).acos();
            let (full, none) = (f64::from(inner).cos(), f64::from(outer).cos());
            let cone = ((angle.cos() - none) / (full - none)).clamp(0.0, 1.0).powi(2);
            let factor = [by_distance, by_distance * cone, f64::from(sun.y)][number];
            let exact = ALBEDO.as_dvec3() / PI * intensity.as_dvec3() * factor;
            for illumination in [Illumination::Direct, Illumination::Global { max_bounces: 4 }] {
                let mut builder = SceneBuilder::default();
                let floor = builder.material(Material::diffuse(ALBEDO));
                plate(&mut builder, 0.0, 10.0, true, floor);
                let quality = Quality { illumination, samples: 2, seed: 0 };
                let tracer = Tracer::new(build(builder, vec![light])).with_quality(quality);
                let estimate = tracer.estimate(Vec3::new(x, 1.0, 0.3), Vec3::NEG_Y);
                assert_agrees(&format!("light {number} at {x}"), &estimate, exact, 1e-9);
            }
        }
    }
}

/// Irradiance at a point from a polygon of radiance 1 that lies wholly above the surface (Lambert's formula).
fn polygon_irradiance(point: DVec3, normal: DVec3, corners: &[DVec3]) -> f64 {
    let unit: Vec<_> = corners.iter().map(|c| (c - point).normalize()).collect();
    let edge = |i: usize| {
        let (a, b) = (unit[i], unit[(i + 1) % unit.len()]);
        a.angle_between(b) * normal.dot(a.cross(b).normalize())
    };
    0.5 * (0..unit.len()).map(edge).sum::<f64>().abs()
}

const LAMP: [Vec3; 4] =
    [Vec3::new(-0.5, 1.0, -1.0), Vec3::new(0.75, 1.25, -1.0), Vec3::new(0.75, 1.25, 1.0), Vec3::new(-0.5, 1.0, 1.0)];

/// A floor under a tilted rectangular lamp that shines down.
fn lamp_over(floor: Material) -> Scene {
    let mut builder = SceneBuilder::default();
    let floor = builder.material(floor);
    let lamp = builder.material(emitting(Vec3::new(4.0, 5.0, 6.0), Vec3::ZERO));
    plate(&mut builder, 0.0, 10.0, true, floor);
    let [a, b, _, d] = LAMP;
    builder.parallelogram(a, b - a, d - a, Vec2::ONE, lamp);
    build(builder, vec![])
}

#[test]
fn rectangular_lamp_over_a_plane() {
    let scene = lamp_over(Material::diffuse(ALBEDO));
    let corners = LAMP.map(Vec3::as_dvec3);
    let tracers = [
        global(scene.clone(), 1),
        Tracer::new(scene).with_quality(Quality {
            illumination: Illumination::Direct,
            samples: oracle::SAMPLES,
            seed: 3,
        }),
    ];
    for point in [Vec3::ZERO, Vec3::new(0.6, 0.0, -0.9), Vec3::new(-2.0, 0.0, 1.0), Vec3::new(5.0, 0.0, 5.0)] {
        let exact = polygon_irradiance(point.as_dvec3(), DVec3::Y, &corners) / PI;
        for tracer in &tracers {
            let estimate = tracer.estimate(point + Vec3::Y * 0.5, Vec3::NEG_Y);
            assert_agrees("lamp", &estimate, exact * (ALBEDO * Vec3::new(4.0, 5.0, 6.0)).as_dvec3(), 0.01);
        }
    }
}

/// A glowing ball of radius r at distance d above gives the irradiance πL(r/d)². The mesh is inscribed: compared with a ball of
/// the mean of its inner and outer radius, which differ by 4e-5.
#[test]
fn glowing_ball_over_a_plane() {
    let mesh = reflectors::sphere(6).fitted(Vec3::new(0.3, 2.0, 0.1), 0.5).unwrap();
    let mut builder = SceneBuilder::default();
    let floor = builder.material(Material::diffuse(ALBEDO));
    let lamp = builder.material(emitting(Vec3::splat(3.0), Vec3::ZERO));
    plate(&mut builder, 0.0, 10.0, true, floor);
    add_mesh(&mut builder, &mesh, false, false, lamp);
    let tracer = global(build(builder, vec![]), 1);
    for point in [Vec3::ZERO, Vec3::new(1.0, 0.0, 2.0)] {
        let to = DVec3::new(0.3, 2.0, 0.1) - point.as_dvec3();
        let irradiance = PI * 3.0 * 0.25 / to.length_squared() * to.y / to.length();
        let estimate = tracer.estimate(point + Vec3::new(0.4, 0.3, 0.1), Vec3::new(-0.4, -0.3, -0.1));
        assert_agrees("ball", &estimate, ALBEDO.as_dvec3() / PI * irradiance, 0.01);
    }
}

/// glTF's metallic-roughness BRDF as Appendix B writes it, in `f64`, the normal being +Y.
fn appendix_b(base: DVec3, metallic: f64, roughness: f64, v: DVec3, l: DVec3) -> DVec3 {
    let alpha2 = roughness.powi(4);
    let h = (v + l).normalize();
    let heaviside = |x: f64| if x > 0.0 { 1.0 } else { 0.0 };
    let d = alpha2 * heaviside(h.y) / (PI * (h.y * h.y * (alpha2 - 1.0) + 1.0).powi(2));
    let mask = |x: DVec3| 2.0 * x.y.abs() / (x.y.abs() + (alpha2 + (1.0 - alpha2) * x.y * x.y).sqrt());
    let specular = mask(l) * mask(v) * d / (4.0 * l.y.abs() * v.y.abs());
    let fresnel = (1.0 - v.dot(h).abs()).powi(5);
    let metal = specular * (base + (1.0 - base) * fresnel);
    let dielectric = (base / PI).lerp(DVec3::splat(specular), 0.04 + 0.96 * fresnel);
    dielectric.lerp(metal, metallic)
}

const GLOSSY: [(f32, f32); 5] = [(1.0, 1.0), (1.0, 0.3), (0.0, 0.5), (0.5, 0.2), (1.0, 0.1)];

/// Under uniform light a surface has its directional albedo, here by quadrature. Base colour includes 1: the white metal of the furnace test, which
/// lacks what is reflected between facets.
#[test]
fn glossy_things_in_uniform_light() {
    let base = Vec3::new(1.0, 0.6, 0.2);
    GLOSSY.into_par_iter().for_each(|(metallic, roughness)| {
        let mut builder = SceneBuilder::default();
        let floor = builder.material(glossy(base, metallic, roughness));
        plate(&mut builder, 0.0, 1.0, true, floor);
        let tracer = global(builder.build("glossy", uniform(Vec3::ONE)).unwrap(), 1);
        for viewer in [Vec3::Y, Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.3, 0.15, 0.9)] {
            let v = viewer.as_dvec3().normalize();
            let exact =
                hemisphere(|l| appendix_b(base.as_dvec3(), f64::from(metallic), f64::from(roughness), v, l) * l.y);
            let estimate = tracer.estimate(viewer * 0.5, -viewer);
            assert_agrees(&format!("metallic {metallic}, roughness {roughness}, {viewer}"), &estimate, exact, 0.01);
        }
    });
}

/// An integral over the hemisphere around +Y, by midpoints that are denser towards the horizon and everywhere denser than any lobe of the tests.
fn hemisphere(f: impl Fn(DVec3) -> DVec3) -> DVec3 {
    const STEPS: (u32, u32) = (1500, 3000);
    let mut sum = DVec3::ZERO;
    for i in 0..STEPS.0 {
        let theta = (f64::from(i) + 0.5) * 0.5 * PI / f64::from(STEPS.0);
        let ring = (0..STEPS.1).map(|j| {
            let (sin, cos) = ((f64::from(j) + 0.5) * 2.0 * PI / f64::from(STEPS.1)).sin_cos();
            f(DVec3::new(theta.sin() * cos, theta.cos(), theta.sin() * sin))
        });
        sum += ring.sum::<DVec3>() * theta.sin();
    }
    sum * (PI * PI / f64::from(STEPS.0) / f64::from(STEPS.1))
}

/// The reflection of a lamp in glossy floors, by quadrature over the lamp: some points want it sampled by light, some by BSDF.
#[test]
fn rectangular_lamp_over_glossy_planes() {
    let base = Vec3::new(0.9, 0.6, 0.2);
    GLOSSY.into_par_iter().for_each(|(metallic, roughness)| {
        let tracer = global(lamp_over(glossy(base, metallic, roughness)), 1);
        for (point, viewer) in
            [(Vec3::ZERO, Vec3::new(0.1, 1.0, 0.2)), (Vec3::new(-1.5, 0.0, 0.0), Vec3::new(-1.0, 0.7, 0.0))]
        {
            let v = viewer.as_dvec3().normalize();
            let brdf = |l| appendix_b(base.as_dvec3(), f64::from(metallic), f64::from(roughness), v, l);
            let exact = over_lamp(point.as_dvec3(), |l| brdf(l) * l.y) * DVec3::new(4.0, 5.0, 6.0);
            let estimate = tracer.estimate(point + viewer * 0.2, -viewer);
            assert_agrees(&format!("metallic {metallic}, roughness {roughness}, {point}"), &estimate, exact, 0.01);
        }
    });
}

/// An integral over the directions from a point to the lamp, by midpoints.
fn over_lamp(point: DVec3, f: impl Fn(DVec3) -> DVec3) -> DVec3 {
    const STEPS: u32 = 1000;
    let [a, b, _, d] = LAMP.map(Vec3::as_dvec3);
    let area = (b - a).cross(d - a);
    let mut sum = DVec3::ZERO;
    for i in 0..STEPS * STEPS {
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
        let to = a + (b - a) * at(i % STEPS) + (d - a) * at(i / STEPS) - point;
        sum += f(to.normalize()) * (area.dot(to).abs() / to.length().powi(3));
    }
    sum / f64::from(STEPS * STEPS)
}

/// Errors of many rays in standard errors, from the floor under the lamp.
fn errors_over_standard_errors(samples: u32) -> Vec<f64> {
    let tracer = with_samples(lamp_over(Material::diffuse(Vec3::ONE)), 1, samples);
    let corners = LAMP.map(Vec3::as_dvec3);
    let error = |i: u32| {
        let point = Vec3::new((i % 50) as f32 * 0.1 - 2.5, 0.0, (i / 50) as f32 * 0.1 - 2.0);
        let exact = 4.0 / PI * polygon_irradiance(point.as_dvec3(), DVec3::Y, &corners);
        let estimate = tracer.estimate(point + Vec3::Y * 0.5, Vec3::NEG_Y);
        (f64::from(estimate.radiance.x) - exact).abs() / f64::from(estimate.standard_error.x)
    };
    (0..2000).map(error).collect()
}

/// The standard error, which takes samples for independent, is an upper bound: two of them cover the exact value for at least the 95 % of rays that they would cover
/// then, and the typical error is the smaller a part of it the more samples there are.
#[test]
fn two_standard_errors_cover_95_of_100() {
    for (samples, most) in [(16, 0.4), (400, 0.15)] {
        let errors = errors_over_standard_errors(samples);
        let covered = errors.iter().filter(|&&error| error < 2.0).count();
        // 95.4 % of 2000, less four standard deviations of a binomial.
        assert!(covered >= 1870, "{samples} samples: {covered} of 2000");
        let typical = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
        assert!(typical < most, "{samples} samples: errors of {typical} standard errors");
    }
}

/// However few the samples, and whatever their number, they are right on average: over rays to one point, whose spread tells the error of their mean.
#[test]
fn few_samples_have_no_bias() {
    const RAYS: u32 = 20_000;
    let metal = glossy(Vec3::new(0.9, 0.6, 0.2), 0.5, 0.5);
    let (point, viewer) = (Vec3::new(-0.8, 0.0, 0.1), Vec3::new(-0.5, 0.7, 0.2));
    let (v, base) = (viewer.as_dvec3().normalize(), DVec3::new(0.9, 0.6, 0.2));
    let exact = over_lamp(point.as_dvec3(), |l| appendix_b(base, 0.5, 0.5, v, l) * l.y).x * 4.0;
    for samples in [1, 2, 3, 4, 7, 16] {
        let tracer = with_samples(lamp_over(metal.clone()), 1, samples);
        let far = |i: u32| 0.2 + 1e-5 * i as f32;
        let seen = |i: u32| f64::from(tracer.trace(point + viewer * far(i), -viewer).radiance.x);
        let (sum, squares) = (0..RAYS).map(seen).fold((0.0, 0.0), |(sum, squares), x| (sum + x, squares + x * x));
        let mean = sum / f64::from(RAYS);
        let error = ((squares / f64::from(RAYS) - mean * mean) / f64::from(RAYS)).sqrt();
        assert!(error < 0.01 * exact, "{samples} samples: {mean} ± {error}");
        assert!(
            (mean - exact).abs() < 3.0 * error + 1e-5 * exact,
            "{samples} samples: {mean} ± {error}, exact {exact}"
        );
    }
}

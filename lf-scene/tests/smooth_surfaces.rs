//! Mirrors and glass against what is known exactly.

mod oracle;

use std::f64::consts::PI;

use glam::{DVec2, DVec3, Vec2, Vec3};
use lf_math::reflect;
use lf_scene::{Illumination, Material, Pattern, Quality, Scene, SceneBuilder, Surface, Tracer, reflectors};
use oracle::{SAMPLES, add_mesh, assert_agrees, dark, emitting, glass, global, glossy, room};
use rayon::prelude::*;

fn build(builder: SceneBuilder) -> Scene {
    builder.build("smooth", dark(vec![])).unwrap()
}

/// Both kinds of illumination follow smooth surfaces.
fn both(scene: &Scene, samples: u32) -> [Tracer; 2] {
    [Illumination::Direct, Illumination::Global { max_bounces: 300 }]
        .map(|illumination| Tracer::new(scene.clone()).with_quality(Quality { illumination, samples, seed: 5 }))
}

/// A room of mirrors of colour a with one glowing wall. Unfolded, the ray goes straight through a lattice of rooms; each wall it
/// crosses on the way to the glowing one takes a factor of a.
#[test]
fn mirror_box() {
    let color = Vec3::new(0.9, 0.8, 0.7);
    let mut builder = SceneBuilder::default();
    let mirror = builder.material(Material::mirror(color));
    let lamp = builder.material(Material::glowing(Vec3::splat(2.0)));
    room(&mut builder, 1.0, [lamp, mirror, mirror, mirror, mirror, mirror]);
    let tracers = both(&build(builder), 1);
    let origin = Vec3::new(0.3, -0.2, 0.45);
    for i in 0..200 {
        let angle = 2.4 * i as f32;
        let direction = Vec3::new(angle.cos(), angle.sin(), (i as f32 * 0.7).sin());
        let (o, d) = (origin.as_dvec3(), direction.as_dvec3());
        // The first wall at x = −1 is crossed too if the ray sets out towards it.
        let (way, first) = if d.x > 0.0 { (1.0 - o.x, 0.0) } else { (3.0 + o.x, 1.0) };
        let end = o + d * (way / d.x.abs());
        // Walls across an axis are at odd numbers.
        let walls = |x: f64| ((x + 1.0) / 2.0).floor().abs();
        let crossed = first + walls(end.y) + walls(end.z);
        if crossed > 12.0 || [end.y, end.z].into_iter().any(|x| ((x + 1.0) / 2.0).fract() < 1e-3) {
            continue;
        }
        for (limit, tracer) in [16.0, 5.0].into_iter().zip(&tracers) {
            // From five bounces on paths of all light end by chance.
            if crossed < limit {
                let exact = 2.0 * color.as_dvec3().powf(crossed);
                assert_agrees(&format!("{crossed} mirrors {direction}"), &sure(tracer, origin, direction), exact, 1e-9);
            }
        }
    }
}

/// An estimate of what is not random, for which one sample tells all.
fn sure(tracer: &Tracer, origin: Vec3, direction: Vec3) -> lf_scene::Estimate {
    lf_scene::Estimate { standard_error: Vec3::ZERO, ..tracer.estimate(origin, direction) }
}

/// A mirror ball in a room with checkered walls shows the field that the exact reflected ray meets.
#[test]
fn mirror_ball() {
    let checker = |a: Vec3, b: Vec3| {
        let emission = Surface::Procedural(Pattern::Checker([a, b]));
        Material { emission, ..Material::diffuse(Vec3::ZERO) }
    };
    let color = |axis: usize, sign: f32, light: bool| {
        Vec3::AXES[axis] * if light { 1.0 } else { 0.5 } + if sign > 0.0 { 0.25 } else { 0.0 }
    };
    let mut builder = SceneBuilder::default();
    let walls = [0, 1, 2].map(|axis| {
        [1.0, -1.0].map(|sign| builder.material(checker(color(axis, sign, true), color(axis, sign, false))))
    });
    room(&mut builder, 3.0, [walls[0][0], walls[0][1], walls[1][0], walls[1][1], walls[2][0], walls[2][1]]);
    let silver = builder.material(Material::mirror(Vec3::ONE));
    add_mesh(&mut builder, &reflectors::sphere(7), false, false, silver);
    let tracers = both(&build(builder), 1);
    let mut compared = 0;
    for i in 0..4000 {
        // Parallel rays over a disc: the normal of a ball of radius 1 is known.
        let (angle, radius) = (2.399_963 * i as f32, 0.98 * (i as f32 / 4000.0).sqrt());
        let eye = Vec3::new(radius * angle.cos(), radius * angle.sin(), 2.5);
        let normal = Vec3::new(eye.x, eye.y, (1.0 - radius * radius).sqrt());
        let reflected = reflect(Vec3::NEG_Z, normal);
        let walls = (3.0 * reflected.signum() - normal) / reflected;
        let axis = (0..3).min_by(|&a, &b| walls[a].total_cmp(&walls[b])).unwrap();
        let place = normal + reflected * walls[axis];
        let sign = reflected[axis].signum();
        let inside = |x: f32| ((x + 3.0) / 1.5).fract();
        let others = [place[(axis + 1) % 3], place[(axis + 2) % 3]];
        if others.iter().any(|&x| !(0.03..0.97).contains(&inside(x))) {
            continue;
        }
        // On the walls at +3 texture coordinates run down one axis.
        let fields =
            others.iter().map(|&x| ((x + 3.0) / 1.5).floor()).sum::<f32>() + if sign > 0.0 { 1.0 } else { 0.0 };
        let even = fields % 2.0 == 0.0;
        for tracer in &tracers {
            assert_eq!(tracer.trace(eye, Vec3::NEG_Z).radiance, color(axis, sign, even), "{eye} {place}");
        }
        compared += 1;
    }
    assert!(compared > 3000, "{compared}");
}

/// Fresnel's reflectance and the cosine inside, from the refraction angle.
fn fresnel(cosine: f64, eta: f64) -> (f64, f64) {
    let (incident, refracted) = (cosine.acos(), (cosine.acos().sin() / eta).asin());
    if incident == 0.0 {
        return (((eta - 1.0) / (eta + 1.0)).powi(2), 1.0);
    }
    let s = ((incident - refracted).sin() / (incident + refracted).sin()).powi(2);
    let p = ((incident - refracted).tan() / (incident + refracted).tan()).powi(2);
    (0.5 * (s + p), refracted.cos())
}

const TINT: DVec3 = DVec3::new(0.9, 0.7, 0.5);
const BEFORE: DVec3 = DVec3::new(1.0, 2.0, 3.0);
const BEHIND: DVec3 = DVec3::new(7.0, 5.0, 3.0);

/// A pane or slab across z = 0 between a wall that glows before it and one that glows behind.
fn between_walls(pane: impl FnOnce(&mut SceneBuilder)) -> Scene {
    let mut builder = SceneBuilder::default();
    for (z, light, u) in [(40.0, BEFORE, Vec3::Y), (-40.0, BEHIND, Vec3::X)] {
        let wall = builder.material(emitting(light.as_vec3(), Vec3::ZERO));
        let v = Vec3::X + Vec3::Y - u;
        builder.parallelogram(Vec3::new(-5e3, -5e3, z), u * 1e4, v * 1e4, Vec2::ONE, wall);
    }
    pane(&mut builder);
    build(builder)
}

const COSINES: [f64; 4] = [1.0, 0.8, 0.5, 0.1];

/// The eye's distance from (0.1, 0.2, 0) makes no difference, so rays arrive there along the cosine.
fn ray(cosine: f64) -> (Vec3, Vec3) {
    let sine = (1.0 - cosine * cosine).sqrt();
    let direction = DVec3::new(0.6 * sine, 0.8 * sine, -cosine).as_vec3();
    (Vec3::new(0.1, 0.2, 0.0) - direction * 3.0, direction)
}

/// A pane lets (1 − R)/(1 + R) through, light going to and fro in it.
#[test]
fn pane_between_two_walls() {
    let scene = between_walls(|builder| {
        let pane = builder.material(glass(TINT.as_vec3(), 1.5, true));
        builder.parallelogram(Vec3::new(-1e3, -1e3, 0.0), Vec3::X * 2e3, Vec3::Y * 2e3, Vec2::ONE, pane);
    });
    for tracer in both(&scene, SAMPLES) {
        COSINES.into_par_iter().for_each(|cosine| {
            let (r, _) = fresnel(cosine, 1.5);
            let through = (1.0 - r) / (1.0 + r);
            let (origin, direction) = ray(cosine);
            let exact = through * TINT * BEHIND + (1.0 - through) * BEFORE;
            assert_agrees(&format!("cosine {cosine}"), &tracer.estimate(origin, direction), exact, 0.01);
        });
    }
}

/// A slab with a tint t at each surface, all orders of reflection added up. In and out, refraction's factors of radiance cancel.
#[test]
fn slab_between_two_walls() {
    let scene = between_walls(|builder| {
        let slab = builder.material(glass(TINT.as_vec3(), 1.5, false));
        builder.cuboid(Vec3::new(-1e3, -1e3, -1.0), Vec3::new(1e3, 1e3, 0.0), slab);
    });
    for tracer in both(&scene, SAMPLES) {
        COSINES.into_par_iter().for_each(|cosine| {
            let (r, _) = fresnel(cosine, 1.5);
            let inside = TINT * TINT * (1.0 - r) * (1.0 - r) / (1.0 - r * r);
            let (origin, direction) = ray(cosine);
            let exact = inside * BEHIND + (r + r * inside) * BEFORE;
            assert_agrees(&format!("cosine {cosine}"), &tracer.estimate(origin, direction), exact, 0.01);
        });
    }
}

/// Inside glass radiance is larger by the square of the index of refraction.
#[test]
fn radiance_inside_glass() {
    let scene = between_walls(|builder| {
        let slab = builder.material(glass(Vec3::ONE, 1.5, false));
        builder.cuboid(Vec3::new(-1e3, -1e3, -1.0), Vec3::new(1e3, 1e3, 0.0), slab);
    });
    for tracer in both(&scene, SAMPLES) {
        // Straight up: what comes in from above, and what comes from below and is reflected once or more.
        let (r, _) = fresnel(1.0, 1.5);
        let exact = 2.25 * (1.0 - r) * (BEFORE + r * BEHIND) / (1.0 - r * r);
        assert_agrees("inside", &tracer.estimate(Vec3::new(0.1, 0.2, -0.5), Vec3::Z), exact, 0.01);
    }
}

/// A ray through a slab of thickness d leaves it shifted by d·sin θ·(1 − cos θ/(n·cos θ′)), where a small target waits.
#[test]
fn slab_shifts_rays() {
    let (thickness, ior) = (2.0, 1.5);
    for cosine in [0.9f64, 0.5, 0.2] {
        let (r, inside) = fresnel(cosine, ior);
        let sine = (1.0 - cosine * cosine).sqrt();
        let shift = thickness * sine * (1.0 - cosine / (ior * inside));
        // Across the ray, towards the normal's foot: straight on from (0, 0), then back by the shift.
        let direction = DVec2::new(sine, -cosine);
        let across = DVec2::new(-cosine, -sine);
        let seen = DVec2::ZERO + direction * 10.0 + across * shift;
        for (miss, exact) in [(0.0, (1.0 - r) * (1.0 - r)), (0.02, 0.0), (-0.02, 0.0)] {
            let mut builder = SceneBuilder::default();
            let slab = builder.material(glass(Vec3::ONE, ior as f32, false));
            let target = builder.material(Material::glowing(Vec3::ONE));
            let [x, z] = [50.0, thickness as f32];
            builder.cuboid(Vec3::new(-x, -x, -z), Vec3::new(x, x, 0.0), slab);
            let center = seen + across * miss;
            let at = |along: f64, side: f32| {
                let p = center + across * along;
                Vec3::new(p.x as f32, side, p.y as f32)
            };
            let corner = at(-0.01, -0.01);
            builder.parallelogram(corner, at(0.01, -0.01) - corner, at(-0.01, 0.01) - corner, Vec2::ONE, target);
            let [_, tracer] = both(&build(builder), SAMPLES);
            let direction = Vec3::new(sine as f32, 0.0, -cosine as f32);
            let estimate = tracer.estimate(direction * -3.0, direction);
            assert_agrees(&format!("cosine {cosine}, beside by {miss}"), &estimate, DVec3::splat(exact), 0.01);
        }
    }
}

/// A right-angled prism: straight in through one leg, totally reflected by the long side, out through the other leg. Part of the light is
/// sent back at each leg and takes the same way again.
#[test]
fn total_reflection_in_a_prism() {
    let ior = 1.6f32;
    let mut builder = SceneBuilder::default();
    let prism = builder.material(glass(Vec3::ONE, ior, false));
    // Legs on x = 1 and z = 1, the long side through (−1, 1) and (1, −1), facing −x −z.
    let high = Vec3::Y * 2.0;
    let at = |x: f32, z: f32| Vec3::new(x, -1.0, z);
    for (from, to) in [(at(1.0, 1.0), at(1.0, -1.0)), (at(1.0, -1.0), at(-1.0, 1.0)), (at(-1.0, 1.0), at(1.0, 1.0))] {
        builder.parallelogram(from, to - from, high, Vec2::ONE, prism);
    }
    let walls = [(Vec3::X, 2.0f32), (Vec3::Z, 3.0), (-Vec3::X, 100.0), (-Vec3::Z, 100.0)];
    for (side, light) in walls {
        let wall = builder.material(emitting(Vec3::splat(light), Vec3::ZERO));
        let u = side.cross(Vec3::Y);
        builder.parallelogram(side * 5.0 - u * 5.0 - Vec3::Y * 5.0, u * 10.0, Vec3::Y * 10.0, Vec2::ONE, wall);
    }
    let r = f64::from((ior - 1.0) / (ior + 1.0)).powi(2);
    let (seen, around) = (2.0, 3.0);
    let exact = r * around + (1.0 - r) * (1.0 - r) / (1.0 - r * r) * (seen + r * around);
    for tracer in both(&build(builder), SAMPLES) {
        let estimate = tracer.estimate(Vec3::new(0.25, 0.1, 3.0), Vec3::NEG_Z);
        assert_agrees("prism", &estimate, DVec3::splat(exact), 0.01);
    }
}

/// A metal without roughness is a mirror, its colour following Schlick's approximation.
#[test]
fn smooth_metal() {
    let base = DVec3::new(0.9, 0.5, 0.1);
    let scene = between_walls(|builder| {
        let metal = builder.material(glossy(base.as_vec3(), 1.0, 0.0));
        builder.parallelogram(Vec3::new(-1e3, -1e3, 0.0), Vec3::X * 2e3, Vec3::Y * 2e3, Vec2::ONE, metal);
    });
    for (tracer, cosine) in both(&scene, 2).iter().flat_map(|tracer| COSINES.map(|cosine| (tracer, cosine))) {
        let (origin, direction) = ray(cosine);
        let exact = (base + (1.0 - base) * (1.0 - cosine).powi(5)) * BEFORE;
        assert_agrees(&format!("cosine {cosine}"), &tracer.estimate(origin, direction), exact, 1e-9);
    }
}

/// Light reaches a floor through a pane only by chance: the pane casts a shadow for rays that look for the lamp. A lamp large
/// enough is found: here half of everything above is one. Its light through the pane by quadrature.
#[test]
fn lamp_seen_through_a_pane() {
    let mut builder = SceneBuilder::default();
    let floor = builder.material(Material::diffuse(Vec3::ONE));
    let pane = builder.material(glass(Vec3::ONE, 1.5, true));
    let lamp = builder.material(emitting(Vec3::ONE, Vec3::ZERO));
    oracle::plate(&mut builder, 0.0, 1e4, true, floor);
    oracle::plate(&mut builder, 1.0, 1e4, true, pane);
    oracle::plate(&mut builder, 2.0, 1e4, false, lamp);
    const STEPS: u32 = 100_000;
    let through = |i: u32| {
        let theta = (f64::from(i) + 0.5) / f64::from(STEPS) * 0.5 * PI;
        let (r, _) = fresnel(theta.cos(), 1.5);
        (1.0 - r) / (1.0 + r) * 2.0 * theta.sin() * theta.cos()
    };
    let share = (0..STEPS).map(through).sum::<f64>() * 0.5 * PI / f64::from(STEPS);
    // What the pane sends back to the white floor comes again.
    let exact = share / (1.0 - (1.0 - share));
    let tracer = global(build(builder), 2000);
    let estimate = tracer.estimate(Vec3::new(0.3, 0.5, 0.1), Vec3::NEG_Y);
    assert_agrees("floor under a pane", &estimate, DVec3::splat(exact), 0.01);
}

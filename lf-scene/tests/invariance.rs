//! What must not change an answer: threads, order, the unit of length, the place in the world. And what must: holes.

mod oracle;

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use lf_math::{Cell, Image, LightFieldGeometry, PlanePlacement};
use lf_scene::{
    ColorEncoding, Estimate, Illumination, Light, Lighting, Material, Quality, Scene, SceneBuilder, Surface, Texture,
    Tracer, Vertex, capture_slabs, museum, reflectors,
};
use oracle::{add_mesh, dark, emitting, glass, glossy, uniform, with_samples};
use proptest::prelude::*;
use rayon::prelude::*;

/// A scene with everything in it, in a unit of `1/scale` metres, moved.
fn everything(scale: f32, place: Vec3) -> Scene {
    let mut builder = SceneBuilder::default();
    let materials = [
        Material::diffuse(Vec3::new(0.6, 0.5, 0.4)),
        glossy(Vec3::new(0.9, 0.6, 0.3), 1.0, 0.3),
        Material::mirror(Vec3::splat(0.9)),
        glass(Vec3::new(0.9, 1.0, 0.9), 1.5, false),
        emitting(Vec3::new(6.0, 5.0, 4.0), Vec3::splat(0.2)),
    ]
    .map(|material| builder.material(material));
    oracle::plate(&mut builder, 0.0, 4.0, true, materials[0]);
    oracle::plate(&mut builder, 3.0, 0.5, false, materials[4]);
    for (i, material) in materials.into_iter().enumerate().take(4) {
        let ball = reflectors::sphere(3).fitted(Vec3::new(1.2 * i as f32 - 1.8, 0.6, 0.3), 0.5).unwrap();
        add_mesh(&mut builder, &ball, false, false, material);
    }
    let lamp = Light::Point { position: Vec3::new(1.0, 2.5, 2.0), intensity: Vec3::splat(4.0) };
    let sun = Light::Sun { towards: Vec3::new(0.6, 0.8, 0.0), irradiance: Vec3::splat(0.5) };
    let lighting = Lighting { lights: vec![lamp, sun], ..uniform(Vec3::new(0.1, 0.2, 0.3)) };
    moved(&builder.build("everything", lighting).unwrap(), scale, place)
}

fn moved(scene: &Scene, scale: f32, place: Vec3) -> Scene {
    let mut builder = SceneBuilder::default();
    for material in scene.materials() {
        builder.material(material.clone());
    }
    for (corners, material) in scene.triangles() {
        let corner = |v: &Vertex| Vertex { position: v.position * scale + place, ..*v };
        builder.triangle([corner(&corners[0]), corner(&corners[1]), corner(&corners[2])], *material);
    }
    let light = |light: &Light| match *light {
        Light::Point { position, intensity } => {
            Light::Point { position: position * scale + place, intensity: intensity * (scale * scale) }
        }
        other => other,
    };
    let lights = scene.lighting().lights.iter().map(light).collect();
    builder.build(scene.name(), Lighting { lights, ..scene.lighting().clone() }).unwrap()
}

/// Rays from an eye over the scene, in a unit of `1/scale` metres.
fn rays(scale: f32, place: Vec3) -> Vec<(Vec3, Vec3)> {
    let ray = |i: u32| {
        let (x, y) = ((i % 20) as f32 / 10.0 - 0.95, (i / 20) as f32 / 10.0 - 0.95);
        (Vec3::new(0.1, 1.5, 4.0) * scale + place, Vec3::new(x, 0.6 * y - 0.3, -1.0))
    };
    (0..400).map(ray).collect()
}

fn answers(tracer: &Tracer, rays: &[(Vec3, Vec3)]) -> Vec<Estimate> {
    rays.par_iter().map(|&(origin, direction)| tracer.estimate(origin, direction)).collect()
}

#[test]
fn neither_threads_nor_order_nor_company_matter() {
    let tracer = with_samples(everything(1.0, Vec3::ZERO), 8, 8);
    let rays = rays(1.0, Vec3::ZERO);
    let parallel = answers(&tracer, &rays);
    let mut backwards: Vec<_> = rays.iter().rev().map(|&(o, d)| tracer.estimate(o, d)).collect();
    backwards.reverse();
    assert_eq!(parallel, backwards);
}

#[test]
fn threads_do_not_change_global_illumination() {
    let tracer = with_samples(everything(1.0, Vec3::ZERO), 4, 4);
    let cell = Cell::cube(DVec3::new(0.0, 1.8, 1.5), 0.8).unwrap();
    let geometry = LightFieldGeometry::around(cell, PlanePlacement::CellFaces, 2, 5).unwrap();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let captured = pool.install(|| capture_slabs(&tracer, &geometry, 2, &|_| ()).unwrap());
        (captured.geometry, captured.texels, pool.install(|| answers(&tracer, &rays(1.0, Vec3::ZERO))))
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn seeds_and_rays_have_noise_of_their_own() {
    let tracer = |seed: u64| {
        let quality = Quality { illumination: Illumination::Global { max_bounces: 4 }, samples: 4, seed };
        Tracer::new(everything(1.0, Vec3::ZERO)).with_quality(quality)
    };
    let rays = rays(1.0, Vec3::ZERO);
    let (one, other) = (answers(&tracer(1), &rays), answers(&tracer(2), &rays));
    // What is not random, as the sky, is the same.
    let random = |estimate: &Estimate| estimate.standard_error != Vec3::ZERO;
    let same = one.iter().zip(&other).filter(|(a, b)| random(a) && a.radiance == b.radiance).count();
    assert!(same == 0, "{same} of 400");
    let apart = |a: &Estimate, b: &Estimate| (a.radiance - b.radiance).length();
    let neighbours = one.windows(2).filter(|pair| random(&pair[0]) && apart(&pair[0], &pair[1]) == 0.0).count();
    assert!(neighbours == 0 && one.iter().filter(|estimate| random(estimate)).count() > 200, "{neighbours} of 399");
}

/// Powers of two: the same bits.
#[test]
fn scaled_scenes_look_the_same_to_the_bit() {
    let seen = answers(&with_samples(everything(1.0, Vec3::ZERO), 8, 8), &rays(1.0, Vec3::ZERO));
    for exponent in [-20, -7, 20] {
        let scale = 2f32.powi(exponent);
        let scaled = answers(&with_samples(everything(scale, Vec3::ZERO), 8, 8), &rays(scale, Vec3::ZERO));
        for (one, other) in seen.iter().zip(&scaled) {
            assert_eq!((one.radiance, one.standard_error), (other.radiance, other.standard_error), "2^{exponent}");
            assert_eq!(one.distance * scale, other.distance);
        }
    }
}

/// Other factors round coordinates differently: direct light, which is not random, is the same but at edges.
#[test]
fn a_million_metres_and_a_micrometre_look_the_same() {
    let eye = Vec3::new(0.1, 1.5, 0.2);
    let direction = |i: u32| {
        let (y, angle) = (1.0 - (2.0 * i as f32 + 1.0) / 4000.0, 2.399_963 * i as f32);
        let r = (1.0 - y * y).sqrt();
        Vec3::new(r * angle.cos(), y, r * angle.sin())
    };
    let seen = |scale: f32| -> Vec<_> {
        let tracer = Tracer::new(moved(&museum::scene(), scale, Vec3::ZERO));
        (0..4000).into_par_iter().map(|i| tracer.trace(eye * scale, direction(i)).radiance).collect()
    };
    let plain = seen(1.0);
    for scale in [1e6, 1e-6] {
        let differ = plain.iter().zip(seen(scale)).filter(|(a, b)| (**a - *b).length() > 1e-4 * a.length()).count();
        assert!(differ <= 4, "{differ} of 4000 at {scale}");
    }
}

/// The rays of a scene of a metre, 10⁴ m from the origin, where coordinates have steps of a millimetre: no point may shade itself.
#[test]
fn far_from_the_origin_no_surface_shades_itself() {
    let place = Vec3::new(1e4, -0.7e4, 1.3e4);
    for place in [Vec3::ZERO, place, place * 100.0] {
        let unit = if place == Vec3::ZERO { 1.0 } else { place.length() / 1e4 };
        // A convex body under a sky of radiance 1, white: it vanishes, up to the shading of its silhouette.
        let mut builder = SceneBuilder::default();
        let white = builder.material(Material::diffuse(Vec3::ONE));
        add_mesh(&mut builder, &reflectors::sphere(2), true, false, white);
        let ball = builder.build("ball", uniform(Vec3::ONE)).unwrap();
        let mut corner = SceneBuilder::default();
        for (corners, material) in ball.triangles() {
            let round = |v: &Vertex| v.position * unit + place;
            let [a, b, c] = [round(&corners[0]), round(&corners[1]), round(&corners[2])];
            let normal = (b - a).cross(c - a);
            corner.triangle([a, b, c].map(|position| Vertex { position, normal, uv: Vec2::ZERO }), *material);
        }
        corner.material(Material::diffuse(Vec3::ONE));
        let tracer = with_samples(corner.build("ball", uniform(Vec3::ONE)).unwrap(), 100, 64);
        let mut sum = 0.0;
        for i in 0..2000 {
            let (y, angle) = (1.0 - (2.0 * i as f32 + 1.0) / 2000.0, 2.399_963 * i as f32);
            let r = (1.0 - y * y).sqrt();
            let outwards = Vec3::new(r * angle.cos(), y, r * angle.sin());
            let estimate = tracer.estimate(place + outwards * 3.0 * unit, -outwards);
            assert!(estimate.radiance.x > 0.7, "{place}: {estimate:?}");
            sum += f64::from(estimate.radiance.x);
        }
        assert!((sum / 2000.0 - 1.0).abs() < 3e-3, "{place}: {}", sum / 2000.0);
    }
}

/// A card whose left half is a hole by its alpha.
fn card() -> Material {
    let texels = vec![[255, 255, 255, 0], [255, 255, 255, 0], [255; 4], [255; 4]];
    let image = Image::new(4, 1, texels).unwrap();
    let texture = Arc::new(Texture { image, encoding: ColorEncoding::Srgb });
    Material { alpha_cutoff: Some(0.5), ..Material::of(Surface::Textured(texture, Vec3::ONE)) }
}

#[test]
fn holes_let_rays_and_light_through() {
    let mut builder = SceneBuilder::default();
    let floor = builder.material(Material::diffuse(Vec3::ONE));
    let card = builder.material(card());
    oracle::plate(&mut builder, 0.0, 5.0, true, floor);
    builder.parallelogram(Vec3::new(-1.0, 1.0, 1.0), Vec3::X * 2.0, Vec3::NEG_Z * 2.0, Vec2::ONE, card);
    let sun = Light::Sun { towards: Vec3::Y, irradiance: Vec3::splat(std::f32::consts::PI) };
    let tracer = Tracer::new(builder.build("card", dark(vec![sun])).unwrap());
    let down = |x: f32, y: f32| tracer.trace(Vec3::new(x, y, 0.1), Vec3::NEG_Y);
    // The texture's border is between texels 1 and 2, and again at the edge where it repeats.
    for (x, distance, light) in [(-0.6, 2.0, 1.0), (-0.3, 2.0, 1.0), (0.3, 1.0, 1.0), (0.6, 1.0, 1.0)] {
        assert_eq!((down(x, 2.0).distance, down(x, 2.0).radiance.x), (distance, light), "{x}");
    }
    for (x, light) in [(-0.6, 1.0), (-0.3, 1.0), (0.3, 0.0), (0.6, 0.0)] {
        assert_eq!(down(x, 0.5).radiance.x, light, "{x}");
    }
}

/// Normals that lean over an edge must not let light through the surface.
#[test]
fn leaning_normals_do_not_leak() {
    let mut builder = SceneBuilder::default();
    let white = builder.material(Material::diffuse(Vec3::ONE));
    let vertex =
        |x: f32, z: f32| Vertex { position: Vec3::new(x, 0.0, z), normal: Vec3::new(1.0, 0.2, 0.0), uv: Vec2::ZERO };
    builder.triangle([vertex(-1.0, -1.0), vertex(0.0, 2.0), vertex(1.0, -1.0)], white);
    let scene = builder.build("leaning", dark(vec![])).unwrap();
    // Both suns are in front of the normal, one is behind the triangle.
    for (height, lit) in [(0.6, true), (-0.1, false)] {
        let sun = Light::Sun { towards: Vec3::new(0.8, height, 0.0).normalize(), irradiance: Vec3::ONE };
        let tracer = Tracer::new(scene.clone().with_lighting(dark(vec![sun])));
        let traced = tracer.trace(Vec3::new(0.0, 1.0, 0.1), Vec3::new(0.1, -1.0, 0.0));
        assert_eq!(traced.radiance.x > 0.0, lit, "{height}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Whatever the ray, radiance is a number and not negative.
    #[test]
    fn any_ray_has_an_answer(origin in prop::array::uniform3(-5.0f32..5.0), direction in prop::array::uniform3(any::<f32>())) {
        let tracer = with_samples(everything(1.0, Vec3::ZERO), 20, 2);
        let estimate = tracer.estimate(origin.into(), direction.into());
        prop_assert!(estimate.radiance.is_finite() && estimate.radiance.min_element() >= 0.0, "{estimate:?}");
    }
}

//! What the tests of the tracer share: scenes from parts, and the comparison with what is exact.
#![allow(dead_code, unreachable_pub, reason = "each test file uses its part")]

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use lf_math::{Image, TriangleMesh};
use lf_scene::{
    Environment, EnvironmentMap, Estimate, Illumination, Light, Lighting, Material, Quality, Scattering, Scene,
    SceneBuilder, Surface, Tracer, Vertex,
};

pub const SAMPLES: u32 = 100_000;

/// A tracer of all light.
pub fn global(scene: Scene, max_bounces: u32) -> Tracer {
    with_samples(scene, max_bounces, SAMPLES)
}

pub fn with_samples(scene: Scene, max_bounces: u32, samples: u32) -> Tracer {
    Tracer::new(scene).with_quality(Quality { illumination: Illumination::Global { max_bounces }, samples, seed: 1 })
}

/// Holds an estimate against what is exact: within three standard errors in each channel, the standard error being at most
/// `error` of the exact value. Where nothing is random, single precision decides.
pub fn assert_agrees(what: &str, estimate: &Estimate, exact: DVec3, error: f64) {
    let (mean, sigma) = (estimate.radiance.as_dvec3(), estimate.standard_error.as_dvec3());
    for channel in 0..3 {
        let (mean, sigma, exact) = (mean[channel], sigma[channel], exact[channel]);
        assert!(sigma <= error * exact, "{what}: the error {sigma} of {mean} is too large to tell it from {exact}");
        let rounding = 1e-5 * exact;
        assert!((mean - exact).abs() <= 3.0 * sigma + rounding, "{what}: {mean} ± {sigma} should be {exact}");
    }
}

pub fn dark(lights: Vec<Light>) -> Lighting {
    Lighting { lights, ..Lighting::from_environment(Environment::BLACK) }
}

/// The same radiance from everywhere.
pub fn uniform(radiance: Vec3) -> Lighting {
    let map = EnvironmentMap::new(Image::filled(4, 2, radiance), 0.0).unwrap();
    Lighting::from_environment(Environment::Map(Arc::new(map)))
}

/// A surface that emits on the side it faces and scatters.
pub fn emitting(radiance: Vec3, albedo: Vec3) -> Material {
    Material { emission: Surface::Uniform(radiance), ..Material::diffuse(albedo) }
}

pub fn glossy(base: Vec3, metallic: f32, roughness: f32) -> Material {
    let scattering = Scattering::MetallicRoughness { metallic, roughness, texture: None };
    Material { scattering, ..Material::diffuse(base) }
}

pub fn glass(tint: Vec3, ior: f32, thin: bool) -> Material {
    Material { scattering: Scattering::Glass { ior, thin }, ..Material::diffuse(tint) }
}

/// A horizontal square of half size `half` at height `y`, facing up (or down).
pub fn plate(builder: &mut SceneBuilder, y: f32, half: f32, up: bool, material: u32) {
    let (u, v) = if up { (Vec3::Z, Vec3::X) } else { (Vec3::X, Vec3::Z) };
    let corner = Vec3::new(-half, y, -half);
    builder.parallelogram(corner, u * 2.0 * half, v * 2.0 * half, Vec2::ONE, material);
}

/// An axis-aligned box of half size `half` around the origin that faces inwards, a material for each wall, in the order
/// +X −X +Y −Y +Z −Z.
pub fn room(builder: &mut SceneBuilder, half: f32, materials: [u32; 6]) {
    for (axis, (inwards, material)) in [1.0f32, -1.0]
        .iter()
        .flat_map(|s| Vec3::AXES.map(|a| -a * *s))
        .enumerate()
        .map(|(i, inwards)| (inwards, materials[2 * (i % 3) + i / 3]))
        .enumerate()
    {
        let u = Vec3::AXES[(axis + 1) % 3];
        let v = inwards.cross(u);
        builder.parallelogram((-inwards - u - v) * half, u * 2.0 * half, v * 2.0 * half, Vec2::splat(4.0), material);
    }
}

/// A mesh, each triangle flat if asked for, turned inside out if asked for.
pub fn add_mesh(builder: &mut SceneBuilder, mesh: &TriangleMesh, flat: bool, inside_out: bool, material: u32) {
    for &[a, b, c] in mesh.triangles() {
        let triangle = if inside_out { [a, c, b] } else { [a, b, c] };
        let [p, q, r] = triangle.map(|i| mesh.positions()[i as usize]);
        let normal = (q - p).cross(r - p);
        let vertex = |i: u32| Vertex {
            position: mesh.positions()[i as usize],
            normal: if flat { normal } else { mesh.normals()[i as usize] },
            uv: Vec2::ZERO,
        };
        builder.triangle(triangle.map(vertex), material);
    }
}

//! GPU and CPU pictures of the same light field and environment map.

use glam::Vec3;
use lf_gpu::{Gpu, MirrorMesh, ReflectionPass, SlabTexture, Storage, Target};
use lf_ibr::{CubeField, Environment, GBuffer, SlabField, reflect_frame};
use lf_math::{Image, Pinhole, TriangleMesh};
use lf_scene::{capture_cube, museum, reflectors};
use lf_tests::{capture, gpu, museum, packed};

const SIZE: u32 = 512;

fn cameras() -> Vec<Pinhole> {
    let eyes = [Vec3::new(1.5, 0.4, 0.2), Vec3::new(-0.7, 0.8, 1.2), Vec3::new(0.3, -0.9, -1.3)];
    eyes.map(|eye| Pinhole::look_at(eye, Vec3::ZERO, 0.7, SIZE, SIZE).expect("a camera")).to_vec()
}

fn mirrors() -> [(&'static str, TriangleMesh); 2] {
    [
        ("sphere", reflectors::sphere(5).fitted(Vec3::ZERO, 0.45)),
        ("teapot", reflectors::teapot(10).fitted(Vec3::ZERO, 0.48)),
    ]
}

/// The share of pixels whose channels all agree within 2/255, and the largest difference.
fn agreement(a: &Image<[u8; 4]>, b: &Image<[u8; 4]>) -> (f64, u8) {
    let difference = |(a, b): (&[u8; 4], &[u8; 4])| (0..4).map(|c| a[c].abs_diff(b[c])).max().unwrap_or(0);
    let differences: Vec<_> = a.texels().iter().zip(b.texels()).map(difference).collect();
    let close = differences.iter().filter(|&&d| d <= 2).count();
    (close as f64 / differences.len() as f64, differences.into_iter().max().unwrap_or(0))
}

fn compare(gpu: &Gpu, what: &str, pass: &ReflectionPass, twin: &impl Environment) {
    for (name, mesh) in mirrors() {
        let device_mesh = MirrorMesh::new(gpu, &mesh).expect("uploads");
        let target = Target::new(gpu, SIZE, SIZE).expect("a target");
        for (eye, camera) in cameras().iter().enumerate() {
            pass.draw(gpu, &target, &device_mesh, camera);
            let drawn = target.read(gpu).expect("reads");
            let expected = reflect_frame(&GBuffer::rasterize(&mesh, camera), twin);
            let covered = drawn.texels().iter().filter(|texel| texel[3] == 255).count();
            assert!(covered > 30_000, "{name} covers {covered} pixels");
            let (share, worst) = agreement(&drawn, &expected);
            println!("{what}, {name}, eye {eye}: {:.4} % within 2/255, worst {worst}", 100.0 * share);
            assert!(share >= 0.999, "{what}, {name}, eye {eye}: only {share} within 2/255");
        }
    }
}

#[test]
fn slabs_agree_within_two_steps_on_999_of_1000_pixels() {
    let (gpu, tracer) = (gpu(), museum());
    let field = packed(&capture(&tracer, 10, 48));
    let twin = SlabField::new(field.geometry().clone(), field.decode().expect("decodes")).expect("a field");
    for storage in Storage::ALL {
        let texture = SlabTexture::with_storage(&gpu, &field, storage).expect("uploads");
        let pass = ReflectionPass::slabs(&gpu, &field, &texture).expect("a pass");
        compare(&gpu, &storage.to_string(), &pass, &twin);
    }
}

#[test]
fn environment_maps_agree_within_two_steps_on_999_of_1000_pixels() {
    let (gpu, tracer) = (gpu(), museum());
    let cube = capture_cube(&tracer, &museum::cell(), 128, 2).expect("a cube map");
    let pass = ReflectionPass::environment(&gpu, &cube).expect("a pass");
    compare(&gpu, "environment map", &pass, &CubeField::new(&cube));
}

//! glTF scenes from anyone: they are imported or refused, within the budget, and what is imported keeps the scene's promises.

use lf_scene::{ImportOptions, Imported, Light, Material, Scattering, Scene, import_gltf_slice};

/// What importing may cost.
const MEMORY_BYTES: u64 = 16 << 20;

/// Takes the bytes as a file; if a zero byte parts them, also as the JSON and the binary chunk of a `.glb`, whose lengths a
/// fuzzer hardly guesses.
///
/// # Panics
/// If something is wrong.
pub fn run(data: &[u8]) {
    import(data);
    if let Some(end) = data.iter().position(|&byte| byte == 0) {
        import(&glb(&data[..end], &data[end + 1..]));
    }
}

fn import(bytes: &[u8]) {
    let options = ImportOptions { memory_bytes: MEMORY_BYTES, ..ImportOptions::default() };
    if let Ok(imported) = import_gltf_slice("fuzzed", bytes, &options) {
        check(&imported);
    }
}

fn check(Imported { scene, cameras, .. }: &Imported) {
    assert!(scene.triangles().len() as u64 * 100 <= MEMORY_BYTES);
    for (corners, _) in scene.triangles() {
        assert!(corners.iter().all(|v| v.position.is_finite() && v.normal.is_finite() && v.uv.is_finite()));
        let [a, b, c] = corners.map(|v| v.position.as_dvec3());
        assert!((b - a).cross(c - a).length() > 0.0);
    }
    scene.materials().iter().for_each(check_material);
    check_lights(scene);
    for camera in cameras {
        assert!(camera.pinhole(4, 3).is_ok());
    }
}

fn check_material(material: &Material) {
    let unit = |value: &f32| (0.0..=1.0).contains(value);
    match &material.scattering {
        Scattering::MetallicRoughness { metallic, roughness, .. } => assert!(unit(metallic) && unit(roughness)),
        Scattering::Glass { ior, .. } => assert!(*ior > 1.0 && ior.is_finite()),
        Scattering::Diffuse | Scattering::Mirror => {}
    }
    assert!(material.alpha_cutoff.is_none_or(|cutoff| cutoff > 0.0 && cutoff <= 2.0));
    for surface in [&material.base, &material.emission] {
        let color = surface.color(glam::Vec2::splat(0.3));
        assert!(color.is_finite() && color.min_element() >= 0.0);
    }
}

fn check_lights(scene: &Scene) {
    for light in &scene.lighting().lights {
        let seen = light.at(glam::Vec3::ONE);
        assert!(seen.is_none_or(|seen| !seen.irradiance.is_nan() && seen.irradiance.min_element() >= 0.0));
        if let Light::Spot { inner, outer, .. } = light {
            assert!(inner < outer);
        }
    }
}

fn glb(json: &[u8], blob: &[u8]) -> Vec<u8> {
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(((28 + json.len() + blob.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", blob)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

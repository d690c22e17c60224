//! Materials and textures.

use glam::{Vec2, Vec3};
use image::{DynamicImage, ImageFormat, Luma, Rgb, RgbImage, Rgba, RgbaImage};
use lf_scene::{ColorEncoding, Imported, Material, Scattering, Surface, Tracer};
use serde_json::{Value, json};

use crate::files::{add_picture, encoded, import, noted, refusal, square};

fn material(value: Value) -> (Material, Imported) {
    let (mut json, binary) = square();
    json["materials"][0] = value;
    let imported = import(&json, &binary).unwrap();
    (imported.scene.materials()[0].clone(), imported)
}

/// A picture of 2×1 texels: red with alpha ¼, and blue.
fn picture() -> DynamicImage {
    let mut picture = RgbaImage::new(2, 1);
    picture.put_pixel(0, 0, Rgba([255, 0, 0, 64]));
    picture.put_pixel(1, 0, Rgba([0, 0, 255, 255]));
    picture.into()
}

#[test]
fn factors_arrive() {
    let pbr = json!({ "baseColorFactor": [0.1, 0.2, 0.3, 1.0], "metallicFactor": 1.0, "roughnessFactor": 0.0 });
    let strength = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 4.0 } });
    let (material, imported) = material(json!({
        "pbrMetallicRoughness": pbr, "emissiveFactor": [0.5, 0.25, 0.0], "extensions": strength, "doubleSided": true
    }));
    assert_eq!(material.base, Surface::Uniform(Vec3::new(0.1, 0.2, 0.3)));
    assert_eq!(material.emission, Surface::Uniform(Vec3::new(2.0, 1.0, 0.0)));
    assert!(material.double_sided && material.alpha_cutoff.is_none());
    assert_eq!(material.scattering, Scattering::MetallicRoughness { metallic: 1.0, roughness: 0.0, texture: None });
    assert!(noted(&imported).is_empty(), "{:?}", imported.warnings);
}

#[test]
fn transmission_becomes_glass() {
    let glass = |extensions: Value| {
        let pbr = json!({ "metallicFactor": 0, "roughnessFactor": 0 });
        material(json!({ "pbrMetallicRoughness": pbr, "extensions": extensions }))
    };
    let clear = json!({ "transmissionFactor": 1.0 });
    let (pane, _) = glass(json!({ "KHR_materials_transmission": clear }));
    assert_eq!(pane.scattering, Scattering::Glass { ior: 1.5, thin: true });
    let volume = json!({ "thicknessFactor": 0.1, "attenuationDistance": 2.0 });
    let (solid, imported) = glass(json!({ "KHR_materials_transmission": clear, "KHR_materials_ior": { "ior": 1.33 },
        "KHR_materials_volume": volume }));
    assert_eq!(solid.scattering, Scattering::Glass { ior: 1.33, thin: false });
    assert!(imported.warnings.iter().any(|warning| warning.contains("absorbs")), "{:?}", imported.warnings);
    let (weak, _) = glass(json!({ "KHR_materials_transmission": { "transmissionFactor": 0.25 } }));
    assert!(matches!(weak.scattering, Scattering::MetallicRoughness { .. }));
    let (flat, imported) = glass(json!({ "KHR_materials_transmission": clear, "KHR_materials_ior": { "ior": 0.5 } }));
    assert!(matches!(flat.scattering, Scattering::Glass { ior, .. } if ior > 1.0));
    assert!(imported.warnings.iter().any(|warning| warning.contains("out of their range")));
}

/// Only the part that is not metal transmits, and metal is what a file means that says nothing.
#[test]
fn metals_do_not_transmit() {
    let clear = json!({ "KHR_materials_transmission": { "transmissionFactor": 1.0 } });
    let cases = [
        (json!({}), false, Some("are metals, which")),
        (json!({ "metallicFactor": 0.75 }), false, Some("metals in part")),
        (json!({ "metallicFactor": 0.25 }), true, Some("metals in part")),
        (json!({ "metallicFactor": 0, "roughnessFactor": 0 }), true, None),
    ];
    for (pbr, expected, said) in cases {
        let (material, imported) =
            material(json!({ "pbrMetallicRoughness": pbr, "emissiveFactor": [1, 1, 1], "extensions": clear }));
        assert_eq!(matches!(material.scattering, Scattering::Glass { .. }), expected, "{pbr}");
        let notes = noted(&imported);
        assert!(said.is_none_or(|said| notes.iter().any(|note| note.contains(said))), "{pbr}: {notes:?}");
        assert!(said.is_some() || notes.is_empty(), "{pbr}: {notes:?}");
    }
    // The picture's blue, which is how much metal there is, is 0 on its left and 1 on its right.
    let (mut json, mut binary) = square();
    add_picture(&mut json, &mut binary, &encoded(&picture(), ImageFormat::Png), "image/png");
    let thickness = json!({ "thicknessFactor": 0.1, "thicknessTexture": { "index": 0 } });
    for (metallic, expected) in [(1.0, false), (0.5, true)] {
        let transmission = json!({ "transmissionFactor": 0.99 });
        json["materials"][0] = json!({
            "pbrMetallicRoughness": { "metallicFactor": metallic, "metallicRoughnessTexture": { "index": 0 } },
            "extensions": { "KHR_materials_transmission": transmission, "KHR_materials_volume": thickness.clone() }
        });
        let imported = import(&json, &binary).unwrap();
        let scattering = &imported.scene.materials()[0].scattering;
        assert_eq!(matches!(scattering, Scattering::Glass { .. }), expected, "{metallic}");
        assert!(imported.warnings.iter().any(|warning| warning.contains("metals in part")), "{:?}", imported.warnings);
        assert_eq!(imported.warnings.iter().any(|warning| warning.contains("textures of thickness")), expected);
    }
}

#[test]
fn black_pictures_still_cut_holes() {
    let (mut json, mut binary) = square();
    add_picture(&mut json, &mut binary, &encoded(&picture(), ImageFormat::Png), "image/png");
    for (mode, textured) in [("OPAQUE", false), ("MASK", true), ("BLEND", true)] {
        json["materials"][0] = json!({
            "pbrMetallicRoughness": { "baseColorFactor": [0, 0, 0, 1], "baseColorTexture": { "index": 0 } },
            "emissiveTexture": { "index": 0 }, "alphaMode": mode
        });
        let imported = import(&json, &binary).unwrap();
        let material = &imported.scene.materials()[0];
        assert_eq!(matches!(material.base, Surface::Textured(..)), textured, "{mode}");
        assert_eq!(material.base.color(Vec2::new(0.25, 0.5)), Vec3::ZERO);
        assert_eq!(material.emission, Surface::Uniform(Vec3::ZERO));
        let tracer = Tracer::new(imported.scene);
        // The left half has alpha ¼, the right half 1.
        let met = |x: f32| tracer.distance(Vec3::new(5.0 + x, 0.5, 3.0), Vec3::NEG_Z).is_some();
        assert_eq!((met(0.25), met(0.75)), (!textured, true), "{mode}");
    }
}

#[test]
fn textures_have_alpha_and_the_right_encoding() {
    let (mut json, mut binary) = square();
    add_picture(&mut json, &mut binary, &encoded(&picture(), ImageFormat::Png), "image/png");
    json["materials"][0] = json!({
        "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 0.5, 0.5], "baseColorTexture": { "index": 0 },
            "metallicRoughnessTexture": { "index": 0 } },
        "emissiveFactor": [0, 0, 2], "emissiveTexture": { "index": 0 }, "alphaMode": "MASK", "alphaCutoff": 0.25
    });
    let imported = import(&json, &binary).unwrap();
    let material = &imported.scene.materials()[0];
    let left = Vec2::new(0.25, 0.5);
    assert_eq!(material.base.color(left), Vec3::X);
    assert_eq!(material.base.color(Vec2::new(0.75, 0.5)), Vec3::Z * 0.5);
    assert!((material.base.alpha(left) - 64.0 / 255.0).abs() < 1e-6);
    // Alpha ¼ × factor ½ is below the cutoff of ¼: the picture's own alpha is compared with ½.
    assert_eq!(material.alpha_cutoff, Some(0.5));
    assert_eq!(material.emission.color(Vec2::new(0.75, 0.5)), Vec3::Z * 2.0);
    let Scattering::MetallicRoughness { texture: Some(texture), .. } = &material.scattering else {
        panic!("{material:?}")
    };
    assert_eq!(texture.encoding, ColorEncoding::Linear);
    json["materials"][0]["alphaMode"] = json!("BLEND");
    let blended = import(&json, &binary).unwrap();
    assert_eq!(blended.scene.materials()[0].alpha_cutoff, Some(1.0));
    assert!(blended.warnings[0].contains("blended"));
}

#[test]
fn pictures_of_all_kinds_are_decoded() {
    let grey = DynamicImage::ImageLuma16(image::ImageBuffer::from_pixel(2, 2, Luma([0x8000])));
    let color = DynamicImage::ImageRgb8(RgbImage::from_pixel(8, 8, Rgb([200, 200, 200])));
    let pictures = [(encoded(&grey, ImageFormat::Png), 128), (encoded(&color, ImageFormat::Jpeg), 200)];
    for (bytes, value) in pictures {
        let (mut json, mut binary) = square();
        // The type that is named does not matter.
        add_picture(&mut json, &mut binary, &bytes, "image/png");
        json["materials"][0] = json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } });
        let imported = import(&json, &binary).unwrap();
        let Surface::Textured(texture, _) = &imported.scene.materials()[0].base else { panic!("no texture") };
        assert!(texture.image.texels().iter().all(|&[r, g, b, a]| (r, g, b, a) == (value, value, value, 255)));
    }
}

#[test]
fn coordinates_follow_the_texture_and_its_transform() {
    let (mut json, mut binary) = square();
    add_picture(&mut json, &mut binary, &encoded(&picture(), ImageFormat::Png), "image/png");
    let uv_of = |json: &Value, binary: &[u8]| {
        import(json, binary).map(|i| (i.scene.triangles()[0].0.map(|v| v.uv), i.warnings))
    };
    let transform = json!({ "KHR_texture_transform": { "offset": [0.5, 0.25], "scale": [2, 3] } });
    json["materials"][0] =
        json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "extensions": transform } } });
    let (uvs, _) = uv_of(&json, &binary).unwrap();
    assert_eq!(uvs, [Vec2::new(0.5, 0.25), Vec2::new(2.5, 0.25), Vec2::new(2.5, 3.25)]);
    // A quarter turn: what lay to the right lies above, where v is less.
    let turn = json!({ "KHR_texture_transform": { "rotation": std::f32::consts::FRAC_PI_2 } });
    json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = turn;
    let (uvs, _) = uv_of(&json, &binary).unwrap();
    assert!(uvs[1].distance(Vec2::NEG_Y) < 1e-6 && uvs[2].distance(Vec2::new(1.0, -1.0)) < 1e-6, "{uvs:?}");
    // A second set, which another texture does not use; and a texture that ends.
    json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(4);
    json["accessors"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC2" }));
    json["samplers"] = json!([{ "wrapS": 33071 }]);
    json["textures"][0]["sampler"] = json!(0);
    json["materials"][0] = json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "texCoord": 1 },
        "metallicRoughnessTexture": { "index": 0 } } });
    binary[12..16].copy_from_slice(&1.5f32.to_le_bytes());
    let (uvs, warnings) = uv_of(&json, &binary).unwrap();
    assert_eq!(uvs[1], Vec2::new(0.0, 1.5), "two floats apart, not three");
    assert!(
        warnings.iter().any(|w| w.contains("instead of their own"))
            && warnings.iter().any(|w| w.contains("does not repeat"))
    );
}

#[test]
fn missing_coordinates_and_broken_normals_are_noted() {
    let (mut json, mut binary) = square();
    binary[48..52].copy_from_slice(&f32::NAN.to_le_bytes());
    binary[68..72].copy_from_slice(&0.0f32.to_le_bytes());
    let imported = import(&json, &binary).unwrap();
    assert_eq!(noted(&imported), ["normals are zero or not finite, and computed instead (2)"]);
    assert!(imported.scene.triangles().iter().flat_map(|(corners, _)| corners).all(|v| v.normal == Vec3::Z));
    let (_, good) = square();
    json["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": 0, "NORMAL": 1 });
    assert!(noted(&import(&json, &good).unwrap()).is_empty(), "no texture needs them");
    binary = good;
    add_picture(&mut json, &mut binary, &encoded(&picture(), ImageFormat::Png), "image/png");
    json["materials"][0] = json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } });
    let imported = import(&json, &binary).unwrap();
    assert!(
        noted(&imported).contains(&"primitives lack the texture coordinates that their material uses, taken for 0 (1)")
    );
}

#[test]
fn numbers_out_of_range_are_mended_and_infinite_ones_refused() {
    let (material, imported) = material(json!({
        "pbrMetallicRoughness": { "baseColorFactor": [2, -1, 0.5, 1], "metallicFactor": 7, "roughnessFactor": -1 },
        "emissiveFactor": [-3, 0, 0]
    }));
    assert_eq!(material.base, Surface::Uniform(Vec3::new(1.0, 0.0, 0.5)));
    assert_eq!(material.scattering, Scattering::MetallicRoughness { metallic: 1.0, roughness: 0.0, texture: None });
    assert!(
        imported.warnings.iter().any(|warning| warning.ends_with("brought into it (5)")),
        "{:?}",
        imported.warnings
    );
    let (mut json, binary) = square();
    json["materials"][0]["emissiveFactor"] = json!([1e300, 0, 0]);
    let error = refusal(&json, &binary);
    // The second where another crate asks serde_json for exact floats.
    assert!(error.contains("material 0") || error.contains("number out of range"), "{error}");
}

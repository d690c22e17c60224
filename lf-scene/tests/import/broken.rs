//! Broken glTF files: one clear error each, no panic, no memory beyond the budget.

use image::{DynamicImage, ImageFormat, RgbaImage};
use lf_scene::{ImportError, ImportOptions, import_gltf_slice};
use serde_json::{Value, json};

use crate::files::{add_picture, encoded, glb, import, noted, refusal, square};

#[test]
fn each_broken_number_is_an_error_that_names_the_place() {
    let (good, binary) = square();
    let edits: [(&str, Value, &str); 16] = [
        ("/accessors/0/count", json!(4_000_000_000u32), "accessor 0"),
        ("/accessors/3/componentType", json!(5126), "accessor 3"),
        ("/accessors/0/type", json!("VEC2"), "accessor 0"),
        ("/accessors/1/count", json!(3), "3 normals for 4 positions"),
        ("/bufferViews/0/byteLength", json!(4000), "buffer view 0"),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), "buffer view 0"),
        ("/buffers/0/byteLength", json!(100_000), "buffer 0"),
        ("/buffers/0/byteLength", json!("long"), "JSON"),
        ("/meshes/0/primitives/0/attributes/POSITION", json!(9), "accessor 9"),
        ("/accessors/1/bufferView", json!(7), "JSON"),
        ("/scenes/0/nodes/0", json!(12), "JSON"),
        ("/nodes/0/mesh", json!(-1), "JSON"),
        ("/nodes/0/translation", json!([1e38, 1e38, 1e300]), "is not finite"),
        ("/asset/version", json!("3.0"), "glTF 3.0"),
        ("/meshes", json!({}), "JSON"),
        ("/scenes/0/nodes", json!([]), "no triangles"),
    ];
    for (pointer, value, said) in edits {
        let mut json = good.clone();
        match json.pointer_mut(pointer) {
            Some(place) => *place = value.clone(),
            None => json["bufferViews"][0]["byteOffset"] = value.clone(),
        }
        let error = refusal(&json, &binary);
        // Where another crate asks serde_json for exact floats, the parser refuses what is too large for one.
        let parser = said == "is not finite" && error.contains("number out of range");
        assert!(error.contains(said) || parser, "{pointer} = {value}: {error}");
    }
}

#[test]
fn broken_vertices_and_indices_are_named() {
    let (json, good) = square();
    for bad in [f32::NAN, f32::INFINITY] {
        let mut binary = good.clone();
        binary[12..16].copy_from_slice(&bad.to_le_bytes());
        assert!(refusal(&json, &binary).contains("vertex 1 is not finite"));
    }
    let mut binary = good.clone();
    binary[128..130].copy_from_slice(&900u16.to_le_bytes());
    assert!(refusal(&json, &binary).contains("index 900 of 4 vertices"));
    let mut large = json.clone();
    large["nodes"][0]["scale"] = json!([1e13, 1e13, 1]);
    assert!(refusal(&large, &good).contains("vertex position"));
}

#[test]
fn triangles_without_area_are_left_out() {
    let (json, mut binary) = square();
    // The second triangle's last corner becomes its first.
    binary[138..140].copy_from_slice(&0u16.to_le_bytes());
    let imported = import(&json, &binary).unwrap();
    assert_eq!(imported.scene.triangles().len(), 1);
    assert_eq!(noted(&imported), ["triangles have no area and are left out (1)"]);
    let mut flat = json.clone();
    flat["nodes"][0]["scale"] = json!([1, 0, 0]);
    assert!(refusal(&flat, &binary).contains("no triangles"));
}

#[test]
fn nodes_form_trees_of_any_depth() {
    let (good, binary) = square();
    let mut ring = good.clone();
    ring["nodes"][0]["children"] = json!([0]);
    assert!(refusal(&ring, &binary).contains("node 0: it has two parents"));
    let mut deep = good.clone();
    let mut nodes: Vec<Value> = (1..100_000).map(|child| json!({ "children": [child] })).collect();
    nodes.push(json!({ "mesh": 0 }));
    deep["nodes"] = json!(nodes);
    deep["scenes"][0]["nodes"] = json!([0]);
    assert_eq!(import(&deep, &binary).unwrap().scene.triangles().len(), 2);
}

#[test]
fn required_extensions_that_are_missing_are_named() {
    let (mut json, binary) = square();
    json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert!(refusal(&json, &binary).contains("KHR_draco_mesh_compression"));
}

#[test]
fn broken_pictures_are_named() {
    let picture =
        DynamicImage::ImageRgba8(RgbaImage::from_fn(16, 16, |x, y| image::Rgba([x as u8 * 9, y as u8 * 7, 3, 255])));
    let refused = |bytes: &[u8]| {
        let (mut json, mut binary) = square();
        add_picture(&mut json, &mut binary, bytes, "image/png");
        json["materials"][0] = json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } });
        refusal(&json, &binary)
    };
    assert!(refused(b"0123").contains("image 0: its 4 bytes are neither PNG nor JPEG"));
    let jpeg = encoded(&DynamicImage::ImageRgb8(picture.to_rgb8()), ImageFormat::Jpeg);
    for whole in [encoded(&picture, ImageFormat::Png), jpeg] {
        assert!(refused(&whole[..whole.len() / 3]).contains("image 0"));
    }
    let mut corrupt = encoded(&picture, ImageFormat::Png);
    let middle = corrupt.len() / 2;
    corrupt[middle] ^= 0xff;
    assert!(refused(&corrupt).contains("image 0"));
    // A picture that says it has 65 535 × 65 535 texels; its header's checksum does not matter before the size does.
    let mut bomb = encoded(&picture, ImageFormat::Png);
    bomb[16..24].copy_from_slice(&[0, 0, 255, 255, 0, 0, 255, 255]);
    let crc = crc32(&bomb[12..29]);
    bomb[29..33].copy_from_slice(&crc.to_be_bytes());
    assert!(refused(&bomb).contains("bytes of memory"), "{}", refused(&bomb));
}

/// The checksum of PNG's chunks.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1));
    !bytes.iter().fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}

#[test]
fn pictures_that_come_from_nowhere_are_refused() {
    let (mut json, binary) = square();
    json["textures"] = json!([{ "source": 0 }]);
    json["materials"][0] = json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } });
    // The `gltf` crate panics on the first two.
    let images = [
        json!({}),
        json!({ "bufferView": 0 }),
        json!({ "uri": "missing.png" }),
        json!({ "uri": "data:image/png;base64," }),
    ];
    for image in images {
        json["images"] = json!([image]);
        assert!(refusal(&json, &binary).contains("image 0"), "{image}");
    }
    json["textures"] = json!([{}]);
    let imported = import(&json, &binary).unwrap();
    assert!(imported.warnings.iter().any(|warning| warning.contains("neither a PNG nor a JPEG")));
}

#[test]
fn many_nodes_with_one_mesh_stay_within_the_budget() {
    let (mut json, binary) = square();
    let nodes: Vec<usize> = (0..20_000).collect();
    json["nodes"] = json!(vec![json!({ "mesh": 0 }); nodes.len()]);
    json["scenes"][0]["nodes"] = json!(nodes);
    let options = ImportOptions { memory_bytes: 16 << 20, ..ImportOptions::default() };
    let error = import_gltf_slice("many", &glb(&json, &binary), &options).unwrap_err();
    assert!(matches!(error, ImportError::LimitExceeded { .. }), "{error}");
    assert_eq!(import(&json, &binary).unwrap().scene.triangles().len(), 40_000);
}

#[test]
fn buffers_without_bytes_are_named() {
    let (good, binary) = square();
    let said = |json: &Value, with_binary: bool| {
        let text = json.to_string();
        let bytes = if with_binary { glb(json, &binary) } else { text.into_bytes() };
        import_gltf_slice("made", &bytes, &ImportOptions::default()).unwrap_err().to_string()
    };
    assert_eq!(said(&good, false), "buffer 0: the file has no binary chunk");
    let mut second = good.clone();
    second["buffers"].as_array_mut().unwrap().push(json!({ "byteLength": 4 }));
    assert_eq!(said(&second, true), "buffer 1: it names no file");
    let mut outside = good.clone();
    outside["buffers"][0]["uri"] = json!("square.bin");
    assert_eq!(said(&outside, false), "buffer 0: \"square.bin\" is outside of the file");
    let mut none = good.clone();
    none["buffers"] = json!([]);
    assert!(said(&none, true).starts_with("JSON: bufferViews[0].buffer"), "{}", said(&none, true));
    // A chunk of another kind is passed over.
    let mut other = glb(&good, &binary);
    let place = other.windows(4).position(|bytes| bytes == b"BIN\0").unwrap();
    other[place..place + 4].copy_from_slice(b"TEXT");
    let error = import_gltf_slice("made", &other, &ImportOptions::default()).unwrap_err();
    assert_eq!(error.to_string(), "buffer 0: the file has no binary chunk");
}

#[test]
fn files_that_are_cut_off_are_errors() {
    let (json, binary) = square();
    let bytes = glb(&json, &binary);
    for length in 0..bytes.len() {
        let cut = import_gltf_slice("cut", &bytes[..length], &ImportOptions::default());
        assert!(cut.is_err(), "{length} bytes of {}", bytes.len());
    }
}

//! glTF and OBJ files made byte by byte, good and bad.

use std::fs;
use std::path::{Path, PathBuf};

use glam::Vec3;
use lf_scene::{Imported, SceneError, Tracer, import_gltf, import_obj};
use serde_json::{Value, json};

/// A folder of its own for each test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// A .glb file from its JSON and its binary chunk.
fn glb(path: &Path, json: &Value, binary: &[u8]) {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut data = binary.to_vec();
    data.resize(data.len().next_multiple_of(4), 0);
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(((12 + 8 + text.len() + 8 + data.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &data)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    fs::write(path, file).unwrap();
}

/// A triangle in the plane z = 0 with indices, under a node that moves it by 5 along x, and a camera.
fn triangle() -> (Value, Vec<u8>) {
    let positions: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut binary: Vec<u8> = positions.iter().flat_map(|v| v.to_le_bytes()).collect();
    binary.extend([0u16, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
    let json = json!({
        "asset": { "version": "2.0", "copyright": "nobody" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 1] }],
        "nodes": [
            { "mesh": 0, "translation": [5.0, 0.0, 0.0] },
            { "camera": 0, "translation": [5.2, 0.2, 3.0] }
        ],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }],
        "materials": [{
            "pbrMetallicRoughness": { "baseColorFactor": [0.0, 0.0, 0.0, 1.0], "metallicFactor": 0.0 },
            "emissiveFactor": [0.25, 0.5, 1.0]
        }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] }],
        "buffers": [{ "byteLength": 42 }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 6 }
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR" }
        ]
    });
    (json, binary)
}

fn import(name: &str, json: &Value, binary: &[u8]) -> Result<Imported, SceneError> {
    let path = folder("gltf").join(format!("{name}.glb"));
    glb(&path, json, binary);
    import_gltf(&path)
}

#[test]
fn transforms_materials_and_camera_arrive() {
    let (json, binary) = triangle();
    let imported = import("triangle", &json, &binary).unwrap();
    assert_eq!(imported.copyright.as_deref(), Some("nobody"));
    assert_eq!(imported.camera, Some((Vec3::new(5.2, 0.2, 3.0), Vec3::NEG_Z)));
    assert!(imported.warnings.is_empty(), "{:?}", imported.warnings);
    let tracer = Tracer::new(imported.scene);
    let traced = tracer.trace(Vec3::new(5.2, 0.2, 3.0), Vec3::NEG_Z);
    assert_eq!((traced.radiance, traced.distance), (Vec3::new(0.25, 0.5, 1.0), 3.0));
    assert!(tracer.distance(Vec3::new(0.2, 0.2, 3.0), Vec3::NEG_Z).is_none());
}

#[test]
fn what_is_not_used_is_listed() {
    let (mut json, binary) = triangle();
    json["materials"][0]["alphaMode"] = json!("BLEND");
    let lines = json!({ "attributes": { "POSITION": 0 }, "mode": 1 });
    json["meshes"][0]["primitives"].as_array_mut().unwrap().push(lines);
    let warnings = import("warnings", &json, &binary).unwrap().warnings;
    assert_eq!(warnings.len(), 2, "{warnings:?}");
}

#[test]
fn broken_files_are_errors_and_never_panics() {
    let (good, binary) = triangle();
    let edits: [(&str, &str, Value); 7] = [
        ("count past the view", "/accessors/0/count", json!(4_000_000)),
        ("offset past the view", "/accessors/0/byteOffset", json!(36)),
        ("view past the buffer", "/bufferViews/0/byteLength", json!(4000)),
        ("buffer past the file", "/buffers/0/byteLength", json!(100_000)),
        ("no such accessor", "/meshes/0/primitives/0/attributes/POSITION", json!(9)),
        ("no such view", "/accessors/1/bufferView", json!(7)),
        ("no such node", "/scenes/0/nodes/0", json!(12)),
    ];
    for (what, pointer, value) in edits {
        let mut json = good.clone();
        match json.pointer_mut(pointer) {
            Some(place) => *place = value,
            None => json["accessors"][0]["byteOffset"] = value,
        }
        assert!(import("broken", &json, &binary).is_err(), "{what}");
    }
    // A ring of nodes comes to an end; accessors of types that glTF forbids are left out.
    let mut ring = good.clone();
    ring["nodes"][0]["children"] = json!([0]);
    assert!(import("ring", &ring, &binary).is_ok());
    let mut types = good.clone();
    types["accessors"][1]["componentType"] = json!(5126);
    types["accessors"][1]["count"] = json!(1);
    assert!(import("types", &types, &binary).is_err());
    // Indices out of range name no triangle.
    let mut wild = binary.clone();
    wild[36..38].copy_from_slice(&900u16.to_le_bytes());
    assert!(matches!(import("wild", &good, &wild), Err(SceneError::NoTriangles { .. })));
    let mut not_a_number = binary.clone();
    not_a_number[0..4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(import("nan", &good, &not_a_number).is_err());
    let path = folder("gltf").join("good.glb");
    glb(&path, &good, &binary);
    let bytes = fs::read(&path).unwrap();
    let cut = folder("gltf").join("cut.glb");
    for length in 0..bytes.len() {
        fs::write(&cut, &bytes[..length]).unwrap();
        assert!(import_gltf(&cut).is_err(), "{length} bytes of {}", bytes.len());
    }
}

#[test]
fn obj_polygons_become_triangles_with_normals() {
    let path = folder("obj").join("square.obj");
    fs::write(&path, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").unwrap();
    let mesh = import_obj(&path).unwrap();
    assert_eq!((mesh.triangles().len(), mesh.positions().len()), (2, 4));
    assert!(mesh.normals().iter().all(|n| *n == Vec3::Z));
}

#[test]
fn bad_obj_files_are_errors() {
    let path = folder("obj").join("bad.obj");
    for text in
        ["", "v 0 0 0\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "f x y z"]
    {
        fs::write(&path, text).unwrap();
        assert!(import_obj(&path).is_err(), "{text:?}");
    }
    assert!(import_obj(Path::new("no such file.obj")).is_err());
}

//! glTF files made byte by byte.

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageFormat};
use lf_scene::{ImportError, ImportOptions, Imported, import_gltf_slice};
use serde_json::{Value, json};

/// A folder of its own for each test.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// A .glb file from its JSON and its binary chunk.
pub(crate) fn glb(json: &Value, binary: &[u8]) -> Vec<u8> {
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
    file
}

/// A square in the plane z = 0 with normals along +Z and texture coordinates (x, y), of two triangles with indices, under a
/// node that moves it by 5 along x, and a camera 3 before it.
pub(crate) fn square() -> (Value, Vec<u8>) {
    let corners = [[0.0f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let positions = corners.iter().flat_map(|[x, y]| [*x, *y, 0.0]);
    let normals = corners.iter().flat_map(|_| [0.0, 0.0, 1.0]);
    let numbers = positions.chain(normals).chain(corners.iter().flatten().copied());
    let mut binary: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
    binary.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    let json = json!({
        "asset": { "version": "2.0", "copyright": "nobody" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 1] }],
        "nodes": [
            { "mesh": 0, "translation": [5.0, 0.0, 0.0] },
            { "camera": 0, "name": "eye", "translation": [5.2, 0.2, 3.0] }
        ],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }],
        "materials": [{
            "pbrMetallicRoughness": { "baseColorFactor": [0.0, 0.0, 0.0, 1.0], "metallicFactor": 0.0 },
            "emissiveFactor": [0.25, 0.5, 1.0]
        }],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "indices": 3, "material": 0
        }] }],
        "buffers": [{ "byteLength": 140 }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 96, "byteLength": 32 },
            { "buffer": 0, "byteOffset": 128, "byteLength": 12 }
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2" },
            { "bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR" }
        ]
    });
    (json, binary)
}

/// Adds a picture as image, texture and buffer view.
pub(crate) fn add_picture(json: &mut Value, binary: &mut Vec<u8>, picture: &[u8], kind: &str) {
    let view = json["bufferViews"].as_array().unwrap().len();
    let place = json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": picture.len() });
    json["bufferViews"].as_array_mut().unwrap().push(place);
    binary.extend(picture);
    json["buffers"][0]["byteLength"] = json!(binary.len());
    json["images"] = json!([{ "bufferView": view, "mimeType": kind }]);
    json["textures"] = json!([{ "source": 0 }]);
}

pub(crate) fn encoded(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    picture.write_to(&mut out, format).unwrap();
    out.into_inner()
}

pub(crate) fn import(json: &Value, binary: &[u8]) -> Result<Imported, ImportError> {
    import_gltf_slice("made", &glb(json, binary), &ImportOptions::default())
}

/// The warnings but for the one about the sky, which every scene gets for which no environment is given.
pub(crate) fn noted(imported: &Imported) -> Vec<&str> {
    let warnings = imported.warnings.iter().map(String::as_str);
    warnings.filter(|warning| !warning.starts_with("no environment is given")).collect()
}

/// The error as people see it.
pub(crate) fn refusal(json: &Value, binary: &[u8]) -> String {
    import(json, binary).map(|imported| imported.warnings).unwrap_err().to_string()
}

//! Nodes, cameras, lights, and the real scenes.

use std::error::Error;
use std::f32::consts::PI;
use std::io::Write;
use std::path::Path;

use glam::Vec3;
use lf_math::Image;
use lf_scene::{Environment, EnvironmentMap, ImportOptions, Light, Tracer, import_gltf, import_gltf_slice};
use serde_json::json;

use crate::files::{folder, glb, import, noted, square};

#[test]
fn transforms_materials_and_camera_arrive() {
    let (json, binary) = square();
    let imported = import(&json, &binary).unwrap();
    assert_eq!(imported.copyright.as_deref(), Some("nobody"));
    let camera = &imported.cameras[0];
    assert_eq!((camera.position, camera.forward, camera.up), (Vec3::new(5.2, 0.2, 3.0), Vec3::NEG_Z, Vec3::Y));
    assert_eq!((camera.name.as_deref(), camera.fov_y), (Some("eye"), 0.7));
    assert!(noted(&imported).is_empty(), "{:?}", imported.warnings);
    assert!(imported.scene.lighting().lights.is_empty(), "what glows needs no lamp");
    let tracer = Tracer::new(imported.scene);
    assert_eq!(tracer.distance(Vec3::new(5.2, 0.2, 3.0), Vec3::NEG_Z), Some(3.0));
    assert!(tracer.distance(Vec3::new(0.2, 0.2, 3.0), Vec3::NEG_Z).is_none());
}

#[test]
fn mirrored_nodes_keep_their_front() {
    let (mut json, binary) = square();
    for (scale, front) in
        [([1, 1, 1], 1.0), ([-1, 1, 1], 1.0), ([-2, -3, 1], 1.0), ([1, 1, -1], -1.0), ([-1, -1, -1], -1.0)]
    {
        json["nodes"][0]["scale"] = json!(scale);
        let imported = import(&json, &binary).unwrap();
        for (corners, _) in imported.scene.triangles() {
            let [a, b, c] = corners.map(|v| v.position);
            let winding = (b - a).cross(c - a).normalize();
            assert_eq!(winding, Vec3::Z * front, "{scale:?}");
            assert!(corners.iter().all(|v| v.normal.normalize() == winding), "{scale:?}");
        }
    }
}

#[test]
fn lights_become_radiometric() {
    let (mut json, binary) = square();
    json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "point", "intensity": 683, "color": [1, 0.5, 0] },
        { "type": "spot", "intensity": 1366, "spot": { "innerConeAngle": 0.2, "outerConeAngle": 0.6 } },
        { "type": "directional", "intensity": 68.3 }
    ] } });
    for light in 0..3 {
        // A quarter turn about x: −Z, where a light shines, becomes +Y.
        let node = json!({ "translation": [0, light, 0], "rotation": [0.5f32.sqrt(), 0.0, 0.0, 0.5f32.sqrt()],
            "extensions": { "KHR_lights_punctual": { "light": light } } });
        json["nodes"].as_array_mut().unwrap().push(node);
    }
    json["scenes"][0]["nodes"] = json!([0, 1, 2, 3, 4]);
    let imported = import(&json, &binary).unwrap();
    let lights = &imported.scene.lighting().lights;
    assert_eq!(lights[0], Light::Point { position: Vec3::ZERO, intensity: Vec3::new(1.0, 0.5, 0.0) });
    let Light::Spot { position, direction, intensity, inner, outer } = lights[1] else { panic!("{lights:?}") };
    assert!(position == Vec3::Y && direction.distance(Vec3::Y) < 1e-6 && intensity == Vec3::splat(2.0));
    assert_eq!((inner, outer), (0.2, 0.6));
    let Light::Sun { towards, irradiance } = lights[2] else { panic!("{lights:?}") };
    assert!(towards.distance(Vec3::NEG_Y) < 1e-6 && irradiance.distance(Vec3::splat(0.1)) < 1e-6);
}

#[test]
fn only_a_scene_where_nothing_shines_gets_a_lamp() {
    let (mut json, binary) = square();
    json["materials"][0]["emissiveFactor"] = json!([0, 0, 0]);
    let dark = import(&json, &binary).unwrap();
    assert!(matches!(dark.scene.lighting().lights[..], [Light::Point { .. }]));
    assert!(dark.warnings[0].contains("lamp"));
    json["asset"]["extras"] = json!({ "emitters": [{ "sun_direction_world": [0, 2, 0] }, { "type": "envmap" }] });
    let sunny = import(&json, &binary).unwrap();
    assert!(matches!(sunny.scene.lighting().lights[..], [Light::Sun { towards: Vec3::Y, .. }]));
    assert!(sunny.warnings[0].contains("emitters of asset.extras"), "{:?}", sunny.warnings);
    assert!(matches!(sunny.scene.lighting().environment, Environment::Sky(_)));
}

#[test]
fn what_is_made_up_is_said() {
    let (mut json, binary) = square();
    json["asset"]["extras"] = json!({ "emitters": [{ "sun_direction_world": [0, 2, 0] }] });
    let sky = "no environment is given: a blue-white sky of [0.75, 0.85, 1] W/(m²·sr) is put around the scene, with ambient \
               light of 0.45; --environment sets another";
    let sun = "the sun's strength is not given: its irradiance is taken for [5.0, 4.7, 4.1] W/m²";
    assert_eq!(import(&json, &binary).unwrap().warnings, [sun, sky]);
    let environment = Some(EnvironmentMap::new(Image::filled(2, 1, Vec3::ONE), 0.0).unwrap());
    let options = ImportOptions { environment, ..ImportOptions::default() };
    assert_eq!(import_gltf_slice("made", &glb(&json, &binary), &options).unwrap().warnings, [sun]);
}

#[test]
fn cameras_are_all_read_and_orthographic_ones_noted() {
    let (mut json, binary) = square();
    json["cameras"] = json!([
        { "name": "left", "type": "perspective", "perspective": { "yfov": 9.0, "znear": 0.1 } },
        { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "zfar": 2, "znear": 1 } }
    ]);
    json["nodes"].as_array_mut().unwrap().push(json!({ "camera": 1 }));
    json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let imported = import(&json, &binary).unwrap();
    assert_eq!(imported.cameras.len(), 1);
    assert!(imported.cameras[0].name.as_deref() == Some("left") && imported.cameras[0].fov_y < PI);
    assert_eq!(noted(&imported).len(), 2, "{:?}", imported.warnings);
}

#[test]
fn what_is_not_used_is_listed_with_counts() {
    let (mut json, binary) = square();
    json["extensionsUsed"] = json!(["KHR_materials_clearcoat", "EXT_of_tomorrow"]);
    json["animations"] = json!([{ "channels": [], "samplers": [] }]);
    json["skins"] = json!([{ "joints": [0] }]);
    let primitives = json["meshes"][0]["primitives"].as_array_mut().unwrap();
    primitives[0]["attributes"]["COLOR_0"] = json!(0);
    primitives[0]["targets"] = json!([{ "POSITION": 0 }]);
    primitives.push(json!({ "attributes": { "POSITION": 0 }, "mode": 1 }));
    primitives.push(json!({ "attributes": { "POSITION": 0 }, "mode": 0 }));
    primitives.push(json!({ "attributes": { "POSITION": 4 } }));
    let sparse =
        json!({ "count": 1, "indices": { "bufferView": 3, "componentType": 5123 }, "values": { "bufferView": 0 } });
    let accessor = json!({ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse,
        "min": [0, 0, 0], "max": [1, 1, 0] });
    json["accessors"].as_array_mut().unwrap().push(accessor);
    let imported = import(&json, &binary).unwrap();
    let warnings = noted(&imported);
    for part in
        ["clearcoat", "EXT_of_tomorrow", "animations", "skins", "colours", "morph", "lines are left out (2)", "sparse"]
    {
        assert!(warnings.iter().any(|warning| warning.contains(part)), "{part}: {warnings:?}");
    }
    assert_eq!(warnings.len(), 8, "{warnings:?}");
}

#[test]
fn buffers_and_pictures_may_lie_beside_the_scene() {
    let (mut json, binary) = square();
    let folder = folder("beside");
    std::fs::create_dir_all(folder.join("data")).unwrap();
    std::fs::write(folder.join("data/a square.bin"), &binary).unwrap();
    json["buffers"][0]["uri"] = json!("data/a%20square.bin");
    let path = folder.join("square.gltf");
    std::fs::write(&path, json.to_string()).unwrap();
    let imported = import_gltf(&path, &ImportOptions::default()).unwrap();
    assert_eq!((imported.scene.name(), imported.scene.triangles().len()), ("square", 2));
    for uri in ["data/missing.bin", "../beside/data/a square.bin", "/etc/hostname", "file:///etc/hostname"] {
        json["buffers"][0]["uri"] = json!(uri);
        std::fs::write(&path, json.to_string()).unwrap();
        let error = import_gltf(&path, &ImportOptions::default()).unwrap_err();
        let said = error.source().unwrap().to_string();
        assert!(said.starts_with(if uri == "data/missing.bin" { "cannot read" } else { "buffer 0" }), "{uri}: {said}");
    }
    std::fs::write(&path, glb(&json, &binary)).unwrap();
    assert!(import_gltf(&path, &ImportOptions { memory_bytes: 5000, ..ImportOptions::default() }).is_err());
}

#[test]
fn real_scenes_arrive() {
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/scenes"));
    let scenes = [
        ("godot-living_room", 1_500),
        ("grey-white-room-small", 27_000),
        ("japanese-classroom", 100_000),
        ("wooden-staircase", 260_000),
    ];
    for (name, least) in scenes {
        let path = data.join(format!("{name}.glb"));
        if !path.exists() {
            let _ = writeln!(std::io::stderr(), "NOT TESTED: {} is not on this machine", path.display());
            continue;
        }
        let imported = import_gltf(&path, &ImportOptions::default()).unwrap();
        let count = imported.scene.triangles().len();
        assert!((least..=least + least / 10).contains(&count), "{name}: {count} triangles");
        assert!(noted(&imported).len() <= 4, "{name}: {:?}", imported.warnings);
        assert_eq!(imported.cameras.len(), usize::from(name != "godot-living_room"), "{name}");
    }
}

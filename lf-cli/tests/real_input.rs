//! The demo on a scene and a mesh that none of us made. They are too large to ship; without them the test says so.

use std::io::Write;
use std::path::Path;
use std::process::Command;

#[test]
fn a_real_room_and_a_real_mesh() {
    demo("grey-white-room-small", "spot-11533v");
}

/// `cargo xtask test --long` asks for it.
#[test]
fn a_staircase_of_a_quarter_million_triangles_and_a_skull() {
    if std::env::var_os("LFSLAB_LONG").is_some() {
        demo("wooden-staircase", "skull-49999v");
    } else {
        not_tested("needs LFSLAB_LONG=1");
    }
}

/// Says so straight to standard error, past the capture of the test harness.
fn not_tested(why: &str) {
    let _ = writeln!(std::io::stderr(), "NOT TESTED: {why}");
}

fn demo(scene: &str, reflector: &str) {
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data"));
    let scene = data.join(format!("scenes/{scene}.glb"));
    let mesh = data.join(format!("meshes/{reflector}.obj"));
    if !scene.exists() || !mesh.exists() {
        not_tested(&format!("{} and {} are not on this machine", scene.display(), mesh.display()));
        return;
    }
    let folder = tempfile::TempDir::new().unwrap();
    let [out, scene, mesh] = [folder.path(), &scene, &mesh].map(|path| path.to_string_lossy().into_owned());
    // Its light has an extent: by itself it would get more samples.
    let few = ["--samples", "1"];
    let arguments =
        [&["demo", "--size", "64", "--out", &out, "--scene", &scene, "--reflector", &mesh], &few[..]].concat();
    let output = Command::new(env!("CARGO_BIN_EXE_lfslab")).args(arguments).output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{stderr}");
    assert!(stderr.contains("triangles have no area and are left out"), "what is not used is listed: {stderr}");
    let report = std::fs::read(folder.path().join("report.json")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&report).unwrap();
    for reflector in ["sphere", reflector] {
        let results = json["results"].as_array().unwrap();
        let mean = |method: &str| {
            let found = results.iter().find(|r| r["reflector"] == reflector && r["method"] == method).unwrap();
            found["mean_psnr_db"].as_f64().unwrap()
        };
        assert!(mean("slabs") > mean("environment map"), "{reflector}");
    }
}

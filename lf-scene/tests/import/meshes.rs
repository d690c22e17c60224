//! OBJ meshes.

use std::fs;
use std::path::Path;

use glam::Vec3;
use lf_scene::import_obj;

use crate::files::folder;

#[test]
fn obj_polygons_become_triangles_with_normals() {
    let path = folder("obj").join("square.obj");
    fs::write(&path, "mtllib ../../no.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").unwrap();
    let mesh = import_obj(&path).unwrap();
    assert_eq!((mesh.triangles().len(), mesh.positions().len()), (2, 4));
    assert!(mesh.normals().iter().all(|n| *n == Vec3::Z));
}

#[test]
fn bad_obj_files_are_errors() {
    let path = folder("obj").join("bad.obj");
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let texts = [
        String::new(),
        "v 0 0 0\n".into(),
        format!("{triangle}f 1 2 4\n"),
        format!("{triangle}f 1 2 -9\n"),
        format!("{triangle}f 0 1 2\n"),
        format!("{triangle}f 1 2 99999999999999999999\n"),
        "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".into(),
        "v 1e30 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".into(),
        "v 0 0\nf 1 1 1".into(),
        "f x y z".into(),
    ];
    for text in texts {
        fs::write(&path, &text).unwrap();
        assert!(import_obj(&path).is_err(), "{text:?}");
    }
    fs::write(&path, [0xff, 0xfe, 0, 1, 2]).unwrap();
    assert!(import_obj(&path).is_err());
    assert!(import_obj(Path::new("no such file.obj")).is_err());
}

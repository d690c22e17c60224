//! OBJ meshes.

use std::fs;
use std::path::Path;

use glam::Vec3;
use lf_scene::{ImportedMesh, import_obj};

use crate::files::folder;

#[test]
fn obj_polygons_become_triangles_with_normals() {
    let path = folder("obj").join("square.obj");
    fs::write(&path, "mtllib ../../no.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").unwrap();
    let ImportedMesh { mesh, warnings } = import_obj(&path).unwrap();
    assert_eq!(warnings, ["statements of materials are not used (1)"]);
    assert_eq!((mesh.triangles().len(), mesh.positions().len()), (2, 4));
    assert!(mesh.normals().iter().all(|n| *n == Vec3::Z));
}

#[test]
fn what_has_no_area_is_left_out_and_counted() {
    let path = folder("obj").join("left-out.obj");
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 0 9 0\nv 8 0 0\nusemtl red\nf 1 2 3\nl 1 2\n  l 1 3 5\np 4\nf 1 5\nf 6\n\
                f 1 2 4\nf 5 5 3\n";
    fs::write(&path, text).unwrap();
    let ImportedMesh { mesh, warnings } = import_obj(&path).unwrap();
    assert_eq!((mesh.triangles(), mesh.positions()), (&[[0, 1, 2]][..], &[Vec3::ZERO, Vec3::X, Vec3::Y][..]));
    let expected = [
        "faces have fewer than three corners and are left out (2)",
        "statements of materials are not used (1)",
        "statements of points or lines are left out (3)",
        "triangles have no area and are left out (2)",
    ];
    assert_eq!(warnings, expected);
}

#[test]
fn obj_normals_that_say_nothing_are_computed_and_counted() {
    let path = folder("obj").join("normals.obj");
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 0\nvn 1 0 0\nvn nan 0 0\n";
    let cases = [
        ("f 1//1 2//2 3//3\n", "normals are zero or not finite, and computed instead (2)", 1),
        // Only some have one: `tobj` does not say which.
        (
            "f 1 2 3\nf 2//2 4//2 3//2\n",
            "objects have normals at some of their vertices only, and all are computed (1)",
            0,
        ),
    ];
    for (faces, said, given) in cases {
        fs::write(&path, format!("{corners}{faces}")).unwrap();
        let ImportedMesh { mesh, warnings } = import_obj(&path).unwrap();
        assert_eq!(warnings, [said]);
        assert_eq!(mesh.normals().iter().filter(|normal| **normal == Vec3::X).count(), given);
        assert!(mesh.normals().iter().all(|normal| [Vec3::X, Vec3::Z].contains(normal)));
    }
}

#[test]
fn bad_obj_files_are_errors() {
    let path = folder("obj").join("bad.obj");
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let texts = [
        String::new(),
        format!("{triangle}l 1 2 3\nl 1 2\np 1\n"),
        format!("{triangle}f 1 2\nf 3\n"),
        format!("{triangle}f 1 1 2\n"),
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

//! `transforms.json`, the camera file of NeRF tools (instant-ngp, Nerfstudio and others), with its pictures.
//!
//! Cameras are those of OpenGL and Blender: +X to the right, +Y up, looking along −Z; `transform_matrix` takes camera
//! space to world space, which is this project's: right-handed, +Y up, metres.

use std::fs;
use std::path::Path;

use glam::{DMat3, DVec3};
use serde_json::{Map, Value, json};

use crate::field::SlabPictures;
use crate::grid::{GridNaming, face_folder, write_grid};
use crate::plan::PlanCamera;
use crate::{ExchangeError, Intrinsics, LightField, PictureBasis, Plan, Texel};

/// Writes `transforms.json` and the pictures of all slabs (as [`write_grid`] does, by rows and columns) to `folder`.
///
/// The camera's numbers stand at the top of the file if all slabs share them, as tools of the original NeRF expect, and
/// else with each frame, which Nerfstudio reads.
///
/// # Errors
/// As [`write_grid`].
pub fn write_transforms<T: Texel>(folder: &Path, field: &LightField<'_, T>) -> Result<(), ExchangeError> {
    write_grid(folder, field, GridNaming::RowColumn)?;
    let path = folder.join("transforms.json");
    fs::write(&path, format!("{:#}\n", transforms(field))).map_err(ExchangeError::io(&path))
}

/// The content of `transforms.json`.
#[must_use]
pub fn transforms<T: Texel>(field: &LightField<'_, T>) -> Value {
    let cameras: Vec<Intrinsics> = field.all_pictures().map(|pictures| pictures.intrinsics()).collect();
    let shared = cameras.first().filter(|first| cameras.iter().all(|camera| camera == *first));
    let mut root = shared.map_or_else(Map::new, camera_fields);
    let frames = field.all_pictures().flat_map(|pictures| frames(&pictures, shared.is_none()));
    root.insert("frames".into(), frames.collect());
    Value::Object(root)
}

fn camera_fields(camera: &Intrinsics) -> Map<String, Value> {
    let angles = [0, 1].map(|i| 2.0 * (0.5 * f64::from(camera.size[i]) / camera.focal[i]).atan());
    let fields = [
        ("camera_model", json!("OPENCV")),
        ("camera_angle_x", json!(angles[0])),
        ("camera_angle_y", json!(angles[1])),
        ("fl_x", json!(camera.focal[0])),
        ("fl_y", json!(camera.focal[1])),
        ("cx", json!(camera.principal[0])),
        ("cy", json!(camera.principal[1])),
        ("w", json!(camera.size[0])),
        ("h", json!(camera.size[1])),
    ];
    fields.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

fn frames<T: Texel>(pictures: &SlabPictures<'_, T>, own_camera: bool) -> Vec<Value> {
    let folder = face_folder(pictures.slab().face());
    let frame = |(column, row)| {
        let mut fields = if own_camera { camera_fields(&pictures.intrinsics()) } else { Map::new() };
        fields.insert("file_path".into(), json!(format!("{folder}/{row:02}_{column:02}.{}", T::EXTENSION)));
        fields.insert(
            "transform_matrix".into(),
            json!(matrix(pictures.basis().world_from_camera(), pictures.position(column, row))),
        );
        Value::Object(fields)
    };
    pictures.stored_cameras().map(frame).collect()
}

/// World space from camera space, row by row.
fn matrix(rotation: DMat3, eye: DVec3) -> [[f64; 4]; 4] {
    let line = |i: usize| [rotation.x_axis[i], rotation.y_axis[i], rotation.z_axis[i], eye[i]];
    [line(0), line(1), line(2), [0.0, 0.0, 0.0, 1.0]]
}

/// The same for the pictures of a plan that are yet to be rendered, as PNG. In this project's world, whatever the plan's is.
pub(crate) fn plan_transforms(plan: &Plan) -> Value {
    let lfslab_from_world = plan.world().world_from_lfslab().transpose();
    let rotations: Vec<DMat3> =
        plan.geometry().slabs().iter().map(|slab| PictureBasis::new(slab.face()).world_from_camera()).collect();
    let frame = |camera: PlanCamera| {
        let file = plan.picture_name(camera.frame, "png");
        let matrix = rotations.get(camera.slab).map(|rotation| matrix(*rotation, lfslab_from_world * camera.position));
        json!({ "file_path": format!("{}/{file}", Plan::PICTURES), "transform_matrix": matrix })
    };
    let mut root = camera_fields(&plan.intrinsics());
    root.insert("frames".into(), plan.cameras().map(frame).collect());
    Value::Object(root)
}

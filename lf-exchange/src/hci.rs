//! Folders in the layout of the 4D Light Field Benchmark (HCI, Heidelberg, and Konstanz; Honauer et al., ACCV 2016).
//!
//! Pictures are `input_Cam000.png` and so on, row by row from the top left camera. `parameters.cfg` has the sections
//! `intrinsics`, `extrinsics` and `meta`. The sensor's size is that of the picture's longer edge. Cameras are parallel
//! with their sensors shifted, so that points at `focus_distance_m` have no disparity; `offset` is the shift in pixels
//! from one camera to the next, baseline · focal length in pixels / focus distance.
//!
//! The pose is that of the middle camera in Blender's world, with +Z up: a point (x, y, z) of this project's world is
//! (x, −z, y) there. The angles are Blender's Euler angles, in the order XYZ.

use std::fs;
use std::path::Path;

use glam::{DMat3, DVec3, EulerRot};

use crate::field::SlabPictures;
use crate::{ExchangeError, PictureAxis, Texel as _};

/// Stands for infinity. The benchmark's depth formula divides by the focus distance after multiplying with it, which
/// zero, for none, would spoil; at this distance the shift of a sensor is far below a pixel.
pub(crate) const PARALLEL_FOCUS_M: f64 = 1e6;
/// Only the ratio of focal length and sensor size means anything here. The benchmark's sensors have 35 mm.
const SENSOR_MM: f64 = 35.0;
/// The largest difference of two lengths, as a share of either, that still counts as none.
const TOLERANCE: f64 = 1e-4;

/// What a light field does not know about itself, but the benchmark wants to be told.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HciScene {
    /// The name of the scene. Line breaks are replaced by blanks.
    pub name: String,
    /// The depths of the nearest and the farthest point from the camera plane, metres; the farthest may be infinite.
    pub depth_range: Option<[f64; 2]>,
}

/// Writes a slab to `folder` as a benchmark scene.
///
/// Without a depth range the disparities reach from 0 to what a point on the focal plane has.
///
/// # Errors
/// [`ExchangeError::Unsupported`] if the slab has oblong pixels, an optical axis outside the middle, or cameras closer
/// in one direction than in the other: the format cannot express them. [`ExchangeError::InvalidArgument`] if the depth
/// range is not one, or if there is none and no focal plane. [`ExchangeError::Io`] and [`ExchangeError::Picture`] if
/// the system refuses.
pub fn write_hci(folder: &Path, pictures: &SlabPictures<'_, [u8; 4]>, scene: &HciScene) -> Result<(), ExchangeError> {
    let text = parameters(pictures, scene)?;
    fs::create_dir_all(folder).map_err(ExchangeError::io(folder))?;
    let path = folder.join("parameters.cfg");
    fs::write(&path, text).map_err(ExchangeError::io(&path))?;
    pictures.cameras().enumerate().try_for_each(|(index, (column, row))| {
        let path = folder.join(format!("input_Cam{index:03}.png"));
        <[u8; 4]>::write_picture(&pictures.picture(column, row)?, &path)
    })
}

fn parameters(pictures: &SlabPictures<'_, [u8; 4]>, scene: &HciScene) -> Result<String, ExchangeError> {
    let (camera, positions, grid) = (pictures.intrinsics(), pictures.positions(), pictures.grid());
    let focal = single("square pixels", camera.focal)?;
    for i in [0, 1] {
        single("an optical axis in the middle of the picture", [camera.principal[i], 0.5 * f64::from(camera.size[i])])?;
    }
    let baseline = baseline(positions)?;
    let [width, height] = camera.size;
    let focal_mm = focal * SENSOR_MM / f64::from(width.max(height));
    let offset = baseline * focal / PARALLEL_FOCUS_M;
    let [min, max] = disparities(pictures, scene)?.map(|inverse_depth| baseline * focal * inverse_depth - offset);
    let (eye, [rx, ry, rz]) = blender_pose(pictures);
    // Python's ConfigParser, which the benchmark's tools use, takes a single % for a reference.
    let name = scene.name.replace(char::is_control, " ").replace('%', "%%");
    Ok(format!(
        "[intrinsics]\nfocal_length_mm = {focal_mm}\nimage_resolution_x_px = {width}\nimage_resolution_y_px = {height}\n\
         sensor_size_mm = {SENSOR_MM}\nfstop = 100.0\n\n\
         [extrinsics]\nnum_cams_x = {}\nnum_cams_y = {}\nbaseline_mm = {}\nfocus_distance_m = {PARALLEL_FOCUS_M}\n\
         center_cam_x_m = {}\ncenter_cam_y_m = {}\ncenter_cam_z_m = {}\n\
         center_cam_rx_rad = {rx}\ncenter_cam_ry_rad = {ry}\ncenter_cam_rz_rad = {rz}\noffset = {offset}\n\n\
         [meta]\nscene = {name}\ncategory = lfslab\ndate = \nversion = v1\nauthors = \ncontact = \n\
         disp_min = {min}\ndisp_max = {max}\nfrustum_disp_min = {min}\nfrustum_disp_max = {max}\ndepth_map_scale = 1.0\n",
        grid[0],
        grid[1],
        1e3 * baseline,
        eye.x,
        eye.y,
        eye.z,
    ))
}

/// One number for two that have to be the same.
fn single(what: &str, [a, b]: [f64; 2]) -> Result<f64, ExchangeError> {
    if (a - b).abs() <= TOLERANCE * a.abs().max(b.abs()) {
        return Ok(a);
    }
    Err(ExchangeError::unsupported(format!("the benchmark's layout needs {what}, this slab has {a} and {b}")))
}

/// The distance between neighbouring cameras, metres. A single row or column has none of its own.
fn baseline([right, down]: [PictureAxis; 2]) -> Result<f64, ExchangeError> {
    match (right.count, down.count) {
        (_, 1) => Ok(right.step),
        (1, _) => Ok(down.step),
        _ => single("cameras that are equally far apart in rows and columns", [right.step, down.step]),
    }
}

/// The smallest and largest inverse depth.
fn disparities(pictures: &SlabPictures<'_, [u8; 4]>, scene: &HciScene) -> Result<[f64; 2], ExchangeError> {
    match (scene.depth_range, pictures.slab().focal_depth()) {
        (Some([near, far]), _) if near > 0.0 && far >= near => Ok([1.0 / far, 1.0 / near]),
        (Some([near, far]), _) => {
            Err(ExchangeError::argument(format!("a depth range has to be 0 < near ≤ far, is {near} to {far}")))
        }
        (None, Some(depth)) => Ok([0.0, 1.0 / f64::from(depth)]),
        (None, None) => {
            Err(ExchangeError::argument("the slab has no focal plane to tell its depth by; give the depth range"))
        }
    }
}

/// Blender's world, +Z up, from this project's, +Y up.
pub(crate) fn blender_from_world() -> DMat3 {
    DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y)
}

/// Where the middle of the grid is in Blender's world, and the Euler angles of its cameras.
fn blender_pose(pictures: &SlabPictures<'_, [u8; 4]>) -> (DVec3, [f64; 3]) {
    let [columns, rows] = pictures.grid();
    let middle = 0.5 * (pictures.position(0, 0) + pictures.position(columns - 1, rows - 1));
    let rotation = blender_from_world() * pictures.basis().world_from_camera();
    // Blender's XYZ turns about the fixed axes X, then Y, then Z.
    let (rz, ry, rx) = glam::DQuat::from_mat3(&rotation).to_euler(EulerRot::ZYX);
    (blender_from_world() * middle, [rx, ry, rz])
}

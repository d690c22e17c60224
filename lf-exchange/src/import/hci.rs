//! Scenes of the 4D Light Field Benchmark; `crate::hci` writes them and describes the layout.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use glam::{DMat3, DQuat, DVec3, EulerRot};
use lf_math::Face;

use crate::hci::{PARALLEL_FOCUS_M, blender_from_world};
use crate::import::assemble::{CameraGrid, camera, centered, focal_plane, spacing};
use crate::import::decode::{self, Decode as _};
use crate::import::{ImportOptions, Imported, Lens};
use crate::{ExchangeError, PictureAxis, PictureBasis};

/// Longer files are not parameters.
const MAX_CONFIG_BYTES: u64 = 1 << 20;
/// How far a camera's axes may be from the world's, in the length of a unit vector, to count as along them.
const POSE_TOLERANCE: f64 = 1e-3;

/// Imports a scene of the 4D Light Field Benchmark: a folder with `parameters.cfg` and `input_Cam000.png` and so on.
///
/// Lens, baseline and focus distance come from the parameters unless the options say otherwise. The pose is kept if the
/// cameras look along an axis of the world with the right way up and the options name no face; otherwise the grid is
/// put to the world's origin, and a note says so. Depth and disparity maps are not read.
///
/// # Errors
/// [`ExchangeError::Malformed`] if a parameter is missing or is not a number, or if there is no picture;
/// [`ExchangeError::LimitExceeded`] before anything is decoded; others as their names say.
pub fn import_hci(folder: &Path, options: &ImportOptions) -> Result<Imported, ExchangeError> {
    let parameters = Parameters::read(folder.join("parameters.cfg"))?;
    let [columns, rows] = [parameters.count("num_cams_x")?, parameters.count("num_cams_y")?];
    let files = pictures(folder)?;
    let first =
        files.values().next().ok_or_else(|| ExchangeError::malformed(folder, "there is no input_Cam000.png"))?;
    let size = decode::size(first, options.max_bytes)?;
    let mut notes = Vec::new();
    let pose = pose(&parameters, options, &mut notes);
    let spacing = match spacing(options)? {
        Some(spacing) => spacing,
        None => 1e-3 * parameters.positive("baseline_mm")?,
    };
    let offset = |axis: PictureAxis, by: f64| PictureAxis { first: axis.first + by, ..axis };
    let grid = CameraGrid {
        face: pose.face,
        plane: pose.plane,
        positions: [offset(centered(columns, spacing), pose.right), offset(centered(rows, spacing), pose.down)],
        camera: camera(size, options, (Some(parameters.lens(size)?), None), &mut notes)?,
        focal_plane: focal_plane(options)?.or(parameters.focus()),
        linear: false,
        notes,
    };
    grid.check_budget(options, size)?;
    grid.assemble(options, |column, row| {
        let index = u64::from(row) * u64::from(columns) + u64::from(column);
        files.get(&index).map(|path| <[u8; 4]>::decode(path, size)).transpose()
    })
}

/// The pictures by number.
fn pictures(folder: &Path) -> Result<BTreeMap<u64, PathBuf>, ExchangeError> {
    let mut pictures = BTreeMap::new();
    for entry in fs::read_dir(folder).map_err(ExchangeError::io(folder))? {
        let path = entry.map_err(ExchangeError::io(folder))?.path();
        let name = path.file_name().and_then(|name| name.to_str());
        let number = name.and_then(|name| name.strip_prefix("input_Cam")?.strip_suffix(".png"));
        if let Some(index) = number.and_then(|number| number.parse().ok()) {
            pictures.insert(index, path);
        }
    }
    Ok(pictures)
}

/// The keys and values of `parameters.cfg`; sections do not matter, no key occurs in two of them.
struct Parameters {
    path: PathBuf,
    values: BTreeMap<String, String>,
}

impl Parameters {
    fn read(path: PathBuf) -> Result<Self, ExchangeError> {
        let len = fs::metadata(&path).map_err(ExchangeError::io(&path))?.len();
        if len > MAX_CONFIG_BYTES {
            return Err(ExchangeError::malformed(&path, format!("it is {len} bytes long, too long for parameters")));
        }
        let text = fs::read_to_string(&path).map_err(ExchangeError::io(&path))?;
        let values = text.lines().filter_map(|line| line.split_once(['=', ':']));
        let values = values.map(|(key, value)| (key.trim().to_lowercase(), value.trim().to_owned())).collect();
        Ok(Self { path, values })
    }

    fn number(&self, key: &str) -> Option<f64> {
        self.values.get(key)?.parse().ok().filter(|value: &f64| value.is_finite())
    }

    fn positive(&self, key: &str) -> Result<f64, ExchangeError> {
        let found = || self.values.get(key).map_or("is missing".into(), |value| format!("is `{value}`"));
        let wrong =
            || ExchangeError::malformed(&self.path, format!("{key} has to be a number above 0, but {}", found()));
        self.number(key).filter(|&value| value > 0.0).ok_or_else(wrong)
    }

    fn count(&self, key: &str) -> Result<u32, ExchangeError> {
        let value = self.positive(key)?;
        if value.fract() == 0.0 && value <= f64::from(u32::MAX) {
            return Ok(value as u32);
        }
        Err(ExchangeError::malformed(&self.path, format!("{key} has to be a whole number, is {value}")))
    }

    /// The sensor's size is that of the longer edge of the picture.
    fn lens(&self, size: [u32; 2]) -> Result<Lens, ExchangeError> {
        let focal = self.positive("focal_length_mm")? / self.positive("sensor_size_mm")?;
        Ok(Lens::FocalLength(focal * f64::from(size[0].max(size[1]))))
    }

    /// The focus distance; none, zero and very far all mean parallel cameras.
    fn focus(&self) -> Option<f64> {
        self.number("focus_distance_m").filter(|&depth| depth > 0.0 && depth < PARALLEL_FOCUS_M)
    }
}

/// Where the middle of the grid is, and where its cameras look.
struct Pose {
    face: Face,
    plane: f64,
    right: f64,
    down: f64,
}

fn pose(parameters: &Parameters, options: &ImportOptions, notes: &mut Vec<String>) -> Pose {
    let vector = |keys: [&str; 3]| keys.map(|key| parameters.number(key));
    let position = vector(["center_cam_x_m", "center_cam_y_m", "center_cam_z_m"]);
    let angles = vector(["center_cam_rx_rad", "center_cam_ry_rad", "center_cam_rz_rad"]);
    let face = options.face.or_else(|| looking_along(angles));
    let known = options.face.is_none() && face.is_some();
    if let ([Some(x), Some(y), Some(z)], Some(face), true) = (position, face, known) {
        let eye = blender_from_world().transpose() * DVec3::new(x, y, z);
        let seen = PictureBasis::new(face).world_from_camera().transpose() * eye;
        let plane = options.plane.unwrap_or(eye[face.axis()]);
        return Pose { face, plane, right: seen.x, down: -seen.y };
    }
    notes.push("the pose of the cameras is not kept; the grid is put to the world's origin".into());
    Pose { face: face.unwrap_or(Face::NegZ), plane: options.plane.unwrap_or(0.0), right: 0.0, down: 0.0 }
}

/// The face whose pictures have the rotation of these Euler angles.
fn looking_along(angles: [Option<f64>; 3]) -> Option<Face> {
    let [Some(rx), Some(ry), Some(rz)] = angles else { return None };
    let blender_from_camera = DMat3::from_quat(DQuat::from_euler(EulerRot::ZYX, rz, ry, rx));
    let rotation = blender_from_world().transpose() * blender_from_camera;
    let near = |face: &Face| {
        let basis = PictureBasis::new(*face).world_from_camera();
        (0..3).all(|i| (basis.col(i) - rotation.col(i)).length() < POSE_TOLERANCE)
    };
    Face::ALL.into_iter().find(near)
}

//! `plan.json`: a plan as a file (`spec/plan.schema.json`).

use std::fs;
use std::path::Path;

use glam::{DMat3, DVec3};
use lf_math::{Cell, Face, LightFieldGeometry, SampledAxis, Slab};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::ExchangeError;
use crate::plan::{Plan, World};

/// What the file says it is.
const SCHEMA: &str = "lfslab-plan";
const VERSION: u64 = 1;
/// A plan of 2²⁰ cameras has about 200 MB.
const MAX_FILE_BYTES: u64 = 1 << 30;

#[derive(Serialize, Deserialize)]
struct File {
    schema: String,
    version: u64,
    generator: String,
    world: WorldEntry,
    cell: CellEntry,
    image: ImageEntry,
    pictures: PicturesEntry,
    slabs: Vec<SlabEntry>,
    cameras: Vec<CameraEntry>,
}

#[derive(Serialize, Deserialize)]
struct WorldEntry {
    name: String,
    handedness: String,
    lfslab_from_world: [[f64; 3]; 3],
}

#[derive(Serialize, Deserialize)]
struct CellEntry {
    center: [f64; 3],
    half_extent: [f32; 3],
}

#[derive(Serialize, Deserialize)]
struct ImageEntry {
    width: u32,
    height: u32,
    first_slope: f32,
    slope_step: f32,
    edge_slope: f64,
    field_of_view_degrees: f64,
}

#[derive(Serialize, Deserialize)]
struct PicturesEntry {
    folder: String,
    prefix: String,
    digits: usize,
    extensions: Vec<String>,
}

#[derive(Serialize, Deserialize)]
struct AxisEntry {
    first: f32,
    step: f32,
    count: u32,
}

#[derive(Serialize, Deserialize)]
struct SlabEntry {
    face: String,
    plane: f32,
    s: AxisEntry,
    t: AxisEntry,
    u: AxisEntry,
    v: AxisEntry,
    right: [f64; 3],
    up: [f64; 3],
    forward: [f64; 3],
    near_clip: f32,
}

#[derive(Serialize, Deserialize, PartialEq)]
struct CameraEntry {
    frame: u32,
    slab: usize,
    s: u32,
    t: u32,
    position: [f64; 3],
}

impl Plan {
    /// The content of `plan.json`.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Structs of numbers and text: there is nothing that JSON could not hold.
        let text = serde_json::to_string_pretty(&self.file()).unwrap_or_default();
        text + "\n"
    }

    /// Reads a `plan.json`.
    ///
    /// # Errors
    /// [`ExchangeError::Io`], and [`ExchangeError::Malformed`] if it is no plan, one of another version, or if its cameras are not
    /// those of its slabs.
    pub fn read(path: &Path) -> Result<Self, ExchangeError> {
        let bytes = fs::metadata(path).map_err(ExchangeError::io(path))?.len();
        if bytes > MAX_FILE_BYTES {
            let what = format!("the plan {}", path.display());
            return Err(ExchangeError::LimitExceeded { what, bytes, limit: MAX_FILE_BYTES });
        }
        let text = fs::read(path).map_err(ExchangeError::io(path))?;
        Self::from_json(&text).map_err(|what| ExchangeError::malformed(path, what))
    }

    /// A plan from the content of `plan.json`, or what is wrong with it.
    fn from_json(text: &[u8]) -> Result<Self, String> {
        let value: Value = serde_json::from_slice(text).map_err(|error| format!("it is not JSON: {error}"))?;
        if value["schema"] != SCHEMA {
            return Err("it is no plan of `lfslab plan`".into());
        }
        if value["version"] != VERSION {
            return Err(format!("it is a plan of version {}; this program reads version {VERSION}", value["version"]));
        }
        let file: File = serde_json::from_value(value).map_err(|error| error.to_string())?;
        let plan = file.plan()?;
        let same = file.cameras.iter().map(CameraEntry::place).eq(plan.file().cameras.iter().map(CameraEntry::place));
        if !same || file.image.width != plan.slopes().count() {
            return Err("its cameras are not those of its slabs; write it again with `lfslab plan`".into());
        }
        Ok(plan)
    }

    fn file(&self) -> File {
        let lfslab_from_world = self.world_from_lfslab().transpose();
        let (cell, slopes) = (self.geometry().cell(), self.slopes());
        let to_world = |v: DVec3| self.world_from_lfslab() * v;
        File {
            schema: SCHEMA.into(),
            version: VERSION,
            generator: concat!("lfslab ", env!("CARGO_PKG_VERSION")).into(),
            world: WorldEntry {
                name: self.world().name().into(),
                handedness: if lfslab_from_world.determinant() > 0.0 { "right" } else { "left" }.into(),
                lfslab_from_world: [0, 1, 2].map(|i| lfslab_from_world.row(i).to_array()),
            },
            cell: CellEntry {
                center: to_world(cell.center()).to_array(),
                half_extent: to_world(cell.half_extent().as_dvec3()).abs().as_vec3().to_array(),
            },
            image: ImageEntry {
                width: slopes.count(),
                height: slopes.count(),
                first_slope: slopes.first(),
                slope_step: slopes.step(),
                edge_slope: self.edge_slope(),
                field_of_view_degrees: self.field_of_view().to_degrees(),
            },
            pictures: PicturesEntry {
                folder: Self::PICTURES.into(),
                prefix: Self::PREFIX.into(),
                digits: self.digits(),
                extensions: ["png", "exr"].map(Into::into).into(),
            },
            slabs: self.geometry().slabs().iter().enumerate().map(|(i, slab)| self.slab_entry(i, slab)).collect(),
            cameras: self.camera_entries(),
        }
    }

    fn slab_entry(&self, index: usize, slab: &Slab) -> SlabEntry {
        let ([s, t], [u, v]) = (slab.st().map(AxisEntry::new), slab.uv().map(AxisEntry::new));
        let frame = self.picture_frame(index);
        SlabEntry {
            face: slab.face().name().into(),
            plane: slab.plane(),
            s,
            t,
            u,
            v,
            right: without_minus_zero(frame.right),
            up: without_minus_zero(frame.up),
            forward: without_minus_zero(frame.forward),
            near_clip: self.near_clip(index),
        }
    }

    fn camera_entries(&self) -> Vec<CameraEntry> {
        let entry = |camera: crate::plan::PlanCamera| {
            let [s, t] = camera.camera;
            let position = without_minus_zero(camera.position);
            CameraEntry { frame: camera.frame, slab: camera.slab, s, t, position }
        };
        self.cameras().map(entry).collect()
    }
}

impl File {
    /// The plan that the file's cell and slabs make.
    fn plan(&self) -> Result<Plan, String> {
        let world = World::from_name(&self.world.name);
        let world = world.ok_or_else(|| format!("it is in the unknown world `{}`", self.world.name))?;
        let lfslab_from_world: DMat3 = world.world_from_lfslab().transpose();
        let center = lfslab_from_world * DVec3::from(self.cell.center);
        let half_extent = lfslab_from_world * glam::Vec3::from(self.cell.half_extent).as_dvec3();
        let geometry = || -> Result<LightFieldGeometry, ExchangeError> {
            let cell = Cell::new(center, half_extent.abs().as_vec3())?;
            let slabs: Result<Vec<Slab>, ExchangeError> = self.slabs.iter().map(SlabEntry::slab).collect();
            Ok(LightFieldGeometry::new(cell, slabs?)?)
        };
        geometry().and_then(|geometry| Plan::new(world, geometry)).map_err(|error| error.to_string())
    }
}

impl SlabEntry {
    fn slab(&self) -> Result<Slab, ExchangeError> {
        let face = Face::ALL.into_iter().find(|face| face.name() == self.face);
        let face = face.ok_or_else(|| ExchangeError::argument(format!("there is no face `{}`", self.face)))?;
        let st = [self.s.axis()?, self.t.axis()?];
        let uv = [self.u.axis()?, self.v.axis()?];
        Ok(Slab::new(face, self.plane, st, uv, None)?)
    }
}

impl AxisEntry {
    fn new(axis: SampledAxis) -> Self {
        Self { first: axis.first(), step: axis.step(), count: axis.count() }
    }

    fn axis(&self) -> Result<SampledAxis, ExchangeError> {
        Ok(SampledAxis::new(self.first, self.step, self.count)?)
    }
}

impl CameraEntry {
    /// Which camera of which slab has which frame.
    fn place(&self) -> [usize; 4] {
        [self.frame as usize, self.slab, self.s as usize, self.t as usize]
    }
}

/// Mirroring makes −0 of 0, which is right and reads badly.
fn without_minus_zero(v: DVec3) -> [f64; 3] {
    v.to_array().map(|x| x + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use lf_math::PlanePlacement;

    fn plan(world: World) -> Plan {
        let cell = Cell::new(DVec3::new(1.5, -2.25, 1e6 + 0.125), Vec3::new(0.5, 0.3, 0.7)).unwrap();
        Plan::new(world, LightFieldGeometry::around(cell, PlanePlacement::CellCenter, 3, 7).unwrap()).unwrap()
    }

    #[test]
    fn a_plan_survives_its_file() {
        for world in World::ALL {
            let plan = plan(world);
            assert_eq!(Plan::from_json(plan.to_json().as_bytes()).unwrap(), plan, "{world:?}");
        }
    }

    #[test]
    fn other_files_are_refused() {
        let text = plan(World::PovRay).to_json();
        let refusal = |text: &str| Plan::from_json(text.as_bytes()).unwrap_err();
        assert!(refusal("{").contains("not JSON"));
        assert!(refusal("[]").contains("no plan"));
        assert!(refusal("{\"schema\": \"lfslab-plan\", \"version\": 2}").contains("version 2"));
        assert!(refusal("{\"schema\": \"lfslab-plan\", \"version\": 1}").contains("missing field"));
        assert!(refusal(&text.replace("\"povray\"", "\"maya\"")).contains("maya"));
        assert!(refusal(&text.replace("\"frame\": 7,", "\"frame\": 8,")).contains("cameras are not"));
        assert!(refusal(&text.replace("\"width\": 7", "\"width\": 8")).contains("cameras are not"));
        assert!(refusal(&text.replace("\"face\": \"+X\"", "\"face\": \"x\"")).contains("face `x`"));
        assert!(refusal(&text.replace("\"count\": 3", "\"count\": 4294967295")).contains("sample count"));
        assert!(refusal(&text.replace("\"count\": 3", "\"count\": 16777216")).contains("cameras in one plan"));
    }
}

//! Capture by other people's renderers: which pictures are to be rendered, scripts that do it, and the way back.
//!
//! A [`Plan`] lists the cameras of a light field's slabs. [`Plan::write`] puts it to a folder as `plan.json`
//! (`spec/plan.schema.json`), with a camera file for POV-Ray, scripts for Mitsuba 3 and Blender, and `transforms.json`.
//! [`import_plan`] makes slabs of the rendered pictures.
//!
//! **A texel is a pixel.** All cameras have one square frustum, so chosen that the slopes of the pixel centres are those of
//! the texels: n texels from −1 to 1 lie 2/(n − 1) apart, and the picture with its half pixels on all sides spans slopes of
//! ±n/(n − 1), a little more than 90°. Nothing is resampled.
//!
//! **Where rays start.** A stored ray starts where it leaves the cell. A pinhole camera's rays start on one plane:
//! [`Plan::near_clip`] has the distance of the cell's face, 0 for camera planes on the faces and half a cell for planes through
//! the centre. What stands beside the cell and nearer than that is missed. If the cell is empty and no camera stands in
//! anything, a smaller distance is as right for rays that leave through the face and better for those that leave through a side.
//! Cameras outside the face cannot look back: what stands between it and them is missed, too ([`Plan::beyond_face`]).

mod file;
mod import;
mod povray;
mod scripts;
mod world;

use glam::{DMat3, DVec3, Vec2};
use lf_math::{Coverage, LightFieldGeometry, SampledAxis, Slab};

use crate::{ExchangeError, PictureBasis};

pub use import::{ImportedPlan, PlanImportOptions, PlanTexels, import_plan};
pub use world::World;

/// Pictures that a plan may list. A run of POV-Ray takes so many; a light field of a million pictures is hours of parsing alone.
const MAX_CAMERAS: u64 = 1 << 20;

/// The cameras of a light field's slabs, for another renderer.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    world: World,
    geometry: LightFieldGeometry,
    slopes: SampledAxis,
    grids: Vec<Grid>,
}

/// The cameras of one slab that are rendered: all pairs of some columns and some rows.
#[derive(Debug, Clone, PartialEq)]
struct Grid {
    first_frame: u32,
    columns: Vec<u32>,
    rows: Vec<u32>,
}

/// A picture to render. All vectors are in the plan's world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanCamera {
    /// Its number, from 1 on.
    pub frame: u32,
    /// Position among the geometry's slabs.
    pub slab: usize,
    /// Indices (s, t) of the camera in the slab.
    pub camera: [u32; 2],
    /// Where it stands.
    pub position: DVec3,
}

/// How the pictures of one slab lie in space. Unit vectors in the plan's world, perpendicular to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureFrame {
    /// To the right in the picture.
    pub right: DVec3,
    /// Upwards in the picture.
    pub up: DVec3,
    /// Straight ahead.
    pub forward: DVec3,
}

impl Plan {
    /// A plan for all cameras that a ray through the cell asks for. `geometry` is in this project's world, `world` is
    /// that in which the plan is written.
    ///
    /// # Errors
    /// [`ExchangeError::Unsupported`] if the slabs do not share one square grid of slopes around 0, or have more than
    /// 2²⁰ cameras together.
    pub fn new(world: World, geometry: LightFieldGeometry) -> Result<Self, ExchangeError> {
        let slopes = shared_slopes(&geometry)?;
        let sizes = geometry.slabs().iter().map(|slab| slab.cameras().map(u64::from));
        let cameras = sizes.fold(0, |sum: u64, [s, t]| sum.saturating_add(s * t));
        if cameras > MAX_CAMERAS {
            let what = format!("{cameras} cameras in one plan, which takes {MAX_CAMERAS} at most");
            return Err(ExchangeError::unsupported(what));
        }
        let mut next = 1;
        let grids = geometry.slabs().iter().map(|slab| {
            let grid = Grid::needed(&Coverage::of_cell(slab, geometry.cell()), next);
            next += grid.count();
            grid
        });
        let grids = grids.collect();
        Ok(Self { world, geometry, slopes, grids })
    }

    /// The world that the plan's vectors are in.
    #[must_use]
    pub fn world(&self) -> World {
        self.world
    }

    /// The cell and the slabs, in this project's world.
    #[must_use]
    pub fn geometry(&self) -> &LightFieldGeometry {
        &self.geometry
    }

    /// The slopes of the pixel centres: from the left to the right, and from the top to the bottom.
    #[must_use]
    pub fn slopes(&self) -> SampledAxis {
        self.slopes
    }

    /// The slope of a picture's right and bottom edge; that of the left and top edge is its negative.
    #[must_use]
    pub fn edge_slope(&self) -> f64 {
        0.5 * f64::from(self.slopes.count()) * f64::from(self.slopes.step())
    }

    /// The angle between a picture's left and right edge, and between top and bottom, radians.
    #[must_use]
    pub fn field_of_view(&self) -> f64 {
        2.0 * self.edge_slope().atan()
    }

    /// How many pictures there are; their frames are numbered from 1.
    #[must_use]
    pub fn camera_count(&self) -> u32 {
        self.grids.iter().map(Grid::count).sum()
    }

    /// All cameras in the order of their frames: slab after slab, s fastest.
    pub fn cameras(&self) -> impl Iterator<Item = PlanCamera> {
        self.grids.iter().enumerate().flat_map(move |(slab, grid)| {
            grid.frames().map(move |(frame, camera)| PlanCamera {
                frame,
                slab,
                camera,
                position: self.position(slab, camera),
            })
        })
    }

    /// How the pictures of a slab lie in the plan's world.
    ///
    /// # Panics
    /// If there is no such slab.
    #[must_use]
    pub fn picture_frame(&self, slab: usize) -> PictureFrame {
        let rotation = self.world_from_lfslab() * basis(&self.geometry.slabs()[slab]).world_from_camera();
        PictureFrame { right: rotation.x_axis, up: rotation.y_axis, forward: -rotation.z_axis }
    }

    /// The distance along `forward` from a slab's cameras to the cell's face, metres; at least 0.
    ///
    /// # Panics
    /// If there is no such slab.
    #[must_use]
    pub fn near_clip(&self, slab: usize) -> f32 {
        let slab = &self.geometry.slabs()[slab];
        let face = slab.face();
        (self.geometry.cell().half_extent()[face.axis()] - face.sign() * slab.plane()).max(0.0)
    }

    /// How far the cameras stand outside the cell's faces, metres, at most; 0 if they stand on them or within. Nothing that lies
    /// between a face and its cameras is seen.
    #[must_use]
    pub fn beyond_face(&self) -> f32 {
        let half_extent = self.geometry.cell().half_extent();
        let beyond = self.geometry.slabs().iter().map(|slab| {
            let face = half_extent[slab.face().axis()];
            // What rounding makes of a plane on the face is no distance.
            Some(slab.face().sign() * slab.plane() - face).filter(|beyond| *beyond > 1e-5 * face)
        });
        beyond.flatten().fold(0.0, f32::max)
    }

    fn world_from_lfslab(&self) -> DMat3 {
        self.world.world_from_lfslab()
    }

    fn position(&self, slab: usize, camera: [u32; 2]) -> DVec3 {
        let camera = Vec2::new(camera[0] as f32, camera[1] as f32);
        let in_cell = self.geometry.slabs()[slab].sample_ray(camera, Vec2::ZERO).origin;
        self.world_from_lfslab() * self.geometry.cell().world_from_cell(in_cell)
    }
}

impl Grid {
    fn needed(coverage: &Coverage, first_frame: u32) -> Self {
        let filled = |windows: &lf_math::Windows| {
            (0u32..).zip(windows.iter()).filter(|(_, window)| !window.is_empty()).map(|(camera, _)| camera).collect()
        };
        Self { first_frame, columns: filled(coverage.columns()), rows: filled(coverage.rows()) }
    }

    /// At most 2²⁰.
    fn count(&self) -> u32 {
        (self.columns.len() * self.rows.len()) as u32
    }

    /// Frame numbers and cameras (s, t).
    fn frames(&self) -> impl Iterator<Item = (u32, [u32; 2])> {
        let cameras = self.rows.iter().flat_map(|&t| self.columns.iter().map(move |&s| [s, t]));
        (self.first_frame..).zip(cameras)
    }
}

fn basis(slab: &Slab) -> PictureBasis {
    PictureBasis::new(slab.face())
}

/// The one axis of slopes that all slabs have twice.
fn shared_slopes(geometry: &LightFieldGeometry) -> Result<SampledAxis, ExchangeError> {
    let all = geometry.slabs().iter().flat_map(Slab::uv);
    let unequal = || ExchangeError::unsupported("a plan for slabs that do not all have the same slopes along u and v");
    let slopes = all.clone().next().ok_or_else(unequal)?;
    if all.into_iter().any(|axis| axis != slopes) {
        return Err(unequal());
    }
    // What f32 makes of −1 + (n − 1)·2/(n − 1), and not a hundredth of a texel.
    let skew = (f64::from(slopes.first()) + f64::from(slopes.last())).abs();
    if skew > 1e-2 * f64::from(slopes.step()) {
        return Err(ExchangeError::unsupported("a plan for slopes that do not lie evenly around 0"));
    }
    Ok(slopes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lf_math::{Cell, Face, PlanePlacement};

    fn geometry(placement: PlanePlacement) -> LightFieldGeometry {
        let cell = Cell::cube(DVec3::new(1.0, 2.0, 3.0), 0.5).unwrap();
        LightFieldGeometry::around(cell, placement, 3, 8).unwrap()
    }

    #[test]
    fn the_near_plane_is_the_cell_s_face() {
        for (placement, distance) in [(PlanePlacement::CellFaces, 0.0), (PlanePlacement::CellCenter, 0.25)] {
            let plan = Plan::new(World::Gltf, geometry(placement)).unwrap();
            assert!((0..6).all(|slab| plan.near_clip(slab) == distance));
        }
    }

    #[test]
    fn cameras_beyond_the_face_are_told_from_those_on_it() {
        for (offset, distance) in [(0.25, 0.0), (0.25 + 1e-7, 0.0), (-1.0, 0.0), (0.75, 0.5)] {
            let plan = Plan::new(World::Gltf, geometry(PlanePlacement::Offset(offset))).unwrap();
            assert_eq!(plan.beyond_face(), distance, "{offset}");
        }
    }

    #[test]
    fn frames_count_through_all_slabs() {
        let plan = Plan::new(World::PovRay, geometry(PlanePlacement::CellFaces)).unwrap();
        let cameras: Vec<PlanCamera> = plan.cameras().collect();
        assert_eq!((cameras.len(), plan.camera_count()), (54, 54));
        assert!(cameras.iter().zip(1..).all(|(camera, frame)| camera.frame == frame));
        assert_eq!((cameras[10].slab, cameras[10].camera), (1, [1, 0]));
        // Eight texels from −1 to 1: the edges are half of 2/7 further out.
        assert!((plan.edge_slope() - 8.0 / 7.0).abs() < 1e-6);
    }

    #[test]
    fn cameras_that_nothing_asks_for_are_left_out() {
        let wide = SampledAxis::spanning(-4.0, 4.0, 17).unwrap();
        let slopes = SampledAxis::spanning(-1.0, 1.0, 8).unwrap();
        let slab = Slab::new(Face::NegY, -0.25, [wide; 2], [slopes; 2], None).unwrap();
        let cell = Cell::cube(DVec3::ZERO, 0.5).unwrap();
        let plan = Plan::new(World::Gltf, LightFieldGeometry::new(cell, vec![slab]).unwrap()).unwrap();
        // The cell's rays cross the plane within ±0.75; of every half metre that is ±1 camera, and one more on each side.
        let columns: std::collections::BTreeSet<u32> = plan.cameras().map(|camera| camera.camera[0]).collect();
        assert_eq!(columns.into_iter().collect::<Vec<_>>(), [6, 7, 8, 9, 10]);
        assert_eq!(plan.camera_count(), 25);
    }

    #[test]
    fn refuses_what_no_single_camera_can_render() {
        let slab = |uv| Slab::new(Face::PosX, 0.0, [axis(-1.0, 1.0, 2); 2], uv, None).unwrap();
        fn axis(min: f32, max: f32, count: u32) -> SampledAxis {
            SampledAxis::spanning(min, max, count).unwrap()
        }
        let refusal = |slab| {
            let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
            Plan::new(World::Gltf, LightFieldGeometry::new(cell, vec![slab]).unwrap()).unwrap_err().to_string()
        };
        assert!(refusal(slab([axis(-1.0, 1.0, 8), axis(-1.0, 1.0, 9)])).contains("same slopes"));
        assert!(refusal(slab([axis(-1.0, 0.5, 8); 2])).contains("around 0"));
        let many = Slab::new(Face::PosX, 0.0, [axis(-1.0, 1.0, 1025); 2], [axis(-1.0, 1.0, 8); 2], None).unwrap();
        assert!(refusal(many).contains("cameras in one plan"));
    }
}

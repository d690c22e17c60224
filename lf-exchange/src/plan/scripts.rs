//! The folder of a plan: all that the renderers need.

use std::fs;
use std::path::Path;

use crate::plan::{Plan, World, povray};
use crate::transforms::plan_transforms;
use crate::{ExchangeError, Intrinsics, PictureAxis};

impl Plan {
    /// The folder, within the plan's, that pictures are written to.
    pub const PICTURES: &str = "pictures";
    /// What the names of pictures begin with, before the number of the frame.
    pub const PREFIX: &str = "lfslab";

    /// Digits of a frame's number in the names of pictures, as POV-Ray has them: those of the last frame.
    #[must_use]
    pub fn digits(&self) -> usize {
        self.camera_count().to_string().len()
    }

    /// The name of a frame's picture.
    #[must_use]
    pub fn picture_name(&self, frame: u32, extension: &str) -> String {
        format!("{}{frame:0digits$}.{extension}", Self::PREFIX, digits = self.digits())
    }

    /// The lens that all pictures share.
    #[must_use]
    pub fn intrinsics(&self) -> Intrinsics {
        let step = self.slopes().step().into();
        let count = self.slopes().count();
        let axis = PictureAxis { first: 0.5 * step - self.edge_slope(), step, count };
        Intrinsics::from_slopes([axis; 2])
    }

    /// Writes the plan and everything to render it by to a folder, which is made if it is not there: `plan.json`,
    /// `README.md`, and an empty folder for the pictures. Files of these names are replaced, pictures left as they are.
    ///
    /// # Errors
    /// [`ExchangeError::Io`] if the system refuses.
    pub fn write(&self, folder: &Path) -> Result<(), ExchangeError> {
        let pictures = folder.join(Self::PICTURES);
        fs::create_dir_all(&pictures).map_err(ExchangeError::io(&pictures))?;
        let files = [
            ("plan.json", self.to_json()),
            ("transforms.json", format!("{:#}\n", plan_transforms(self))),
            ("lfslab_camera.inc", povray::camera_include(self)),
            ("lfslab.ini", self.fill(include_str!("programs/lfslab.ini"))),
            ("render_mitsuba.py", include_str!("programs/render_mitsuba.py").to_owned()),
            ("render_blender.py", include_str!("programs/render_blender.py").to_owned()),
            ("README.md", self.fill(include_str!("programs/README.md"))),
        ];
        files.into_iter().try_for_each(|(name, content)| {
            let path = folder.join(name);
            fs::write(&path, content).map_err(ExchangeError::io(&path))
        })
    }

    /// A text with the plan's numbers in place of their names in braces.
    fn fill(&self, text: &str) -> String {
        let [near, far] = [f32::min, f32::max].map(|pick| {
            let all = (0..self.geometry().slabs().len()).map(|slab| self.near_clip(slab));
            all.reduce(pick).unwrap_or_default()
        });
        let world = match self.world() {
            World::Gltf => {
                "right-handed, as glTF and Mitsuba have them: (x, y, z) here is (x, y, −z) in POV-Ray and (x, −z, y) in Blender"
            }
            World::PovRay => {
                "POV-Ray's, left-handed: (x, y, z) here is (x, y, −z) in glTF and Mitsuba and (x, z, y) in Blender"
            }
            World::Blender => {
                "Blender's, right-handed, +Z up: (x, y, z) here is (x, z, −y) in glTF and Mitsuba and (x, z, y) in POV-Ray"
            }
        };
        let values = [
            ("{count}", self.camera_count().to_string()),
            ("{size}", self.slopes().count().to_string()),
            ("{angle}", format!("{:.4}", self.field_of_view().to_degrees())),
            ("{near}", if near == far { format!("{near}") } else { format!("{near} to {far}") }),
            ("{first}", self.picture_name(1, "png")),
            ("{last}", self.picture_name(self.camera_count(), "png")),
            ("{start}", self.where_rays_start()),
            ("{world}", world.to_owned()),
        ];
        values.into_iter().fold(text.to_owned(), |text, (name, value)| text.replace(name, &value))
    }

    /// What the README says of the plane that rays start on.
    fn where_rays_start(&self) -> String {
        let beyond = self.beyond_face();
        if beyond > 0.0 {
            return format!(
                "Here it is that of the cameras, up to {beyond} outside the cell's faces: what stands between\n  \
                a face and its cameras is missed, and what stands beside the cell below them. Nothing in `plan.json` mends that;\n  \
                plan again with the cameras on the faces or within."
            );
        }
        "With this near plane it is that of the cell's face; what stands beside the cell and below that plane is missed.\n  \
            If the cell is empty and no camera stands in anything, you may lower it to 0 in `plan.json`; then less is missed."
            .to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use lf_math::{Cell, LightFieldGeometry, PlanePlacement};

    #[test]
    fn no_name_is_left_unfilled() {
        let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
        let geometry = LightFieldGeometry::around(cell, PlanePlacement::CellCenter, 3, 8).unwrap();
        let folder = tempfile::tempdir().unwrap();
        Plan::new(World::Blender, geometry).unwrap().write(folder.path()).unwrap();
        for name in ["README.md", "lfslab.ini"] {
            let text = fs::read_to_string(folder.path().join(name)).unwrap();
            assert!(!text.contains(['{', '}']), "{text}");
        }
        let ini = fs::read_to_string(folder.path().join("lfslab.ini")).unwrap();
        assert!(ini.contains("Final_Frame=54\n") && ini.contains("Width=8\n"), "{ini}");
    }

    /// Beyond the faces the near plane is 0, and no longer that of a face.
    #[test]
    fn where_rays_start_is_said_as_it_is() {
        let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
        let readme = |placement| {
            let plan = Plan::new(World::Gltf, LightFieldGeometry::around(cell, placement, 3, 8).unwrap()).unwrap();
            plan.fill(include_str!("programs/README.md"))
        };
        for placement in [PlanePlacement::CellCenter, PlanePlacement::CellFaces, PlanePlacement::Offset(-0.75)] {
            assert!(readme(placement).contains("With this near plane it is that of the cell's face;"), "{placement:?}");
        }
        let beyond = readme(PlanePlacement::Offset(0.75));
        assert!(
            beyond.contains("`near_clip`: 0 here") && beyond.contains("up to 0.25 outside the cell's faces"),
            "{beyond}"
        );
        assert!(!beyond.contains("With this near plane"), "{beyond}");
    }

    #[test]
    fn names_are_padded_to_the_last_frame() {
        let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
        let geometry = LightFieldGeometry::around(cell, PlanePlacement::CellCenter, 16, 8).unwrap();
        let plan = Plan::new(World::Gltf, geometry).unwrap();
        assert_eq!(plan.picture_name(7, "exr"), "lfslab0007.exr");
    }
}

//! The camera of a plan as an include file of POV-Ray.
//!
//! POV-Ray draws the point `location + direction + x·right + y·up`, with x from −½ at the picture's left edge to ½ at its right
//! one and y from −½ at the bottom to ½ at the top. Whichever way its coordinates are handed, a picture's right is where `right`
//! points: the vectors of a plan, taken to POV-Ray's axes, are all it needs.

use std::fmt::Write as _;

use glam::{DMat3, DVec3, Vec2};

use crate::plan::{Grid, Plan, World};

/// The content of `lfslab_camera.inc`.
pub(super) fn camera_include(plan: &Plan) -> String {
    let last = plan.camera_count();
    let mut text = format!(
        "// The cameras of plan.json, one for each frame_number from 1 to {last}. Written by `lfslab plan`.\n\
         // Coordinates are POV-Ray's, left-handed. Include it in place of the scene's camera, or after it.\n\n\
         #switch (frame_number)\n"
    );
    for (slab, grid) in plan.grids.iter().enumerate().filter(|(_, grid)| grid.count() > 0) {
        text += &slab_case(plan, slab, grid);
    }
    let width = number(2.0 * plan.edge_slope());
    let _ = write!(
        text,
        "  #else\n    #error \"frame_number is to be 1 to {last}: start POV-Ray with +KFI1 +KFF{last}\"\n#end\n\n\
         camera {{\n  perspective\n  location Lfslab_Location\n  direction Lfslab_Forward\n  \
         right {width}*Lfslab_Right\n  up {width}*Lfslab_Up\n}}\n"
    );
    text
}

/// The frames of one slab.
fn slab_case(plan: &Plan, index: usize, grid: &Grid) -> String {
    let slab = &plan.geometry().slabs()[index];
    let (face, [s, t]) = (slab.face(), slab.st());
    let povray_from_world = povray_from_lfslab() * plan.world_from_lfslab().transpose();
    let tangent = |axis: Vec2| vector(povray_from_lfslab() * face.vector(axis, 0.0).as_dvec3());
    let middle = plan.geometry().cell().world_from_cell(face.vector(Vec2::ZERO, slab.plane()));
    let frame = plan.picture_frame(index);
    let [right, up, forward] = [frame.right, frame.up, frame.forward].map(|v| vector(povray_from_world * v));
    let coordinates = |axis: lf_math::SampledAxis, cameras: &[u32]| {
        let list: Vec<String> = cameras.iter().map(|&i| number(axis.coord(i as f32).into())).collect();
        format!("array[{}] {{ {} }}", list.len(), list.join(", "))
    };
    let (first, last) = (grid.first_frame, grid.first_frame + grid.count() - 1);
    format!(
        "  #range ({first}, {last}) // {face}\n    \
         #local Lfslab_S = {columns};\n    \
         #local Lfslab_T = {rows};\n    \
         #local Lfslab_Row = div(frame_number - {first}, {count});\n    \
         #local Lfslab_Column = frame_number - {first} - {count}*Lfslab_Row;\n    \
         #local Lfslab_Location = {middle} + Lfslab_S[Lfslab_Column]*{s} + Lfslab_T[Lfslab_Row]*{t};\n    \
         #local Lfslab_Right = {right};\n    \
         #local Lfslab_Up = {up};\n    \
         #local Lfslab_Forward = {forward};\n    \
         #break\n",
        face = face.name(),
        columns = coordinates(s, &grid.columns),
        rows = coordinates(t, &grid.rows),
        count = grid.columns.len(),
        middle = vector(povray_from_lfslab() * middle),
        s = tangent(Vec2::X),
        t = tangent(Vec2::Y),
    )
}

fn povray_from_lfslab() -> DMat3 {
    World::PovRay.world_from_lfslab()
}

fn vector(v: DVec3) -> String {
    format!("<{}, {}, {}>", number(v.x), number(v.y), number(v.z))
}

/// A number in decimals, without −0.
fn number(x: f64) -> String {
    format!("{}", x + 0.0)
}

//! Where rays leave the cell, and cells of any size, shape and place.

use glam::{DVec3, Vec2, Vec3};
use lf_math::{Cell, LightFieldGeometry, PlanePlacement, Ray};

use super::draws::Draws;
use super::{DRAWS, Row, Tally, U};

/// 2γ(3), the bound of Ize (*Robust BVH Ray Traversal*, JCGT 2013) on where a box is met.
const TWO_GAMMA: f64 = 6.0 * U / (1.0 - 3.0 * U);

/// A box with edges of 1 to 10⁶ times the shortest.
pub(super) fn half_extent(draws: &mut Draws, low: f64, high: f64) -> Vec3 {
    let size = draws.log(low, high);
    Vec3::from_array([0; 3].map(|_| (size * draws.log(1e-3, 1e3)) as f32))
}

pub(super) fn cell(half: Vec3) -> Cell {
    Cell::new(DVec3::ZERO, half).expect("a cell")
}

/// A place on an edge of the box, or at a corner.
fn on_an_edge(draws: &mut Draws, half: Vec3) -> Vec3 {
    let corner = Vec3::from_array([0; 3].map(|_| draws.sign() as f32)) * half;
    let mut place = corner;
    let axis = draws.below(3);
    let along = f64::from(half[axis]) * draws.between(-1.0, 1.0);
    place[axis] = draws.nudged(along as f32);
    if draws.below(8) == 0 { corner } else { place }
}

/// Exit of a line that starts within the box.
fn exact_exit(half: Vec3, ray: &Ray) -> f64 {
    let (h, o, d) = (half.as_dvec3(), ray.origin.as_dvec3(), ray.direction.as_dvec3());
    (0..3).filter(|&i| d[i] != 0.0).map(|i| (h[i].copysign(d[i]) - o[i]) / d[i]).fold(f64::INFINITY, f64::min)
}

/// A million rays from inside the box at its edges and corners. The parameter's condition number is 1: distance and direction are exact.
/// Rules: there is an exit, and the point there is within 2γ(3) of the box.
#[must_use]
pub fn exit() -> Row {
    let (mut draws, mut tally) = (Draws::new(3), Tally::default());
    for _ in 0..5 * DRAWS {
        let half = half_extent(&mut draws, 1e-15, 1e15);
        let origin = draws.in_box(half);
        let direction = on_an_edge(&mut draws, half) - origin;
        let ray = Ray { origin, direction };
        let found = cell(half).exit(&ray);
        let Some(t) = found.map(f64::from) else {
            tally.rule(direction == Vec3::ZERO);
            continue;
        };
        let at = origin.as_dvec3() + t * direction.as_dvec3();
        let outside = |i: usize| at[i].abs() > f64::from(half[i]) * (1.0 + TWO_GAMMA);
        tally.rule(!(0..3).any(outside));
        let exact = exact_exit(half, &ray);
        tally.ratio(t - exact, exact * U);
    }
    tally.row("ray–cell, aimed at edges from inside", "κ·u", [3.0, 3.0])
}

/// Parallel to faces, in faces, from nowhere and to nowhere: the answer is the one documented.
#[must_use]
pub fn exit_of_odd_rays() -> Row {
    let (mut draws, mut tally) = (Draws::new(4), Tally::default());
    for _ in 0..DRAWS {
        let half = half_extent(&mut draws, 1e-3, 1e3);
        let (axis, other) = (draws.below(3), draws.below(2) + 1);
        let zero = if draws.below(2) == 0 { 0.0f32 } else { -0.0 };
        // Along an axis, on two faces, on one, or inside.
        let mut ray = Ray { origin: draws.in_box(half), direction: Vec3::splat(zero) };
        ray.direction[axis] = draws.number(1e-20, 1e20);
        let flat = (axis + other) % 3;
        ray.origin[flat] = half[flat] * draws.sign() as f32;
        let exact = (f64::from(half[axis].copysign(ray.direction[axis])) - f64::from(ray.origin[axis]))
            / f64::from(ray.direction[axis]);
        let found = cell(half).exit(&ray).map_or(f64::NAN, f64::from);
        tally.ratio(found - exact, exact.abs() * U);
        let odd = Ray { origin: draws.odd_vector(1e-30, 1e30), direction: draws.odd_vector(1e-30, 1e30) };
        let can = odd.origin.is_finite() && odd.direction.is_finite() && odd.direction != Vec3::ZERO;
        let answer = cell(half).exit(&odd);
        tally.rule(answer.is_none_or(|t| can && t.is_finite()));
    }
    tally.row("ray–cell, parallel to a face and in it; odd numbers", "κ·u", [3.0, 3.0])
}

fn placement(draws: &mut Draws, half: Vec3) -> PlanePlacement {
    match draws.below(3) {
        0 => PlanePlacement::CellFaces,
        1 => PlanePlacement::CellCenter,
        _ => PlanePlacement::Offset(draws.between(-2.0, 2.0) as f32 * half.max_element()),
    }
}

fn light_field(draws: &mut Draws, half: Vec3, counts: &[u32]) -> LightFieldGeometry {
    let mut pick = || counts[draws.below(counts.len())];
    let (cameras, texels) = ([pick(), pick()], [pick(), pick()]);
    let placement = placement(draws, half);
    LightFieldGeometry::around_with(cell(half), placement, cameras, texels).expect("a light field")
}

/// Every ray from the cell lies in the slabs' range, most of all those along its edges; and rays beyond the range by more than
/// rounding do not: 16 ε of what the slab reaches. (A single camera's range is a point, which no other ray meets.)
#[must_use]
pub fn range() -> Row {
    let (mut draws, mut tally) = (Draws::new(5), Tally::default());
    let counts = [2, 3, 9, 32, 4096];
    let mut field = light_field(&mut draws, Vec3::ONE, &counts);
    for i in 0..5 * DRAWS {
        if i.is_multiple_of(16) {
            let half = half_extent(&mut draws, 1e-26, 1e26);
            field = light_field(&mut draws, half, &counts);
        }
        let half = field.cell().half_extent();
        // Along the edges of the range: from corner to corner, or by a tie of two faces.
        let origin = if draws.below(2) == 0 { on_an_edge(&mut draws, half) } else { draws.in_box(half) };
        let mut direction = draws.vector(1e-3, 1.0);
        let size = direction.abs().max_element();
        direction[draws.below(3)] = draws.nudged(size).copysign(direction.z);
        let ray = Ray { origin: origin.clamp(-half, half), direction };
        let inside = |ray: &Ray| field.index_ray(ray).is_some_and(|i| field.slabs()[i.slab].contains(&i.coord));
        tally.rule(inside(&ray));
        let Some(indexed) = field.index_ray(&ray) else { continue };
        let slab = &field.slabs()[indexed.slab];
        let axis = draws.below(2);
        let reach = f64::from(slab.st()[axis].first().abs()) + f64::from(slab.st()[axis].last().abs());
        let reach = reach + f64::from(slab.st()[axis].step()) * f64::from(slab.cameras()[axis]);
        // Moved so far along s or t that it crosses the plane beyond the last camera.
        let beyond = (1.0 + 16.0 * f64::from(f32::EPSILON)) * reach;
        let tangent = slab.face().tangents()[axis];
        let mut moved = slab.sample_ray(Vec2::from(slab.cameras().map(|n| 0.5 * (n - 1) as f32)), Vec2::ZERO);
        moved.origin[tangent] = (f64::from(slab.st()[axis].last().signum()) * beyond) as f32;
        tally.rule(moved.origin.is_finite() && !slab.contains(&slab.index_ray(&moved)));
    }
    tally.row("ray–plane: the slabs' range, along its edges", "κ·u", [0.0, 0.0])
}

/// A stored sample's ray, started where it leaves the cell, indexes to that sample: sizes of 1e-26 to 1e26, aspects to 1:10⁶, and places a
/// million sizes from the origin.
#[must_use]
pub fn cells() -> Row {
    let (mut draws, mut tally) = (Draws::new(6), Tally::default());
    for _ in 0..DRAWS / 16 {
        let half = half_extent(&mut draws, 1e-26, 1e26);
        let field = light_field(&mut draws, half, &[1, 2, 9, 32, 4096]);
        for _ in 0..16 {
            let number = draws.below(6);
            let slab = &field.slabs()[number];
            let camera = Vec2::from(slab.cameras().map(|n| draws.below(n as usize) as f32));
            let texel = Vec2::from(slab.resolution().map(|n| draws.below(n as usize) as f32));
            let ray = field.capture_ray(number, camera, texel);
            let coord = slab.index_ray(&ray);
            // Camera and start are as far apart as the slab and the cell reach.
            let reach = f64::from(ray.origin.abs().max_element()) + f64::from(slab.plane().abs());
            for i in 0..2 {
                let ends = f64::from(slab.st()[i].first().abs()) + f64::from(slab.st()[i].last().abs());
                let kappa = (ends + reach) / f64::from(slab.st()[i].step()) + f64::from(camera[i]);
                tally.ratio(f64::from(coord.st[i]) - f64::from(camera[i]), kappa * U);
                let kappa = 2.0 / f64::from(slab.uv()[i].step()) + f64::from(texel[i]);
                tally.ratio(f64::from(coord.uv[i]) - f64::from(texel[i]), kappa * U);
            }
            tally.rule(coord.st.is_finite() && coord.uv.is_finite());
        }
        let center = draws.direction() * 1e6 * f64::from(half.max_element());
        let far = Cell::new(center, half).expect("a cell");
        let place = draws.in_box(half);
        let error = far.cell_from_world(far.world_from_cell(place)).as_dvec3() - place.as_dvec3();
        tally.ratio(error.length(), f64::from(half.max_element()) * U);
    }
    tally.row("cells: captured rays index to their sample", "κ·u", [16.0, 32.0])
}

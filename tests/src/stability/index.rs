//! From a ray to the indices (s′, t′, u′, v′).

use glam::Vec3;
use lf_math::{Face, LightFieldGeometry, PlanePlacement, Ray, Slab, SlabCoord};

use super::cell::{cell, half_extent};
use super::draws::Draws;
use super::faces::near_a_tie;
use super::{DRAWS, Row, Tally, U};

/// Slopes below this, and shares of a camera or a texel, count as this: numbers so small leave the range of `f32` in products.
const LEAST: f64 = 1e-12;

/// Eqs. 1, 3 and 4 of the paper in `f64`, the line meeting the plane, with what a relative change of 1 of each input does to each index.
pub(super) struct Indices {
    pub(super) exact: [f64; 4],
    pub(super) kappa: [f64; 4],
}

pub(super) fn indices(slab: &Slab, origin: glam::DVec3, direction: glam::DVec3) -> Indices {
    let k = slab.face().axis();
    let run = f64::from(slab.face().sign()) * (f64::from(slab.plane()) - origin[k]);
    let (mut exact, mut kappa) = ([0.0; 4], [0.0; 4]);
    for (i, axis) in slab.face().tangents().into_iter().enumerate() {
        let slope = direction[axis] / direction[k].abs();
        let (st, uv) = (slab.st()[i], slab.uv()[i]);
        let index = |axis: lf_math::SampledAxis, at: f64| (at - f64::from(axis.first())) / f64::from(axis.step());
        let reach = f64::from(slab.plane().abs()) + origin[k].abs();
        exact[i] = index(st, origin[axis] + run * slope);
        exact[2 + i] = index(uv, slope);
        let moved = origin[axis].abs() + reach * (slope.abs() + LEAST) + f64::from(st.first().abs());
        kappa[i] = moved / f64::from(st.step()) + LEAST;
        kappa[2 + i] = (slope.abs() + f64::from(uv.first().abs())) / f64::from(uv.step()) + LEAST;
    }
    Indices { exact, kappa }
}

pub(super) fn by_number(coord: &SlabCoord) -> [f64; 4] {
    [coord.st.x, coord.st.y, coord.uv.x, coord.uv.y].map(f64::from)
}

/// A few light fields, by size and shape.
pub(super) fn fields(draws: &mut Draws) -> Vec<LightFieldGeometry> {
    let placements = [PlanePlacement::CellFaces, PlanePlacement::CellCenter];
    let field = |i: usize| {
        let half = half_extent(draws, 1e-26, 1e26);
        let counts = [[32, 128], [1, 1], [2, 4096], [4096, 2]][i % 4];
        LightFieldGeometry::around_with(cell(half), placements[i / 4 % 2], [counts[0]; 2], [counts[1]; 2])
            .expect("a light field")
    };
    (0..64).map(field).collect()
}

/// Rays of all sizes and near ties of faces, from within the cell and from anywhere. Rules: an answer is finite; there is none just
/// where the ray is not finite, has no direction, or an index would be beyond `f32`.
#[must_use]
pub fn ray() -> Row {
    let (mut draws, mut tally) = (Draws::new(20), Tally::default());
    let fields = fields(&mut draws);
    for i in 0..2 * DRAWS {
        let field = &fields[draws.below(fields.len())];
        let half = field.cell().half_extent();
        let origin = match i % 4 {
            0 => draws.odd_vector(1e-30, 1e30),
            _ => draws.in_box(half),
        };
        let direction = match i % 3 {
            0 => near_a_tie(&mut draws),
            1 => draws.odd_vector(1e-30, 1e30),
            _ => draws.direction().as_vec3(),
        };
        let found = field.index_ray(&Ray { origin, direction });
        let face = Face::dominant(direction).filter(|_| origin.is_finite());
        let Some(face) = face else {
            tally.rule(found.is_none());
            continue;
        };
        let slab = &field.slabs()[usize::from(face.index())];
        let Indices { exact, kappa } = indices(slab, origin.as_dvec3(), direction.as_dvec3());
        let Some(found) = found else {
            // Where a sum on the way is near the end of the range, either will do.
            let largest = kappa.into_iter().fold(0.0, f64::max) * f64::from(slab.st()[0].step().max(1.0));
            tally.rule(largest.max(f64::from(origin.abs().max_element())) > 1e37);
            continue;
        };
        tally.rule(found.coord.st.is_finite() && found.coord.uv.is_finite());
        for ((found, exact), kappa) in by_number(&found.coord).into_iter().zip(exact).zip(kappa) {
            tally.ratio(found - exact, kappa * U);
        }
    }
    tally.row("R/R_k and indices", "κ·u", [8.0, 8.0])
}

/// A ray that starts on the camera plane asks the camera where it starts, whatever its slope: nothing is added to its place.
#[must_use]
pub fn on_the_plane() -> Row {
    let (mut draws, mut tally) = (Draws::new(21), Tally::default());
    let fields = fields(&mut draws);
    for _ in 0..DRAWS {
        let slab = &fields[draws.below(fields.len())].slabs()[draws.below(6)];
        let mut direction = draws.vector(1e-3, 1.0).clamp(-Vec3::ONE, Vec3::ONE);
        direction[slab.face().axis()] = slab.face().sign();
        let reach = f64::from(slab.st()[0].last().max(slab.st()[1].last()));
        let mut origin = draws.in_box(Vec3::splat(reach as f32));
        origin[slab.face().axis()] = slab.plane();
        let coord = slab.index_ray(&Ray { origin, direction });
        let place = slab.face().tangential(origin);
        tally.rule(coord.st.x == slab.st()[0].index(place.x) && coord.st.y == slab.st()[1].index(place.y));
    }
    tally.row("ray–plane: rays that start on the camera plane", "", [0.0, 0.0])
}

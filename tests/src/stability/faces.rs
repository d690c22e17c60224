//! Which face answers a direction.

use glam::Vec3;
use lf_math::{Face, cube_coord};

use super::draws::Draws;
use super::{DRAWS, Row, Tally};

/// A direction whose two or three largest components are a few steps of the last place apart, or the same.
pub fn near_a_tie(draws: &mut Draws) -> Vec3 {
    let size = draws.log(1e-30, 1e30) as f32;
    let mut direction = Vec3::splat(size * draws.unit() as f32);
    let first = draws.below(3);
    for axis in [first, (first + 1) % 3, (first + 2) % 3].into_iter().take(2 + draws.below(2)) {
        direction[axis] = if draws.below(4) == 0 { size } else { draws.nudged(size) };
    }
    direction * Vec3::from_array([0; 3].map(|_| draws.sign() as f32))
}

/// By bits, whose order is that of sizes: the first of the largest; none of a zero, an infinity or a NaN.
fn face_by_bits(direction: Vec3) -> Option<usize> {
    const INFINITE: u32 = 0x7f80_0000;
    let sizes = direction.to_array().map(|c| c.to_bits() & !(1 << 31));
    let largest = sizes.into_iter().max()?;
    let axis = sizes.iter().position(|&size| size == largest)?;
    (0 < largest && largest < INFINITE).then_some(2 * axis + usize::from(direction[axis].is_sign_negative()))
}

/// Exactly one face, on a tie the first axis; both cube maps and slabs take it; and no other component is larger.
#[must_use]
pub fn selection() -> Row {
    let (mut draws, mut tally) = (Draws::new(10), Tally::default());
    for i in 0..2 * DRAWS {
        let direction = if i % 2 == 0 { near_a_tie(&mut draws) } else { draws.odd_vector(1e-30, 1e30) };
        let expected = face_by_bits(direction);
        let found = Face::dominant(direction).map(|face| usize::from(face.index()));
        let mapped = cube_coord(direction);
        let within =
            mapped.is_none_or(|coord| coord.uv.cmpge(Vec3::ZERO.truncate()).all() && coord.uv.max_element() <= 1.0);
        tally.rule(found == expected && within && mapped.map(|c| usize::from(c.face.index())) == expected);
    }
    tally.row("face selection, near ties and odd numbers", "", [0.0, 0.0])
}

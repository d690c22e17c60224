//! From a pixel to the mirror's surface: the rasteriser.

use glam::{DVec2, DVec3, Vec3};
use lf_ibr::GBuffer;
use lf_math::{Pinhole, TriangleMesh};

use super::draws::Draws;
use super::{DRAWS, Row, Tally, U};

const SIZE: u32 = 64;
/// Half of the steps to which graphics hardware, and its twin, snaps vertices, pixels.
const SNAP: f64 = 1.0 / 512.0;

/// The camera in `f64`: looks along −Z from above the origin.
struct Sight {
    eye: DVec3,
    /// Pixels a unit of slope.
    focal: f64,
}

impl Sight {
    /// Where a point is seen, pixels.
    fn pixel(&self, point: DVec3) -> DVec2 {
        let away = point - self.eye;
        let middle = 0.5 * f64::from(SIZE);
        DVec2::new(middle + self.focal * away.x / -away.z, middle - self.focal * away.y / -away.z)
    }

    fn point(&self, pixel: DVec2, depth: f64) -> DVec3 {
        let middle = 0.5 * f64::from(SIZE);
        self.eye + depth * DVec3::new((pixel.x - middle) / self.focal, (middle - pixel.y) / self.focal, -1.0)
    }
}

/// A triangle whose corners are seen in and around the picture, at depths up to 200 times apart, beyond the near plane: most are seen at grazing angles.
fn triangle(draws: &mut Draws, sight: &Sight, distance: f64) -> [Vec3; 3] {
    let size = f64::from(SIZE);
    std::array::from_fn(|_| {
        let pixel = DVec2::new(draws.between(-0.5 * size, 1.5 * size), draws.between(-0.5 * size, 1.5 * size));
        sight.point(pixel, distance * draws.log(1.0, 200.0)).as_vec3()
    })
}

/// The number is how far from its pixel's centre a fragment's position is seen, against the snapping of vertices to 1/256 pixel and what
/// rounding of the corners makes on the screen. Rule: no pixel whose centre is inside by more than the snapping is missed.
///
/// # Panics
/// If there is no camera.
#[must_use]
pub fn fragments() -> Row {
    let (mut draws, mut tally) = (Draws::new(70), Tally::default());
    while tally.draws < DRAWS {
        let distance = draws.log(1e-6, 1e6);
        let eye = (draws.direction() * distance).as_vec3();
        let camera = Pinhole::looking(eye, Vec3::NEG_Z, Vec3::Y, 1.0, SIZE, SIZE).expect("a camera");
        let tangent = f64::from(0.5f32).tan();
        let sight = Sight { eye: eye.as_dvec3(), focal: 0.5 * f64::from(SIZE) / tangent };
        let corners = triangle(&mut draws, &sight, distance);
        let Ok(mesh) = TriangleMesh::new(corners.to_vec(), vec![], vec![[0, 1, 2]]) else { continue };
        let gbuffer = GBuffer::rasterize(&mesh, &camera);
        let seen = corners.map(|corner| sight.pixel(corner.as_dvec3()));
        let reach = corners.iter().map(|c| f64::from(c.length())).fold(f64::from(eye.length()), f64::max);
        for (x, y) in (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y))) {
            let center = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            match gbuffer.fragments().get(x, y) {
                Some(fragment) => {
                    let position = fragment.position.as_dvec3();
                    let depth = sight.eye.z - position.z;
                    let rounding = sight.focal * reach / depth * U + f64::from(SIZE) * U;
                    tally.rule(fragment.position.is_finite());
                    tally.ratio((sight.pixel(position) - center).abs().max_element(), SNAP + rounding);
                }
                None if inside(seen, center) > 2.0 * SNAP => tally.rule(false),
                None => {}
            }
        }
    }
    tally.row("pixel → triangle, grazing", "1/512 px + κ·u", [2.0, 4.0])
}

/// How far inside a triangle a place is; less than 0 outside.
fn inside(corners: [DVec2; 3], place: DVec2) -> f64 {
    let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
    let edge = |i: usize| {
        let (from, to) = (corners[i], corners[(i + 1) % 3]);
        (to - from).perp_dot(place - from) * area.signum() / (to - from).length()
    };
    edge(0).min(edge(1)).min(edge(2))
}

//! From a surface point to (s′, t′, u′, v′): interpolate the normal, normalise, reflect, choose the face, index.

use glam::{DVec3, Vec3};
use lf_math::{Face, Ray, normalized, reflect};

use super::draws::Draws;
use super::index::{Indices, by_number, fields, indices};
use super::{DRAWS, Row, Tally, U};

/// Three unit normals at the corners of a triangle and the shares of its corners.
struct Corners {
    normals: [Vec3; 3],
    shares: [f32; 3],
}

impl Corners {
    /// Around a normal, turned away from it by up to half a right angle and more: a surface of any curvature.
    fn around(draws: &mut Draws, normal: DVec3) -> Self {
        let bend = draws.log(1e-6, 3.0);
        let turned = || normalized((normal + bend * draws.direction()).as_vec3()).unwrap_or(Vec3::Y);
        let normals = std::array::from_fn({
            let mut turned = turned;
            move |_| turned()
        });
        let shares = [draws.unit(), draws.unit(), draws.unit()];
        let sum: f64 = shares.iter().sum();
        Self { normals, shares: shares.map(|share| (share / sum) as f32) }
    }

    fn blend(&self) -> Vec3 {
        let [a, b, c] = [0, 1, 2].map(|i| self.normals[i] * self.shares[i]);
        a + b + c
    }

    /// The exact blend, and how many times a relative error of its terms it has.
    fn exact(&self) -> (DVec3, f64) {
        let terms = [0, 1, 2].map(|i| self.normals[i].as_dvec3() * f64::from(self.shares[i]));
        let sum: DVec3 = terms.into_iter().sum();
        (sum / sum.length(), terms.iter().map(|term| term.length()).sum::<f64>() / sum.length())
    }
}

/// Rays from an eye outside to a point in the cell, most of them grazing. κ adds up what a relative change of each input does: of eye and
/// point by their distance, of the normals by how they cancel, then of the direction by how far the dominant component is from it,
/// and of the plane and axes as in the index's own row. Rule: the face is that of a component that is largest within rounding.
#[must_use]
pub fn reflected() -> Row {
    let (mut draws, mut tally) = (Draws::new(50), Tally::default());
    let fields = fields(&mut draws);
    for _ in 0..DRAWS {
        let field = &fields[draws.below(fields.len())];
        let half = field.cell().half_extent();
        let point = draws.in_box(half);
        let sight = draws.direction();
        let eye = (point.as_dvec3() - sight * f64::from(half.max_element()) * draws.log(1e-3, 1e3)).as_vec3();
        // The sine of the angle between ray and surface.
        let grazing = draws.log(1e-6, 1.0) * draws.sign();
        let across = sight.cross(draws.direction()).normalize();
        let corners = Corners::around(&mut draws, across * (1.0 - grazing * grazing).sqrt() - sight * grazing);
        let normal = normalized(corners.blend()).unwrap_or(Vec3::Y);
        let direction = reflect(point - eye, normal);
        let Some(found) = field.index_ray(&Ray { origin: point, direction }) else {
            tally.rule(point == eye);
            continue;
        };
        let (normal, normal_kappa) = corners.exact();
        let incident = point.as_dvec3() - eye.as_dvec3();
        let exact = incident - 2.0 * incident.dot(normal) * normal;
        let apart = (point.as_dvec3().length() + eye.as_dvec3().length()) / incident.length();
        let turned = apart + 4.0 * normal_kappa;
        let slab = &field.slabs()[found.slab];
        let k = slab.face().axis();
        let largest = exact.abs().max_element();
        tally.rule(exact[k].abs() >= largest - 8.0 * U * turned * exact.length());
        let Indices { exact: expected, kappa } = indices(slab, point.as_dvec3(), exact);
        let run = (f64::from(slab.plane()) - f64::from(point[k])).abs();
        for (i, axis) in slab.face().tangents().into_iter().enumerate() {
            let slope = exact[axis].abs() / exact[k].abs();
            let tilted = turned * (1.0 + slope) * exact.length() / exact[k].abs();
            let found = by_number(&found.coord);
            let st = kappa[i] + tilted * run / f64::from(slab.st()[i].step());
            tally.ratio(found[i] - expected[i], st * U);
            let uv = kappa[2 + i] + tilted / f64::from(slab.uv()[i].step());
            tally.ratio(found[2 + i] - expected[2 + i], uv * U);
        }
    }
    tally.row("surface → normal → reflect → (s,t,u,v), grazing", "κ·u", [64.0, 128.0])
}

/// The background's chain: a pixel's ray, from an eye near the cell, met with the camera plane. κ adds what the axes of the camera and the
/// pixel's place do.
#[must_use]
pub fn seen() -> Row {
    let (mut draws, mut tally) = (Draws::new(51), Tally::default());
    let fields = fields(&mut draws);
    for _ in 0..DRAWS / 16 {
        let field = &fields[draws.below(fields.len())];
        let half = field.cell().half_extent();
        let eye = draws.in_box(half);
        let (forward, up) = (draws.direction().as_vec3(), draws.direction().as_vec3());
        let fov = draws.between(0.01, 2.5) as f32;
        let [width, height] = [0; 2].map(|_| 1 + draws.below(4096) as u32);
        let camera = lf_math::Pinhole::looking(eye, forward, up, fov, width, height).expect("a camera");
        for _ in 0..16 {
            let (x, y) = (draws.below(width as usize) as u32, draws.below(height as usize) as u32);
            let ray = camera.ray(x, y);
            let (exact, kappa_direction) = pixel_ray(forward, up, fov, [width, height], [x, y]);
            let Some(found) = field.index_ray(&ray) else {
                tally.rule(false);
                continue;
            };
            let slab = &field.slabs()[found.slab];
            tally.rule(Face::dominant(ray.direction) == Some(slab.face()));
            let k = slab.face().axis();
            let Indices { exact: expected, kappa } = indices(slab, eye.as_dvec3(), exact);
            let run = (f64::from(slab.plane()) - f64::from(eye[k])).abs();
            for (i, axis) in slab.face().tangents().into_iter().enumerate() {
                let slope = exact[axis].abs() / exact[k].abs();
                let tilted = kappa_direction * (1.0 + slope) * exact.length() / exact[k].abs();
                let found = by_number(&found.coord);
                let steps = [f64::from(slab.st()[i].step()), f64::from(slab.uv()[i].step())];
                tally.ratio(found[i] - expected[i], (kappa[i] + tilted * run / steps[0]) * U);
                tally.ratio(found[2 + i] - expected[2 + i], (kappa[2 + i] + tilted / steps[1]) * U);
            }
        }
    }
    tally.row("pixel → camera plane → (s,t,u,v)", "κ·u", [64.0, 128.0])
}

/// The direction through a pixel's centre, and its condition number: of the frame by how near `up` is to `forward`, of the field of view by
/// its tangent's.
fn pixel_ray(forward: Vec3, up: Vec3, fov: f32, [width, height]: [u32; 2], [x, y]: [u32; 2]) -> (DVec3, f64) {
    let unit = |v: DVec3| v / v.length();
    let (forward, up) = (unit(forward.as_dvec3()), unit(up.as_dvec3()));
    let across = forward.cross(up);
    let right = unit(across);
    let half = 0.5 * f64::from(fov);
    let scale = 2.0 * half.tan() / f64::from(height);
    let place = |pixel: u32, size: u32| (f64::from(pixel) + 0.5 - 0.5 * f64::from(size)) * scale;
    let (dx, dy) = (place(x, width), -place(y, height));
    let direction = forward + dx * right + dy * right.cross(forward);
    let of_tangent = half / (half.sin() * half.cos());
    let aside = dx.abs() + dy.abs();
    let reach = 0.5 * (f64::from(width) + f64::from(height)) * scale;
    (direction, (1.0 + aside / across.length() + aside * of_tangent + reach) / direction.length())
}

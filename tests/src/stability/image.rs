//! Whole pictures: in other units of length, turned by right angles, and along the seams of faces.

use glam::{DMat3, DQuat, DVec3, Vec2, Vec3};
use lf_ibr::{Behind, Environment, Reflector, SlabField, draw_frame};
use lf_math::{
    Cell, Image, LightFieldGeometry, Pinhole, Placement, PlanePlacement, Ray, Reflectance, SlabTexels, TriangleMesh,
};
use lf_scene::reflectors;

use super::draws::Draws;
use super::{DRAWS, Row, Tally};

const SIZE: u32 = 160;
const CAMERAS: u32 = 5;

/// A scene, its unit of length and how it is turned.
#[derive(Clone, Copy)]
struct Setting {
    scale: f32,
    turn: DMat3,
}

impl Setting {
    fn turned(&self, v: Vec3) -> Vec3 {
        (self.turn * v.as_dvec3()).as_vec3()
    }

    /// Slabs of light from infinity that is a smooth function of direction.
    fn field(&self, focal_depth: Option<f32>, texels: [u32; 2]) -> SlabField {
        let half = self.turned(Vec3::new(0.5, 0.75, 0.625)).abs() * self.scale;
        let cell = Cell::new(DVec3::ZERO, half).expect("a cell");
        let plain =
            LightFieldGeometry::around_with(cell, PlanePlacement::CellFaces, [CAMERAS; 2], texels).expect("slabs");
        let focused = |slab: &lf_math::Slab| slab.with_focal_depth(focal_depth.map(|depth| depth * self.scale));
        let slabs = plain.slabs().iter().map(|slab| focused(slab).expect("a slab")).collect();
        let geometry = LightFieldGeometry::new(cell, slabs).expect("slabs");
        let all = geometry.slabs().iter().map(|slab| {
            let counts = [slab.cameras(), slab.resolution()];
            let each = (0..counts[0].into_iter().chain(counts[1]).product()).map(|i: u32| {
                let texel = Vec2::new((i % texels[0]) as f32, (i / texels[0] % texels[1]) as f32);
                light(self.turn.transpose() * slab.sample_ray(Vec2::ZERO, texel).direction.as_dvec3())
            });
            SlabTexels::new(slab, each.collect()).expect("texels")
        });
        let all = all.collect();
        SlabField::new(geometry, all).expect("a field")
    }

    /// Mirrors in front of the slabs.
    fn picture(&self) -> Image<[u8; 4]> {
        let sphere = reflectors::sphere(3);
        let meshes = [Vec3::new(-0.2, 0.1, 0.1), Vec3::new(0.2, -0.2, -0.1)].map(|at| {
            let place = |p: &Vec3| self.turned(*p * 0.2 + at) * self.scale;
            let positions: Vec<_> = sphere.positions().iter().map(place).collect();
            TriangleMesh::new(positions, vec![], sphere.triangles().to_vec()).expect("a mesh")
        });
        let shares = [Reflectance::MIRROR, Reflectance::new(Vec3::new(0.9, 0.7, 0.5), Some(0.04)).expect("shares")];
        let mirror =
            |(mesh, reflectance)| Reflector { mesh, placement: Placement::IDENTITY, reflectance, normal_map: None };
        let mirrors: Vec<_> = meshes.iter().zip(shares).map(mirror).collect();
        let [eye, forward, up] =
            [Vec3::new(0.9, 0.5, 1.1), Vec3::new(-0.9, -0.5, -1.1), Vec3::Y].map(|v| self.turned(v));
        let camera = Pinhole::looking(eye * self.scale, forward, up, 0.7, SIZE, SIZE).expect("a camera");
        draw_frame(&mirrors, Behind::Environment, &self.field(Some(3.0), [33; 2]), &camera).expect("draws")
    }
}

/// Colours of a direction, 0 … 1: a second derivative along a slope of at most ½.
fn light(direction: DVec3) -> [u8; 4] {
    let [r, g, b] = (0.5 + 0.5 * direction / direction.length()).to_array().map(|c| (255.0 * c).round() as u8);
    [r, g, b, 255]
}

/// Differences of the pictures' pixels, 255ths.
fn compare(tally: &mut Tally, [a, b]: [&Image<[u8; 4]>; 2], at_most: u8) {
    for (a, b) in a.texels().iter().zip(b.texels()) {
        let apart = (0..4).map(|c| a[c].abs_diff(b[c])).max().unwrap_or(0);
        tally.rule(apart <= at_most);
        tally.ratio(f64::from(apart), 1.0);
    }
}

/// Units of length from 2⁻⁹⁰ to 2⁹⁰: the same bits.
#[must_use]
pub fn scaled() -> Row {
    let mut tally = Tally::default();
    let one = Setting { scale: 1.0, turn: DMat3::IDENTITY }.picture();
    for exponent in [-90, -70, -31, -1, 1, 20, 70, 90] {
        let other = Setting { scale: 2.0f32.powi(exponent), turn: DMat3::IDENTITY }.picture();
        compare(&mut tally, [&one, &other], 0);
    }
    tally.row("picture in units of 2⁻⁹⁰ to 2⁹⁰ m", "1/255", [0.0, 0.0])
}

/// The whole scene turned by right angles: other faces answer, with the same colours.
#[must_use]
pub fn turned() -> Row {
    let mut tally = Tally::default();
    let one = Setting { scale: 1.0, turn: DMat3::IDENTITY }.picture();
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        for quarters in 1..4 {
            let turn = DQuat::from_axis_angle(axis, f64::from(quarters) * std::f64::consts::FRAC_PI_2);
            // Exactly: entries are −1, 0 and 1.
            let turn = DMat3::from_cols_array(&DMat3::from_quat(turn).to_cols_array().map(f64::round));
            compare(&mut tally, [&one, &Setting { scale: 1.0, turn }.picture()], 1);
        }
    }
    tally.row("picture turned by 90°", "1/255", [1.0, 1.0])
}

/// Rays on either side of a tie of two faces, a last place apart: the number is the colours' difference against what the filter may be wrong
/// by, a texel's rounding and the second derivative of the light times step²/8, on either side.
///
/// # Panics
/// If there are no slabs.
#[must_use]
pub fn seams() -> Row {
    let (mut draws, mut tally) = (Draws::new(80), Tally::default());
    let field = Setting { scale: 1.0, turn: DMat3::IDENTITY }.field(None, [33, 27]);
    // Two faces have unlike grids along the seam; the coarser one is wrong by more.
    let step = f64::from(field.geometry().slabs()[0].uv()[1].step());
    let tolerance = 2.0 * (0.5 / 255.0 + 0.5 * step * step / 8.0) + 1e-6;
    for _ in 0..DRAWS {
        let axis = draws.below(3);
        let mut direction = Vec3::splat(draws.log(1e-3, 1e3) as f32);
        direction[axis] *= draws.between(-1.0, 1.0) as f32;
        direction *= Vec3::from_array([0; 3].map(|_| draws.sign() as f32));
        let origin = draws.in_box(field.geometry().cell().half_extent());
        let [one, other] = [1, 2].map(|next| {
            let mut beside = direction;
            let c = &mut beside[(axis + next) % 3];
            *c = if *c > 0.0 { c.next_up() } else { c.next_down() };
            let ray = Ray { origin, direction: beside };
            field.geometry().index_ray(&ray).map(|indexed| indexed.slab).zip(field.look_up(&ray))
        });
        let (Some((first, one)), Some((second, other))) = (one, other) else {
            tally.rule(false);
            continue;
        };
        tally.rule(first != second);
        tally.ratio(f64::from((one - other).abs().max_element()), tolerance);
    }
    tally.row("both faces of a tie: jump of the colour", "tolerance", [1.0, 1.0])
}

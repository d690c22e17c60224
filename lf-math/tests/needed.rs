//! The exact set of needed texels against closed forms, random rays and enumeration.

mod any_slab;

use std::collections::HashSet;

use any_slab::any_slab;
use glam::{DVec3, Vec2, Vec3};
use lf_math::{Cell, Coverage, Face, LightFieldGeometry, NeededTexels, PlanePlacement, Ray, Slab};
use proptest::prelude::*;

/// Evenly spread points of the unit 4-cube: powers of 1/g, where g⁵ = g + 1.
fn point(n: u32) -> [f64; 4] {
    let g = 1.167_303_978_261_418_7_f64;
    [1, 2, 3, 4].map(|i| (f64::from(n) * g.powi(-i)).fract())
}

/// The share of 10⁶ evenly spread samples (s, t, u, v) of a finely sampled slab of a unit cube that pass a test.
fn share(placement: PlanePlacement, passes: impl Fn(&LightFieldGeometry, [u32; 2], [u32; 2]) -> bool) -> f64 {
    const COUNT: u32 = 40_000;
    const POINTS: u32 = 1_000_000;
    let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
    let field = LightFieldGeometry::around(cell, placement, COUNT, COUNT).unwrap();
    let passed = (0..POINTS).filter(|&n| {
        let [s, t, u, v] = point(n).map(|x| (x * f64::from(COUNT)) as u32);
        passes(&field, [s, t], [u, v])
    });
    passed.count() as f64 / f64::from(POINTS)
}

fn needed_share(placement: PlanePlacement) -> f64 {
    let needed = |field: &LightFieldGeometry| NeededTexels::of_cell(&field.slabs()[4], field.cell());
    share(placement, |field, camera, texel| needed(field).contains(camera, texel))
}

fn ball_share(placement: PlanePlacement) -> f64 {
    share(placement, |field, camera, texel| {
        let index = |i: [u32; 2]| Vec2::new(i[0] as f32, i[1] as f32);
        let ray = field.slabs()[4].sample_ray(index(camera), index(texel));
        // The line passes the centre at less than half an edge.
        ray.origin.cross(ray.direction).length() < 0.5 * ray.direction.length()
    })
}

/// Rays through a cube of edge l towards one face, by area on the camera plane and slopes (du dv): for slopes (u, v) the
/// cube's shadow on the plane, seen along the ray, is the far face, l², and the sides that the ray sees: l²·(1 + |u| + |v|).
/// The mean of |u| over −1 … 1 is ½, so the shadows of all slopes, an area of 2² = 4, fill 4·l²·(1 + ½ + ½) = 8l². Planes on
/// the faces hold 3l·3l·4 = 36l², planes through the centre 2l·2l·4 = 16l².
#[test]
fn two_ninths_and_one_half_are_needed_of_a_cube() {
    let (faces, center) = (needed_share(PlanePlacement::CellFaces), needed_share(PlanePlacement::CellCenter));
    assert!((faces - 8.0 / 36.0).abs() < 0.001, "{faces}");
    assert!((center - 8.0 / 16.0).abs() < 0.001, "{center}");
    // Between the two, at a quarter of an edge: slabs of 2l + 2·¼l = 2.5l.
    let between = needed_share(PlanePlacement::Offset(0.25));
    assert!((between - 8.0 / 25.0).abs() < 0.001, "{between}");
}

/// A ball of radius R shows each direction a disc of πR², which is πR²·√(1 + u² + v²) on the plane. Over the slopes
/// ∫∫ √(1 + u² + v²) du dv = 4·(√3/3 + 4/3·asinh(1/√2) − π/18), with R = l/2 in all 4.024l².
#[test]
fn a_ball_needs_half_of_what_its_cube_does() {
    let integral = 4.0 * (3f64.sqrt() / 3.0 + 4.0 / 3.0 * 0.5f64.sqrt().asinh() - std::f64::consts::PI / 18.0);
    let ball = std::f64::consts::FRAC_PI_4 * integral;
    assert!((ball / 36.0 - 0.1118).abs() < 1e-4 && (ball / 16.0 - 0.2515).abs() < 1e-4);
    for (placement, all) in [(PlanePlacement::CellFaces, 36.0), (PlanePlacement::CellCenter, 16.0)] {
        let found = ball_share(placement);
        assert!((found - ball / all).abs() < 0.001, "{placement:?}: {found}");
    }
}

/// The paper's set-up without a focal plane: of its 30.8 % in windows of whole blocks, a tenth need not be traced.
#[test]
fn the_papers_set_up_needs_27_percent() {
    let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
    let field = LightFieldGeometry::around(cell, PlanePlacement::CellFaces, 32, 128).unwrap();
    let (slab, mut count) = (&field.slabs()[0], 0u64);
    let needed = NeededTexels::of_cell(slab, &cell);
    let coverage = Coverage::of_cell(slab, &cell).aligned(4);
    for (camera, [u, v]) in coverage.stored() {
        let image = needed.image(camera, [u.clone(), v.clone()]);
        count += v.map(|v| u.clone().filter(|&u| image.contains([u, v])).count() as u64).sum::<u64>();
    }
    let share = count as f64 / f64::from(1u32 << 24);
    assert!((0.274..0.277).contains(&share), "{share}");
}

/// A ray from a place in a box, given by its corners, with each number beyond ±1 drawn to the edge.
fn ray_in([least, most]: [Vec3; 2], slab: &Slab, at: [f32; 3], slopes: [f32; 2]) -> Ray {
    let edge = |x: f32| if x.abs() > 1.0 { x.signum() } else { x };
    let share = 0.5 * Vec3::from(at.map(edge)) + 0.5;
    let origin = (least + (most - least) * share).clamp(least, most);
    Ray { origin, direction: slab.face().vector(Vec2::from(slopes.map(edge)), slab.face().sign()) }
}

/// The texels that a ray's look-up uses with a weight greater than 0: camera and texel.
fn used(slab: &Slab, ray: &Ray) -> HashSet<[[u32; 2]; 2]> {
    let mut used = HashSet::new();
    for tap in slab.taps(&slab.index_ray(ray)).into_iter().filter(|tap| tap.weight > 0.0) {
        let ends = |x: f32| [x.floor() as u32, x.ceil() as u32];
        for (u, v) in ends(tap.uv.x).into_iter().flat_map(|u| ends(tap.uv.y).map(|v| (u, v))) {
            used.insert([tap.camera, [u, v]]);
        }
    }
    used
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100_000, max_global_rejects: 1_000_000, ..ProptestConfig::default() })]

    #[test]
    fn rays_find_all_they_use(
        (cell, slab) in any_slab(), corner in prop::array::uniform3(-1.0f32..1.0), whole in any::<bool>(),
        at in prop::array::uniform3(-1.5f32..1.5), slopes in prop::array::uniform2(-1.5f32..1.5)
    ) {
        let half = cell.half_extent();
        let least = if whole { -half } else { half * Vec3::from(corner) };
        let ray = ray_in([least, half], &slab, at, slopes);
        prop_assume!(Face::dominant(ray.direction) == Some(slab.face()));
        let needed = NeededTexels::of_box(&slab, [least, half]);
        for [camera, texel] in used(&slab, &ray) {
            prop_assert!(needed.contains(camera, texel), "{camera:?} {texel:?}");
        }
    }
}

/// Of the texels called needed nearly all are used by one of many rays from everywhere, the cell's edges and the steepest
/// slopes above all: there is nothing to spare but what is touched in a corner.
#[test]
fn nothing_is_needed_that_no_ray_uses() {
    let cell = Cell::new(DVec3::ZERO, Vec3::new(0.5, 0.75, 0.4)).unwrap();
    for (placement, depth) in [
        (PlanePlacement::CellFaces, None),
        (PlanePlacement::CellFaces, Some(1.5)),
        (PlanePlacement::Offset(0.9), Some(4.0)),
    ] {
        let field = LightFieldGeometry::around_with(cell, placement, [7, 6], [8, 9]).unwrap();
        let slab = field.slabs()[4].with_focal_depth(depth).unwrap();
        let mut found = HashSet::new();
        for n in 0..1_000_000u32 {
            let ([x, y, z, u], v) = (point(n), (f64::from(n) * 0.618_033_988_749_895).fract());
            let wide = |x: f64| (2.4 * x - 1.2) as f32;
            let at = [x, y, z].map(wide);
            let ray = ray_in([-cell.half_extent(), cell.half_extent()], &slab, at, [wide(u), wide(v)]);
            if Face::dominant(ray.direction) == Some(slab.face()) {
                found.extend(used(&slab, &ray));
            }
        }
        let needed = NeededTexels::of_cell(&slab, &cell);
        let cameras = (0..6).flat_map(|t| (0..7).map(move |s| [s, t]));
        let samples = cameras.flat_map(|camera| (0..9).flat_map(move |v| (0..8).map(move |u| [camera, [u, v]])));
        let called: HashSet<_> = samples.filter(|[camera, texel]| needed.contains(*camera, *texel)).collect();
        assert!(found.is_subset(&called));
        assert!(called.len() as f64 <= 1.01 * found.len() as f64, "{placement:?}: {} {}", called.len(), found.len());
        assert!(called.len() < 42 * 72 * 4 / 5, "{placement:?}: {}", called.len());
    }
}

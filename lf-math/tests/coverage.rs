//! The separable crop against closed forms, enumeration and random rays.

mod any_slab;

use any_slab::any_slab;
use glam::{DVec3, Vec2, Vec3};
use lf_math::{Cell, Coverage, Face, LightFieldGeometry, PlanePlacement, Ray, SampledAxis, Slab};
use proptest::prelude::*;

fn cube(placement: PlanePlacement, cameras: u32, resolution: u32) -> LightFieldGeometry {
    let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
    LightFieldGeometry::around(cell, placement, cameras, resolution).unwrap()
}

fn share(field: &LightFieldGeometry, focal_depth: Option<f32>, block: u32) -> f64 {
    let slab = field.slabs()[0].with_focal_depth(focal_depth).unwrap();
    let all = slab.cameras().into_iter().chain(slab.resolution()).map(u64::from).product::<u64>();
    Coverage::of_cell(&slab, field.cell()).aligned(block).texels() as f64 / all as f64
}

/// A camera at a beyond the edge serves slopes from a to 1: a quarter on average over two thirds of each axis, and all of
/// the third in the middle: (1/3 + 2/3 · 1/4)² = 1/4.
#[test]
fn a_quarter_is_kept_in_the_limit_of_fine_sampling() {
    let kept = share(&cube(PlanePlacement::CellFaces, 3001, 3001), None, 1);
    assert!((kept - 0.25).abs() < 0.002, "{kept}");
    assert_eq!(share(&cube(PlanePlacement::CellCenter, 31, 31), None, 1), 1.0);
}

/// The paper's set-up with whole blocks: without a focal plane and with one at two edge lengths.
#[test]
fn the_papers_set_up_keeps_about_three_tenths() {
    let field = cube(PlanePlacement::CellFaces, 32, 128);
    let (plain, focused) = (share(&field, None, 4), share(&field, Some(2.0), 4));
    assert!((0.306..0.309).contains(&plain), "{plain}");
    assert!((0.324..0.327).contains(&focused), "{focused}");
}

/// Whether some ray of the unit cell with the plane at its face crosses the plane in `s` with the slope `u` on both axes,
/// the run being the same.
fn needed(s: [f64; 2], u: [f64; 2]) -> bool {
    // r must satisfy |s − r·u| ≤ ½ on both axes, 0 ≤ r ≤ 1.
    let mut run = [0.0f64, 1.0];
    for (s, u) in s.into_iter().zip(u) {
        let ends = [(s - 0.5) / u, (s + 0.5) / u];
        run = [run[0].max(ends[0].min(ends[1])), run[1].min(ends[0].max(ends[1]))];
    }
    run[0] <= run[1]
}

/// Of all pairs of a position within 3l and a slope, on both axes, 2/9 belong to a ray through the cell: for each run r the
/// positions fill l² for each of 2² slopes; the rays that leave by the face fill 8l² in all, of 36l².
#[test]
fn two_ninths_are_needed_exactly() {
    const POINTS: u32 = 1_000_000;
    // An additive sequence that fills the unit 4-cube evenly: powers of 1/g, where g⁵ = g + 1.
    let g = 1.167_303_978_261_418_7_f64;
    let at = |n: u32, i: i32| (f64::from(n) * g.powi(-i)).fract();
    let inside = |n: &u32| {
        needed([3.0 * at(*n, 1) - 1.5, 3.0 * at(*n, 2) - 1.5], [2.0 * at(*n, 3) - 1.0, 2.0 * at(*n, 4) - 1.0])
    };
    let found = (0..POINTS).filter(inside).count() as f64 / f64::from(POINTS);
    assert!((found - 2.0 / 9.0).abs() < 0.0005, "{found}");
}

/// The blocks of the paper's set-up that a bilinear look-up touches, found by trying depths: fewer than the windows hold,
/// which do not know that both axes share the depth, and all of them inside.
#[test]
fn windows_hold_every_block_that_is_touched() {
    const RUNS: u32 = 64;
    let (cameras, blocks) = (32usize, 32usize);
    let (camera_step, texel_step) = (3.0 / 31.0, 2.0 / 127.0);
    // Bit r: camera i is asked for block b by a ray that left the cell at run r/63.
    let touched = |i: usize, b: usize| {
        (0..RUNS).fold(0u64, |bits, r| {
            let run = f64::from(r) / f64::from(RUNS - 1);
            let near = -1.5 + (i as f64 + [-1.0, 1.0][0]) * camera_step;
            let far = -1.5 + (i as f64 + 1.0) * camera_step;
            // The texels of the block, and less than one beyond on either side.
            let u = [4.0 * b as f64 - 1.0, 4.0 * b as f64 + 4.0].map(|m| (-1.0 + m * texel_step).clamp(-1.0, 1.0));
            let hit = near < 0.5 + run * u[1] && far > -0.5 + run * u[0];
            bits | u64::from(hit) << r
        })
    };
    let axis: Vec<Vec<u64>> = (0..cameras).map(|i| (0..blocks).map(|b| touched(i, b)).collect()).collect();
    let field = cube(PlanePlacement::CellFaces, 32, 128);
    let coverage = Coverage::of_cell(&field.slabs()[0], field.cell()).aligned(4);
    let (mut exact, mut outside) = (0u64, 0);
    for (s, t) in (0..cameras).flat_map(|s| (0..cameras).map(move |t| (s, t))) {
        let window = coverage.window([s as u32, t as u32]).unwrap();
        for (u, v) in (0..blocks).flat_map(|u| (0..blocks).map(move |v| (u, v))) {
            if axis[s][u] & axis[t][v] != 0 {
                exact += 1;
                let inside = window[0].contains(&(4 * u as u32)) && window[1].contains(&(4 * v as u32));
                outside += u32::from(!inside);
            }
        }
    }
    let share = exact as f64 / (cameras * cameras * blocks * blocks) as f64;
    assert_eq!(outside, 0);
    assert!((0.275..0.285).contains(&share), "{share}");
}

fn ray_in(cell: &Cell, slab: &Slab, at: [f32; 3], slopes: [f32; 2], length: f32) -> Ray {
    let edge = |x: f32| if x.abs() > 1.0 { x.signum() } else { x };
    let origin = cell.half_extent() * Vec3::from(at.map(edge));
    let face = slab.face();
    Ray { origin, direction: face.vector(Vec2::from(slopes.map(edge)), face.sign()) * length }
}

/// Every texel that a ray's look-up uses with a weight greater than 0 is kept.
fn finds_all_it_uses(slab: &Slab, coverage: &Coverage, ray: &Ray) -> Result<(), TestCaseError> {
    for tap in slab.taps(&slab.index_ray(ray)).into_iter().filter(|tap| tap.weight > 0.0) {
        let window = coverage.window(tap.camera);
        prop_assert!(window.is_some(), "{tap:?}");
        for (range, place) in window.unwrap().into_iter().zip(tap.uv.to_array()) {
            let touched = [place.floor() as u32, place.ceil() as u32];
            prop_assert!(touched.iter().all(|texel| range.contains(texel)), "{tap:?} {range:?}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, max_global_rejects: 100_000, ..ProptestConfig::default() })]

    #[test]
    fn rays_through_the_cell_find_all_they_use(
        (cell, slab) in any_slab(),
        at in prop::array::uniform3(-1.5f32..1.5), slopes in prop::array::uniform2(-1.5f32..1.5), length in 1e-3f32..1e3
    ) {
        let ray = ray_in(&cell, &slab, at, slopes, length);
        prop_assume!(Face::dominant(ray.direction) == Some(slab.face()));
        let coverage = Coverage::of_cell(&slab, &cell);
        finds_all_it_uses(&slab, &coverage, &ray)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, max_global_rejects: 100_000, ..ProptestConfig::default() })]

    /// A reflector that stays in a part of the cell asks for less, and for nothing that is not there.
    #[test]
    fn rays_from_a_box_find_all_they_use(
        (cell, slab) in any_slab(), corner in prop::array::uniform3(-1.0f32..1.0), size in prop::array::uniform3(0.0f32..1.0),
        at in prop::array::uniform3(-0.5f32..1.5), slopes in prop::array::uniform2(-1.5f32..1.5)
    ) {
        let half = cell.half_extent();
        let least = half * Vec3::from(corner);
        let most = (least + half * Vec3::from(size)).min(half);
        let coverage = Coverage::of_box(&slab, [least, most]);
        prop_assert_eq!(&coverage.intersection(&Coverage::of_cell(&slab, &cell)), &coverage);
        let origin = (least + (most - least) * Vec3::from(at).clamp(Vec3::ZERO, Vec3::ONE)).clamp(least, most);
        let ray = Ray { origin, ..ray_in(&cell, &slab, at, slopes, 1.0) };
        prop_assume!(Face::dominant(ray.direction) == Some(slab.face()));
        finds_all_it_uses(&slab, &coverage, &ray)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// No window is wider than what sampling finds, but for a texel at either end: there is nothing to spare.
    #[test]
    fn windows_are_tight(camera in 0u32..24, depth in prop::option::of(0.5f32..30.0)) {
        let field = cube(PlanePlacement::CellFaces, 24, 96);
        let slab = field.slabs()[4].with_focal_depth(depth).unwrap();
        let found = Coverage::of_cell(&slab, field.cell()).columns().get(camera).unwrap();
        let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
        for (x, z, u) in (0..=64).flat_map(|x| (0..=16).flat_map(move |z| (0..=64).map(move |u| (x, z, u)))) {
            let unit = |i: i32, n: f32| 2.0 * i as f32 / n - 1.0;
            let ray = ray_in(field.cell(), &slab, [unit(x, 64.0), 0.0, unit(z, 16.0)], [unit(u, 64.0), 0.0], 1.0);
            for tap in slab.taps(&slab.index_ray(&ray)).into_iter().filter(|t| t.camera[0] == camera && t.weight > 0.0) {
                (least, most) = (least.min(tap.uv.x), most.max(tap.uv.x));
            }
        }
        prop_assert!((found.start as f32) >= least - 4.0 && (found.end as f32) <= most + 5.0, "{found:?} {least} {most}");
    }
}

/// There is one way to write each coverage, so that equal ones compare equal.
#[test]
fn coverages_are_canonical() {
    let axis = |count| SampledAxis::spanning(-1.0, 1.0, count).unwrap();
    let slab = Slab::new(Face::PosX, 0.5, [axis(2), axis(2)], [axis(4), axis(4)], None).unwrap();
    let windows = || Coverage::new(&slab, vec![0..4, 3..3], vec![1..4, 2..4]).unwrap();
    assert_eq!(windows(), Coverage::new(&slab, vec![0..4, 0..0], vec![1..4, 2..4]).unwrap());
    // The second column has no camera to be kept or not.
    for kept in [[true, false, true, false], [true, true, true, false], [true; 4]] {
        assert_eq!(windows().with_cameras(kept.to_vec()).unwrap(), windows());
    }
    let masked = |kept: [bool; 4]| windows().with_cameras(kept.to_vec()).unwrap();
    assert_eq!(masked([true, true, false, true]), masked([true, false, false, false]));
    assert!(!masked([true, true, false, true]).keeps_all_cameras() && windows().keeps_all_cameras());
    assert_eq!(masked([true, true, false, true]).intersection(&windows()), masked([true, false, false, false]));
    assert!(!masked([true, true, false, true]).intersection(&masked([false, true, true, true])).keeps_any());
}

//! The four cameras around a ray: weights, disparity, and what happens where one camera gives way to the next.

use glam::{DVec2, Vec2};
use lf_math::{Face, SampledAxis, Slab, SlabCoord};

use super::draws::{Draws, ODD};
use super::{DRAWS, Row, Tally, U};

const COUNTS: [u32; 6] = [1, 2, 3, 32, 1000, 4096];

/// A slab of any of [`COUNTS`] cameras and texels by axis.
fn slab(draws: &mut Draws) -> Slab {
    let mut axis = || SampledAxis::spanning(-1.0, 1.0, COUNTS[draws.below(COUNTS.len())]).expect("an axis");
    Slab::new(Face::PosZ, 0.5, [axis(), axis()], [axis(), axis()], None).expect("a slab")
}

/// An index within an axis and a little beyond, often next to a camera, sometimes odd.
fn index(draws: &mut Draws, count: u32) -> f32 {
    match draws.below(8) {
        0 => ODD[draws.below(ODD.len())],
        1..4 => {
            let whole = draws.below(count as usize + 1) as f32;
            draws.nudged(whole)
        }
        _ => draws.between(-1.0, f64::from(count) + 1.0) as f32,
    }
}

fn coord(draws: &mut Draws, slab: &Slab) -> SlabCoord {
    let mut pair = |counts: [u32; 2]| Vec2::new(index(draws, counts[0]), index(draws, counts[1]));
    SlabCoord { st: pair(slab.cameras()), uv: pair(slab.resolution()) }
}

/// What is not a number counts as 0, what is beyond the ends as the ends.
fn held(value: f32, count: u32) -> f64 {
    if value.is_nan() { 0.0 } else { f64::from(value).clamp(0.0, f64::from(count - 1)) }
}

/// Rules: cameras and texels exist, weights are within 0 … 1 and blend cameras to the ray's own place. The number is how far
/// their sum is from 1.
#[must_use]
pub fn weights() -> Row {
    let (mut draws, mut tally) = (Draws::new(30), Tally::default());
    for _ in 0..DRAWS {
        let slab = slab(&mut draws);
        let coord = coord(&mut draws, &slab);
        let disparity = Vec2::new(draws.number(1e-6, 1e4), draws.number(1e-6, 1e4));
        let taps = slab.taps_with(&coord, disparity);
        let (cameras, texels) = (slab.cameras(), slab.resolution());
        let there = taps.iter().all(|tap| {
            let seen = (0..2).all(|i| tap.uv[i] >= 0.0 && tap.uv[i] <= (texels[i] - 1) as f32);
            seen && (0..2).all(|i| tap.camera[i] < cameras[i]) && (0.0..=1.0).contains(&tap.weight)
        });
        let mean: DVec2 =
            taps.iter().map(|t| f64::from(t.weight) * Vec2::from(t.camera.map(|c| c as f32)).as_dvec2()).sum();
        let place = DVec2::new(held(coord.st.x, cameras[0]), held(coord.st.y, cameras[1]));
        // Cameras by their numbers: an error of the sum counts so many times.
        let near = (mean - place).abs().cmple(3.0 * U * (place + 1.0)).all();
        tally.rule(there && near);
        let sum: f64 = taps.iter().map(|tap| f64::from(tap.weight)).sum();
        tally.ratio(sum - 1.0, f64::from(f32::EPSILON));
    }
    tally.row("camera weights: sum against 1", "ulp", [1.0, 1.0])
}

/// From one index to the next number, across a camera or not, the blend of any values of the cameras moves by what the weights' slope
/// makes of the step, and rounding: there is no jump. κ is the index.
#[must_use]
pub fn continuity() -> Row {
    let (mut draws, mut tally) = (Draws::new(31), Tally::default());
    for _ in 0..DRAWS {
        let slab = slab(&mut draws);
        let last = slab.st().map(|axis| axis.last_index());
        let camera = Vec2::new(draws.below(last[0] as usize + 1) as f32, draws.between(0.0, f64::from(last[1])) as f32);
        // Values of −1 and 1 are the worst that weights can blend.
        let value = |c: [u32; 2]| if (c[0].wrapping_mul(7) ^ c[1].wrapping_mul(13)) & 1 == 0 { 1.0 } else { -1.0 };
        let blend = |s: f32| -> f64 {
            let taps = slab.taps(&SlabCoord { st: Vec2::new(s, camera.y), uv: Vec2::ZERO });
            taps.iter().map(|tap| f64::from(tap.weight) * value(tap.camera)).sum()
        };
        let (below, above) = (camera.x.next_down(), camera.x.next_up());
        let step = f64::from(above) - f64::from(below);
        let jump = (blend(above) - blend(camera.x)).abs().max((blend(camera.x) - blend(below)).abs());
        tally.rule(jump <= 2.0 * step + 4.0 * U);
        tally.ratio(jump, (1.0 + f64::from(camera.x)) * U);
    }
    tally.row("camera weights: jump from one camera to the next", "κ·u", [8.0, 8.0])
}

/// Disparities up to ±10⁴ texels a camera, 1×1 to 4096×4096 cameras, images of 1 to 4096 texels. The number is the error in pixels of
/// where a camera is asked, against 0.01.
#[must_use]
pub fn reprojection() -> Row {
    let (mut draws, mut tally) = (Draws::new(32), Tally::default());
    for _ in 0..DRAWS {
        let slab = slab(&mut draws);
        let coord = coord(&mut draws, &slab);
        let disparity = Vec2::new(draws.number(1e-6, 1e4), draws.number(1e-6, 1e4));
        let taps = slab.taps_with(&coord, disparity);
        let (cameras, texels) = (slab.cameras(), slab.resolution());
        tally.rule(taps.iter().all(|tap| tap.uv.is_finite()));
        for (tap, i) in taps.iter().flat_map(|tap| [(tap, 0), (tap, 1)]) {
            let offset = held(coord.st[i], cameras[i]) - f64::from(tap.camera[i]);
            let exact = f64::from(coord.uv[i]) + f64::from(disparity[i]) * offset;
            let exact = if exact.is_nan() { 0.0 } else { exact.clamp(0.0, f64::from(texels[i] - 1)) };
            tally.ratio(f64::from(tap.uv[i]) - exact, 0.01);
        }
    }
    tally.row("disparity: where cameras are asked", "0.01 px", [1.0, 1.0])
}

/// The disparity of a focal plane, from steps and depths of 1e-15 to 1e15. κ is 1: nothing is subtracted.
#[must_use]
pub fn disparity() -> Row {
    let (mut draws, mut tally) = (Draws::new(33), Tally::default());
    for _ in 0..DRAWS {
        let count = COUNTS[draws.below(COUNTS.len())];
        let size = draws.log(1e-15, 1e15) as f32;
        let st = SampledAxis::spanning(-size, size, count).expect("an axis");
        let uv = SampledAxis::spanning(-1.0, 1.0, COUNTS[draws.below(COUNTS.len())]).expect("an axis");
        let depth = (f64::from(size) * draws.log(1e-10, 1e10)) as f32;
        let slab = Slab::new(Face::PosX, 0.0, [st, st], [uv, uv], Some(depth)).expect("a slab");
        let exact = f64::from(st.step()) / f64::from(depth) / f64::from(uv.step());
        tally.rule(slab.disparity().is_finite());
        tally.ratio(f64::from(slab.disparity().x) - exact, exact * U);
        let inverse = (1.0 / f64::from(depth)) as f32;
        let exact = f64::from(st.step()) * f64::from(inverse) / f64::from(uv.step());
        tally.ratio(f64::from(slab.disparity_at(inverse).y) - exact, exact * U);
    }
    tally.row("disparity of a focal plane", "κ·u", [3.0, 3.0])
}

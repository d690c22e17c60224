//! Holds a sampler against its density.

use std::f64::consts::TAU;

use glam::Vec3;

/// Bins in height and around.
const BINS: (usize, usize) = (40, 40);
/// Points of the density a bin, along each side.
const STEPS: usize = 32;
const COUNT: u32 = 200_000;

/// Asserts that `sample`, which may fail to give a unit vector, picks directions as densely as `pdf` says, which is 0 or an
/// integral below 1 if it fails at times: Pearson's test over bins of equal solid angle. Returns the integral.
pub(crate) fn assert_picks(what: &str, mut sample: impl FnMut() -> Option<Vec3>, pdf: impl Fn(Vec3) -> f32) -> f64 {
    let mut counts = vec![0u32; BINS.0 * BINS.1];
    for direction in (0..COUNT).filter_map(|_| sample()) {
        let share = f64::from(direction.z.atan2(direction.x)) / TAU + 0.5;
        let height = 0.5 * (f64::from(direction.y) + 1.0);
        let bin = |share: f64, bins: usize| ((share * bins as f64) as usize).min(bins - 1);
        counts[bin(height, BINS.0) * BINS.1 + bin(share, BINS.1)] += 1;
    }
    let expected: Vec<_> = (0..counts.len()).map(|bin| bin_integral(bin / BINS.1, bin % BINS.1, &pdf)).collect();
    let total: f64 = expected.iter().sum();
    let all = [expected, vec![(1.0 - total).max(0.0)]].concat();
    counts.push(COUNT - counts.iter().sum::<u32>());
    let (mut chi2, mut freedom, mut rare) = (0.0, -1.0, (0.0, 0.0));
    for (expected, count) in all.iter().map(|p| p * f64::from(COUNT)).zip(counts).map(|(e, n)| (e, f64::from(n))) {
        if expected < 10.0 {
            rare = (rare.0 + expected, rare.1 + count);
            continue;
        }
        chi2 += (count - expected).powi(2) / expected;
        freedom += 1.0;
    }
    assert!((rare.1 - rare.0).abs() < 6.0 * rare.0.sqrt() + 12.0, "{what}: {rare:?} in rare bins");
    assert!(
        chi2 < freedom + 5.0 * (2.0f64 * freedom).sqrt() + 10.0,
        "{what}: chi² {chi2} of {freedom} degrees of freedom"
    );
    total
}

/// The integral of a density over a bin, by midpoints.
fn bin_integral(row: usize, column: usize, pdf: &impl Fn(Vec3) -> f32) -> f64 {
    let mut sum = 0.0;
    for (i, j) in (0..STEPS * STEPS).map(|k| (k / STEPS, k % STEPS)) {
        let at = |bin: usize, step: usize, bins: usize| (bin as f64 + (step as f64 + 0.5) / STEPS as f64) / bins as f64;
        let (y, angle) = (2.0 * at(row, i, BINS.0) - 1.0, TAU * (at(column, j, BINS.1) - 0.5));
        let radius = (1.0 - y * y).sqrt();
        sum += f64::from(pdf(Vec3::new((radius * angle.cos()) as f32, y as f32, (radius * angle.sin()) as f32)));
    }
    sum * 2.0 * TAU / (BINS.0 * BINS.1 * STEPS * STEPS) as f64
}

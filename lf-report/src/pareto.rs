//! Which of several compromises between cost and quality are worth choosing.

/// Indices of the points that no other point beats, by ascending cost.
///
/// A point is (cost, quality): lower cost and higher quality are better. It is beaten by a point that is at least as
/// good in both and better in one; equal points do not beat each other. Points with a NaN are never on the front.
/// Takes O(n log n).
///
/// ```
/// let points = [(1.0, 20.0), (2.0, 30.0), (3.0, 25.0)];
/// assert_eq!(lf_report::pareto_front(&points), [0, 1]); // the third is slower and worse than the second
/// ```
#[must_use]
pub fn pareto_front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).filter(|&i| !points[i].0.is_nan() && !points[i].1.is_nan()).collect();
    // Cheapest first, of equal cost the best first. The sort is stable: equal points keep their order. Adding 0.0
    // makes −0 and +0 the same number to `total_cmp`.
    let key = |i: usize| (points[i].0 + 0.0, points[i].1 + 0.0);
    order.sort_by(|&a, &b| key(a).0.total_cmp(&key(b).0).then(key(b).1.total_cmp(&key(a).1)));

    let mut front: Vec<usize> = Vec::new();
    for i in order {
        let beaten = front.last().is_some_and(|&last| points[last] != points[i] && points[last].1 >= points[i].1);
        if !beaten {
            front.push(i);
        }
    }
    front
}

#[cfg(test)]
mod tests {
    use super::*;

    fn brute_force(points: &[(f64, f64)]) -> Vec<usize> {
        let beats = |a: (f64, f64), b: (f64, f64)| a.0 <= b.0 && a.1 >= b.1 && (a.0 < b.0 || a.1 > b.1);
        (0..points.len()).filter(|&i| !points.iter().any(|&other| beats(other, points[i]))).collect()
    }

    #[test]
    fn equals_brute_force_on_random_points() {
        let mut state = 1u64;
        let mut random = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % below) as f64
        };
        for round in 0..2000u64 {
            // Few distinct values in early rounds, so that ties and equal points are common.
            let (count, values) = (round % 13, 2 + round / 50);
            let points: Vec<(f64, f64)> = (0..count).map(|_| (random(values), random(values))).collect();
            let front = pareto_front(&points);
            assert!(front.is_sorted_by(|&a, &b| points[a].0 <= points[b].0), "{points:?}");
            let mut sorted = front;
            sorted.sort_unstable();
            assert_eq!(sorted, brute_force(&points), "{points:?}");
        }
    }

    #[test]
    fn infinities_take_part_and_nan_does_not() {
        let nan = f64::NAN;
        let points = [(nan, 9.0), (1.0, nan), (2.0, f64::INFINITY), (f64::INFINITY, 3.0), (1.0, 1.0)];
        assert_eq!(pareto_front(&points), [4, 2]);
        assert_eq!(pareto_front(&[(0.0, 1.0), (-0.0, 2.0)]), [1]);
        assert!(pareto_front(&[]).is_empty());
    }
}

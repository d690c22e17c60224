//! Who beats whom in speed and PSNR.

use lf_report::pareto_front;

/// A codec's place on the plot of PSNR over speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Speed in any unit, above zero.
    pub speed: f64,
    /// PSNR in dB.
    pub psnr_db: f64,
}

impl Point {
    /// Faster at no lower PSNR, or better at no lower speed.
    #[must_use]
    pub fn beats(&self, other: &Self) -> bool {
        let (faster, better) = (self.speed > other.speed, self.psnr_db > other.psnr_db);
        faster && self.psnr_db >= other.psnr_db || better && self.speed >= other.speed
    }
}

/// Indices of the points that no other point beats, the fastest first.
#[must_use]
pub fn front(points: &[Point]) -> Vec<usize> {
    let costs: Vec<(f64, f64)> = points.iter().map(|p| (1.0 / p.speed, p.psnr_db)).collect();
    pareto_front(&costs)
}

/// Indices of those of `ours` that beat `peer`.
#[must_use]
pub fn beaten_by(peer: &Point, ours: &[Point]) -> Vec<usize> {
    (0..ours.len()).filter(|&i| ours[i].beats(peer)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn at(speed: f64, psnr_db: f64) -> Point {
        Point { speed, psnr_db }
    }

    #[test]
    fn the_front_is_what_nothing_beats() {
        let points = [at(1.0, 35.0), at(3.7, 31.0), at(0.1, 34.0), at(0.03, 35.6), at(1.0, 34.9)];
        assert_eq!(front(&points), [1, 0, 3]);
        for (i, point) in points.iter().enumerate() {
            let beaten = points.iter().any(|other| other.beats(point));
            assert_eq!(beaten, !front(&points).contains(&i), "{i}");
        }
    }

    #[test]
    fn beating_needs_more_of_one_and_no_less_of_the_other() {
        let peer = at(1.0, 35.0);
        let ours = [at(1.0, 35.0), at(1.1, 35.0), at(1.0, 35.1), at(0.9, 36.0), at(2.0, 34.9)];
        assert_eq!(beaten_by(&peer, &ours), [1, 2]);
    }
}

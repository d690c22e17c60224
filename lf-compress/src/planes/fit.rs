//! Two planes for the values of a block.

use half::f16;

use super::{BLOCK_EDGE, BLOCK_TEXELS, MIDDLE, Plane, PlaneBlock};

/// One plane is enough if no texel is further from it than this share of its value: the rounding of half floats.
const EXACT: f32 = 1.0 / 2048.0;
/// How often texels are given to the nearer plane and the planes fitted again. Most splits come to rest after three.
const ROUNDS: usize = 6;

/// The values of a block; at the image's edge some columns and rows are missing.
struct Values {
    size: [usize; 2],
    values: [f32; BLOCK_TEXELS],
}

/// The block that comes nearest to the values, of those found from a few first guesses: the sum of squares counts, as an error in inverse
/// depth moves a texel by as much whatever its depth.
pub(super) fn fit_block([width, height]: [usize; 2], value: impl Fn(usize, usize) -> f32) -> PlaneBlock {
    let mut values = Values { size: [width, height], values: [0.0; BLOCK_TEXELS] };
    for (x, y) in values.places() {
        values.values[BLOCK_EDGE * y + x] = value(x, y);
    }
    let one = values.plane(|_, _| true);
    let single = PlaneBlock { planes: [one, one], mask: 0 };
    if values.places().all(|(x, y)| (values.at(x, y) - one.at(x, y)).abs() <= EXACT * values.at(x, y)) {
        return single;
    }
    let gap = values.widest_gap();
    let guesses = [
        values.mask(|x, y| values.at(x, y) > gap),
        values.mask(|x, y| values.at(x, y) > one.at(x, y)),
        values.mask(|x, _| 2 * x >= width),
        values.mask(|_, y| 2 * y >= height),
    ];
    let found = guesses.map(|mask| values.settle(mask));
    let better = |best: (f64, PlaneBlock), block: PlaneBlock| {
        let error = values.error(&block);
        if error < best.0 { (error, block) } else { best }
    };
    found.into_iter().fold((values.error(&single), single), better).1
}

impl Values {
    fn places(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let [width, height] = self.size;
        (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }

    fn at(&self, x: usize, y: usize) -> f32 {
        self.values[BLOCK_EDGE * y + x]
    }

    fn mask(&self, second: impl Fn(usize, usize) -> bool) -> u64 {
        self.places().filter(|&(x, y)| second(x, y)).fold(0, |mask, (x, y)| mask | 1 << (BLOCK_EDGE * y + x))
    }

    fn error(&self, block: &PlaneBlock) -> f64 {
        self.places().map(|(x, y)| f64::from(self.at(x, y) - block.get(x, y)).powi(2)).sum()
    }

    /// The middle of the widest gap between values: where near and far part.
    fn widest_gap(&self) -> f32 {
        let mut sorted: Vec<f32> = self.places().map(|(x, y)| self.at(x, y)).collect();
        sorted.sort_by(f32::total_cmp);
        let widest = sorted.windows(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
        widest.map_or(0.0, |pair| 0.5 * (pair[0] + pair[1]))
    }

    /// Fits both planes and gives each texel to the nearer one, in turns.
    fn settle(&self, mut mask: u64) -> PlaneBlock {
        let mut block = PlaneBlock::default();
        for _ in 0..ROUNDS {
            let holds = |second: bool| move |x: usize, y: usize| (mask >> (BLOCK_EDGE * y + x) & 1 == 1) == second;
            let planes = [self.plane(holds(false)), self.plane(holds(true))];
            let off = |i: usize, x: usize, y: usize| (self.at(x, y) - planes[i].at(x, y).max(0.0)).abs();
            let next = self.mask(|x, y| off(1, x, y) < off(0, x, y));
            block = PlaneBlock { planes, mask: next };
            if next == mask {
                break;
            }
            mask = next;
        }
        block
    }

    /// The least-squares plane through some of the texels, by the 3×3 normal equations in `f64`, solved by Cramer's rule. Texels in one
    /// row say nothing across it: a little weight on flatness decides. Without texels it is 0.
    fn plane(&self, chosen: impl Fn(usize, usize) -> bool) -> Plane {
        let (mut n, mut sx, mut sy, mut sxx, mut sxy, mut syy) = (0.0, 0.0, 0.0, FLATNESS, 0.0, FLATNESS);
        let (mut sv, mut sxv, mut syv) = (0.0, 0.0, 0.0);
        for (x, y) in self.places().filter(|&(x, y)| chosen(x, y)) {
            let (v, x, y) = (f64::from(self.at(x, y)), x as f64 - f64::from(MIDDLE), y as f64 - f64::from(MIDDLE));
            n += 1.0;
            sx += x;
            sy += y;
            sxx += x * x;
            sxy += x * y;
            syy += y * y;
            sv += v;
            sxv += x * v;
            syv += y * v;
        }
        if n == 0.0 {
            return Plane::default();
        }
        // Around the mean, so that two equations are left.
        let (mx, my, mv) = (sx / n, sy / n, sv / n);
        let (cxx, cxy, cyy) = (sxx - n * mx * mx, sxy - n * mx * my, syy - n * my * my);
        let (cxv, cyv) = (sxv - n * mx * mv, syv - n * my * mv);
        let determinant = cxx * cyy - cxy * cxy;
        let (dx, dy) = ((cxv * cyy - cyv * cxy) / determinant, (cyv * cxx - cxv * cxy) / determinant);
        // What rounding takes from the slopes, the middle gives back at the texels' mean.
        let [dx, dy] = [dx, dy].map(f16::from_f64);
        let middle = mv - mx * f64::from(dx) - my * f64::from(dy);
        Plane([f16::from_f64(middle), dx, dy])
    }
}

/// Weight of flatness against that of one texel a step away: far below rounding, far above that of the equations.
const FLATNESS: f64 = 1e-6;

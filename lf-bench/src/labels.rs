//! Placing the names of points so that they can be read.
//!
//! Greedy: each name takes, of a few positions around its point at growing distance, the one that covers least.

/// An axis-aligned rectangle in pixels, y downwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rect {
    pub(crate) left: i32,
    pub(crate) top: i32,
    pub(crate) right: i32,
    pub(crate) bottom: i32,
}

impl Rect {
    /// The square around a point.
    pub(crate) fn around((x, y): (i32, i32), radius: i32) -> Self {
        Self { left: x - radius, top: y - radius, right: x + radius, bottom: y + radius }
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.left <= other.right && other.left <= self.right && self.top <= other.bottom && other.top <= self.bottom
    }

    fn holds(&self, inner: &Self) -> bool {
        self.left <= inner.left && self.top <= inner.top && inner.right <= self.right && inner.bottom <= self.bottom
    }

    pub(crate) fn center(&self) -> (i32, i32) {
        ((self.left + self.right) / 2, (self.top + self.bottom) / 2)
    }
}

/// Distances from point to text in pixels; from the second on a line leads from one to the other.
const DISTANCES: [i32; 9] = [8, 18, 30, 44, 60, 80, 105, 135, 170];
/// Directions from point to text, the most readable first.
const DIRECTIONS: [(i32, i32); 8] = [(1, 0), (-1, 0), (0, -1), (0, 1), (1, -1), (1, 1), (-1, -1), (-1, 1)];
/// What covering another name costs, in steps of distance: unreadable, so more than any distance.
const OVER_TEXT: usize = 1000;
/// What covering a point costs.
const OVER_POINT: usize = 100;

/// A name to be placed, in pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Name {
    /// The point it belongs to.
    pub(crate) point: (i32, i32),
    /// Width and height of its text.
    pub(crate) size: (i32, i32),
}

/// Where a name goes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placed {
    pub(crate) text: Rect,
    /// Whether a line should lead to it.
    pub(crate) is_far: bool,
}

/// Places each name inside `area`, away from `points` and from each other.
pub(crate) fn place(names: &[Name], points: &[(i32, i32)], area: Rect) -> Vec<Placed> {
    let points: Vec<Rect> = points.iter().map(|&point| Rect::around(point, 4)).collect();
    let mut placed: Vec<Placed> = Vec::with_capacity(names.len());
    for &Name { point, size } in names {
        let cost = |candidate: &Placed| {
            let texts = placed.iter().filter(|other| other.text.overlaps(&candidate.text)).count();
            let covered = points.iter().filter(|other| other.overlaps(&candidate.text)).count();
            OVER_TEXT * texts + OVER_POINT * covered
        };
        let inside = candidates(point, size).filter(|candidate| area.holds(&candidate.text));
        // Of equal cost the first, which is the nearest.
        let best = inside.enumerate().min_by_key(|(step, candidate)| cost(candidate) + step);
        let beside = Rect { left: point.0, top: point.1, right: point.0 + size.0, bottom: point.1 + size.1 };
        placed.push(best.map_or(Placed { text: beside, is_far: false }, |(_, candidate)| candidate));
    }
    placed
}

fn candidates((x, y): (i32, i32), (width, height): (i32, i32)) -> impl Iterator<Item = Placed> {
    DISTANCES.into_iter().enumerate().flat_map(move |(step, distance)| {
        DIRECTIONS.into_iter().map(move |(dx, dy)| {
            let reach = if dx != 0 && dy != 0 { distance * 7 / 10 } else { distance };
            let left = x + dx * reach + (dx - 1) * width / 2;
            let top = y + dy * reach + (dy - 1) * height / 2;
            Placed { text: Rect { left, top, right: left + width, bottom: top + height }, is_far: step > 0 }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Rect = Rect { left: 0, top: 0, right: 600, bottom: 400 };

    #[test]
    fn a_lone_name_stands_right_of_its_point() {
        let placed = place(&[Name { point: (300, 200), size: (50, 14) }], &[(300, 200)], AREA);
        assert_eq!(placed[0].text, Rect { left: 308, top: 193, right: 358, bottom: 207 });
        assert!(!placed[0].is_far);
    }

    #[test]
    fn crowded_names_do_not_cover_each_other_or_points() {
        let points: Vec<(i32, i32)> = (0..8).map(|i| (290 + 3 * i, 200 - 2 * i)).collect();
        let names: Vec<Name> = points.iter().map(|&point| Name { point, size: (110, 14) }).collect();
        let placed = place(&names, &points, AREA);
        for (i, name) in placed.iter().enumerate() {
            assert!(AREA.holds(&name.text));
            assert!(!placed[..i].iter().any(|other| other.text.overlaps(&name.text)), "{name:?}");
            assert!(!points.iter().any(|&p| Rect::around(p, 4).overlaps(&name.text)), "{name:?}");
        }
    }
}

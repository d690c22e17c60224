//! Placing text beside the points of a plot so that it neither overlaps nor is cut off.
//!
//! Greedy: each label in turn takes the cheapest of a fixed list of positions around its point, further away at each
//! step, given all markers, lines and the labels before it. Optimal placement is NP-hard (Formann & Wagner 1991); for
//! the tens of points of a report this is good enough and does not depend on anything but the input.

/// An axis-aligned rectangle in pixels, y downwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rect {
    /// Least x.
    pub left: i32,
    /// Least y.
    pub top: i32,
    /// Greatest x.
    pub right: i32,
    /// Greatest y.
    pub bottom: i32,
}

impl Rect {
    /// The square around a point.
    #[must_use]
    pub fn around((x, y): (i32, i32), radius: i32) -> Self {
        Self { left: x - radius, top: y - radius, right: x + radius, bottom: y + radius }
    }

    /// The rectangle that two points span.
    #[must_use]
    pub fn spanned(a: (i32, i32), b: (i32, i32)) -> Self {
        Self { left: a.0.min(b.0), top: a.1.min(b.1), right: a.0.max(b.0), bottom: a.1.max(b.1) }
    }

    /// Whether they share a point.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.left <= other.right && other.left <= self.right && self.top <= other.bottom && other.top <= self.bottom
    }

    fn holds(&self, inner: &Self) -> bool {
        self.left <= inner.left && self.top <= inner.top && inner.right <= self.right && inner.bottom <= self.bottom
    }

    /// Centre, where the text is anchored.
    #[must_use]
    pub fn center(&self) -> (i32, i32) {
        ((self.left + self.right) / 2, (self.top + self.bottom) / 2)
    }
}

/// Distances from point to text in pixels. Beyond the first a leader line is drawn.
const DISTANCES: [i32; 7] = [9, 20, 34, 50, 70, 95, 125];

/// What one position costs, by what the text would cover. Text on text is unreadable, text on a marker hides data,
/// text across a thin line is merely untidy but worth one step further away.
const OVER_LABEL: i32 = 1000;
const OVER_MARKER: i32 = 300;
const OVER_LINE: i32 = 15;

/// The labels placed so far and what else is in the way.
#[derive(Debug)]
pub struct LabelPlacer {
    area: Rect,
    markers: Vec<Rect>,
    lines: Vec<Rect>,
    labels: Vec<Rect>,
}

/// Where a label goes.
#[derive(Debug, Clone, Copy)]
pub struct Placed {
    /// The box of the text, inside the area.
    pub text: Rect,
    /// End of the leader line on the box, if the text is not right beside its point.
    pub leader: Option<(i32, i32)>,
}

impl LabelPlacer {
    /// Labels are kept inside `area` and away from `markers` and (less so) `lines`.
    #[must_use]
    pub fn new(area: Rect, markers: Vec<Rect>, lines: Vec<Rect>) -> Self {
        Self { area, markers, lines, labels: Vec::new() }
    }

    /// Places a text of `size` (width, height) beside `point`; the size must fit into the area.
    pub fn place(&mut self, point: (i32, i32), size: (i32, i32)) -> Placed {
        let candidates = DISTANCES.iter().enumerate().flat_map(|(step, &distance)| {
            around(point, size, distance).into_iter().enumerate().map(move |(side, text)| {
                let leader = (step > 0).then(|| nearest(text, point));
                (Placed { text, leader }, step as i32 * 8 + side as i32)
            })
        });
        let inside = candidates.filter(|(placed, _)| self.area.holds(&placed.text));
        let best = inside.min_by_key(|(placed, detour)| detour + self.cover_cost(placed, point));
        let placed = best.map_or_else(|| self.pushed_inside(point, size), |(placed, _)| placed);
        self.labels.push(placed.text);
        placed
    }

    fn cover_cost(&self, placed: &Placed, point: (i32, i32)) -> i32 {
        let count = |rects: &[Rect], text: &Rect| rects.iter().filter(|r| r.overlaps(text)).count() as i32;
        let text = &placed.text;
        let mut cost = OVER_LABEL * count(&self.labels, text)
            + OVER_MARKER * count(&self.markers, text)
            + OVER_LINE * count(&self.lines, text);
        if let Some(end) = placed.leader {
            // Samples of the leader; its own marker (the first sample) does not count.
            for step in 1..=4 {
                let along = |from: i32, to: i32| from + (to - from) * step / 5;
                let sample = Rect::around((along(point.0, end.0), along(point.1, end.1)), 1);
                cost += OVER_LABEL / 4 * count(&self.labels, &sample);
            }
        }
        cost
    }

    /// For a point so near a corner that no candidate fits: the first candidate, moved inside.
    fn pushed_inside(&self, (x, y): (i32, i32), (width, height): (i32, i32)) -> Placed {
        let left = (x + DISTANCES[0]).min(self.area.right - width).max(self.area.left);
        let top = (y - height / 2).min(self.area.bottom - height).max(self.area.top);
        Placed { text: Rect { left, top, right: left + width, bottom: top + height }, leader: None }
    }
}

/// The boxes right of, left of, above and below a point, then on its diagonals.
fn around((x, y): (i32, i32), (width, height): (i32, i32), distance: i32) -> [Rect; 8] {
    let diagonal = distance * 7 / 10;
    let at = |left: i32, top: i32| Rect { left, top, right: left + width, bottom: top + height };
    let (middle_x, middle_y) = (x - width / 2, y - height / 2);
    [
        at(x + distance, middle_y),
        at(x - distance - width, middle_y),
        at(middle_x, y - distance - height),
        at(middle_x, y + distance),
        at(x + diagonal, y - diagonal - height),
        at(x + diagonal, y + diagonal),
        at(x - diagonal - width, y - diagonal - height),
        at(x - diagonal - width, y + diagonal),
    ]
}

/// The point of the box nearest to `point`.
fn nearest(text: Rect, (x, y): (i32, i32)) -> (i32, i32) {
    (x.clamp(text.left, text.right), y.clamp(text.top, text.bottom))
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Rect = Rect { left: 0, top: 0, right: 600, bottom: 400 };

    #[test]
    fn crowded_labels_do_not_overlap() {
        let points: Vec<(i32, i32)> = (0..8).map(|i| (290 + i * 3, 200 - i * 2)).collect();
        let markers: Vec<Rect> = points.iter().map(|&p| Rect::around(p, 5)).collect();
        let mut placer = LabelPlacer::new(AREA, markers.clone(), Vec::new());
        let placed: Vec<Rect> = points.iter().map(|&p| placer.place(p, (110, 14)).text).collect();
        for (i, a) in placed.iter().enumerate() {
            assert!(AREA.holds(a), "{a:?}");
            assert!(!markers.iter().any(|m| m.overlaps(a)), "{a:?}");
            assert!(!placed[..i].iter().any(|b| b.overlaps(a)), "{a:?}");
        }
    }

    #[test]
    fn labels_at_the_corners_stay_inside() {
        for point in [(0, 0), (600, 0), (0, 400), (600, 400)] {
            let mut placer = LabelPlacer::new(AREA, vec![Rect::around(point, 5)], Vec::new());
            for size in [(100, 14), (600, 14), (100, 400)] {
                assert!(AREA.holds(&placer.place(point, size).text));
            }
        }
    }

    #[test]
    fn a_free_point_has_its_label_at_the_right_without_leader() {
        let placed = LabelPlacer::new(AREA, vec![Rect::around((300, 200), 5)], Vec::new()).place((300, 200), (50, 14));
        assert_eq!(placed.text, Rect { left: 309, top: 193, right: 359, bottom: 207 });
        assert!(placed.leader.is_none());
    }

    #[test]
    fn a_line_is_avoided_where_that_is_cheap() {
        let line = Rect::spanned((305, 200), (600, 200));
        let placed = LabelPlacer::new(AREA, Vec::new(), vec![line]).place((300, 200), (50, 14));
        assert!(!placed.text.overlaps(&line));
    }
}

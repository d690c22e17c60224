//! What stands for texels that are not traced.

/// For each texel of an image of some width the place of the traced texel that it repeats; its own if it is traced.
///
/// In a row the last one before, or the first if there is none; a row without any repeats the last row that has some, or
/// the first. Edges thus go on straight, which costs few bits and leaves the blocks at the border of what is needed the
/// colours that they need. Place 0 if nothing is traced.
pub(crate) fn sources(traced: &[bool], width: usize) -> Vec<usize> {
    if width == 0 {
        return Vec::new();
    }
    let rows: Vec<&[bool]> = traced.chunks(width).collect();
    let row_sources = held(rows.iter().map(|row| row.contains(&true)));
    let row = |y: usize| held(rows[y].iter().copied()).into_iter().map(move |x| y * width + x);
    row_sources.into_iter().flat_map(row).collect()
}

/// For each place the last one up to it that counts, or the first that does; 0 if none does.
fn held(counts: impl Iterator<Item = bool>) -> Vec<usize> {
    let counts: Vec<bool> = counts.collect();
    let mut last = counts.iter().position(|&counts| counts).unwrap_or(0);
    let step = |(place, counts): (usize, &bool)| {
        last = if *counts { place } else { last };
        last
    };
    counts.iter().enumerate().map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn traced_texels_stay_and_others_repeat_one() {
        let traced: Vec<bool> = ["....", ".#.#", "....", "#..."].concat().chars().map(|c| c == '#').collect();
        let expected = [5, 5, 5, 7, 5, 5, 5, 7, 5, 5, 5, 7, 12, 12, 12, 12];
        assert_eq!(sources(&traced, 4), expected);
        assert!(expected.iter().all(|&source| traced[source]));
        assert!((0..16).filter(|&i| traced[i]).all(|i| expected[i] == i));
    }

    #[test]
    fn nothing_traced_and_nothing_at_all() {
        assert_eq!(sources(&[false; 6], 3), [0; 6]);
        assert!(sources(&[], 0).is_empty());
    }
}

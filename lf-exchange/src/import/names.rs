//! Rows, columns and positions in the names of picture files.

/// What a name such as `out_03_14_-381.909271_1103.376221` says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ViewName<'a> {
    /// What comes before the row.
    pub(crate) series: &'a str,
    pub(crate) row: u32,
    pub(crate) column: u32,
    /// Coordinates downwards and to the right, in the file's unit.
    pub(crate) position: Option<[f64; 2]>,
    /// Focal length and width of the sensor, millimetres, which some renderers append.
    pub(crate) lens: Option<[f64; 2]>,
}

/// Reads the stem of a file name: `…RR_CC`, which may be followed by `_Y_X`, these by `_F_S`, and then by anything.
///
/// Row and column are the first two plain integers with a position behind them, or else the last two in the name.
/// A position is two numbers of which one at least has a point or a sign.
pub(crate) fn parse(stem: &str) -> Option<ViewName<'_>> {
    let parts: Vec<&str> = stem.split('_').collect();
    let pair = |at: usize| Some([index(parts.get(at)?)?, index(parts.get(at + 1)?)?]);
    let place = |at: usize| {
        let texts = [*parts.get(at)?, *parts.get(at + 1)?];
        let marked = texts.iter().any(|text| text.contains(['.', '-', '+']));
        marked.then_some([number(texts[0])?, number(texts[1])?])
    };
    let pairs = || (0..parts.len()).filter(|&at| pair(at).is_some());
    let at = pairs().find(|&at| place(at + 2).is_some()).or_else(|| pairs().next_back())?;
    let [row, column] = pair(at)?;
    let lens = || Some([number(parts.get(at + 4)?)?, number(parts.get(at + 5)?)?]);
    let position = place(at + 2);
    let series_len = parts.iter().take(at).map(|part| part.len() + 1).sum::<usize>().saturating_sub(1);
    Some(ViewName {
        series: stem.get(..series_len)?,
        row,
        column,
        position,
        lens: position.and_then(|_| lens()).filter(|lens| lens.iter().all(|&length| length > 0.0)),
    })
}

/// A plain integer of up to nine digits.
fn index(text: &str) -> Option<u32> {
    let plain = (1..=9).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_digit());
    plain.then(|| text.parse().ok()).flatten()
}

/// A decimal number, not one of the words that `f64` also reads.
fn number(text: &str) -> Option<f64> {
    let decimal = text.bytes().all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte));
    decimal.then(|| text.parse().ok()).flatten().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn names_in_the_wild() {
        let view = |series, row, column, position, lens| Some(ViewName { series, row, column, position, lens });
        let table = [
            ("out_00_16_-780.134705_-3355.331299_", view("out", 0, 16, Some([-780.134705, -3355.331299]), None)),
            ("out_03_14_-381.909271_1103.376221", view("out", 3, 14, Some([-381.909271, 1103.376221]), None)),
            ("out_03_14", view("out", 3, 14, None, None)),
            ("view_09_08", view("view", 9, 8, None, None)),
            ("07_11", view("", 7, 11, None, None)),
            (
                "Original Camera_26_04_-400.000000_276.923077_30_36",
                view("Original Camera", 26, 4, Some([-400.0, 276.923077]), Some([30.0, 36.0])),
            ),
            ("2024_05_scene_1_2_-3_4", view("2024_05_scene", 1, 2, Some([-3.0, 4.0]), None)),
            ("2024_05_scene_1_2", view("2024_05_scene", 1, 2, None, None)),
            ("out_00", None),
            ("", None),
            ("a_1_b_2", None),
            ("out_-1_3", None),
            ("out_1_2_inf_nan", view("out", 1, 2, None, None)),
            ("out_9999999999_1", None),
        ];
        for (stem, expected) in table {
            assert_eq!(parse(stem), expected, "{stem}");
        }
    }

    proptest! {
        #[test]
        fn any_name_is_read_or_left(stem in "[_0-9.eä\\-]{0,40}") {
            if let Some(view) = parse(&stem) {
                prop_assert!(stem.starts_with(view.series));
                prop_assert!(view.position.is_none_or(|p| p.iter().all(|x| x.is_finite())));
            }
        }
    }
}

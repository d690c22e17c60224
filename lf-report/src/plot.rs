//! The plot of error against run time, drawn with plotters' SVG backend.

use plotters::coord::Shift;
use plotters::coord::combinators::{BindKeyPoints, IntoLogRange};
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::error::ReportError;
use crate::labels::{LabelPlacer, Rect};
use crate::pareto::pareto_front;
use crate::result::MethodResult;
use crate::units;

/// Size of the drawing in pixels.
const SIZE: (u32, u32) = (960, 560);
/// Colours by role. The style sheet of the HTML page replaces exactly these values in dark mode.
const PAPER: RGBColor = RGBColor(0xFF, 0xFF, 0xFF);
const INK: RGBColor = RGBColor(0x1F, 0x24, 0x30);
const FAINT_INK: RGBColor = RGBColor(0x5C, 0x66, 0x77);
const GRID: RGBColor = RGBColor(0xE3, 0xE7, 0xEE);
const FRONT: RGBColor = RGBColor(0xA3, 0xAD, 0xBD);
/// Colours of the methods, told apart by colour-blind readers too (Okabe & Ito 2008, without black and yellow).
const METHOD_COLORS: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xE6, 0x9F, 0x00),
    RGBColor(0x56, 0xB4, 0xE9),
];
/// Heights of letters in CSS pixels.
const LABEL_PX: f64 = 13.0;
const TITLE_PX: f64 = 19.0;
const MARKER_RADIUS: i32 = 6;
/// Shortest time shown: a logarithmic axis has no 0.
const SHORTEST_MS: f64 = 1e-6;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// One result as drawn, in pixels.
struct Mark {
    at: (i32, i32),
    /// The time's first and third quartile on the same height.
    quartiles: ((i32, i32), (i32, i32)),
    color: RGBColor,
    shape: usize,
    label: String,
    /// Without a finite error: drawn at the top edge, with a dashed line downwards.
    at_top: bool,
}

/// Draws PSNR against time per frame: one marker for each result, a Pareto front for each reflector.
pub(crate) fn error_time_svg(results: &[MethodResult]) -> Result<String, ReportError> {
    let mut svg = String::new();
    draw(results, &mut svg).map_err(|error| ReportError::Plot(error.to_string()))?;
    Ok(svg)
}

fn draw(results: &[MethodResult], svg: &mut String) -> Drawn {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&PAPER)?;
    draw_title(&root)?;

    let (ms, db) = (time_range(results), psnr_range(results));
    let x_axis = (ms.0..ms.1).log_scale().with_key_points(decade_ticks(ms));
    let mut chart = ChartBuilder::on(&root)
        .margin_top(62)
        .margin_right(24)
        .margin_bottom(10)
        .margin_left(10)
        .x_label_area_size(52)
        .y_label_area_size(60)
        .build_cartesian_2d(x_axis, db.0..db.1)?;
    let small = font(LABEL_PX).color(&INK);
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(FAINT_INK)
        .label_style(small.clone())
        .axis_desc_style(small)
        .x_desc("median time per frame, ms (logarithmic)")
        .y_desc("PSNR, dB (mean of the eyes)")
        .x_label_formatter(&|value| tick_label(*value))
        .y_label_formatter(&|value| format!("{value:.0}"))
        .draw()?;

    let (columns, rows) = chart.plotting_area().get_pixel_range();
    let area = Rect { left: columns.start, top: rows.start, right: columns.end, bottom: rows.end };
    let pixel = |ms: f64, psnr: f64| chart.backend_coord(&(ms.max(SHORTEST_MS), psnr));
    let marks = marks(results, &area, pixel);
    let fronts = front_lines(results, &marks, &area);
    for line in &fronts {
        root.draw(&PathElement::new(line.clone(), FRONT.stroke_width(2)))?;
    }
    draw_labels(&root, &marks, &fronts, area)?;
    for mark in &marks {
        draw_mark(&root, mark, &area)?;
    }
    root.present()?;
    Ok(())
}

fn draw_title(root: &Area<'_>) -> Drawn {
    let subtitle = "Higher and further left is better. Grey lines: Pareto front of each reflector. \
                    Dashed: time of a method without error, such as the reference.";
    let title = font(TITLE_PX).style(FontStyle::Bold).color(&INK);
    root.draw(&Text::new("Error against run time", (24, 12), title))?;
    root.draw(&Text::new(subtitle, (24, 37), font(LABEL_PX).color(&FAINT_INK)))?;
    Ok(())
}

/// A sans-serif font of a height in CSS pixels; plotters divides by 1.24 when it writes SVG.
fn font(px: f64) -> FontDesc<'static> {
    FontDesc::new(FontFamily::SansSerif, px * 1.24, FontStyle::Normal)
}

/// The shortest and the longest time, widened to steps of 1, 2, 5 so that no marker lies on the edge.
fn time_range(results: &[MethodResult]) -> (f64, f64) {
    let ms = || {
        results.iter().flat_map(|r| {
            let (q1, q3) = r.timing.quartiles();
            [q1, r.timing.median(), q3].map(|s| (s * 1e3).max(SHORTEST_MS))
        })
    };
    let Some(shortest) = ms().min_by(f64::total_cmp) else { return (1.0, 10.0) };
    let longest = ms().fold(shortest, f64::max);
    let steps = steps_125(shortest / 10.0, longest * 10.0);
    let low = steps.iter().copied().rfind(|step| *step < shortest / 1.1).unwrap_or(shortest / 2.0);
    let high = steps.iter().copied().find(|step| *step > longest * 1.1).unwrap_or(longest * 2.0);
    (low, high)
}

/// …, 1, 2, 5, 10, 20, 50, … from `low` to `high`, both included up to rounding.
fn steps_125(low: f64, high: f64) -> Vec<f64> {
    let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let steps = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|digit| digit * 10f64.powi(decade)));
    steps.filter(|step| *step >= low * (1.0 - 1e-9) && *step <= high * (1.0 + 1e-9)).collect()
}

/// Ticks at 1, 2, 5 of each decade, at powers of ten only where that would crowd the axis.
fn decade_ticks(range: (f64, f64)) -> Vec<f64> {
    let all = steps_125(range.0, range.1);
    if all.len() <= 13 {
        return all;
    }
    all.into_iter().filter(|step| (step.log10() - step.log10().round()).abs() < 1e-6).collect()
}

/// A tick's value without trailing zeros: 0.05, 2, 500.
fn tick_label(ms: f64) -> String {
    let decimals = (-ms.log10().floor()).max(0.0) as usize;
    format!("{ms:.decimals$}")
}

/// The finite errors' range, with room below for labels and above for the marks at the top edge.
fn psnr_range(results: &[MethodResult]) -> (f64, f64) {
    let finite = || results.iter().filter_map(MethodResult::mean_psnr_db).filter(|psnr| psnr.is_finite());
    let Some(low) = finite().min_by(f64::total_cmp) else { return (0.0, 50.0) };
    let high = finite().fold(low, f64::max);
    let room = 0.15 * (high - low).max(6.0);
    ((low - room).floor(), (high + 2.0 * room).ceil())
}

/// Position, look and label of every result.
fn marks(results: &[MethodResult], area: &Rect, pixel: impl Fn(f64, f64) -> (i32, i32)) -> Vec<Mark> {
    let methods = distinct(results, |r| &r.method);
    let reflectors = distinct(results, |r| &r.reflector);
    let index = |names: &[&str], name: &str| names.iter().position(|n| *n == name).unwrap_or(0);
    let mark = |result: &MethodResult| {
        let psnr = result.mean_psnr_db().filter(|psnr| psnr.is_finite());
        let place = |seconds: f64| {
            let (x, y) = pixel(seconds * 1e3, psnr.unwrap_or(0.0));
            (x, if psnr.is_some() { y } else { area.top + 2 * MARKER_RADIUS })
        };
        let (q1, q3) = result.timing.quartiles();
        Mark {
            at: place(result.timing.median()),
            quartiles: (place(q1), place(q3)),
            color: METHOD_COLORS[index(&methods, &result.method) % METHOD_COLORS.len()],
            shape: index(&reflectors, &result.reflector),
            label: label(results, result, area),
            at_top: psnr.is_none(),
        }
    };
    results.iter().map(mark).collect()
}

/// The different names among the results, in order of appearance.
fn distinct<'a>(results: &'a [MethodResult], name: impl Fn(&'a MethodResult) -> &'a str) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for name in results.iter().map(name) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Method and reflector; device and parameters only where these are needed to tell results apart. Long ones are cut.
fn label(results: &[MethodResult], result: &MethodResult, area: &Rect) -> String {
    let twins = || results.iter().filter(|r| r.method == result.method && r.reflector == result.reflector);
    let mut parts = vec![result.method.as_str(), result.reflector.as_str()];
    if twins().any(|r| r.device != result.device) {
        parts.push(&result.device);
    }
    let same_device = || twins().filter(|r| r.device == result.device);
    if same_device().any(|r| r.parameters != result.parameters) && !result.parameters.is_empty() {
        parts.push(&result.parameters);
    }
    let mut text = parts.join(", ");
    if result.is_reference() {
        text += &format!(": reference, {} ms", units::milliseconds(result.timing.median()));
    } else if result.mean_psnr_db().is_some_and(f64::is_infinite) {
        text += ": no error";
    }
    let room = (f64::from(area.right - area.left) * 0.45 / letter_width()) as usize;
    if text.chars().count() > room {
        text = text.chars().take(room.saturating_sub(1)).chain(['…']).collect();
    }
    text
}

/// Width of an average letter. Fonts differ between readers; this is on the wide side of the common sans-serif ones.
fn letter_width() -> f64 {
    0.58 * LABEL_PX
}

/// For each reflector the staircase over its undominated results, on to the right edge.
fn front_lines(results: &[MethodResult], marks: &[Mark], area: &Rect) -> Vec<Vec<(i32, i32)>> {
    let front_of = |reflector: &str| {
        let drawn: Vec<usize> =
            (0..results.len()).filter(|&i| results[i].reflector == reflector && !marks[i].at_top).collect();
        let points: Vec<(f64, f64)> =
            drawn.iter().map(|&i| (results[i].timing.median(), results[i].mean_psnr_db().unwrap_or(0.0))).collect();
        let mut line: Vec<(i32, i32)> = Vec::new();
        for at in pareto_front(&points).into_iter().map(|i| marks[drawn[i]].at) {
            if let Some(&(_, y)) = line.last() {
                line.push((at.0, y));
            }
            line.push(at);
        }
        if let Some(&(_, y)) = line.last() {
            line.push((area.right, y));
        }
        line
    };
    distinct(results, |r| &r.reflector).into_iter().map(front_of).filter(|line| !line.is_empty()).collect()
}

fn draw_mark(root: &Area<'_>, mark: &Mark, area: &Rect) -> Drawn {
    let Mark { at, color, quartiles: (q1, q3), .. } = mark;
    let line =
        |from: (i32, i32), to: (i32, i32), style: ShapeStyle| root.draw(&PathElement::new(vec![from, to], style));
    if mark.at_top {
        for y in (at.1..area.bottom).step_by(9) {
            line((at.0, y), (at.0, (y + 5).min(area.bottom)), color.stroke_width(1))?;
        }
    }
    line(*q1, *q3, color.stroke_width(2))?;
    for end in [q1, q3] {
        line((end.0, end.1 - 3), (end.0, end.1 + 3), color.stroke_width(2))?;
    }
    let r = MARKER_RADIUS;
    let (x, y) = *at;
    let outline = match mark.shape % 4 {
        0 => return root.draw(&Circle::new(*at, r, color.filled())),
        1 => vec![(x - r, y - r), (x + r, y - r), (x + r, y + r), (x - r, y + r)],
        2 => vec![(x, y - r - 1), (x + r + 1, y + r), (x - r - 1, y + r)],
        _ => vec![(x, y - r - 2), (x + r + 2, y), (x, y + r + 2), (x - r - 2, y)],
    };
    root.draw(&Polygon::new(outline, color.filled()))
}

fn draw_labels(root: &Area<'_>, marks: &[Mark], fronts: &[Vec<(i32, i32)>], area: Rect) -> Drawn {
    let markers = marks.iter().map(|mark| Rect::around(mark.at, MARKER_RADIUS + 1)).collect();
    let whiskers = marks.iter().map(|mark| Rect::spanned(mark.quartiles.0, mark.quartiles.1));
    let dashes = marks.iter().filter(|m| m.at_top).map(|m| Rect::spanned(m.at, (m.at.0, area.bottom)));
    let stairs = fronts.iter().flat_map(|line| line.windows(2).map(|pair| Rect::spanned(pair[0], pair[1])));
    let mut placer = LabelPlacer::new(area, markers, whiskers.chain(dashes).chain(stairs).collect());
    let centered = font(LABEL_PX).color(&INK).pos(Pos::new(HPos::Center, VPos::Center));
    for mark in marks {
        let width = (mark.label.chars().count() as f64 * letter_width()).ceil() as i32;
        let placed = placer.place(mark.at, (width, (LABEL_PX * 1.2) as i32));
        if let Some(end) = placed.leader {
            let leader = PathElement::new(vec![mark.at, end], FAINT_INK.stroke_width(1));
            root.draw(&leader)?;
        }
        let text = Text::new(mark.label.as_str(), placed.text.center(), centered.clone());
        root.draw(&text)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn svg_holds_every_label_and_closes_its_tags() {
        let svg = error_time_svg(&sample::report().results).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for text in ["slabs, teapot", "environment map, sphere", "ray tracing, teapot: reference", "PSNR, dB"] {
            assert!(svg.contains(text), "{text}");
        }
        // Elements either close themselves or are closed: <svg>, <text>.
        let opened = svg.matches('<').count() - svg.matches("</").count() - svg.matches("/>").count();
        assert_eq!(opened, svg.matches("</").count());
    }

    #[test]
    fn odd_results_are_drawn_too() {
        assert!(error_time_svg(&[]).unwrap().starts_with("<svg"));
        let cases = [
            sample::result("a", "instant", &[20.0], 0.0),
            sample::result("a", "exact", &[f64::INFINITY], 1.0),
            sample::result("a", "reference alone", &[], 1e6),
            sample::result("<b>", &"long ".repeat(100), &[-3.0, 99.0], 1e-12),
        ];
        for case in &cases {
            assert!(error_time_svg(std::slice::from_ref(case)).unwrap().starts_with("<svg"), "{}", case.method);
        }
        let svg = error_time_svg(&cases).unwrap();
        assert!(!svg.contains("<b>") && svg.contains("exact, a: no error") && svg.contains('…'));
    }

    #[test]
    fn time_axis_encloses_the_data_in_steps() {
        let at = |ms: f64| sample::result("a", "m", &[30.0], ms * 1e-3);
        assert_eq!(time_range(&[]), (1.0, 10.0));
        assert_eq!(time_range(&[at(3.0), at(400.0)]), (2.0, 500.0));
        assert_eq!(decade_ticks((2.0, 50.0)), [2.0, 5.0, 10.0, 20.0, 50.0]);
        assert_eq!(decade_ticks((1e-3, 1e3)).len(), 7);
        assert_eq!([0.05, 1.0, 500.0].map(tick_label), ["0.05", "1", "500"]);
    }

    #[test]
    fn labels_tell_twins_apart() {
        let area = Rect { left: 0, top: 0, right: 900, bottom: 500 };
        let mut results = vec![sample::result("a", "slabs", &[30.0], 1.0), sample::result("a", "slabs", &[31.0], 2.0)];
        results[1].parameters = "BC1".to_owned();
        assert_eq!(label(&results, &results[1], &area), "slabs, a, BC1");
        results[1].parameters = results[0].parameters.clone();
        results[1].device = "GPU".to_owned();
        assert_eq!(label(&results, &results[1], &area), "slabs, a, GPU");
        assert_eq!(label(&results[..1], &results[0], &area), "slabs, a");
    }
}

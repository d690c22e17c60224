//! The plots of error against run time and against memory, drawn with plotters' SVG backend.

use plotters::coord::Shift;
use plotters::coord::combinators::{BindKeyPoints, IntoLogRange};
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::axis::{Axis, decade_ticks, tick_label};
use crate::error::ReportError;
use crate::labels::{LabelPlacer, Rect};
use crate::pareto::pareto_front;
use crate::result::MethodResult;

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

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// One result as drawn, in pixels.
struct Mark {
    at: (i32, i32),
    /// The first and the third quartile on the same height.
    quartiles: ((i32, i32), (i32, i32)),
    color: RGBColor,
    shape: usize,
    label: String,
    /// Without a finite error: drawn at the top edge, with a dashed line downwards.
    at_top: bool,
}

/// Draws PSNR against time per frame or memory: one marker for each result, a Pareto front for each reflector.
pub(crate) fn error_svg(results: &[MethodResult], axis: Axis) -> Result<String, ReportError> {
    let mut svg = String::new();
    draw(results, axis, &mut svg).map_err(|error| ReportError::Plot(error.to_string()))?;
    Ok(svg)
}

fn draw(results: &[MethodResult], axis: Axis, svg: &mut String) -> Drawn {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&PAPER)?;
    draw_title(&root, axis)?;

    let (range, db) = (axis.range(results), psnr_range(results));
    let x_axis = (range.0..range.1).log_scale().with_key_points(decade_ticks(range));
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
        .x_desc(axis.description())
        .y_desc("PSNR, dB (mean of the eyes)")
        .x_label_formatter(&|value| tick_label(*value))
        .y_label_formatter(&|value| format!("{value:.0}"))
        .draw()?;

    let (columns, rows) = chart.plotting_area().get_pixel_range();
    let area = Rect { left: columns.start, top: rows.start, right: columns.end, bottom: rows.end };
    let marks = marks(results, axis, &area, |x, psnr| chart.backend_coord(&(x, psnr)));
    let fronts = front_lines(results, axis, &marks, &area);
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

fn draw_title(root: &Area<'_>, axis: Axis) -> Drawn {
    let title = font(TITLE_PX).style(FontStyle::Bold).color(&INK);
    root.draw(&Text::new(axis.title(), (24, 12), title))?;
    root.draw(&Text::new(axis.subtitle(), (24, 37), font(LABEL_PX).color(&FAINT_INK)))?;
    Ok(())
}

/// A sans-serif font of a height in CSS pixels; plotters divides by 1.24 when it writes SVG.
fn font(px: f64) -> FontDesc<'static> {
    FontDesc::new(FontFamily::SansSerif, px * 1.24, FontStyle::Normal)
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
fn marks(results: &[MethodResult], axis: Axis, area: &Rect, pixel: impl Fn(f64, f64) -> (i32, i32)) -> Vec<Mark> {
    let methods = distinct(results, |r| &r.method);
    let reflectors = distinct(results, |r| &r.reflector);
    let index = |names: &[&str], name: &str| names.iter().position(|n| *n == name).unwrap_or(0);
    let mark = |result: &MethodResult| {
        let psnr = result.mean_psnr_db().filter(|psnr| psnr.is_finite());
        let place = |value: f64| {
            let (x, y) = pixel(value, psnr.unwrap_or(0.0));
            (x, if psnr.is_some() { y } else { area.top + 2 * MARKER_RADIUS })
        };
        let (q1, q3) = axis.spread(result);
        let method = index(&methods, &result.method);
        Mark {
            at: place(axis.value(result)),
            quartiles: (place(q1), place(q3)),
            color: METHOD_COLORS[method % METHOD_COLORS.len()],
            // Where colours run out, another shape tells methods apart.
            shape: index(&reflectors, &result.reflector) + method / METHOD_COLORS.len(),
            label: label(results, result, axis, area),
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

/// The method; reflector, device and parameters only as far as these are needed to tell results apart. Long ones are cut.
fn label(results: &[MethodResult], result: &MethodResult, axis: Axis, area: &Rect) -> String {
    let twins = || results.iter().filter(|r| r.method == result.method && r.reflector == result.reflector);
    let mut parts = vec![result.method.as_str()];
    if results.iter().any(|r| r.reflector != result.reflector) {
        parts.push(&result.reflector);
    }
    if twins().any(|r| r.device != result.device) {
        parts.push(&result.device);
    }
    let same_device: Vec<&MethodResult> = twins().filter(|r| r.device == result.device).collect();
    parts.extend(telling_parameters(result, &same_device));
    let mut text = parts.join(", ");
    if result.is_reference() {
        text += &format!(": reference, {}", axis.text(result));
    } else if result.mean_psnr_db().is_some_and(f64::is_infinite) {
        text += ": no error";
    }
    let room = (f64::from(area.right - area.left) * 0.45 / letter_width()) as usize;
    if text.chars().count() > room {
        text = text.chars().take(room.saturating_sub(1)).chain(['…']).collect();
    }
    text
}

/// Those of a result's parameters, set apart by commas and semicolons, that not all of its twins have.
fn telling_parameters<'a>(result: &'a MethodResult, twins: &[&MethodResult]) -> Vec<&'a str> {
    fn split(text: &str) -> impl Iterator<Item = &str> {
        text.split([',', ';']).map(str::trim).filter(|part| !part.is_empty())
    }
    let common = |part: &str| twins.iter().all(|twin| split(&twin.parameters).any(|other| other == part));
    split(&result.parameters).filter(|part| !common(part)).collect()
}

/// Width of an average letter. Fonts differ between readers; this is on the wide side of the common sans-serif ones.
fn letter_width() -> f64 {
    0.58 * LABEL_PX
}

/// For each reflector the staircase over its undominated results, on to the right edge.
fn front_lines(results: &[MethodResult], axis: Axis, marks: &[Mark], area: &Rect) -> Vec<Vec<(i32, i32)>> {
    let front_of = |reflector: &str| {
        let drawn: Vec<usize> =
            (0..results.len()).filter(|&i| results[i].reflector == reflector && !marks[i].at_top).collect();
        let points: Vec<(f64, f64)> =
            drawn.iter().map(|&i| (axis.value(&results[i]), results[i].mean_psnr_db().unwrap_or(0.0))).collect();
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
        let svg = error_svg(&sample::report().results, Axis::Time).unwrap();
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
        assert!(error_svg(&[], Axis::Time).unwrap().starts_with("<svg"));
        let cases = [
            sample::result("a", "instant", &[20.0], 0.0),
            sample::result("a", "exact", &[f64::INFINITY], 1.0),
            sample::result("a", "reference alone", &[], 1e6),
            sample::result("<b>", &"long ".repeat(100), &[-3.0, 99.0], 1e-12),
        ];
        for case in &cases {
            for axis in [Axis::Time, Axis::Bytes] {
                let svg = error_svg(std::slice::from_ref(case), axis).unwrap();
                assert!(svg.starts_with("<svg") && svg.contains(axis.title()), "{}", case.method);
            }
        }
        let svg = error_svg(&cases, Axis::Time).unwrap();
        assert!(!svg.contains("<b>") && svg.contains("exact, a: no error") && svg.contains('…'));
    }

    #[test]
    fn labels_tell_twins_apart_and_say_no_more() {
        let area = Rect { left: 0, top: 0, right: 900, bottom: 500 };
        let of = |parameters: &str| MethodResult {
            parameters: parameters.to_owned(),
            ..sample::result("a", "slabs", &[30.0], 1.0)
        };
        let mut results = vec![of("64², BC1; 4 steps"), of("64², BC1; 8 steps")];
        let named = |results: &[MethodResult], i: usize| label(results, &results[i], Axis::Time, &area);
        assert_eq!([named(&results, 0), named(&results, 1)], ["slabs, 4 steps", "slabs, 8 steps"]);
        results[1].device = "GPU".to_owned();
        assert_eq!(named(&results, 1), "slabs, GPU");
        assert_eq!(named(&results[..1], 0), "slabs");
        results[1].reflector = "b".to_owned();
        assert_eq!(named(&results, 1), "slabs, b");
    }
}

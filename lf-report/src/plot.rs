//! The plots of a report, drawn with plotters' SVG backend.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::combinators::{BindKeyPoints, IntoLogRange};
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint};
use plotters::coord::types::RangedCoordf64;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::axis::{Plot, decade_ticks, tick_label};
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

/// A linear axis with ticks of our own: plotters binds those to logarithmic ones only.
struct Heights {
    range: RangedCoordf64,
    ticks: Vec<f64>,
}

impl Ranged for Heights {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.range.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, _hint: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range.range()
    }
}

/// Draws results that share their frames: a marker for each that has a place on this plot, and the Pareto front.
pub(crate) fn svg(results: &[&MethodResult], plot: Plot, heading: &str) -> Result<String, ReportError> {
    let mut shown: Vec<&MethodResult> = vec![];
    for &result in results.iter().filter(|result| plot.shows(result)) {
        if !shown.iter().any(|other| plot.same(other, result)) {
            shown.push(result);
        }
    }
    let mut svg = String::new();
    draw(&shown, plot, heading, &mut svg).map_err(|error| ReportError::Plot(error.to_string()))?;
    Ok(svg)
}

fn draw(results: &[&MethodResult], plot: Plot, heading: &str, svg: &mut String) -> Drawn {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&PAPER)?;
    draw_title(&root, plot, heading)?;

    let (range, heights) = (plot.costs(results), plot.heights(results));
    let x_axis = (range.0..range.1).log_scale().with_key_points(decade_ticks(range));
    let mut chart = ChartBuilder::on(&root)
        .margin_top(62)
        .margin_right(24)
        .margin_bottom(10)
        .margin_left(10)
        .x_label_area_size(52)
        .y_label_area_size(60)
        .build_cartesian_2d(
            x_axis,
            Heights { range: (heights.0..heights.1).into(), ticks: plot.height_ticks(heights) },
        )?;
    let small = font(LABEL_PX).color(&INK);
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(FAINT_INK)
        .label_style(small.clone())
        .axis_desc_style(small)
        .x_desc(plot.horizontal())
        .y_desc(plot.vertical())
        .x_label_formatter(&|value| tick_label(*value))
        .y_label_formatter(&|value| plot.height_label(*value))
        .draw()?;

    let (columns, rows) = chart.plotting_area().get_pixel_range();
    let area = Rect { left: columns.start, top: rows.start, right: columns.end, bottom: rows.end };
    let marks = marks(results, plot, &area, |x, y| chart.backend_coord(&(x, y)));
    let front = front_line(results, plot, &marks, &area);
    root.draw(&PathElement::new(front.clone(), FRONT.stroke_width(2)))?;
    draw_labels(&root, &marks, &front, area)?;
    for mark in &marks {
        draw_mark(&root, mark, &area)?;
    }
    root.present()?;
    Ok(())
}

fn draw_title(root: &Area<'_>, plot: Plot, heading: &str) -> Drawn {
    let title = font(TITLE_PX).style(FontStyle::Bold).color(&INK);
    let text = if heading.is_empty() { plot.title().to_owned() } else { format!("{}: {heading}", plot.title()) };
    root.draw(&Text::new(text, (24, 12), title))?;
    root.draw(&Text::new(plot.subtitle(), (24, 37), font(LABEL_PX).color(&FAINT_INK)))?;
    Ok(())
}

/// A sans-serif font of a height in CSS pixels; plotters divides by 1.24 when it writes SVG.
fn font(px: f64) -> FontDesc<'static> {
    FontDesc::new(FontFamily::SansSerif, px * 1.24, FontStyle::Normal)
}

/// Position, look and label of every result.
fn marks(results: &[&MethodResult], plot: Plot, area: &Rect, pixel: impl Fn(f64, f64) -> (i32, i32)) -> Vec<Mark> {
    let methods = distinct(results);
    let mark = |result: &&MethodResult| {
        let height = plot.height(result);
        let place = |value: f64| {
            let (x, y) = pixel(value, height.unwrap_or(0.0));
            (x, if height.is_some() { y } else { area.top + 2 * MARKER_RADIUS })
        };
        let (q1, q3) = plot.spread(result);
        let method = methods.iter().position(|name| *name == result.method).unwrap_or(0);
        Mark {
            at: place(plot.cost(result)),
            quartiles: (place(q1), place(q3)),
            color: METHOD_COLORS[method % METHOD_COLORS.len()],
            // Where colours run out, another shape tells methods apart.
            shape: method / METHOD_COLORS.len(),
            label: label(results, result, plot, area),
            at_top: height.is_none(),
        }
    };
    results.iter().map(mark).collect()
}

/// The different methods among the results, in order of appearance.
fn distinct<'a>(results: &[&'a MethodResult]) -> Vec<&'a str> {
    let mut names = Vec::new();
    for name in results.iter().map(|result| result.method.as_str()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// The method; device and parameters only as far as these are needed to tell results apart. Long ones are cut.
fn label(results: &[&MethodResult], result: &MethodResult, plot: Plot, area: &Rect) -> String {
    let twins = || results.iter().filter(|r| r.method == result.method);
    let mut parts = vec![result.method.as_str()];
    if twins().any(|r| r.device != result.device) {
        parts.push(&result.device);
    }
    let same_device: Vec<&MethodResult> = twins().copied().filter(|r| r.device == result.device).collect();
    parts.extend(telling_parameters(result, &same_device));
    let mut text = parts.join(", ");
    if result.is_reference() {
        text += &format!(": reference, {}", plot.text(result));
    } else if plot.height(result).is_none() {
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

/// The staircase over the undominated results, on to the right edge.
fn front_line(results: &[&MethodResult], plot: Plot, marks: &[Mark], area: &Rect) -> Vec<(i32, i32)> {
    let drawn: Vec<usize> = (0..results.len()).filter(|&i| !marks[i].at_top).collect();
    let point = |&i: &usize| (plot.cost(results[i]), plot.height(results[i]).unwrap_or(0.0));
    let points: Vec<(f64, f64)> = drawn.iter().map(point).collect();
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

fn draw_labels(root: &Area<'_>, marks: &[Mark], front: &[(i32, i32)], area: Rect) -> Drawn {
    let markers = marks.iter().map(|mark| Rect::around(mark.at, MARKER_RADIUS + 1)).collect();
    let whiskers = marks.iter().map(|mark| Rect::spanned(mark.quartiles.0, mark.quartiles.1));
    let dashes = marks.iter().filter(|m| m.at_top).map(|m| Rect::spanned(m.at, (m.at.0, area.bottom)));
    let stairs = front.windows(2).map(|pair| Rect::spanned(pair[0], pair[1]));
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
        let report = sample::report();
        let results: Vec<&MethodResult> = report.results.iter().filter(|r| r.frames.reflector == "teapot").collect();
        for plot in Plot::ALL {
            let svg = svg(&results, plot, "teapot").unwrap();
            assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
            assert!(svg.contains("slabs") && svg.contains(plot.title()) && svg.contains("teapot"), "{plot:?}");
            // Elements either close themselves or are closed: <svg>, <text>.
            let opened = svg.matches('<').count() - svg.matches("</").count() - svg.matches("/>").count();
            assert_eq!(opened, svg.matches("</").count());
        }
        let time = svg(&results, Plot::Time, "").unwrap();
        for text in ["environment map", "ray tracing: reference", "PSNR, dB"] {
            assert!(time.contains(text), "{text}");
        }
        assert!(!svg(&results, Plot::Disk, "").unwrap().contains("ray tracing"));
    }

    #[test]
    fn odd_results_are_drawn_too() {
        assert!(svg(&[], Plot::Time, "").unwrap().starts_with("<svg"));
        let cases = [
            sample::result("a", "instant", &[20.0], 0.0),
            sample::result("a", "exact", &[f64::INFINITY], 1.0),
            sample::result("a", "reference alone", &[], 1e6),
            sample::result("<b>", &"long <b> ".repeat(100), &[-3.0, 99.0], 1e-12),
        ];
        for case in &cases {
            for plot in Plot::ALL {
                let svg = svg(&[case], plot, "").unwrap();
                assert!(svg.starts_with("<svg") && svg.contains(plot.title()), "{}", case.method);
            }
        }
        let svg = svg(&cases.iter().collect::<Vec<_>>(), Plot::Time, "<b>").unwrap();
        assert!(!svg.contains("<b>") && svg.contains("exact: no error") && svg.contains('…'));
    }

    #[test]
    fn labels_tell_twins_apart_and_say_no_more() {
        let area = Rect { left: 0, top: 0, right: 900, bottom: 500 };
        let of = |parameters: &str| MethodResult {
            parameters: parameters.to_owned(),
            ..sample::result("a", "slabs", &[30.0], 1.0)
        };
        let mut results = vec![of("64², BC1; 4 steps"), of("64², BC1; 8 steps")];
        let named = |results: &[MethodResult], i: usize| {
            label(&results.iter().collect::<Vec<_>>(), &results[i], Plot::Time, &area)
        };
        assert_eq!([named(&results, 0), named(&results, 1)], ["slabs, 4 steps", "slabs, 8 steps"]);
        results[1].device = "GPU".to_owned();
        assert_eq!(named(&results, 1), "slabs, GPU");
        assert_eq!(named(&results[..1], 0), "slabs");
    }
}

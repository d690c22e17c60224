//! The plot of PSNR over speed for one class, drawn with plotters' SVG backend.

use lf_report::{LabelPlacer, Rect};
use plotters::coord::Shift;
use plotters::coord::combinators::{BindKeyPoints, IntoLogRange};
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::codec::Maker;
use crate::error::BenchError;
use crate::front::{Point, front};

/// Size of the drawing in pixels.
const SIZE: (u32, u32) = (1200, 760);
const INK: RGBColor = RGBColor(0x1F, 0x24, 0x30);
const FAINT_INK: RGBColor = RGBColor(0x5C, 0x66, 0x77);
const GRID: RGBColor = RGBColor(0xE3, 0xE7, 0xEE);
/// Vermilion and blue, told apart by colour-blind readers too (Okabe & Ito 2008).
const OURS: RGBColor = RGBColor(0xD5, 0x5E, 0x00);
const PEERS: RGBColor = RGBColor(0x00, 0x72, 0xB2);
const TEXT_PX: f64 = 12.0;
const RADIUS: i32 = 4;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// What a point stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Measured(Maker),
    /// Measured on another machine and placed relative to the unit.
    Recorded,
}

/// One encoder on the plot.
#[derive(Debug, Clone)]
pub(crate) struct Mark {
    /// Left out where names would crowd the plot.
    pub(crate) label: Option<String>,
    pub(crate) kind: Kind,
    /// Speed as a ratio to the unit, and PSNR.
    pub(crate) at: Point,
}

/// Draws all marks, a line through ours and the front of the measured peers.
pub(crate) fn svg(title: &str, marks: &[Mark]) -> Result<String, BenchError> {
    let mut text = String::new();
    draw(title, marks, &mut text).map_err(|error| BenchError::Plot(error.to_string()))?;
    Ok(text)
}

fn draw(title: &str, marks: &[Mark], text: &mut String) -> Drawn {
    let root = SVGBackend::with_string(text, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    heading(&root, title)?;
    let (ratios, db) = ranges(marks);
    let mut chart = ChartBuilder::on(&root)
        .margin_top(64)
        .margin_right(24)
        .margin_bottom(10)
        .margin_left(10)
        .x_label_area_size(48)
        .y_label_area_size(60)
        .build_cartesian_2d((ratios.0..ratios.1).log_scale().with_key_points(ticks(ratios)), db.0..db.1)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(FAINT_INK)
        .label_style(font(TEXT_PX).color(&INK))
        .x_desc("speed, × intel_tex_2 (logarithmic)")
        .y_desc("PSNR, dB")
        .x_label_formatter(&|ratio| format!("{ratio}"))
        .y_label_formatter(&|db| format!("{db:.1}"))
        .draw()?;
    let (columns, rows) = chart.plotting_area().get_pixel_range();
    let area = Rect { left: columns.start, top: rows.start, right: columns.end, bottom: rows.end };
    let pixels: Vec<(i32, i32)> =
        marks.iter().map(|mark| chart.backend_coord(&(mark.at.speed, mark.at.psnr_db))).collect();

    lines(&root, marks, &pixels, &area)?;
    for (mark, &pixel) in marks.iter().zip(&pixels) {
        symbol(&root, mark.kind, pixel)?;
    }
    names(&root, marks, &pixels, area)?;
    root.present()?;
    Ok(())
}

fn heading(root: &Area<'_>, title: &str) -> Drawn {
    root.draw(&Text::new(title.to_owned(), (24, 10), font(18.0).style(FontStyle::Bold).color(&INK)))?;
    let entries = [
        (Kind::Measured(Maker::Ours), 30, "this project"),
        (Kind::Measured(Maker::Peer), 150, "other crates, with their front"),
        (Kind::Recorded, 370, "recorded elsewhere, relative to intel_tex_2 (named where on the front there)"),
    ];
    for (kind, x, text) in entries {
        symbol(root, kind, (x, 46))?;
        root.draw(&Text::new(text, (x + 12, 39), font(TEXT_PX).color(&FAINT_INK)))?;
    }
    Ok(())
}

/// A sans-serif font of a height in CSS pixels; plotters divides by 1.24 when it writes SVG.
fn font(px: f64) -> FontDesc<'static> {
    FontDesc::new(FontFamily::SansSerif, px * 1.24, FontStyle::Normal)
}

/// The data's ranges with some room; of infinite PSNR, which no axis shows, nothing is left.
fn ranges(marks: &[Mark]) -> ((f64, f64), (f64, f64)) {
    let span = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let ratios = span(&mut marks.iter().map(|mark| mark.at.speed));
    let db = span(&mut marks.iter().map(|mark| mark.at.psnr_db));
    if !(ratios.0 > 0.0 && ratios.1.is_finite() && db.0.is_finite() && db.1.is_finite()) {
        return ((0.1, 10.0), (0.0, 50.0));
    }
    let room = 0.06 * (db.1 - db.0).max(0.5);
    ((ratios.0 / 1.6, ratios.1 * 1.6), (db.0 - room, db.1 + room))
}

/// 1, 2 and 5 of each decade in a range.
fn ticks((low, high): (f64, f64)) -> Vec<f64> {
    let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
    // By parsing, so that 0.002 is written as such and not as 0.0020000000000000005.
    let steps = decades.flat_map(|decade| [1, 2, 5].map(|digit| format!("{digit}e{decade}").parse().unwrap_or(1.0)));
    steps.filter(|step| *step >= low && *step <= high).collect()
}

fn lines(root: &Area<'_>, marks: &[Mark], pixels: &[(i32, i32)], area: &Rect) -> Drawn {
    let of =
        |maker: Maker| -> Vec<usize> { (0..marks.len()).filter(|&i| marks[i].kind == Kind::Measured(maker)).collect() };
    let peers = of(Maker::Peer);
    let points: Vec<Point> = peers.iter().map(|&i| marks[i].at).collect();
    // The front runs from the fastest to the best: leftwards and upwards in steps.
    let mut stairs: Vec<(i32, i32)> = Vec::new();
    for pixel in front(&points).into_iter().map(|i| pixels[peers[i]]) {
        stairs.push((pixel.0, stairs.last().map_or(area.bottom, |last| last.1)));
        stairs.push(pixel);
    }
    if let Some(&(_, y)) = stairs.last() {
        stairs.push((area.left, y));
    }
    root.draw(&PathElement::new(stairs, PEERS.mix(0.35).stroke_width(2)))?;
    let mut ours: Vec<(i32, i32)> = of(Maker::Ours).into_iter().map(|i| pixels[i]).collect();
    ours.sort_unstable();
    root.draw(&PathElement::new(ours, OURS.stroke_width(2)))
}

fn symbol(root: &Area<'_>, kind: Kind, (x, y): (i32, i32)) -> Drawn {
    let r = RADIUS;
    match kind {
        Kind::Measured(Maker::Ours) => root.draw(&Circle::new((x, y), r + 1, OURS.filled())),
        Kind::Measured(Maker::Peer) => root.draw(&Rectangle::new([(x - r, y - r), (x + r, y + r)], PEERS.filled())),
        Kind::Recorded => {
            let corners = vec![(x, y - r), (x + r, y), (x, y + r), (x - r, y), (x, y - r)];
            root.draw(&PathElement::new(corners, FAINT_INK.stroke_width(1)))
        }
    }
}

fn names(root: &Area<'_>, marks: &[Mark], pixels: &[(i32, i32)], area: Rect) -> Drawn {
    let mut named: Vec<(&Mark, &String, (i32, i32))> =
        marks.iter().zip(pixels).filter_map(|(mark, &pixel)| Some((mark, mark.label.as_ref()?, pixel))).collect();
    // The first have the first choice: ours, then the peers measured here.
    named.sort_by_key(|(mark, _, _)| match mark.kind {
        Kind::Measured(Maker::Ours) => 0,
        Kind::Measured(Maker::Peer) => 1,
        Kind::Recorded => 2,
    });
    // Letters of the usual sans-serif fonts are hardly wider than 0.58 of their height on average.
    let width = |name: &str| (name.chars().count() as f64 * 0.58 * TEXT_PX).ceil() as i32;
    let markers = pixels.iter().map(|&pixel| Rect::around(pixel, 4)).collect();
    let mut placer = LabelPlacer::new(area, markers, Vec::new());
    for (mark, name, pixel) in &named {
        let placed = placer.place(*pixel, (width(name), TEXT_PX as i32 + 2));
        let color = match mark.kind {
            Kind::Measured(Maker::Ours) => OURS,
            Kind::Measured(Maker::Peer) => PEERS,
            Kind::Recorded => FAINT_INK,
        };
        if let Some(end) = placed.leader {
            root.draw(&PathElement::new(vec![*pixel, end], color.mix(0.5).stroke_width(1)))?;
        }
        let style = font(TEXT_PX).color(&color).pos(Pos::new(HPos::Center, VPos::Center));
        root.draw(&Text::new(name.as_str(), placed.text.center(), style))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mark(label: &str, kind: Kind, speed: f64, psnr_db: f64) -> Mark {
        Mark { label: Some(label.to_owned()), kind, at: Point { speed, psnr_db } }
    }

    #[test]
    fn every_name_is_drawn() {
        let marks = [
            mark("unit", Kind::Measured(Maker::Peer), 1.0, 35.0),
            mark("mine", Kind::Measured(Maker::Ours), 2.0, 34.0),
            mark("a<b", Kind::Recorded, 0.001, 36.0),
        ];
        let svg = svg("lf", &marks).unwrap();
        for text in ["unit", "mine", "a&lt;b", "recorded elsewhere", "0.002", "PSNR, dB"] {
            assert!(svg.contains(text), "{text}");
        }
    }

    #[test]
    fn odd_data_is_drawn_too() {
        for marks in [vec![], vec![mark("exact", Kind::Recorded, 1.0, f64::INFINITY)]] {
            assert!(svg("odd", &marks).unwrap().trim_end().ends_with("</svg>"));
        }
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(ticks((0.004, 3.0)), [0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0]);
    }
}

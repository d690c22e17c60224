//! The report as one HTML page: no scripts, nothing to load, readable on a phone, in the light and in the dark.
//!
//! Every text of the report passes [`html_escape`] on its way into the page.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::axis::Plot;
use crate::error::ReportError;
use crate::report::{Figure, Report, Table, psnr_texts, time_texts};
use crate::result::{Frames, MethodResult};
use crate::units::{self, html_escape};

const STYLE: &str = include_str!("style.css");

/// First bytes of every PNG file (PNG specification, 5.2), and of every JPEG file (ITU T.81, B.1.1.3: SOI, then a marker).
const SIGNATURES: [(&[u8], &str); 2] = [(b"\x89PNG\r\n\x1a\n", "png"), (b"\xFF\xD8\xFF", "jpeg")];

pub(crate) fn page(report: &Report, figures: &[Figure]) -> Result<String, ReportError> {
    let frames = report.frames().into_iter().map(|frames| frames_section(report, frames));
    let sections = [
        header(report),
        frames.collect::<Result<Vec<_>, _>>()?.concat(),
        report.tables.iter().map(table_section).collect(),
        figures_section(figures)?,
        eyes_section(report),
        run_section(report),
    ];
    let title = html_escape(&report.title);
    let body = sections.concat();
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n"
    ))
}

/// Title and what came out, in one sentence for all frames and devices.
fn header(report: &Report) -> String {
    let mut html = format!("<header>\n<h1>{}</h1>\n", html_escape(&report.title));
    for headline in report.headlines() {
        // The reflector up to the colon, the gain up to the parenthesis: what the eye should catch.
        let text = html_escape(&headline);
        let (start, rest) = text.split_once(" (").unwrap_or((&text, ""));
        let rest = if rest.is_empty() { String::new() } else { format!(" ({rest}") };
        let _ = writeln!(html, "<p class=\"headline\"><strong>{start}</strong>{rest}</p>");
    }
    let mut scenes: Vec<&str> = report.results.iter().map(|result| result.frames.scene.as_str()).collect();
    scenes.dedup();
    let scene = html_escape(&scenes.join(", "));
    let generator = html_escape(&report.generator);
    let _ =
        writeln!(html, "<p class=\"faint\">Scene: {scene}. All figures were measured in one run by {generator}.</p>");
    html + "</header>\n"
}

/// What was measured on the same frames: plots, and the methods in the order measured.
fn frames_section(report: &Report, frames: &Frames) -> Result<String, ReportError> {
    let label = html_escape(&report.label(frames));
    let mut html = format!("<section>\n<h2>{label}</h2>\n");
    for plot in Plot::ALL {
        if let Some(svg) = report.plot(frames, plot)? {
            let named = format!(
                "class=\"plot\" role=\"img\" aria-label=\"{}; the numbers are in the next table\"",
                plot.title()
            );
            let inline = svg.replacen("xmlns=\"http://www.w3.org/2000/svg\"", &named, 1);
            let _ = writeln!(html, "<div class=\"wide\">\n{inline}</div>");
        }
    }
    let results = report.results_of(frames);
    let best = results.iter().filter_map(|r| r.mean_psnr_db()).max_by(f64::total_cmp);
    let _ = write!(
        html,
        "<div class=\"wide\"><table>\n<caption>{label}</caption>\n<thead><tr><th scope=\"col\">Method</th>\
         <th scope=\"col\">PSNR <small>dB, mean</small></th><th scope=\"col\">FLIP <small>mean</small></th>\
         <th scope=\"col\">Per frame <small>ms, median</small></th>\
         <th scope=\"col\">Over eyes <small>dB, min–max</small></th><th scope=\"col\">Quartiles <small>ms</small></th>\
         <th scope=\"col\">On device</th><th scope=\"col\">On disk</th><th scope=\"col\">Preparation</th></tr></thead>\n\
         <tbody>\n"
    );
    for result in results {
        result_row(&mut html, result, best.is_some() && result.mean_psnr_db() == best);
    }
    Ok(html + "</tbody>\n</table></div>\n</section>\n")
}

/// A table of texts.
fn table_section(Table { title, caption, columns, rows }: &Table) -> String {
    let cells = |cells: &[String], tag: &str| -> String {
        cells.iter().map(|cell| format!("<{tag}>{}</{}>", html_escape(cell), &tag[..2])).collect()
    };
    let rows: String = rows.iter().map(|row| format!("<tr>{}</tr>\n", cells(row, "td"))).collect();
    format!(
        "<section>\n<h2>{}</h2>\n<p class=\"faint\">{}</p>\n<div class=\"wide\"><table class=\"texts\">\n<thead><tr>{}</tr></thead>\n\
         <tbody>\n{rows}</tbody>\n</table></div>\n</section>\n",
        html_escape(title),
        html_escape(caption),
        cells(columns, "th scope=\"col\""),
    )
}

fn result_row(html: &mut String, result: &MethodResult, best: bool) {
    let [psnr, range] = psnr_texts(result);
    let [median, quartiles] = time_texts(result);
    let on_disk = result.bytes_on_disk.map_or_else(|| "<td>–</td>".to_owned(), bytes_cell);
    let _ = writeln!(
        html,
        "<tr><th scope=\"row\">{method}<small>{parameters}</small><small>{device}</small></th><td{class}>{psnr}</td>\
         <td>{flip}</td><td>{median}</td><td>{range}</td><td>{quartiles}</td>{on_device}{on_disk}<td>{preparation}</td></tr>",
        method = html_escape(&result.method),
        parameters = html_escape(&result.parameters),
        device = html_escape(&result.device),
        flip = result.mean_flip().map_or_else(|| "–".to_owned(), |flip| format!("{flip:.3}")),
        class = if best { " class=\"best\"" } else { "" },
        range = if range.is_empty() { "–" } else { &range },
        on_device = bytes_cell(result.bytes_on_device),
        preparation = units::duration(result.preparation_s),
    );
}

fn bytes_cell(count: u64) -> String {
    format!("<td title=\"{} bytes\">{}</td>", units::grouped(count), units::bytes(count))
}

/// One table for all frames: PSNR and largest difference of every eye.
fn eyes_section(report: &Report) -> String {
    let mut html = "<section>\n<h2>Each eye</h2>\n<p class=\"faint\">PSNR in dB, below it the largest difference of \
                    any colour component in steps of 1/255.</p>\n"
        .to_owned();
    for frames in report.frames() {
        let compared: Vec<_> = report.results_of(frames).into_iter().filter(|r| !r.is_reference()).collect();
        let columns = compared.iter().map(|r| r.eyes.len()).max().unwrap_or(0);
        if columns == 0 {
            continue;
        }
        let pixels = || compared.iter().flat_map(|r| &r.eyes).map(|eye| eye.pixels as u64);
        let (fewest, most) = (pixels().min().unwrap_or(0), pixels().max().unwrap_or(0));
        let label = html_escape(&report.label(frames));
        let (fewest, most) = (units::grouped(fewest), units::grouped(most));
        let pixels = if fewest == most { most } else { format!("{fewest}–{most}") };
        let _ = write!(
            html,
            "<div class=\"wide\"><table class=\"eyes\">\n<caption>{label} <small>{pixels} pixels an eye</small>\
             </caption>\n<thead><tr><th scope=\"col\">Method</th>"
        );
        for eye in 0..columns {
            let number = compared.iter().find_map(|r| r.eyes.get(eye)).map_or(eye, |e| e.eye);
            let _ = write!(html, "<th scope=\"col\">{number}</th>");
        }
        html += "</tr></thead>\n<tbody>\n";
        for result in compared {
            eyes_row(&mut html, result, columns);
        }
        html += "</tbody>\n</table></div>\n";
    }
    html + "</section>\n"
}

fn eyes_row(html: &mut String, result: &MethodResult, columns: usize) {
    let (method, parameters) = (html_escape(&result.method), html_escape(&result.parameters));
    let _ = write!(html, "<tr><th scope=\"row\">{method}<small>{parameters}</small></th>");
    for eye in &result.eyes {
        let _ = write!(html, "<td>{}<small>{}</small></td>", units::decibels(eye.psnr_db, 2), eye.max_abs);
    }
    *html += &"<td>–</td>".repeat(columns - result.eyes.len());
    *html += "</tr>\n";
}

fn figures_section(figures: &[Figure]) -> Result<String, ReportError> {
    if figures.is_empty() {
        return Ok(String::new());
    }
    let mut html = "<section>\n<h2>Images</h2>\n".to_owned();
    for figure in figures {
        let known = SIGNATURES.iter().find(|(signature, _)| figure.picture.starts_with(signature));
        let (_, kind) = known.ok_or_else(|| ReportError::InvalidArgument {
            what: format!("the figure \"{}\"", figure.title),
            why: "its bytes are neither a PNG nor a JPEG file".to_owned(),
        })?;
        let (title, caption) = (html_escape(&figure.title), html_escape(&figure.caption));
        let data = STANDARD.encode(&figure.picture);
        let _ = writeln!(
            html,
            "<figure>\n<img alt=\"{title}\" src=\"data:image/{kind};base64,{data}\">\n\
             <figcaption><strong>{title}</strong> {caption}</figcaption>\n</figure>"
        );
    }
    Ok(html + "</section>\n")
}

/// Facts, machine, command and notes.
fn run_section(report: &Report) -> String {
    let machine = &report.machine;
    let threads = machine.threads.to_string();
    let machine_rows = [
        ("Processor", machine.cpu.as_str()),
        ("Threads", &threads),
        ("Graphics adapter", machine.adapter.as_deref().unwrap_or("none")),
        ("System", &machine.os),
        ("Build", &machine.build_profile),
    ];
    let mut html = "<section>\n<h2>The run</h2>\n".to_owned();
    if !report.facts.is_empty() {
        html += &definitions("Facts", report.facts.iter().map(|(name, value)| (name.as_str(), value.as_str())));
    }
    html += &definitions("Machine", machine_rows);
    let _ = writeln!(html, "<h3>To measure it again</h3>\n<pre><code>{}</code></pre>", html_escape(&report.reproduce));
    if !report.notes.is_empty() {
        html += "<h3>Notes</h3>\n";
    }
    for note in &report.notes {
        let _ = writeln!(html, "<p>{}</p>", html_escape(note));
    }
    html + "</section>\n"
}

fn definitions<'a>(heading: &str, rows: impl IntoIterator<Item = (&'a str, &'a str)>) -> String {
    let mut html = format!("<h3>{heading}</h3>\n<dl>\n");
    for (name, value) in rows {
        let _ = writeln!(html, "<div><dt>{}</dt><dd>{}</dd></div>", html_escape(name), html_escape(value));
    }
    html + "</dl>\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    fn figure(png: &[u8]) -> Figure {
        Figure { title: "Orbit & <eyes>".to_owned(), caption: "Eight of them.".to_owned(), picture: png.to_vec() }
    }

    #[test]
    fn page_has_every_part_and_loads_nothing() {
        let html = sample::report().to_html(&[figure(b"\x89PNG\r\n\x1a\n...")]).unwrap();
        for part in [
            "<h1>Reflections in the museum</h1>",
            "teapot: 8.4 dB more with slabs than with environment map",
            "<svg",
            "<caption>sphere</caption>",
            "Quartiles",
            "FLIP",
            "<td>0.062</td>",
            "<h2>Left out</h2>",
            "<td>a|b</td>",
            "Each eye",
            "src=\"data:image/png;base64,iVBORw0KGgouLi4=\"",
            "Orbit &amp; &lt;eyes&gt;",
            "<dt>Slabs</dt>",
            "<dt>Processor</dt><dd>Some CPU</dd>",
            "<code>lfslab demo --out lfslab-demo</code>",
            "Times are wall clock.",
        ] {
            assert!(html.contains(part), "{part}");
        }
        for loading in ["http", "<script", "<link", "@import", "url("] {
            assert!(!html.contains(loading), "{loading}");
        }
    }

    #[test]
    fn every_text_is_escaped() {
        let evil = || "<script>alert(1)</script>".to_owned();
        let mut report = sample::report();
        (report.title, report.generator, report.reproduce) = (evil(), evil(), evil());
        let table = &mut report.tables[0];
        (table.title, table.caption, table.columns, table.rows) = (evil(), evil(), vec![evil()], vec![vec![evil()]]);
        (report.facts, report.notes) = (vec![(evil(), evil())], vec![evil()]);
        let machine = &mut report.machine;
        (machine.cpu, machine.adapter, machine.os, machine.build_profile) = (evil(), Some(evil()), evil(), evil());
        for result in &mut report.results {
            (result.frames.reflector, result.frames.scene) = (evil(), evil());
            (result.parameters, result.device) = (evil(), evil());
        }
        report.results[2].method = evil();
        let mut figure = figure(SIGNATURES[0].0);
        (figure.title, figure.caption) = (evil(), evil());
        let html = report.to_html(&[figure]).unwrap();
        assert!(!html.contains("<script") && html.contains("&lt;script&gt;alert(1)"));
    }

    #[test]
    fn figures_must_be_pictures() {
        let message = sample::report().to_html(&[figure(b"GIF89a")]).unwrap_err().to_string();
        assert!(message.contains("Orbit & <eyes>") && message.contains("neither a PNG"), "{message}");
    }

    #[test]
    fn an_empty_report_is_still_a_page() {
        let mut report = sample::report();
        report.results.clear();
        assert!(report.headlines().is_empty());
        assert!(report.to_html(&[]).unwrap().ends_with("</html>\n"));
    }

    #[test]
    fn elements_are_balanced() {
        let html = sample::report().to_html(&[figure(SIGNATURES[0].0)]).unwrap();
        for tag in ["main", "header", "section", "table", "tr", "td", "th", "div", "dl", "figure", "small", "svg"] {
            let opened = html.matches(&format!("<{tag}>")).count() + html.matches(&format!("<{tag} ")).count();
            assert_eq!(opened, html.matches(&format!("</{tag}>")).count(), "{tag}");
        }
    }
}

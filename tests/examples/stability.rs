//! The table of `docs/stability.md`, and what it costs to be robust.
//!
//! `cargo run --release -p lf-tests --example stability -- --svg docs/stability.svg` prints the rows as Markdown, then the time a call of
//! the robust and of the textbook's functions takes, and draws one against the other.

#![forbid(unsafe_code)]

use std::error::Error;
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;
use std::{fs, process};

use clap::Parser;
use lf_math::{normalized, sphere_exit, triangle_normal};
use lf_tests::stability::draws::Draws;
use lf_tests::stability::{ROWS, Row, normals, sphere, table};

#[derive(Parser)]
struct Arguments {
    /// Where to draw error against time
    #[arg(long)]
    svg: Option<PathBuf>,
}

/// Two ways to one end, the textbook's first.
struct Pair {
    name: &'static str,
    rows: [Row; 2],
    nanoseconds: [f64; 2],
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let rows: Vec<Row> = ROWS.iter().map(|measure| measure()).collect();
    print!("{}", table(&rows));
    let pairs = pairs();
    println!("\n| function | way | p99.99 | ns a call |\n|---|---|--:|--:|");
    for pair in &pairs {
        for (way, (row, time)) in ["plain", "robust"].iter().zip(pair.rows.iter().zip(pair.nanoseconds)) {
            println!("| {} | {way} | {} | {time:.1} |", pair.name, ratio_label(row.p9999));
        }
    }
    if let Some(path) = arguments.svg {
        fs::write(path, svg(&pairs))?;
    }
    let compared = |row: &Row| row.limits[1].is_infinite();
    process::exit(i32::from(!rows.iter().all(|row| compared(row) || row.passes())));
}

/// The functions that have a plain sibling.
fn pairs() -> [Pair; 3] {
    let mut draws = Draws::new(90);
    let lines: Vec<_> = (0..INPUTS).map(|_| sphere::line(&mut draws)).collect();
    let vectors: Vec<_> = (0..INPUTS).map(|_| draws.vector(1e-10, 1e10)).collect();
    let triangles: Vec<_> = (0..INPUTS).map(|_| normals::needle(&mut draws, [1e-6, 1e6])).collect();
    [
        Pair {
            name: "ray–sphere",
            rows: [sphere::naive(), sphere::robust()],
            nanoseconds: [
                time(&lines, |&(o, d, r)| sphere::naive_exit(o, d, r)),
                time(&lines, |&(o, d, r)| sphere_exit(o, d, r)),
            ],
        },
        Pair {
            name: "normalise",
            rows: [normals::plain_normalise(), normals::normalise()],
            nanoseconds: [time(&vectors, |&v| normals::plain_normalized(v)), time(&vectors, |&v| normalized(v))],
        },
        Pair {
            name: "normal of a triangle",
            rows: [normals::plain_triangle(), normals::triangle()],
            nanoseconds: [
                time(&triangles, |&t| normals::plain_triangle_normal(t)),
                time(&triangles, |&t| triangle_normal(t)),
            ],
        },
    ]
}

/// Few enough to stay in the cache.
const INPUTS: usize = 1024;

/// Nanoseconds a call: the least of many rounds.
fn time<T, U>(inputs: &[T], call: impl Fn(&T) -> U) -> f64 {
    let round = |_| {
        let start = Instant::now();
        for input in inputs {
            black_box(call(black_box(input)));
        }
        start.elapsed().as_secs_f64() * 1e9 / inputs.len() as f64
    };
    (0..2000).map(round).fold(f64::INFINITY, f64::min)
}

/// Beyond this a result has no digit left.
const NO_DIGIT: f64 = 1e7;

fn ratio_label(ratio: f64) -> String {
    if ratio >= NO_DIGIT { "no digit".to_owned() } else { format!("{ratio:.1}") }
}

const SIZE: [f64; 2] = [720.0, 420.0];
const MARGINS: [f64; 4] = [70.0, 24.0, 56.0, 48.0];
const COLORS: [&str; 3] = ["#0072B2", "#D55E00", "#009E73"];

/// Error against time: an arrow from the plain way to the robust one.
fn svg(pairs: &[Pair]) -> String {
    let [left, right, top, bottom] = MARGINS;
    let longest = pairs.iter().flat_map(|pair| pair.nanoseconds).fold(1.0, f64::max) * 1.4;
    let x = |time: f64| left + (SIZE[0] - left - right) * time / longest;
    let y = |ratio: f64| {
        let share = (ratio.clamp(1.0, NO_DIGIT)).log10() / NO_DIGIT.log10();
        SIZE[1] - bottom - (SIZE[1] - top - bottom) * share
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"24\" y=\"26\" font-size=\"17\" font-weight=\"bold\">Error of stiff cases against time</text>\n\
         <text x=\"24\" y=\"44\" fill=\"#5c6677\">hollow: plain; filled: robust, as in the product</text>\n",
        SIZE[0], SIZE[1]
    );
    let mut put = |line: String| {
        svg += &line;
        svg.push('\n');
    };
    for decade in 0..=7 {
        let at = y(10f64.powi(decade));
        let label = if decade == 7 {
            "no digit".to_owned()
        } else {
            format!("10{}", ["⁰", "¹", "²", "³", "⁴", "⁵", "⁶"][decade as usize])
        };
        put(format!("<path d=\"M{left} {at:.1}H{}\" stroke=\"#e3e7ee\"/>", SIZE[0] - right));
        put(format!("<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>", left - 8.0, at + 4.0));
    }
    let step = if longest > 20.0 { 5 } else { 2 };
    for time in (0..=longest as u32).step_by(step) {
        let at = x(f64::from(time));
        put(format!("<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{time}</text>", SIZE[1] - bottom + 18.0));
    }
    let middle = 0.5 * (left + SIZE[0] - right);
    put(format!("<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">ns a call</text>", SIZE[1] - 10.0));
    let side = 0.5 * (top + SIZE[1] - bottom);
    put(format!(
        "<text transform=\"translate(16 {side}) rotate(-90)\" text-anchor=\"middle\">p99.99 of err / (κ·u)</text>"
    ));
    for (pair, color) in pairs.iter().zip(COLORS) {
        put(arrow(pair, color, x, y));
    }
    svg + "</svg>\n"
}

fn arrow(pair: &Pair, color: &str, x: impl Fn(f64) -> f64, y: impl Fn(f64) -> f64) -> String {
    let [from, to] = [0, 1].map(|i| (x(pair.nanoseconds[i]), y(pair.rows[i].p9999)));
    let mut text = format!(
        "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"{color}\" stroke-width=\"2\" stroke-dasharray=\"4 4\"/>",
        from.0, from.1, to.0, to.1
    );
    for ((cx, cy), fill) in [(from, "#fff"), (to, color)] {
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "<circle cx=\"{cx:.1}\" cy=\"{cy:.1}\" r=\"6\" fill=\"{fill}\" stroke=\"{color}\" stroke-width=\"2\"/>"
        );
    }
    let _ =
        write!(text, "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{color}\">{}</text>", to.0 + 11.0, to.1 - 6.0, pair.name);
    text
}

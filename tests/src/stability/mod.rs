//! How far results in `f32` are from the exact ones where the problem is stiff, row by row of `docs/stability.md`.
//!
//! A row draws inputs, most of them where a small change of the input changes the output much, and compares the forward error
//! with the condition number κ: err / (κ·u), u = 2⁻²⁴. A method that rounds well stays at a few, however stiff the case. What is exact is
//! worked out here in `f64` from the mathematics, from the very numbers the method was given. Rules without a size, such as "exactly
//! one face", are counted where they are broken.

pub mod bc1;
pub mod cell;
pub mod chain;
pub mod draws;
pub mod faces;
pub mod image;
pub mod index;
pub mod normals;
pub mod raster;
pub mod sphere;
pub mod taps;

use std::fmt::Write as _;

/// Relative rounding error of `f32`, 2⁻²⁴.
pub const U: f64 = f32::EPSILON as f64 / 2.0;
/// Draws of a row, at least.
pub const DRAWS: usize = 200_000;

/// What was found of one function.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What was looked at.
    pub name: &'static str,
    /// What the numbers are multiples of.
    pub unit: &'static str,
    /// Inputs drawn.
    pub draws: usize,
    /// Draws for which a rule did not hold.
    pub broken: usize,
    /// 9,999 of 10,000 draws are no worse.
    pub p9999: f64,
    /// The worst draw.
    pub worst: f64,
    /// What `p9999` and `worst` may be.
    pub limits: [f64; 2],
}

impl Row {
    /// Whether no rule is broken and both numbers are within their limits.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.broken == 0 && self.p9999 <= self.limits[0] && self.worst <= self.limits[1]
    }
}

/// Collects the draws of a row.
#[derive(Debug, Default)]
pub struct Tally {
    ratios: Vec<f64>,
    draws: usize,
    broken: usize,
}

impl Tally {
    /// Counts a draw, and whether every rule held for it.
    pub fn rule(&mut self, holds: bool) {
        self.draws += 1;
        self.broken += usize::from(!holds);
    }

    /// Notes how an error compares with what it may be, of a draw that is counted by [`Self::rule`]. What is no number is as bad as
    /// can be.
    pub fn ratio(&mut self, error: f64, unit: f64) {
        let ratio = if error == 0.0 { 0.0 } else { error.abs() / unit };
        self.ratios.push(if ratio.is_nan() { f64::INFINITY } else { ratio });
    }

    /// The row.
    #[must_use]
    pub fn row(mut self, name: &'static str, unit: &'static str, limits: [f64; 2]) -> Row {
        self.ratios.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| self.ratios.get((self.ratios.len() as f64 * share) as usize).copied();
        let worst = self.ratios.last().copied().unwrap_or(0.0);
        Row { name, unit, draws: self.draws, broken: self.broken, p9999: at(0.9999).unwrap_or(worst), worst, limits }
    }
}

/// Measures a row.
pub type Measure = fn() -> Row;

/// All rows of the table, by what they are about.
pub const ROWS: &[Measure] = &[
    raster::fragments,
    chain::reflected,
    chain::seen,
    sphere::robust,
    sphere::naive,
    cell::exit,
    cell::exit_of_odd_rays,
    cell::range,
    index::on_the_plane,
    faces::selection,
    image::seams,
    index::ray,
    normals::normalise,
    normals::plain_normalise,
    normals::triangle,
    normals::plain_triangle,
    taps::weights,
    taps::continuity,
    taps::reprojection,
    taps::disparity,
    cell::cells,
    bc1::fits,
    bc1::quick_fits,
    bc1::nearly_even,
    bc1::odd_numbers,
    image::scaled,
    image::turned,
];

/// Rows as a Markdown table.
#[must_use]
pub fn table(rows: &[Row]) -> String {
    let limit = |x: f64| if x.is_finite() { x.to_string() } else { "–".to_owned() };
    let mut text = String::from("| function | draws | rules broken | p99.99 | worst | in | limits |  |\n");
    text += "|---|--:|--:|--:|--:|---|--:|---|\n";
    for row in rows {
        let [most, worst] = row.limits.map(limit);
        let verdict = match row.passes() {
            _ if row.limits[1].is_infinite() => "compare",
            true => "pass",
            false => "**fail**",
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {most} / {worst} | {verdict} |",
            row.name,
            row.draws,
            row.broken,
            short(row.p9999),
            short(row.worst),
            row.unit
        );
    }
    text
}

/// Three digits, or as many as there are before the point.
fn short(x: f64) -> String {
    if x == 0.0 || x >= 100.0 { format!("{x:.0}") } else { format!("{x:.2}") }
}

//! Encoders that are not on crates.io or do not build here, as measured on another machine.
//!
//! Only their distance from [`crate::UNIT_ENCODER`] is used, as a ratio of speeds and a difference in dB, since machine
//! and images differ. They are shown for orientation and take no part in the front of measured peers.

use crate::encoders::UNIT_ENCODER;
use crate::error::BenchError;
use crate::front::Point;

const TABLE: &str = include_str!("../data/recorded-peers.csv");
const HEADER: &str = "name,measured_as,lf_ratio,lf_db,lf_front,photo_ratio,photo_db,photo_front";

/// The images of a recorded measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Setting {
    /// An atlas of 8×8 views.
    LightField,
    /// Twelve photographs.
    Photographs,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Recorded {
    ratio: f64,
    psnr_db: f64,
    on_front: bool,
}

/// An encoder at one setting, placed relative to the unit.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedPeer {
    /// Name with its setting.
    pub name: String,
    /// Speed as a ratio to the unit's, PSNR as dB above the unit's.
    pub from_unit: Point,
    /// Whether it was on the front of all encoders measured there.
    pub on_front: bool,
}

/// The recorded encoders that this program cannot measure itself.
///
/// # Errors
///
/// [`BenchError::Recorded`] if the table is damaged.
pub fn recorded_peers(setting: Setting) -> Result<Vec<RecordedPeer>, BenchError> {
    relative(&parse(TABLE)?, setting)
}

struct Row {
    name: String,
    measured_as: Option<String>,
    lf: Option<Recorded>,
    photo: Option<Recorded>,
}

impl Row {
    fn at(&self, setting: Setting) -> Option<Recorded> {
        match setting {
            Setting::LightField => self.lf,
            Setting::Photographs => self.photo,
        }
    }
}

fn relative(rows: &[Row], setting: Setting) -> Result<Vec<RecordedPeer>, BenchError> {
    let unit = rows.iter().find(|row| row.measured_as.as_deref() == Some(UNIT_ENCODER));
    let unit = unit.and_then(|row| row.at(setting));
    let unit = unit.ok_or_else(|| BenchError::Recorded { line: 1, why: format!("no row for {UNIT_ENCODER}") })?;
    let elsewhere = rows.iter().filter(|row| row.measured_as.is_none());
    let peer = |row: &Row| {
        row.at(setting).map(|recorded| RecordedPeer {
            name: row.name.clone(),
            from_unit: Point { speed: recorded.ratio / unit.ratio, psnr_db: recorded.psnr_db - unit.psnr_db },
            on_front: recorded.on_front,
        })
    };
    Ok(elsewhere.filter_map(peer).collect())
}

/// Rows of comma-separated fields under [`HEADER`]; lines that start with `#` are skipped.
fn parse(table: &str) -> Result<Vec<Row>, BenchError> {
    let mut lines = table.lines().enumerate().filter(|(_, line)| !line.starts_with('#') && !line.is_empty());
    match lines.next() {
        Some((_, HEADER)) => (),
        other => {
            let line = other.map_or(1, |(i, _)| i + 1);
            return Err(BenchError::Recorded { line, why: format!("not the header {HEADER}") });
        }
    }
    lines.map(|(i, line)| row(line).map_err(|why| BenchError::Recorded { line: i + 1, why })).collect()
}

fn row(line: &str) -> Result<Row, String> {
    let fields: Vec<&str> = line.split(',').collect();
    let &[name, measured_as, lf_ratio, lf_db, lf_front, photo_ratio, photo_db, photo_front] = fields.as_slice() else {
        return Err(format!("{} fields instead of 8", fields.len()));
    };
    Ok(Row {
        name: name.to_owned(),
        measured_as: (!measured_as.is_empty()).then(|| measured_as.to_owned()),
        lf: recorded(lf_ratio, lf_db, lf_front)?,
        photo: recorded(photo_ratio, photo_db, photo_front)?,
    })
}

/// Three fields, or nothing where all three are empty.
fn recorded(ratio: &str, psnr_db: &str, on_front: &str) -> Result<Option<Recorded>, String> {
    if [ratio, psnr_db, on_front].iter().all(|field| field.is_empty()) {
        return Ok(None);
    }
    let positive = |text: &str| match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err(format!("{text:?} is not a positive number")),
    };
    let on_front = match on_front {
        "yes" => true,
        "no" => false,
        other => return Err(format!("{other:?} is neither yes nor no")),
    };
    Ok(Some(Recorded { ratio: positive(ratio)?, psnr_db: positive(psnr_db)?, on_front }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encoders::encoders;

    #[test]
    fn rows_are_placed_relative_to_the_unit() {
        let table = format!(
            "# note\n{HEADER}\nintel_tex_2,intel_tex_2,2.0,35.0,yes,1.0,30.0,no\na,,1.0,35.5,yes,,,\n\
             b,dds-fast,1,1,no,1,1,no\n"
        );
        let rows = parse(&table).unwrap();
        let lf = relative(&rows, Setting::LightField).unwrap();
        let from_unit = Point { speed: 0.5, psnr_db: 0.5 };
        assert_eq!(lf, [RecordedPeer { name: "a".to_owned(), from_unit, on_front: true }]);
        assert!(relative(&rows, Setting::Photographs).unwrap().is_empty());
    }

    #[test]
    fn damage_is_told_with_its_line() {
        let cases = [
            ("", "line 1"),
            ("a,b\n", "line 1"),
            (&format!("#\n{HEADER}\nx,y\n"), "line 3"),
            (&format!("{HEADER}\nx,,-1,35,yes,,,\n"), "\"-1\" is not a positive number"),
            (&format!("{HEADER}\nx,,1,35,perhaps,,,\n"), "neither yes nor no"),
        ];
        for (table, expected) in cases {
            let error = parse(table).map(|_| ()).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }

    #[test]
    fn the_table_parses_and_names_encoders_that_exist() {
        let names: Vec<String> = encoders(0).iter().map(|e| e.name().to_owned()).collect();
        for row in parse(TABLE).unwrap() {
            assert!(row.measured_as.is_none_or(|name| names.contains(&name)), "{}", row.name);
        }
        for setting in [Setting::LightField, Setting::Photographs] {
            let peers = recorded_peers(setting).unwrap();
            assert!(peers.iter().any(|peer| peer.on_front && peer.name.starts_with("icbc512-")));
            assert!(!peers.iter().any(|peer| peer.name == "etcpak"));
        }
    }
}

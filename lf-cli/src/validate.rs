//! `lfslab validate`: everything that is wrong with a file.

use std::fs::File;

use anyhow::{Context, Result, bail};
use lf_compress::{Finding, Severity, validate};
use lf_format::Structure;
use serde_json::{Value, json};

use crate::args::{Format, ValidateArgs};
use crate::output::print;

pub(crate) fn run(args: &ValidateArgs) -> Result<()> {
    let path = args.input.file.display();
    let context = || format!("cannot read {path}");
    let file = File::open(&args.input.file).with_context(context)?;
    let mut findings = Vec::new();
    let structure = validate(file, &args.input.limits(), |found| findings.push(found)).with_context(context)?;
    let valid = findings.iter().all(|found| found.severity != Severity::Error);
    match args.format {
        Format::Json => print(&format!("{:#}", to_json(&path.to_string(), valid, structure.as_ref(), &findings)))?,
        Format::Text => {
            findings.iter().try_for_each(|found| print(&line(found)))?;
            if let Some(structure) = structure.as_ref().filter(|_| valid) {
                let (slabs, chunks) = (structure.tilings().len(), structure.chunks().len());
                print(&format!("{path}: valid ({slabs} slabs, {chunks} chunks)"))?;
            }
        }
    }
    if !valid {
        let errors = findings.iter().filter(|found| found.severity == Severity::Error).count();
        bail!("{path} is not valid: {errors} error{}", if errors == 1 { "" } else { "s" });
    }
    Ok(())
}

/// `error entry.offset (§4.5, byte 80): chunk …`
fn line(found: &Finding) -> String {
    let places = [found.clause.map(str::to_owned), found.offset.map(|offset| format!("byte {offset}"))];
    let places: Vec<String> = places.into_iter().flatten().collect();
    let place = if places.is_empty() { String::new() } else { format!(" ({})", places.join(", ")) };
    format!("{} {}{place}: {}", severity(found.severity), found.id, found.message.escape_debug())
}

fn severity(severity: Severity) -> &'static str {
    match severity {
        Severity::Note => "note",
        Severity::Warning => "warning",
        _ => "error",
    }
}

/// As `spec/validate.schema.json` describes it.
fn to_json(file: &str, valid: bool, structure: Option<&Structure>, findings: &[Finding]) -> Value {
    let finding = |found: &Finding| {
        json!({
            "severity": severity(found.severity),
            "id": found.id,
            "clause": found.clause,
            "offset": found.offset,
            "slab": found.tile.map(|(slab, _)| slab),
            "tile": found.tile.map(|(_, tile)| tile),
            "message": found.message,
        })
    };
    let version = structure.map(|structure| format!("{}.{}", structure.version().0, structure.version().1));
    let findings: Vec<Value> = findings.iter().map(finding).collect();
    json!({ "file": file, "valid": valid, "version": version, "findings": findings })
}

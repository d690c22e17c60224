//! Looking for everything that is wrong with a file.

use std::io::{Read, Seek};

use lf_format::{ChunkEntry, FileReader, FormatError, Limits, Packing, Structure, Tag};

use crate::check::check_tile;
use crate::error::PackError;

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// Against a recommendation of the specification.
    Warning,
    /// A rule is broken, or the file cannot be read.
    Error,
}

/// Something that was found in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// A name for programs that does not change between versions of this crate.
    pub id: &'static str,
    /// The clause of the specification, such as `§4.5`.
    pub clause: Option<&'static str>,
    /// The byte of the file where it is, or where the chunk begins that it is in.
    pub offset: Option<u64>,
    /// Slab and tile, if it is in a tile.
    pub tile: Option<(u32, u32)>,
    /// What it is, in a sentence.
    pub message: String,
}

/// Raw length of tiles above which a writer is warned (spec §10), bytes.
const LARGE_TILE: u64 = 64 << 20;
/// The metadata keys that `spec/registry.md` lists.
const STANDARD_KEYS: [&str; 6] = ["attribution", "coverage", "created-by-preset", "generator", "license", "scene"];

/// Checks a file against every rule of the specification and hands each finding to `report`. One tile at a time is held in
/// memory. Returns the structure of the file, if that is sound.
///
/// # Errors
/// [`FormatError::Io`] if the input cannot be read.
pub fn validate<R: Read + Seek>(
    input: R,
    limits: &Limits,
    mut report: impl FnMut(Finding),
) -> Result<Option<Structure>, FormatError> {
    let mut file = match FileReader::open(input, limits) {
        Err(error @ FormatError::Io { .. }) => return Err(error),
        Err(error) => {
            report(Finding::new(Severity::Error, &error));
            return Ok(None);
        }
        Ok(file) => file,
    };
    file.verify(|error| report(Finding::new(Severity::Error, &error)))?;
    check_tiles(&mut file, &mut report)?;
    advise(&file, &mut report);
    Ok(Some(Structure::clone(&file)))
}

/// Checks what is inside each tile whose checksum is right.
fn check_tiles<R: Read + Seek>(file: &mut FileReader<R>, report: &mut impl FnMut(Finding)) -> Result<(), FormatError> {
    let (tilings, chunks) = (file.tilings().to_vec(), file.chunks().to_vec());
    let mut buffer = Vec::new();
    for entry in chunks.iter().filter(|entry| entry.tag == Tag::TILE) {
        let mut budget = file.budget();
        let found = budget.take("a tile", entry.raw_len.saturating_add(entry.stored_len)).and_then(|()| {
            let slab = entry.slab as usize;
            let stored = file.tile(slab, entry.tile, &mut buffer)?;
            Ok(check_tile(&stored, &tilings[slab], slab, entry.tile))
        });
        match found {
            // A wrong checksum, which `verify` has found already.
            Ok(Ok(())) | Err(FormatError::Malformed { .. }) => {}
            Ok(Err(error)) => report(Finding::in_tile(entry, &error)),
            Err(error @ FormatError::Io { .. }) => return Err(error),
            Err(error) => report(Finding { offset: Some(entry.offset), ..Finding::new(Severity::Error, &error) }),
        }
    }
    Ok(())
}

/// What is allowed, but not as it should be or might be expected.
fn advise(file: &Structure, report: &mut impl FnMut(Finding)) {
    let (major, minor) = file.version();
    if minor > 0 {
        let message = format!("the file is of version {major}.{minor}; what that adds to 1.0 is not looked at");
        report(Finding::advice(Severity::Note, "note.minor-version", "§9.1", 14, message));
    }
    for entry in file.chunks() {
        if !entry.tag.is_known() {
            let message = format!("{entry} is of a kind that is not known; only its checksum is looked at");
            report(Finding::advice(Severity::Note, "note.unknown-chunk", "§4.2", entry.offset, message));
        }
        if entry.tag == Tag::TILE && entry.packing != Packing::None && entry.stored_len >= entry.raw_len {
            let message = format!("{entry} is no shorter for being packed");
            report(Finding::advice(Severity::Warning, "warning.packing", "§7.5", entry.offset, message));
        }
        if entry.tag == Tag::TILE && entry.raw_len > LARGE_TILE {
            let message = format!("{entry} has {} bytes unpacked; readers may have memory for less", entry.raw_len);
            report(Finding::advice(Severity::Warning, "warning.tile-size", "§10", entry.offset, message));
        }
    }
    let unknown =
        file.metadata().iter().map(|(key, _)| key).filter(|key| !key.contains('.') && !STANDARD_KEYS.contains(key));
    for key in unknown {
        let message = format!("the metadata key {key} is neither registered nor private");
        let at = file.chunks().iter().find(|entry| entry.tag == Tag::META).map_or(0, |entry| entry.offset);
        report(Finding::advice(Severity::Warning, "warning.metadata-key", "§8.5", at, message));
    }
}

impl Finding {
    fn new(severity: Severity, error: &FormatError) -> Self {
        let rule = error.broken_rule();
        let (clause, offset) = (rule.map(|(rule, _)| rule.clause()), rule.map(|(_, offset)| offset));
        Self { severity, id: error.id(), clause, offset, tile: None, message: error.to_string() }
    }

    fn in_tile(entry: &ChunkEntry, error: &PackError) -> Self {
        let (id, clause) = match error {
            PackError::Tile { rule, .. } => (rule.id(), Some(rule.clause())),
            _ => ("tile", None),
        };
        let (offset, tile) = (Some(entry.offset), Some((entry.slab, entry.tile)));
        Self { severity: Severity::Error, id, clause, offset, tile, message: error.to_string() }
    }

    fn advice(severity: Severity, id: &'static str, clause: &'static str, offset: u64, message: String) -> Self {
        Self { severity, id, clause: Some(clause), offset: Some(offset), tile: None, message }
    }
}

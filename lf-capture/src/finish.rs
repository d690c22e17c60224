//! From journals to the file.

use std::path::Path;

use lf_format::{Contents, Metadata, Packing, SlabTiling, Writer};

use crate::error::CaptureError;
use crate::journal::{Journal, Totals};
use crate::plan::{Plan, TileId};

/// Writes the `.lfslab` file of a capture, and beside it that of the inverse depths if they were captured; returns what the journals
/// hold. The journals are left as they are.
///
/// Together they must be one capture: one journal of the whole, or one of each shard. Files appear whole or not at all.
///
/// # Errors
/// [`CaptureError::Foreign`], [`CaptureError::DuplicateShard`], [`CaptureError::MissingShards`] or
/// [`CaptureError::Unfinished`] if they are not; [`CaptureError::DepthFile`] if `depth` is given without inverse depths or
/// the other way round; [`CaptureError::Format`] if a file cannot be written.
pub fn write_files(journals: &mut [Journal], out: &Path, depth: Option<&Path>) -> Result<Totals, CaptureError> {
    check_shards(journals)?;
    let Some(plan) = journals.first().map(|journal| journal.plan().clone()) else {
        return Err(CaptureError::MissingShards { missing: vec![1], count: 1 });
    };
    match (depth, plan.depth_tilings()) {
        (Some(path), Some(tilings)) => write(journals, &plan, tilings, plan.depth_metadata()?, path, true)?,
        (None, None) => {}
        (_, tilings) => return Err(CaptureError::DepthFile { captured: tilings.is_some() }),
    }
    write(journals, &plan, plan.tilings(), plan.metadata.clone(), out, false)?;
    Ok(journals.iter().map(Journal::totals).fold(Totals::default(), Totals::plus))
}

/// Makes sure that the journals are all shards of one capture, each once and finished.
fn check_shards(journals: &[Journal]) -> Result<(), CaptureError> {
    let Some(first) = journals.first() else { return Ok(()) };
    for (i, journal) in journals.iter().enumerate() {
        let differences = first.header().differences(journal.header(), "shard");
        if !differences.is_empty() {
            return Err(CaptureError::Foreign { path: journal.path().to_owned(), differences });
        }
        let shard = journal.shard();
        if let Some(other) = journals[..i].iter().find(|other| other.shard() == shard) {
            let [first, second] = [other, journal].map(|journal| journal.path().to_owned());
            return Err(CaptureError::DuplicateShard { shard, first, second });
        }
    }
    let count = first.shard().count();
    let given = |number: &u32| journals.iter().any(|journal| journal.shard().number() == *number);
    let missing: Vec<u32> = (1..=count).filter(|number| !given(number)).collect();
    if !missing.is_empty() {
        return Err(CaptureError::MissingShards { missing, count });
    }
    let unfinished =
        journals.iter().map(|journal| (journal, journal.missing().len())).find(|(_, missing)| *missing > 0);
    unfinished.map_or(Ok(()), |(journal, missing)| {
        Err(CaptureError::Unfinished { path: journal.path().to_owned(), missing, tiles: journal.tile_count() })
    })
}

fn write(
    journals: &mut [Journal],
    plan: &Plan,
    tilings: &[SlabTiling],
    metadata: Metadata,
    out: &Path,
    depth: bool,
) -> Result<(), CaptureError> {
    let mut writer = Writer::create(out, Contents::new(plan.geometry().clone(), tilings.to_vec(), metadata))?;
    while let Some((slab, tile)) = writer.next_tile() {
        let (packing, bytes) = read(journals, TileId { slab, tile }, depth)?;
        writer.tile(packing, &bytes)?;
    }
    writer.save()?;
    Ok(())
}

/// A tile's bytes from the journal that holds it.
fn read(journals: &mut [Journal], id: TileId, depth: bool) -> Result<(Packing, Vec<u8>), CaptureError> {
    for journal in &mut *journals {
        if let Some(found) = journal.read(id, depth)? {
            return Ok(found);
        }
    }
    // Not after they were found to be finished.
    Err(CaptureError::MissingShards { missing: vec![], count: journals.len() as u32 })
}

//! `lfslab capture` and `lfslab merge`: scene in, file out, with a journal between.

use std::ffi::OsString;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use lf_capture::{CaptureError, Journal, Options, Outcome, Plan, Shard, Totals, capture, write_files};
use lf_format::Metadata;
use lf_math::LightFieldGeometry;
use lf_scene::FocusRule;

use crate::args::Sampling;
use crate::capture_args::{CaptureArgs, MergeArgs};
use crate::output::{check_distinct, check_writable, megabytes, print};
use crate::progress::{CaptureProgress, rate};
use crate::sources::Source;

/// A capture was stopped by the user, and can be resumed.
#[derive(Debug)]
pub(crate) struct Stopped(String);

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Stopped {}

/// What a capture made, and what it took.
pub(crate) struct Captured {
    pub(crate) file_bytes: u64,
    /// Rays traced for texels.
    pub(crate) rays: u64,
    pub(crate) time: Duration,
    /// Of the traced texels as they are stored.
    pub(crate) psnr: f64,
}

pub(crate) fn run(args: &CaptureArgs) -> Result<()> {
    let shard = args.shard.unwrap_or(Shard::WHOLE);
    let path = journal_path(&args.out, shard);
    check_outputs(&args.out, args.depth.as_deref(), &[("the journal".to_owned(), &path)])?;
    refuse_to_forget(args, &path)?;
    if let Some(threads) = args.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global().context("--threads")?;
    }
    let stop = stop_on_signal()?;
    let source = Source::load(&args.scene)?;
    let plan = survey(&source, &sampling(args), args.focus.0, options(args))?;
    if args.restart {
        // Not before the new capture is sure to begin.
        Journal::discard(&path)?;
    }
    let mut journal = begin(&path, &plan, shard)?;
    if trace(&source, &mut journal, &stop).with_context(|| kept(&journal))? == Outcome::Stopped {
        return Err(Stopped(kept(&journal)).into());
    }
    if shard == Shard::WHOLE {
        let bytes = finish(journal, &args.out, args.depth.as_deref())?;
        return print(&format!("{}: {}", args.out.display(), megabytes(bytes)));
    }
    let bytes = megabytes(journal.totals().bytes);
    print(&format!("{}: shard {shard}, {bytes}; put all shards together with lfslab merge", path.display()))
}

pub(crate) fn run_merge(args: &MergeArgs) -> Result<()> {
    let given = (1..).zip(&args.journals).map(|(number, path)| (format!("journal {number}"), path.as_path()));
    check_outputs(&args.out, args.depth.as_deref(), &given.collect::<Vec<_>>())?;
    let mut journals = args.journals.iter().map(|path| Journal::open(path)).collect::<Result<Vec<_>, _>>()?;
    let merged = write_files(&mut journals, &args.out, args.depth.as_deref());
    let totals = merged.map_err(|error| {
        let advice = match error {
            CaptureError::Unfinished { .. } => "; run its command again with --resume",
            CaptureError::DepthFile { captured: true } => "; name it by --depth FILE",
            _ => "",
        };
        anyhow::Error::new(error).context(format!("cannot make {}{advice}", args.out.display()))
    })?;
    eprintln!("merge    {} tiles of {} journals, {}", totals.tiles, journals.len(), quality(&totals));
    print(&format!("{}: {}", args.out.display(), megabytes(std::fs::metadata(&args.out)?.len())))
}

/// Captures into a file in one go, whatever an earlier such run left. Its journal has another name than that of `lfslab capture`,
/// which may be hours of work.
pub(crate) fn capture_to(
    source: &Source,
    sampling: &Sampling,
    rule: FocusRule,
    options: Options,
    out: &Path,
) -> Result<Captured> {
    let start = Instant::now();
    let plan = survey(source, sampling, rule, options)?;
    let path = with_suffix(out, ".demo.part");
    Journal::discard(&path)?;
    let mut journal = begin(&path, &plan, Shard::WHOLE)?;
    trace(source, &mut journal, &AtomicBool::new(false))?;
    let totals = journal.totals();
    let file_bytes = finish(journal, out, None)?;
    let rays = totals.traced * plan.rays_per_texel();
    Ok(Captured { file_bytes, rays, time: start.elapsed(), psnr: totals.psnr() })
}

fn sampling(args: &CaptureArgs) -> Sampling {
    let preset = args.preset.sampling();
    Sampling {
        cameras: args.cameras.unwrap_or(preset.cameras),
        resolution: args.resolution.unwrap_or(preset.resolution),
        placement: args.planes.map_or(preset.placement, |planes| planes.0),
        grid: args.supersample.unwrap_or(preset.grid),
    }
}

fn options(args: &CaptureArgs) -> Options {
    let (encoding, pack) = args.encoding.options();
    Options { grid: sampling(args).grid, encoding, pack, whole: args.whole, depth: args.depth.is_some() }
}

/// The journal of a file: beside it.
fn journal_path(out: &Path, shard: Shard) -> PathBuf {
    if shard == Shard::WHOLE {
        return with_suffix(out, ".part");
    }
    with_suffix(out, &format!(".{}-of-{}.part", shard.number(), shard.count()))
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(suffix);
    name.into()
}

/// Refuses files that cannot be written, or would be written over each other or over a journal.
fn check_outputs(out: &Path, depth: Option<&Path>, journals: &[(String, &Path)]) -> Result<()> {
    let named = [("--out", Some(out)), ("--depth", depth)];
    let outputs = named.into_iter().filter_map(|(name, path)| Some((name.to_owned(), path?)));
    let outputs: Vec<(String, &Path)> = outputs.collect();
    outputs.iter().try_for_each(|(_, path)| check_writable(path))?;
    check_distinct(&[journals, &outputs].concat())
}

/// Refuses to begin where a journal lies, unless it was said what is to become of it.
fn refuse_to_forget(args: &CaptureArgs, path: &Path) -> Result<()> {
    if !args.resume && !args.restart && path.exists() {
        bail!("{} holds an unfinished capture: --resume goes on with it, --restart begins anew", path.display());
    }
    Ok(())
}

/// A flag that is set by Ctrl-C or a polite kill; the second one ends the program at once.
fn stop_on_signal() -> Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let handler = move || {
        if flag.swap(true, Ordering::Relaxed) {
            process::exit(130);
        }
        eprintln!("\nstopping: finished tiles are kept; once more to quit at once");
    };
    ctrlc::set_handler(handler).context("cannot watch for Ctrl-C")?;
    Ok(stop)
}

/// Finds the focal planes and what is needed, and says what will be done.
fn survey(source: &Source, sampling: &Sampling, rule: FocusRule, options: Options) -> Result<Plan> {
    let &Sampling { cameras: [s, t], resolution: [u, v], placement, grid } = sampling;
    let geometry = LightFieldGeometry::around_with(source.cell, placement, sampling.cameras, sampling.resolution)?;
    let start = Instant::now();
    let plan = Plan::survey_by(&source.tracer, &geometry, rule, options, metadata(source)?)?;
    let stored: u64 = plan.tilings().iter().map(|tiling| tiling.coverage().texels()).sum();
    eprintln!(
        "capture  6 slabs of {s}×{t} cameras × {u}×{v} texels, {grid}×{grid} rays each; surveyed in {:.1} s, {:.1} % of \
         the texels to be stored in {} tiles",
        start.elapsed().as_secs_f64(),
        100.0 * stored as f64 / plan.all_texels() as f64,
        plan.tiles().len()
    );
    Ok(plan)
}

/// Begins a journal, or goes on with the one that is there.
fn begin(path: &Path, plan: &Plan, shard: Shard) -> Result<Journal> {
    if !path.exists() {
        return Ok(Journal::create(path, plan, shard)?);
    }
    let journal = Journal::resume(path, plan, shard).map_err(|error| {
        let advice = match error {
            CaptureError::InUse { .. } => "wait for it",
            _ => "give the options that it was begun with, or --restart",
        };
        anyhow::Error::new(error).context(format!("cannot resume ({advice})"))
    })?;
    eprintln!("resume   {} tiles are in {}", journal.totals().tiles, path.display());
    Ok(journal)
}

/// Captures what a journal lacks, telling how far it has come.
fn trace(source: &Source, journal: &mut Journal, stop: &AtomicBool) -> Result<Outcome> {
    let progress = CaptureProgress::new();
    let outcome = capture(&source.tracer, journal, &|now| progress.report(now), stop);
    let (rays, elapsed) = progress.finish();
    let outcome = outcome?;
    if outcome == Outcome::Finished {
        tell(journal, rays, elapsed);
    }
    Ok(outcome)
}

/// What is left of a capture that ended too soon.
fn kept(journal: &Journal) -> String {
    let (path, tiles) = (journal.path().display(), journal.totals().tiles);
    let all = tiles + journal.missing().len();
    format!("stopped: {tiles} of {all} tiles are in {path}; the same command with --resume goes on")
}

/// The last line of a capture: this run's rays, and what is in the journal.
fn tell(journal: &Journal, rays: u64, elapsed: Duration) {
    let totals = journal.totals();
    let share = match journal.shard() {
        Shard::WHOLE => {
            let share = 100.0 * totals.traced as f64 / journal.plan().all_texels() as f64;
            format!("; {share:.1} % of the texels were traced")
        }
        _ => String::new(),
    };
    eprintln!(
        "         {:.1} s, {:.1} million rays, {:.2} million a second{share}; {}",
        elapsed.as_secs_f64(),
        rays as f64 / 1e6,
        rate(rays, elapsed),
        quality(&totals)
    );
}

fn quality(totals: &Totals) -> String {
    let psnr = totals.psnr();
    if psnr.is_finite() { format!("stored at {psnr:.2} dB") } else { "lossless".to_owned() }
}

/// Makes the files of a finished journal, which is removed; the length of the first.
fn finish(journal: Journal, out: &Path, depth: Option<&Path>) -> Result<u64> {
    let mut journals = [journal];
    write_files(&mut journals, out, depth)?;
    let [journal] = journals;
    journal.remove()?;
    Ok(std::fs::metadata(out).with_context(|| out.display().to_string())?.len())
}

/// Who made the file from what.
fn metadata(source: &Source) -> Result<Metadata> {
    let mut metadata = Metadata::new();
    metadata.insert("generator", concat!("lfslab ", env!("CARGO_PKG_VERSION")))?;
    metadata.insert("scene", source.name())?;
    if let Some(license) = &source.license {
        // A line of a file that we did not write: kept short and without control characters, whatever it holds.
        let line: String = license.chars().filter(|c| !c.is_control()).take(1000).collect();
        metadata.insert("license", line)?;
    }
    Ok(metadata)
}

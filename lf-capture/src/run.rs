//! Tracing and encoding tiles on all threads.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use lf_math::NeededTexels;
use lf_scene::{TexelSampler, Tracer};

use crate::error::CaptureError;
use crate::image::{CameraImage, ImageJob, is_traced};
use crate::journal::Journal;
use crate::plan::{Plan, TileId};
use crate::tile::EncodedTile;

/// How a capture ended without an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The journal holds all its tiles.
    Finished,
    /// It was stopped; the journal can be resumed.
    Stopped,
}

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Texels of the run's windows that are done, traced or not.
    pub texels: u64,
    /// Of so many.
    pub all_texels: u64,
    /// Rays traced by this run, secondary rays and those for depth not counted.
    pub rays: u64,
}

/// Captures the tiles that a journal lacks, on all threads of the current rayon pool.
///
/// Threads take camera images one by one, in the order of the tiles; whoever traces a tile's last one encodes the tile and
/// appends it. The bytes of a tile depend on nothing but the plan. `progress` is called after each image, from any thread. When
/// `stop` is set, threads end at the next row of texels; tiles whose images are all traced are still encoded.
///
/// # Errors
/// The first that occurs: the disk is full, say. What was finished before is in the journal.
///
/// # Panics
/// If the tracer does.
pub fn capture(
    tracer: &Tracer,
    journal: &mut Journal,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<Outcome, CaptureError> {
    let plan = journal.plan().clone();
    let run = Run::new(tracer, &plan, journal, progress, stop);
    rayon::broadcast(|_| run.work());
    let failed = run.failed.into_inner().unwrap_or_else(PoisonError::into_inner);
    failed.map_or(Ok(()), Err)?;
    Ok(if journal.missing().is_empty() { Outcome::Finished } else { Outcome::Stopped })
}

struct Run<'a> {
    tracer: &'a Tracer,
    plan: &'a Plan,
    needed: Option<Vec<NeededTexels>>,
    /// All images to trace, those of a tile one after the other.
    units: Vec<(TileId, [u32; 2])>,
    next: AtomicUsize,
    /// Tiles of which some image is traced or being traced.
    open: Mutex<HashMap<TileId, OpenTile>>,
    journal: Mutex<&'a mut Journal>,
    failed: Mutex<Option<CaptureError>>,
    halt: AtomicBool,
    stop: &'a AtomicBool,
    done: [AtomicU64; 2],
    all_texels: u64,
    progress: &'a (dyn Fn(Progress) + Sync),
}

struct OpenTile {
    images: Vec<([u32; 2], CameraImage)>,
    waiting: usize,
}

impl<'a> Run<'a> {
    fn new(
        tracer: &'a Tracer,
        plan: &'a Plan,
        journal: &'a mut Journal,
        progress: &'a (dyn Fn(Progress) + Sync),
        stop: &'a AtomicBool,
    ) -> Self {
        let tiles = journal.missing();
        let cameras = |id: &TileId| {
            let tiling = &plan.tilings()[id.slab];
            let [columns, rows] = tiling.cameras_of(id.tile);
            tiling.coverage().windowed(columns, rows).map(|camera| (*id, camera)).collect::<Vec<_>>()
        };
        let units: Vec<_> = tiles.iter().flat_map(cameras).collect();
        let texels = |(id, camera): &(TileId, [u32; 2])| {
            let window = plan.tilings()[id.slab].coverage().window(*camera);
            window.map_or(0, |[u, v]| u.len() as u64 * v.len() as u64)
        };
        let mut open: HashMap<TileId, OpenTile> = HashMap::new();
        for (id, _) in &units {
            open.entry(*id).or_insert(OpenTile { images: Vec::new(), waiting: 0 }).waiting += 1;
        }
        Self {
            tracer,
            plan,
            needed: plan.needed(),
            all_texels: units.iter().map(texels).sum(),
            units,
            next: AtomicUsize::new(0),
            open: Mutex::new(open),
            journal: Mutex::new(journal),
            failed: Mutex::new(None),
            halt: AtomicBool::new(false),
            stop,
            done: [AtomicU64::new(0), AtomicU64::new(0)],
            progress,
        }
    }

    /// What one thread does.
    fn work(&self) {
        while !self.stop.load(Ordering::Relaxed) && !self.halt.load(Ordering::Relaxed) {
            let Some(&(id, camera)) = self.units.get(self.next.fetch_add(1, Ordering::Relaxed)) else { return };
            let Some(image) = self.image(id, camera) else { return };
            self.report(&image);
            if let Err(error) = self.finished(id, camera, image).map_or(Ok(()), |images| self.encode(id, &images)) {
                self.halt.store(true, Ordering::Relaxed);
                held(&self.failed).get_or_insert(error);
            }
        }
    }

    /// Traces an image; `None` if the run was stopped.
    fn image(&self, id: TileId, camera: [u32; 2]) -> Option<CameraImage> {
        let window = self.plan.tilings()[id.slab].coverage().window(camera)?;
        let needed = self.needed.as_ref().map(|needed| needed[id.slab].image(camera, window.clone()));
        let sampler = TexelSampler::new(self.tracer, self.plan.geometry(), self.plan.options().grid);
        let depth = self.plan.options().depth;
        ImageJob { sampler, slab: id.slab, camera, window, needed, depth }.run(self.stop)
    }

    /// Keeps an image until its tile is complete; then all of the tile's.
    fn finished(&self, id: TileId, camera: [u32; 2], image: CameraImage) -> Option<Vec<([u32; 2], CameraImage)>> {
        let mut open = held(&self.open);
        let tile = open.get_mut(&id)?;
        tile.images.push((camera, image));
        tile.waiting -= 1;
        (tile.waiting == 0).then(|| open.remove(&id))?.map(|tile| tile.images)
    }

    fn encode(&self, id: TileId, images: &[([u32; 2], CameraImage)]) -> Result<(), CaptureError> {
        let tile = EncodedTile::new(self.plan, id, images)?;
        held(&self.journal).append(&tile)
    }

    fn report(&self, image: &CameraImage) {
        let traced = image.texels.iter().filter(|texel| is_traced(texel)).count() as u64;
        let added = [image.texels.len() as u64, traced * self.plan.rays_per_texel()];
        let [texels, rays] = [0, 1].map(|i| self.done[i].fetch_add(added[i], Ordering::Relaxed) + added[i]);
        (self.progress)(Progress { texels, all_texels: self.all_texels, rays });
    }
}

/// What a mutex guards. A thread that panicked with it takes the whole run down anyway.
fn held<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

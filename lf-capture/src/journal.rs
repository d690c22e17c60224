//! The file that finished tiles are appended to while a light field is captured.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `LFSPART1` |
//! | 4, 8 | length of the header, xxHash64 of it |
//! | | the header: plan and shard as JSON |
//! | 56 each, and payloads | records, one for each tile, in the order in which they were finished |
//!
//! A record is: xxHash64 of all that follows; slab, tile (4 bytes each); traced texels, squared error, length of the
//! radiance's bytes, length of the depth's (8 each); packing of the radiance, of the depth (4 each); the bytes. All numbers are little endian. A record
//! is appended in one write and flushed to the disk. What is not a whole record with a right checksum ends the journal: it
//! is what a killed process or a full disk left, and is written over.
//!
//! Whoever has a journal open holds a lock on it.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use lf_format::Packing;
use xxhash_rust::xxh64::{Xxh64, xxh64};

use crate::error::{CaptureError, io_error};
use crate::header::Header;
use crate::plan::{Plan, TileId};
use crate::shard::Shard;
use crate::tile::EncodedTile;

const MAGIC: &[u8; 8] = b"LFSPART1";
/// Bytes before the header.
const PREFACE: u64 = 20;
/// A header is longer than this only if it is none: metadata ends at 1 MiB.
const MAX_HEADER: u64 = 4 << 20;
/// Bytes of a record before its payload.
const HEAD: usize = 56;

/// A capture in the making, or a finished shard of one. Holds one entry in memory for each tile.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    header: Header,
    plan: Plan,
    shard: Shard,
    records: BTreeMap<TileId, Record>,
    /// Where the next record begins.
    end: u64,
}

/// What a journal holds, summed over its tiles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Totals {
    /// Tiles.
    pub tiles: usize,
    /// Texels that were traced.
    pub traced: u64,
    /// Squared error of the traced texels as they are stored, summed over red, green and blue.
    pub squares: u64,
    /// Bytes of the packed tiles.
    pub bytes: u64,
}

/// Where a tile's bytes are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Record {
    /// Where the payload begins.
    offset: u64,
    traced: u64,
    squares: u64,
    /// Lengths and packings: radiance, depth.
    lengths: [u64; 2],
    packings: [Packing; 2],
}

impl Totals {
    /// Peak signal-to-noise ratio of the traced texels as they are stored, dB; infinite if nothing is lost.
    #[must_use]
    pub fn psnr(&self) -> f64 {
        let peak = 3.0 * 255.0 * 255.0 * self.traced as f64;
        10.0 * (peak / self.squares as f64).log10()
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            tiles: self.tiles + other.tiles,
            traced: self.traced.saturating_add(other.traced),
            squares: self.squares.saturating_add(other.squares),
            bytes: self.bytes.saturating_add(other.bytes),
        }
    }
}

impl Journal {
    /// Begins a journal.
    ///
    /// # Errors
    /// [`CaptureError::Io`] if there is such a file, or it cannot be written; [`CaptureError::InUse`].
    pub fn create(path: &Path, plan: &Plan, shard: Shard) -> Result<Self, CaptureError> {
        let header = Header::new(plan, shard);
        let json = serde_json::to_vec_pretty(&header)
            .map_err(|e| CaptureError::NotAJournal { path: path.to_owned(), what: e.to_string() })?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend((json.len() as u32).to_le_bytes());
        bytes.extend(xxh64(&json, 0).to_le_bytes());
        bytes.extend(json);
        let file = begin(path, &bytes).map_err(io_error("begin the journal", path))?;
        let end = bytes.len() as u64;
        let records = BTreeMap::new();
        Ok(Self { path: path.to_owned(), file, header, plan: plan.clone(), shard, records, end })
    }

    /// Deletes what is at a path, a journal or not, unless some run is writing it. If nothing is there, nothing is done.
    ///
    /// # Errors
    /// [`CaptureError::InUse`], [`CaptureError::Io`].
    pub fn discard(path: &Path) -> Result<(), CaptureError> {
        match OpenOptions::new().write(true).open(path) {
            Ok(file) => lock(&file, path)?,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            Err(error) => return Err(io_error("remove", path)(error)),
        }
        fs::remove_file(path).map_err(io_error("remove", path))
    }

    /// Opens a journal that some run of the same capture left, to go on with it.
    ///
    /// # Errors
    /// [`CaptureError::Foreign`] if anything that decides the bytes of the file differs; as [`Self::open`].
    pub fn resume(path: &Path, plan: &Plan, shard: Shard) -> Result<Self, CaptureError> {
        let journal = Self::open(path)?;
        let differences = Header::new(plan, shard).differences(&journal.header, "");
        if !differences.is_empty() {
            return Err(CaptureError::Foreign { path: path.to_owned(), differences });
        }
        Ok(Self { plan: plan.clone(), ..journal })
    }

    /// Opens a journal. All of it is read once, to check it.
    ///
    /// # Errors
    /// [`CaptureError::NotAJournal`], [`CaptureError::InUse`], or [`CaptureError::Io`] if it cannot be read.
    pub fn open(path: &Path) -> Result<Self, CaptureError> {
        let file = OpenOptions::new().read(true).write(true).open(path).map_err(io_error("open", path))?;
        lock(&file, path)?;
        let not = |what: String| CaptureError::NotAJournal { path: path.to_owned(), what };
        let (header, start) = read_header(&file).map_err(io_error("read", path))?.map_err(not)?;
        let shard = header.shard().ok_or_else(|| not("it names a shard that there is not".to_owned()))?;
        let plan = header.plan().map_err(|error| not(error.to_string()))?;
        let (records, end) = read_records(&file, start, &plan).map_err(io_error("read", path))?;
        Ok(Self { path: path.to_owned(), file, header, plan, shard, records, end })
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What is captured. Of a journal that was [opened](Self::open) without knowing, the options of the block encoder are not told.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Which part of the tiles it is for.
    #[must_use]
    pub fn shard(&self) -> Shard {
        self.shard
    }

    /// The tiles that it is for and does not hold yet, in the order of [`Plan::tiles`].
    #[must_use]
    pub fn missing(&self) -> Vec<TileId> {
        self.tiles().filter(|id| !self.records.contains_key(id)).collect()
    }

    /// What it holds.
    #[must_use]
    pub fn totals(&self) -> Totals {
        self.records.values().map(Record::totals).fold(Totals::default(), Totals::plus)
    }

    /// Ends the capture: deletes the file.
    ///
    /// # Errors
    /// [`CaptureError::Io`].
    pub fn remove(self) -> Result<(), CaptureError> {
        // Some systems do not delete what is open.
        drop(self.file);
        fs::remove_file(&self.path).map_err(io_error("remove", &self.path))
    }

    /// The tiles that it is for.
    fn tiles(&self) -> impl Iterator<Item = TileId> {
        let all = self.plan.tiles().into_iter().enumerate();
        all.filter(|(position, _)| self.shard.holds(*position)).map(|(_, id)| id)
    }

    pub(crate) fn tile_count(&self) -> usize {
        self.tiles().count()
    }

    pub(crate) fn header(&self) -> &Header {
        &self.header
    }

    /// Adds a tile and flushes it to the disk.
    pub(crate) fn append(&mut self, tile: &EncodedTile) -> Result<(), CaptureError> {
        let (bytes, record) = Record::write(tile, self.end);
        let write = |file: &mut File| {
            file.seek(SeekFrom::Start(self.end))?;
            file.write_all(&bytes)?;
            file.sync_data()
        };
        write(&mut self.file).map_err(io_error("write", &self.path))?;
        self.end += bytes.len() as u64;
        self.records.insert(tile.id, record);
        Ok(())
    }

    /// The packed bytes of a tile, of its radiance or its depth; `None` if it does not hold the tile.
    pub(crate) fn read(&mut self, id: TileId, depth: bool) -> Result<Option<(Packing, Vec<u8>)>, CaptureError> {
        let Some(record) = self.records.get(&id) else { return Ok(None) };
        let [radiance, _] = record.lengths;
        let place = usize::from(depth);
        let offset = record.offset + if depth { radiance } else { 0 };
        let mut bytes = Vec::new();
        let mut read = |file: &mut File| {
            file.seek(SeekFrom::Start(offset))?;
            file.take(record.lengths[place]).read_to_end(&mut bytes)
        };
        read(&mut self.file).map_err(io_error("read", &self.path))?;
        Ok(Some((record.packings[place], bytes)))
    }
}

/// A new file that appears under its name with these bytes and its lock held, or not at all.
fn begin(path: &Path, bytes: &[u8]) -> io::Result<File> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    // What a kill leaves under such a name is swept by whoever next writes a file there.
    builder.prefix(".lfslab-").suffix(".tmp");
    // Without this the file could be read by its owner only. The system takes the umask off.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    // Nobody else knows its name; where there are no locks, none is needed.
    let _ = file.as_file().try_lock();
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist_noclobber(path).map_err(|error| error.error)
}

fn lock(file: &File, path: &Path) -> Result<(), CaptureError> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(CaptureError::InUse { path: path.to_owned() }),
        // A file system without locks is no reason not to work.
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(()),
        Err(TryLockError::Error(source)) => Err(io_error("lock", path)(source)),
    }
}

/// The header and where the records begin, or what is wrong.
fn read_header(file: &File) -> io::Result<Result<(Header, u64), String>> {
    let mut preface = Vec::new();
    file.take(PREFACE).read_to_end(&mut preface)?;
    let Some(preface) = preface.first_chunk::<{ PREFACE as usize }>().filter(|bytes| bytes.starts_with(MAGIC)) else {
        return Ok(Err("it does not begin like one".to_owned()));
    };
    let [len, checksum] = [u64::from(number32(preface, 8)), number64(preface, 12)];
    if len > MAX_HEADER {
        return Ok(Err(format!("its header would have {len} bytes")));
    }
    let mut json = Vec::new();
    file.take(len).read_to_end(&mut json)?;
    if json.len() as u64 != len || xxh64(&json, 0) != checksum {
        return Ok(Err("its header is not whole".to_owned()));
    }
    let header = serde_json::from_slice(&json).map_err(|e| format!("its header is that of another version: {e}"));
    Ok(header.map(|header| (header, PREFACE + len)))
}

/// All whole records from `start` on, and where they end.
fn read_records(mut file: &File, start: u64, plan: &Plan) -> io::Result<(BTreeMap<TileId, Record>, u64)> {
    let len = file.metadata()?.len();
    file.seek(SeekFrom::Start(start))?;
    let mut input = BufReader::with_capacity(1 << 20, file);
    let (mut records, mut end) = (BTreeMap::new(), start);
    let tiles: std::collections::BTreeSet<TileId> = plan.tiles().into_iter().collect();
    while len - end >= HEAD as u64 {
        let mut head = [0; HEAD];
        input.read_exact(&mut head)?;
        let Some((id, record)) = Record::parse(&head, end) else { break };
        let Some(next) = record.end().filter(|&next| next <= len && tiles.contains(&id)) else { break };
        if payload_hash(&mut input, &head, next - record.offset)? != number64(&head, 0) {
            break;
        }
        records.insert(id, record);
        end = next;
    }
    Ok((records, end))
}

/// The checksum of a record whose payload, of so many bytes, comes next.
fn payload_hash(input: &mut impl Read, head: &[u8; HEAD], mut left: u64) -> io::Result<u64> {
    let mut hash = Xxh64::new(0);
    hash.update(&head[8..]);
    let mut piece = vec![0; left.min(1 << 16) as usize];
    while left > 0 {
        let len = left.min(piece.len() as u64) as usize;
        input.read_exact(&mut piece[..len])?;
        hash.update(&piece[..len]);
        left -= len as u64;
    }
    Ok(hash.digest())
}

impl Record {
    /// A record to stand at `start`: its bytes and what is remembered of it.
    fn write(tile: &EncodedTile, start: u64) -> (Vec<u8>, Self) {
        let (packing, radiance) = &tile.radiance;
        let (depth_packing, depth) = tile.depth.as_ref().map_or((Packing::None, &[][..]), |(p, b)| (*p, b.as_slice()));
        let record = Self {
            offset: start + HEAD as u64,
            traced: tile.traced,
            squares: tile.squares,
            lengths: [radiance.len() as u64, depth.len() as u64],
            packings: [*packing, depth_packing],
        };
        let mut bytes = vec![0; 8];
        bytes.extend((tile.id.slab as u32).to_le_bytes());
        bytes.extend(tile.id.tile.to_le_bytes());
        let numbers = [record.traced, record.squares, record.lengths[0], record.lengths[1]];
        bytes.extend(numbers.into_iter().flat_map(u64::to_le_bytes));
        bytes.extend(record.packings.into_iter().flat_map(|packing| number_of(packing).to_le_bytes()));
        bytes.extend_from_slice(radiance);
        bytes.extend_from_slice(depth);
        let checksum = xxh64(&bytes[8..], 0);
        bytes[..8].copy_from_slice(&checksum.to_le_bytes());
        (bytes, record)
    }

    /// What stands at `start`; `None` if it is none.
    fn parse(head: &[u8; HEAD], start: u64) -> Option<(TileId, Self)> {
        let id = TileId { slab: number32(head, 8) as usize, tile: number32(head, 12) };
        let record = Self {
            offset: start.checked_add(HEAD as u64)?,
            traced: number64(head, 16),
            squares: number64(head, 24),
            lengths: [number64(head, 32), number64(head, 40)],
            packings: [packing_of(number32(head, 48))?, packing_of(number32(head, 52))?],
        };
        Some((id, record))
    }

    fn totals(&self) -> Totals {
        let bytes = self.lengths[0].saturating_add(self.lengths[1]);
        Totals { tiles: 1, traced: self.traced, squares: self.squares, bytes }
    }

    /// Where the next record begins; `None` if its lengths are absurd.
    fn end(&self) -> Option<u64> {
        self.offset.checked_add(self.lengths[0])?.checked_add(self.lengths[1])
    }
}

/// The packings that tiles are stored in, by their numbers in a journal.
const PACKINGS: [Packing; 3] = [Packing::None, Packing::Zstd, Packing::Tile];

fn number_of(packing: Packing) -> u32 {
    PACKINGS.iter().position(|&p| p == packing).map_or(u32::MAX, |number| number as u32)
}

fn packing_of(number: u32) -> Option<Packing> {
    PACKINGS.get(number as usize).copied()
}

/// The number at a place that lies within the bytes.
fn number32(bytes: &[u8], at: usize) -> u32 {
    (0..4).fold(0, |number, i| number | u32::from(bytes[at + i]) << (8 * i))
}

fn number64(bytes: &[u8], at: usize) -> u64 {
    u64::from(number32(bytes, at)) | u64::from(number32(bytes, at + 4)) << 32
}

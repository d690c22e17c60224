//! Replacing a file in one step.

use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use tempfile::NamedTempFile;

const PREFIX: &str = ".lfslab-";
const SUFFIX: &str = ".tmp";
/// Temporary files younger than this are left alone: their owner may not have locked them yet, and would have to begin anew.
const STALE_AFTER: Duration = Duration::from_secs(60);

/// A file in the making: `path` holds what it held before until [`commit`](Self::commit), and then all that was written,
/// whatever happens.
///
/// The bytes go to a temporary file in the same folder. To commit is to flush it to the disk and rename it onto `path`; on Unix
/// the folder is flushed too, if its file system can. Of several files that are committed to one path the last stays. Dropping
/// an `AtomicFile` removes the temporary file. The new file gets the permissions that any new file gets, not those of the one
/// it replaces. A symbolic link at `path`, to a regular file or to nothing, is itself replaced, not followed.
///
/// A process that is killed half-way leaves a file named `.lfslab-….tmp` behind. The owner of such a file holds a lock on
/// it; [`create`](Self::create) removes those in the folder that are a minute old and that nobody holds.
#[derive(Debug)]
pub struct AtomicFile {
    file: BufWriter<NamedTempFile>,
    path: PathBuf,
    /// A handle to flush the folder by.
    folder: Option<File>,
}

impl AtomicFile {
    /// Begins to write a file.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidInput`] if `path` names no file, or leads to something other than a regular file, such as a
    /// folder, a pipe or a device: a rename would put a file in its place. Otherwise whatever the file system returns.
    pub fn create(path: &Path) -> io::Result<Self> {
        let folder = folder_of(path)?;
        check_target(path)?;
        let handle = open_folder(folder)?;
        sweep(folder);
        Ok(Self { file: BufWriter::new(temporary_in(folder)?), path: path.to_owned(), folder: handle })
    }

    /// The path that the file will have.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Puts the file in place and returns its length in bytes.
    ///
    /// # Errors
    /// Whatever the file system returns. The target is then untouched and the temporary file is gone, if it can be removed; only if
    /// the last step fails, flushing the folder, the new file is already in place.
    pub fn commit(self) -> io::Result<u64> {
        let file = self.file.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.as_file().sync_all()?;
        let len = file.as_file().metadata()?.len();
        file.persist(&self.path).map_err(|error| error.error)?;
        self.folder.map_or(Ok(()), |folder| flush_folder(&folder))?;
        Ok(len)
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for AtomicFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Writes a file by [`AtomicFile`]: `path` holds either what it held before or all that `write` wrote.
///
/// # Errors
/// Those of [`AtomicFile`], and whatever `write` returns.
pub fn write_atomic(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut file = AtomicFile::create(path)?;
    write(&mut file)?;
    file.commit().map(drop)
}

/// The folder that `path` is in; an error if `path` does not name a file.
fn folder_of(path: &Path) -> io::Result<&Path> {
    let no_file = || io::Error::new(io::ErrorKind::InvalidInput, "the path does not name a file");
    path.file_name().ok_or_else(no_file)?;
    Ok(path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")))
}

/// Makes sure that a rename onto `path` replaces no device, pipe, socket or folder, nor a link to one (`/dev/stdout`).
fn check_target(path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(target) if target.is_file() => Ok(()),
        Ok(_) => {
            let what = "there is something that is not a regular file, which must not be replaced by one";
            Err(io::Error::new(io::ErrorKind::InvalidInput, what))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
    }
}

/// A handle to flush the folder by; opened early, so that what can fail fails before the target changes. Only Unix can
/// flush a folder.
fn open_folder(folder: &Path) -> io::Result<Option<File>> {
    cfg!(unix).then(|| File::open(folder)).transpose()
}

/// Flushes a folder; a file system that knows no such thing says that it is invalid, and has nothing to flush.
fn flush_folder(folder: &File) -> io::Result<()> {
    match folder.sync_all() {
        Err(error) if matches!(error.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => Ok(()),
        result => result,
    }
}

/// Removes what killed processes have left behind. Not being able to is no reason to fail.
fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        if name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX)) {
            let _ = remove_stale(&entry.path());
        }
    }
}

/// Removes a temporary file if it is old and nobody holds its lock. It is removed under the lock: an owner that gets the
/// lock later finds it gone.
fn remove_stale(path: &Path) -> io::Result<()> {
    let metadata = fs::symlink_metadata(path)?;
    let age = SystemTime::now().duration_since(metadata.modified()?).unwrap_or_default();
    if metadata.is_file() && age >= STALE_AFTER {
        // NFS locks only what is open for writing.
        let file = File::options().write(true).open(path)?;
        file.try_lock()?;
        fs::remove_file(path)?;
    }
    Ok(())
}

/// A temporary file with its lock held. One that was swept before it was locked is given up for another.
fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    loop {
        let file = temporary().tempfile_in(folder)?;
        // Some file systems have no locks; what is left behind there stays until someone deletes it.
        let swept = matches!(file.as_file().try_lock(), Err(TryLockError::WouldBlock)) || !file.path().try_exists()?;
        if !swept {
            return Ok(file);
        }
    }
}

fn temporary() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    // Without this the file could be read by its owner only. The system takes the umask off.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder
}

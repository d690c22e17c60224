//! Replacing a file in one step.

use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes a file so that `path` holds either what it held before or all that `write` wrote, whatever happens.
///
/// The bytes go to a temporary file in the same folder, which is flushed to the disk and then renamed onto `path`; on
/// Unix the folder is flushed too. The new file gets the permissions that any new file gets, not those of the one it
/// replaces. A symbolic link at `path` is itself replaced, not followed. A process that is killed half-way leaves a
/// file named `.lfslab-….tmp` behind, which can be deleted.
///
/// # Errors
/// Whatever `write` or the file system returns. The target is then untouched and the temporary file is gone; only if
/// the last step fails, flushing the folder, the new file is already in place.
pub fn write_atomic(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let folder = folder_of(path)?;
    let mut file = temporary().tempfile_in(folder)?;
    let mut out = BufWriter::new(file.as_file_mut());
    write(&mut out)?;
    out.flush()?;
    drop(out);
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    sync_folder(folder)
}

/// The folder that `path` is in; an error if `path` does not name a file.
fn folder_of(path: &Path) -> io::Result<&Path> {
    let no_file = || io::Error::new(io::ErrorKind::InvalidInput, "the path does not name a file");
    path.file_name().ok_or_else(no_file)?;
    Ok(path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")))
}

fn temporary() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".lfslab-").suffix(".tmp");
    // Without this the file could be read by its owner only. The system takes the umask off.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder
}

#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    std::fs::File::open(folder)?.sync_all()
}

#[cfg(not(unix))]
fn sync_folder(_folder: &Path) -> io::Result<()> {
    Ok(())
}

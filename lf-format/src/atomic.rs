//! Replacing a file in one step.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes a file so that `path` holds either what it held before or all that `write` wrote, whatever happens.
///
/// The bytes go to a temporary file in the same folder, which is flushed to the disk and then renamed onto `path`; on
/// Unix the folder is flushed too. The new file gets the permissions that any new file gets, not those of the one it
/// replaces. A symbolic link at `path`, to a regular file or to nothing, is itself replaced, not followed. A process that
/// is killed half-way leaves a file named `.lfslab-….tmp` behind, which can be deleted.
///
/// # Errors
/// [`io::ErrorKind::InvalidInput`] if `path` names no file, or leads to something other than a regular file, such as a
/// folder, a pipe or a device: a rename would put a file in its place. Otherwise whatever `write` or the file system
/// returns. The target is then untouched and the temporary file is gone; only if the last step fails, flushing the
/// folder, the new file is already in place.
pub fn write_atomic(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let folder = folder_of(path)?;
    check_target(path)?;
    let handle = open_folder(folder)?;
    let mut file = temporary().tempfile_in(folder)?;
    let mut out = BufWriter::new(file.as_file_mut());
    write(&mut out)?;
    out.flush()?;
    drop(out);
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    handle.map_or(Ok(()), |folder| folder.sync_all())
}

/// The folder that `path` is in; an error if `path` does not name a file.
fn folder_of(path: &Path) -> io::Result<&Path> {
    let no_file = || io::Error::new(io::ErrorKind::InvalidInput, "the path does not name a file");
    path.file_name().ok_or_else(no_file)?;
    Ok(path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")))
}

/// Makes sure that a rename onto `path` replaces no device, pipe, socket or folder, nor a link to one (`/dev/stdout`).
///
/// What cannot be looked at is left to the steps that follow: nothing is there, or they fail for the same reason.
fn check_target(path: &Path) -> io::Result<()> {
    if fs::metadata(path).is_ok_and(|target| !target.is_file()) {
        let what = "there is something that is not a regular file, which must not be replaced by one";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
    }
    Ok(())
}

/// A handle to flush the folder by; opened early, so that what can fail fails before the target changes. Only Unix can
/// flush a folder.
fn open_folder(folder: &Path) -> io::Result<Option<File>> {
    cfg!(unix).then(|| File::open(folder)).transpose()
}

fn temporary() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".lfslab-").suffix(".tmp");
    // Without this the file could be read by its owner only. The system takes the umask off.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder
}

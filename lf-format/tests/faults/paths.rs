//! Targets that are something else than a file with a plain name in a folder that can be written to.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
use std::path::Path;

use lf_format::FormatError;

use crate::child::{Ending, chain, command};
use crate::folder::Folder;
use crate::sample::{NEW, OLD, identify};
use crate::tools::{available, not_tested};

/// Saving must fail with this kind of error, whose text names the path and says `why`.
#[track_caller]
fn assert_refused(path: &Path, kind: io::ErrorKind, why: &str) {
    let error = NEW.save(path).unwrap_err();
    let text = chain(&error);
    assert!(matches!(&error, FormatError::Io { source, .. } if source.kind() == kind), "{error:?}");
    assert!(text.starts_with(&format!("could not write {}: ", path.display())) && text.contains(why), "{text}");
}

#[test]
fn what_cannot_be_a_file_is_refused_before_anything_is_written() {
    let folder = Folder::with(OLD);
    let target = folder.target();
    let inner = folder.path("inner");
    fs::create_dir(&inner).unwrap();
    let not_regular = "something that is not a regular file";
    assert_refused(&inner, io::ErrorKind::InvalidInput, not_regular);
    assert_refused(&inner.join(".."), io::ErrorKind::InvalidInput, "does not name a file");
    assert_refused(Path::new("/"), io::ErrorKind::InvalidInput, "does not name a file");
    assert_refused(Path::new(""), io::ErrorKind::InvalidInput, "does not name a file");
    assert_refused(&folder.path("missing/a.lfslab"), io::ErrorKind::NotFound, "No such file or directory");
    assert_refused(&target.join("a.lfslab"), io::ErrorKind::NotADirectory, "Not a directory");
    assert_refused(&folder.path("new/"), io::ErrorKind::NotADirectory, "Not a directory");
    assert_refused(&folder.path(&"n".repeat(256)), io::ErrorKind::InvalidFilename, "name too long");
    assert_eq!((folder.holds(&[OLD]), folder.temporaries().len()), (OLD, 0));
    assert_eq!(fs::read_dir(inner).unwrap().count(), 0);
}

/// To open a pipe would wait for its other end.
#[test]
fn a_pipe_is_refused_also_as_a_folder() {
    let folder = Folder::new();
    let pipe = folder.path("pipe");
    if !available(&["mkfifo", pipe.to_str().unwrap()]) {
        return;
    }
    assert_refused(&pipe, io::ErrorKind::InvalidInput, "not a regular file");
    assert_refused(&pipe.join("a.lfslab"), io::ErrorKind::NotADirectory, "Not a directory");
    assert!(fs::symlink_metadata(pipe).unwrap().file_type().is_fifo());
}

#[test]
fn links_are_replaced_if_they_lead_to_a_file_or_to_nothing() {
    let folder = Folder::with(OLD);
    let link = folder.path("link");
    for to in [folder.target(), folder.path("nothing")] {
        symlink(to, &link).unwrap();
        NEW.save(&link).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_file());
        assert_eq!(identify(&fs::read(&link).unwrap(), &[NEW]), NEW);
        fs::remove_file(&link).unwrap();
    }
    assert!(folder.holds(&[OLD, NEW]) == OLD && !folder.path("nothing").exists());
}

#[test]
fn links_to_what_is_no_file_or_cannot_be_looked_at_stay() {
    let folder = Folder::new();
    let link = folder.path("link");
    for (to, kind, why) in [
        (Path::new("/dev/null"), io::ErrorKind::InvalidInput, "not a regular file"),
        (&folder.path(""), io::ErrorKind::InvalidInput, "not a regular file"),
    ] {
        symlink(to, &link).unwrap();
        assert_refused(&link, kind, why);
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        fs::remove_file(&link).unwrap();
    }
    symlink(&link, &link).unwrap();
    let text = chain(&NEW.save(&link).unwrap_err());
    assert!(text.contains("symbolic links") && link.is_symlink(), "{text}");
    assert_eq!(folder.temporaries().len(), 0);
}

/// A folder is reached through a link, which stays.
#[test]
fn the_folder_may_be_a_link() {
    let folder = Folder::with(OLD);
    let link = folder.path("link");
    symlink(folder.path(""), &link).unwrap();
    NEW.save(&link.join("field.lfslab")).unwrap();
    assert_eq!((folder.holds(&[OLD, NEW]), link.is_symlink()), (NEW, true));
}

#[test]
fn names_of_any_bytes_up_to_255_of_them() {
    let folder = Folder::new();
    let long = "n".repeat(255);
    for name in [long.as_bytes(), b"\xFF\xFE.lfslab", b"-", b"a\nb"].map(OsStr::from_bytes) {
        let path = folder.path("").join(name);
        match OLD.save(&path) {
            Ok(_) => assert_eq!(identify(&fs::read(&path).unwrap(), &[OLD]), OLD),
            Err(error) if cfg!(target_os = "linux") => panic!("{name:?}: {}", chain(&error)),
            Err(error) => not_tested(&format!("{name:?}: {}", chain(&error))),
        }
    }
    assert_eq!(folder.temporaries().len(), 0);
}

/// Without a folder in the path it is the one that the process is in.
#[test]
fn a_bare_name_is_saved_in_the_current_folder() {
    let folder = Folder::with(OLD);
    let mut command = command(&[], &format!("save {NEW}"), "field.lfslab");
    command.current_dir(folder.path(""));
    assert!(Ending::of(command).saved());
    assert_eq!((folder.holds(&[OLD, NEW]), folder.temporaries().len()), (NEW, 0));
}

/// The permissions of the file that was there do not matter, not even that it is read-only.
#[test]
fn the_umask_decides_on_permissions() {
    for (umask, mode) in [("000", 0o666), ("022", 0o644), ("027", 0o640), ("077", 0o600), ("777", 0o000)] {
        let folder = Folder::with(OLD);
        fs::set_permissions(folder.target(), fs::Permissions::from_mode(0o444)).unwrap();
        let script = format!(r#"umask {umask}; exec "$@""#);
        let ending = Ending::of(command(&["sh", "-c", &script, "sh"], &format!("save {NEW}"), folder.target()));
        assert!(ending.saved(), "{ending:?}");
        let file = fs::metadata(folder.target()).unwrap();
        assert_eq!(file.permissions().mode() & 0o7777, mode, "umask {umask}");
        assert_eq!(file.len(), NEW.bytes().len() as u64);
    }
}

#[test]
fn in_a_folder_without_the_right_to_write_the_old_file_stays() {
    let folder = Folder::with(OLD);
    fs::set_permissions(folder.path(""), fs::Permissions::from_mode(0o555)).unwrap();
    // Root may write all the same, unless it gives up that right.
    let without = ["setpriv", "--bounding-set=-dac_override,-dac_read_search"];
    let is_root = fs::write(folder.path("probe"), "").is_ok();
    let can_test = !is_root || available(&[without[0], without[1], "true"]);
    if can_test {
        let ending = Ending::of(command(if is_root { &without } else { &[] }, &format!("save {NEW}"), folder.target()));
        assert!(!ending.saved() && ending.message.contains("Permission denied"), "{ending:?}");
        assert_eq!((folder.holds(&[OLD, NEW]), folder.temporaries().len()), (OLD, 0));
    }
    fs::set_permissions(folder.path(""), fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn on_a_disk_that_is_mounted_read_only_the_old_file_stays() {
    let folder = Folder::with(OLD);
    let script = r#"mount --bind "$0" "$0" && mount -o remount,bind,ro "$0" && exec "$@""#;
    let path = folder.path("");
    let wrapper = ["unshare", "-rm", "sh", "-c", script, path.to_str().unwrap()];
    if !available(&[&wrapper[..], &["true"]].concat()) {
        return;
    }
    let ending = Ending::of(command(&wrapper, &format!("save {NEW}"), folder.target()));
    assert!(!ending.saved() && ending.message.contains("Read-only file system"), "{ending:?}");
    assert_eq!((folder.holds(&[OLD, NEW]), folder.temporaries().len()), (OLD, 0));
}

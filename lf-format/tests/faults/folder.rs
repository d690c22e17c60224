//! A folder with one file to save, and what else is left in it.

use std::fs::{self, File};
use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use tempfile::TempDir;

use crate::sample::{Sample, identify};

pub(crate) struct Folder {
    dir: TempDir,
}

impl Folder {
    pub(crate) fn new() -> Self {
        Self { dir: tempfile::tempdir().unwrap() }
    }

    /// With a file.
    pub(crate) fn with(sample: Sample) -> Self {
        let folder = Self::new();
        fs::write(folder.target(), sample.bytes()).unwrap();
        folder
    }

    /// A path in the folder.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// The file that is saved.
    pub(crate) fn target(&self) -> PathBuf {
        self.path("field.lfslab")
    }

    /// Which sample the file is.
    #[track_caller]
    pub(crate) fn holds(&self, among: &[Sample]) -> Sample {
        identify(&fs::read(self.target()).unwrap(), among)
    }

    /// The temporary files, sorted.
    pub(crate) fn temporaries(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.dir.path()).unwrap().map(|entry| entry.unwrap());
        let ours = entries.filter(|entry| entry.file_name().as_encoded_bytes().starts_with(b".lfslab-"));
        let mut paths: Vec<PathBuf> = ours.map(|entry| entry.path()).collect();
        paths.sort();
        paths
    }

    /// What a killed process left two minutes ago.
    pub(crate) fn add_leftover(&self, name: &str) -> PathBuf {
        let path = self.path(&format!(".lfslab-{name}.tmp"));
        File::create(&path).unwrap();
        age(&path);
        path
    }
}

/// Makes a file two minutes old.
pub(crate) fn age(path: &std::path::Path) {
    let then = SystemTime::now() - Duration::from_secs(120);
    File::options().write(true).open(path).unwrap().set_modified(then).unwrap();
}

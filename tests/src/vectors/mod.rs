//! The test vectors of the file format, `spec/vectors`, made from the specification alone: nothing here calls the library.
//!
//! `cargo run -p lf-tests --example write_vectors` writes them anew.

mod content;
mod directory;
mod frames;
mod header;
mod packed;
mod paint;
mod tile_codec;
mod tiles;
mod valid;

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// A file to test a reader with, and what a reader must say to it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Vector {
    /// The file is `valid/NAME.lfslab` or `invalid/NAME.lfslab`.
    pub name: String,
    /// Whether a reader must read it.
    pub valid: bool,
    /// What the file shows.
    pub shows: String,
    /// Clauses that it is about: of the specification with a paragraph sign, of the codecs as they are named there.
    pub clauses: Vec<String>,
    /// Of a valid file, the digest of each slab.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub digests: Vec<String>,
    /// Of an invalid file, why it is refused.
    #[serde(default, flatten, skip_serializing_if = "Option::is_none")]
    pub refusal: Option<Refusal>,
    /// The file.
    #[serde(skip)]
    pub bytes: Vec<u8>,
}

/// How an invalid file must be refused.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Refusal {
    /// The message id of this workspace's reader.
    pub id: String,
    /// What kind of refusal it is.
    pub refusal: Kind,
    /// When it can be found.
    pub stage: Stage,
    /// The bound on memory, in bytes, that is to be set for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory_bytes: Option<u64>,
}

/// What a reader says of a file that it refuses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// It is some other kind of file.
    Foreign,
    /// It breaks a rule.
    Malformed,
    /// It has something that this version does not know (§1.2).
    Unsupported,
    /// It breaks no rule, but takes more memory than allowed (§10).
    Limit,
}

/// The earliest time at which a reader can find out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// When the file is opened: the structure is wrong.
    Open,
    /// When a chunk or the padding is read, or a tile is unpacked.
    Tile,
    /// When texels are looked at that a reader need not look at.
    Texels,
}

impl Vector {
    /// Where the file is in the folder of the vectors.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        let folder = if self.valid { "valid" } else { "invalid" };
        Path::new(folder).join(&self.name).with_extension("lfslab")
    }

    fn new(name: &str, shows: &str, clauses: &str, bytes: Vec<u8>) -> Self {
        let clauses = clauses.split(' ').map(str::to_owned).collect();
        let (name, shows) = (name.to_owned(), shows.to_owned());
        Self { name, valid: true, shows, clauses, digests: Vec::new(), refusal: None, bytes }
    }

    fn refused(mut self, id: &str, refusal: Kind, stage: Stage) -> Self {
        self.valid = false;
        self.refusal = Some(Refusal { id: id.to_owned(), refusal, stage, memory_bytes: None });
        self
    }
}

/// A file that is refused when it is opened: name, message id, clauses, what is wrong, bytes.
fn malformed(name: &str, id: &str, clauses: &str, shows: &str, bytes: Vec<u8>) -> Vector {
    Vector::new(name, shows, clauses, bytes).refused(id, Kind::Malformed, Stage::Open)
}

/// A file that is refused as unsupported when it is opened.
fn unsupported(name: &str, id: &str, clauses: &str, shows: &str, bytes: Vec<u8>) -> Vector {
    Vector::new(name, shows, clauses, bytes).refused(id, Kind::Unsupported, Stage::Open)
}

/// A file that is refused when a chunk is read or a tile unpacked.
fn damaged(name: &str, id: &str, clauses: &str, shows: &str, bytes: Vec<u8>) -> Vector {
    Vector::new(name, shows, clauses, bytes).refused(id, Kind::Malformed, Stage::Tile)
}

/// A file whose writer broke a rule that a reader need not check.
fn unsound(name: &str, id: &str, clauses: &str, shows: &str, bytes: Vec<u8>) -> Vector {
    Vector::new(name, shows, clauses, bytes).refused(id, Kind::Malformed, Stage::Texels)
}

/// All vectors: the valid ones first, each kind in the order of the specification.
#[must_use]
pub fn all() -> Vec<Vector> {
    [valid::vectors(), header::vectors(), directory::vectors(), content::vectors(), tiles::vectors()].concat()
}

/// The text of `index.json`, one vector a line.
///
/// # Panics
/// Never: a vector has nothing that JSON has not.
#[must_use]
pub fn index(vectors: &[Vector]) -> String {
    let line = |vector: &Vector| serde_json::to_string(vector).expect("text and numbers");
    let lines: Vec<String> = vectors.iter().map(line).collect();
    format!("[\n{}\n]\n", lines.join(",\n"))
}

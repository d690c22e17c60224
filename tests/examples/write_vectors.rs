//! Writes the test vectors of the file format anew: `cargo run -p lf-tests --example write_vectors`.

#![forbid(unsafe_code)]

use std::path::Path;
use std::{fs, io};

use lf_tests::vectors;

fn main() -> io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec/vectors");
    for kind in ["valid", "invalid"] {
        let kind = folder.join(kind);
        if kind.exists() {
            fs::remove_dir_all(&kind)?;
        }
        fs::create_dir_all(&kind)?;
    }
    let vectors = vectors::all();
    for vector in &vectors {
        fs::write(folder.join(vector.path()), &vector.bytes)?;
    }
    fs::write(folder.join("index.json"), vectors::index(&vectors))?;
    let bytes: usize = vectors.iter().map(|vector| vector.bytes.len()).sum();
    println!("{} files, {bytes} bytes", vectors.len());
    Ok(())
}

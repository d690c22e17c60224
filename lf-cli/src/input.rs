//! Files to read.

use std::fs::File;

use anyhow::{Context, Result};
use lf_compress::PackedLightField;
use lf_format::FileReader;

use crate::args::FileArgs;

/// An open file whose structure is sound.
pub(crate) type Input = FileReader<File>;

/// Decoded texels may take this much memory.
pub(crate) const MAX_DECODED_BYTES: u64 = 8 << 30;

/// Opens a file and validates its structure.
pub(crate) fn open(args: &FileArgs) -> Result<Input> {
    let file = File::open(&args.file).with_context(|| format!("cannot read {}", args.file.display()))?;
    FileReader::open(file, &args.limits()).with_context(|| args.file.display().to_string())
}

/// Reads and unpacks a light field.
pub(crate) fn load(args: &FileArgs) -> Result<PackedLightField> {
    PackedLightField::read_file(&mut open(args)?).with_context(|| args.file.display().to_string())
}

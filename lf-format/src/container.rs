//! Reading a file that is already in memory.

use alloc::borrow::Cow;
use alloc::format;
use core::ops::Deref;

use crate::bytes::{range, zeros};
use crate::structure::Source;
#[cfg(feature = "std")]
use crate::{ChunkEntry, ExtraChunk};
use crate::{FormatError, Limits, Rule, StoredTile, Structure};

/// A file in memory, or mapped into it. Its [`Structure`] is validated; tiles are borrowed, and checked when they are asked
/// for.
#[derive(Debug, Clone)]
pub struct Container<'a> {
    bytes: &'a [u8],
    structure: Structure,
}

impl<'a> Container<'a> {
    /// Validates the structure of a file: every rule of the specification but those about tiles, padding, and chunks that
    /// this version does not know.
    ///
    /// # Errors
    /// [`FormatError::NotLfslab`] for other kinds of files, `Malformed` for damage, `Unsupported` for what this
    /// version does not know, `LimitExceeded` for files that would take more memory than the caller wants to give.
    pub fn parse(bytes: &'a [u8], limits: &Limits) -> Result<Self, FormatError> {
        Ok(Self { bytes, structure: Structure::read(&mut Memory(bytes), limits)? })
    }

    /// A tile as it is stored, after its checksum was compared.
    ///
    /// # Errors
    /// [`FormatError::InvalidArgument`] if there is no such slab, a position in the geometry, or the tile is not stored;
    /// [`FormatError::Malformed`] if the checksum is wrong.
    pub fn tile(&self, slab: usize, tile: u32) -> Result<StoredTile<'a>, FormatError> {
        let index = self.structure.tile_chunk(slab, tile).ok_or_else(|| no_tile(slab, tile))?;
        let payload = self.payload(index);
        self.structure.chunks()[index].verify(index, payload)?;
        Ok(self.structure.tile(index, payload))
    }

    /// Checks the bytes of every chunk and all padding, and hands each error to `report`: together with
    /// [`parse`](Self::parse) every byte of the file has then been looked at.
    pub fn verify(&self, mut report: impl FnMut(FormatError)) {
        for (index, entry) in self.structure.chunks().iter().enumerate() {
            let start = self.structure.padding_start(index);
            let padding = range(self.bytes, start, entry.offset.saturating_sub(start)).unwrap_or_default();
            let padded = zeros(padding, start, Rule::Padding, "a padding byte");
            padded.and_then(|()| entry.verify(index, self.payload(index))).unwrap_or_else(&mut report);
        }
    }

    /// The chunks that this version does not know but that a program may take over into a file with other tiles, as they
    /// are safe to copy.
    ///
    /// # Errors
    /// If a checksum is wrong.
    #[cfg(feature = "std")]
    pub fn copyable_chunks(&self) -> Result<Vec<ExtraChunk>, FormatError> {
        let chunks = self.structure.chunks().iter().enumerate();
        let unknown = chunks.filter(|(_, entry)| !entry.tag.is_known() && entry.safe_to_copy);
        let copy = |(index, entry): (usize, &ChunkEntry)| {
            let payload = self.payload(index);
            entry.verify(index, payload)?;
            Ok(ExtraChunk::copied(entry, payload.to_vec()))
        };
        unknown.map(copy).collect()
    }

    /// The stored bytes of a chunk. All of them: the structure makes sure that they lie within the file.
    fn payload(&self, index: usize) -> &'a [u8] {
        let entry = &self.structure.chunks()[index];
        range(self.bytes, entry.offset, entry.stored_len).unwrap_or_default()
    }
}

impl Deref for Container<'_> {
    type Target = Structure;

    fn deref(&self) -> &Structure {
        &self.structure
    }
}

pub(crate) fn no_tile(slab: usize, tile: u32) -> FormatError {
    FormatError::argument(format!("the file stores no tile {tile} of slab {slab}"))
}

struct Memory<'a>(&'a [u8]);

impl Source for Memory<'_> {
    fn file_len(&self) -> u64 {
        self.0.len() as u64
    }

    fn read(&mut self, offset: u64, len: u64) -> Result<Cow<'_, [u8]>, FormatError> {
        Ok(Cow::Borrowed(range(self.0, offset, len).unwrap_or_default()))
    }
}

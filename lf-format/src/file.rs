//! Reading a file piece by piece.

use std::borrow::Cow;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Deref;

use crate::bytes::range;
use crate::container::no_tile;
use crate::structure::Source;
use crate::{ExtraChunk, FormatError, Limits, StoredTile, Structure};

/// What is read at once at the start: enough for header, directory and geometry of most files.
const HEAD_LEN: u64 = 4 << 10;

/// A file that is read where it is, with memory for its [`Structure`] and one tile at a time.
#[derive(Debug)]
pub struct FileReader<R> {
    input: R,
    structure: Structure,
}

impl<R: Read + Seek> FileReader<R> {
    /// Validates the structure of a file, as [`Container::parse`](crate::Container::parse) does.
    ///
    /// # Errors
    /// As there; [`FormatError::Io`] if the input cannot be read.
    pub fn open(mut input: R, limits: &Limits) -> Result<Self, FormatError> {
        let structure = Structure::read(&mut Seeking::new(&mut input)?, limits)?;
        Ok(Self { input, structure })
    }

    /// Reads a tile into `buffer`, in place of what it holds, and compares its checksum.
    ///
    /// # Errors
    /// As [`Container::tile`](crate::Container::tile); [`FormatError::Io`] if the input cannot be read.
    pub fn tile<'b>(&mut self, slab: usize, tile: u32, buffer: &'b mut Vec<u8>) -> Result<StoredTile<'b>, FormatError> {
        let index = self.structure.tile_chunk(slab, tile).ok_or_else(|| no_tile(slab, tile))?;
        let entry = &self.structure.chunks()[index];
        read_at(&mut self.input, entry.offset, entry.stored_len, buffer)?;
        entry.verify(index, buffer)?;
        Ok(self.structure.tile(index, buffer))
    }

    /// Checks the bytes of every chunk and all padding, and hands each error to `report`.
    ///
    /// # Errors
    /// [`FormatError::Io`] if the input cannot be read.
    pub fn verify(&mut self, mut report: impl FnMut(FormatError)) -> Result<(), FormatError> {
        let mut buffer = Vec::new();
        for (index, entry) in self.structure.chunks().iter().enumerate() {
            let start = self.structure.padding_start(index);
            read_at(&mut self.input, start, entry.end().saturating_sub(start), &mut buffer)?;
            self.structure.verify_chunk(index, &buffer).unwrap_or_else(&mut report);
        }
        Ok(())
    }

    /// The chunks that this version does not know but that a program may take over into a file with other tiles, as
    /// [`Container::copyable_chunks`](crate::Container::copyable_chunks). They are taken from the memory budget.
    ///
    /// # Errors
    /// As there; [`FormatError::Io`] if the input cannot be read.
    pub fn copyable_chunks(&mut self) -> Result<Vec<ExtraChunk>, FormatError> {
        let mut budget = self.structure.budget();
        let mut copied = Vec::new();
        for (index, entry) in self.structure.chunks().iter().enumerate() {
            if entry.tag.is_known() || !entry.safe_to_copy {
                continue;
            }
            budget.take("chunks to copy", entry.stored_len)?;
            let mut payload = Vec::new();
            read_at(&mut self.input, entry.offset, entry.stored_len, &mut payload)?;
            entry.verify(index, &payload)?;
            copied.push(ExtraChunk::copied(entry, payload));
        }
        Ok(copied)
    }
}

impl<R> Deref for FileReader<R> {
    type Target = Structure;

    fn deref(&self) -> &Structure {
        &self.structure
    }
}

/// Reads exactly `len` bytes. Memory is taken as they come, so that a length that the input does not have costs nothing.
fn read_at(input: &mut (impl Read + Seek), offset: u64, len: u64, buffer: &mut Vec<u8>) -> Result<(), FormatError> {
    buffer.clear();
    let read = input.seek(SeekFrom::Start(offset)).and_then(|_| input.take(len).read_to_end(buffer));
    match read {
        Ok(read) if read as u64 == len => Ok(()),
        Ok(_) => Err(FormatError::io("read the file", std::io::ErrorKind::UnexpectedEof.into())),
        Err(source) => Err(FormatError::io("read the file", source)),
    }
}

/// The start of the input, and the rest where it is asked for.
struct Seeking<'a, R> {
    input: &'a mut R,
    len: u64,
    head: Vec<u8>,
    buffer: Vec<u8>,
}

impl<'a, R: Read + Seek> Seeking<'a, R> {
    fn new(input: &'a mut R) -> Result<Self, FormatError> {
        let len = input.seek(SeekFrom::End(0)).map_err(|source| FormatError::io("find the end of the file", source))?;
        let mut head = vec![0; len.min(HEAD_LEN) as usize];
        let read = input.seek(SeekFrom::Start(0)).and_then(|_| input.read_exact(&mut head));
        read.map_err(|source| FormatError::io("read the file", source))?;
        Ok(Self { input, len, head, buffer: Vec::new() })
    }
}

impl<R: Read + Seek> Source for Seeking<'_, R> {
    fn file_len(&self) -> u64 {
        self.len
    }

    fn read(&mut self, offset: u64, len: u64) -> Result<Cow<'_, [u8]>, FormatError> {
        if let Some(bytes) = range(&self.head, offset, len) {
            return Ok(Cow::Borrowed(bytes));
        }
        read_at(self.input, offset, len, &mut self.buffer)?;
        Ok(Cow::Borrowed(&self.buffer))
    }
}

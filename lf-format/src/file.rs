//! Reading a file piece by piece.

use std::borrow::Cow;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Deref;

use crate::bytes::{range, zeros};
use crate::container::no_tile;
use crate::structure::Source;
use crate::{ExtraChunk, FormatError, Limits, Rule, StoredTile, Structure};

/// What is read at once at the start: enough for header, directory and geometry of most files.
const HEAD_LEN: u64 = 4 << 10;

/// What is read at once to compute a checksum.
const PIECE_LEN: u64 = 64 << 10;

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
    /// As [`Container::tile`](crate::Container::tile); [`FormatError::LimitExceeded`] if the stored bytes are more than the memory
    /// budget has left; [`FormatError::Io`] if the input cannot be read.
    pub fn tile<'b>(&mut self, slab: usize, tile: u32, buffer: &'b mut Vec<u8>) -> Result<StoredTile<'b>, FormatError> {
        let index = self.structure.tile_chunk(slab, tile).ok_or_else(|| no_tile(slab, tile))?;
        let entry = &self.structure.chunks()[index];
        self.structure.budget().take("a stored tile", entry.stored_len)?;
        read_at(&mut self.input, entry.offset, entry.stored_len, buffer)?;
        entry.verify(index, buffer)?;
        Ok(self.structure.tile(index, buffer))
    }

    /// Checks the bytes of every chunk and all padding, and hands each error to `report`. Takes no more memory for long chunks than
    /// for short ones.
    ///
    /// # Errors
    /// [`FormatError::Io`] if the input cannot be read.
    pub fn verify(&mut self, mut report: impl FnMut(FormatError)) -> Result<(), FormatError> {
        let mut buffer = vec![0; PIECE_LEN as usize];
        for (index, entry) in self.structure.chunks().iter().enumerate() {
            let start = self.structure.padding_start(index);
            let padding = buffer.get_mut(..entry.offset.saturating_sub(start) as usize).unwrap_or_default();
            seek_and_read(&mut self.input, start, padding)?;
            let mut hash = entry.hasher();
            let mut left = entry.stored_len;
            let padded = zeros(padding, start, Rule::Padding, "a padding byte");
            while left > 0 {
                let len = left.min(PIECE_LEN);
                let piece = buffer.get_mut(..len as usize).unwrap_or_default();
                self.input.read_exact(piece).map_err(read_error)?;
                hash.update(piece);
                left -= len;
            }
            padded.and_then(|()| entry.verify_digest(index, hash.digest())).unwrap_or_else(&mut report);
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
        Ok(_) => Err(read_error(std::io::ErrorKind::UnexpectedEof.into())),
        Err(source) => Err(read_error(source)),
    }
}

/// Fills a buffer from a place of the input.
fn seek_and_read(input: &mut (impl Read + Seek), offset: u64, buffer: &mut [u8]) -> Result<(), FormatError> {
    input.seek(SeekFrom::Start(offset)).and_then(|_| input.read_exact(buffer)).map_err(read_error)
}

fn read_error(source: std::io::Error) -> FormatError {
    FormatError::io("read the file", source)
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
        seek_and_read(input, 0, &mut head)?;
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

//! What an encoder or decoder looks like to the measurement.

use crate::error::BenchError;
use crate::picture::Picture;

/// One codec's work on one input, prepared so that only the work itself is left.
pub trait Job {
    /// Does the work once more; the output replaces that of the call before.
    ///
    /// # Errors
    ///
    /// What the codec says if it refuses.
    fn run(&mut self) -> Result<(), String>;

    /// The output of the last run: blocks of an encoder, row-major RGBA8 of a decoder.
    fn output(&self) -> Vec<u8>;
}

/// Whether a codec is this project's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Maker {
    /// `lf-compress`.
    Ours,
    /// Any other crate.
    Peer,
}

/// BC1 blocks with the size of the image they hold: what every decoder is given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Encoded {
    /// Name for messages.
    pub name: String,
    /// Width in texels, a multiple of 4.
    pub width: u32,
    /// Height in texels, a multiple of 4.
    pub height: u32,
    /// Row-major blocks of 8 bytes.
    pub blocks: Vec<u8>,
}

impl Encoded {
    /// Number of texels.
    #[must_use]
    pub fn texels(&self) -> usize {
        2 * self.blocks.len()
    }
}

/// What a codec works on: a [`Picture`] or [`Encoded`] blocks.
pub trait Input {
    /// Name for messages.
    fn name(&self) -> &str;
}

impl Input for Picture {
    fn name(&self) -> &str {
        self.name()
    }
}

impl Input for Encoded {
    fn name(&self) -> &str {
        &self.name
    }
}

type Prepare<I> = dyn for<'a> Fn(&'a I) -> Result<Box<dyn Job + 'a>, String> + Send + Sync;

/// An encoder (`I` is [`Picture`]) or a decoder (`I` is [`Encoded`]) at one setting.
pub struct Codec<I> {
    name: String,
    package: &'static str,
    maker: Maker,
    prepare: Box<Prepare<I>>,
}

impl<I> Codec<I> {
    pub(crate) fn peer<F>(name: &str, package: &'static str, prepare: F) -> Self
    where
        F: for<'a> Fn(&'a I) -> Result<Box<dyn Job + 'a>, String> + Send + Sync + 'static,
    {
        Self { name: name.to_owned(), package, maker: Maker::Peer, prepare: Box::new(prepare) }
    }

    pub(crate) fn ours<F>(name: &str, prepare: F) -> Self
    where
        F: for<'a> Fn(&'a I) -> Result<Box<dyn Job + 'a>, String> + Send + Sync + 'static,
    {
        Self { name: name.to_owned(), package: "lf-compress", maker: Maker::Ours, prepare: Box::new(prepare) }
    }

    /// Name of the codec with its setting, unique in its table.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The crate it comes from.
    #[must_use]
    pub fn package(&self) -> &'static str {
        self.package
    }

    /// Whose it is.
    #[must_use]
    pub fn maker(&self) -> Maker {
        self.maker
    }
}

impl<I: Input> Codec<I> {
    /// The work on one input, not yet done. What it yields is unchecked: see [`Codec::encode`] and [`Codec::decode`].
    ///
    /// # Errors
    ///
    /// [`BenchError::Codec`] if the codec refuses the input.
    pub fn job<'a>(&self, input: &'a I) -> Result<Box<dyn Job + 'a>, BenchError> {
        (self.prepare)(input).map_err(|why| self.failure(input, why))
    }

    /// What went wrong with this codec on this input.
    pub(crate) fn failure(&self, input: &I, why: String) -> BenchError {
        BenchError::Codec { codec: self.name.clone(), input: input.name().to_owned(), why }
    }
}

impl Codec<Picture> {
    /// Encodes one picture, once.
    ///
    /// # Errors
    ///
    /// [`BenchError::Codec`] if the encoder refuses or its output has the wrong length.
    pub fn encode(&self, picture: &Picture) -> Result<Vec<u8>, BenchError> {
        let mut job = self.job(picture)?;
        job.run().map_err(|why| self.failure(picture, why))?;
        let blocks = job.output();
        if blocks.len() != picture.block_bytes() {
            let why = format!("{} bytes of blocks instead of {}", blocks.len(), picture.block_bytes());
            return Err(self.failure(picture, why));
        }
        Ok(blocks)
    }
}

impl Codec<Encoded> {
    /// Decodes once, to row-major RGBA8.
    ///
    /// # Errors
    ///
    /// [`BenchError::Codec`] if the decoder refuses or its output has the wrong length.
    pub fn decode(&self, encoded: &Encoded) -> Result<Vec<u8>, BenchError> {
        let mut job = self.job(encoded)?;
        job.run().map_err(|why| self.failure(encoded, why))?;
        let rgba = job.output();
        if rgba.len() != 4 * encoded.texels() {
            let why = format!("{} bytes of texels instead of {}", rgba.len(), 4 * encoded.texels());
            return Err(self.failure(encoded, why));
        }
        Ok(rgba)
    }
}

/// A job made of a buffer, the work on it, and the way its content is shown.
struct Work<B, R, O> {
    buffer: B,
    run: R,
    output: O,
}

impl<B, R, O> Job for Work<B, R, O>
where
    R: FnMut(&mut B) -> Result<(), String>,
    O: Fn(&B) -> Vec<u8>,
{
    fn run(&mut self) -> Result<(), String> {
        (self.run)(&mut self.buffer)
    }

    fn output(&self) -> Vec<u8> {
        (self.output)(&self.buffer)
    }
}

/// A job whose output is not a plain slice of bytes: `shown` turns it into one, untimed.
pub(crate) fn job_of<'a, B: 'a>(
    buffer: B,
    run: impl FnMut(&mut B) -> Result<(), String> + 'a,
    shown: impl Fn(&B) -> Vec<u8> + 'a,
) -> Box<dyn Job + 'a> {
    Box::new(Work { buffer, run, output: shown })
}

/// A job that fills the same bytes again and again: what a library allows that writes into the caller's slice.
pub(crate) fn job_into<'a>(
    bytes: usize,
    mut fill: impl FnMut(&mut [u8]) -> Result<(), String> + 'a,
) -> Box<dyn Job + 'a> {
    job_of(vec![0; bytes], move |buffer| fill(buffer), Clone::clone)
}

/// A job of a library that returns fresh bytes each time; their allocation is part of its cost.
pub(crate) fn job_returning<'a>(mut make: impl FnMut() -> Result<Vec<u8>, String> + 'a) -> Box<dyn Job + 'a> {
    let run = move |buffer: &mut Vec<u8>| {
        *buffer = make()?;
        Ok(())
    };
    job_of(Vec::new(), run, Clone::clone)
}

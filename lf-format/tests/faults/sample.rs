//! Files to save, and the question which of them some bytes are.

use std::fmt;
use std::io::{Cursor, Seek, Write};
use std::path::Path;
use std::str::FromStr;

use glam::{DVec3, Vec3};
use lf_format::{Container, Contents, FormatError, Limits, Metadata, Packing, SlabTiling, TexelEncoding, Writer};
use lf_math::{Cell, Face, LightFieldGeometry, SampledAxis, Slab};

/// A file of one slab with a row of cameras, one tile of 4 KiB for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Sample {
    pub(crate) tiles: u32,
    pub(crate) seed: u8,
}

/// About 17 KiB.
pub(crate) const OLD: Sample = Sample { tiles: 4, seed: 1 };
/// About 13 KiB, so that a part of it over [`OLD`] is neither.
pub(crate) const NEW: Sample = Sample { tiles: 3, seed: 2 };

impl Sample {
    pub(crate) fn save(self, path: &Path) -> Result<u64, FormatError> {
        let mut writer = Writer::create(path, self.contents())?;
        self.write(&mut writer)?;
        writer.save()
    }

    /// The same file by another way: in memory.
    pub(crate) fn bytes(self) -> Vec<u8> {
        self.write_to(Cursor::new(Vec::new())).unwrap().into_inner()
    }

    pub(crate) fn write_to<W: Write + Seek>(self, out: W) -> Result<W, FormatError> {
        let mut writer = Writer::new(out, self.contents())?;
        self.write(&mut writer)?;
        writer.finish()
    }

    fn contents(self) -> Contents {
        let axis = |count| SampledAxis::new(0.0, 0.5, count).unwrap();
        let slab = Slab::new(Face::PosX, 0.0, [axis(self.tiles), axis(1)], [axis(32), axis(32)], None).unwrap();
        let tiling = SlabTiling::new(&slab, TexelEncoding::Rgba8, [1, 1]).unwrap();
        let cell = Cell::new(DVec3::ZERO, Vec3::ONE).unwrap();
        Contents::new(LightFieldGeometry::new(cell, vec![slab]).unwrap(), vec![tiling], Metadata::new())
    }

    fn write<W: Write + Seek>(self, writer: &mut Writer<W>) -> Result<(), FormatError> {
        while let Some((_, tile)) = writer.next_tile() {
            let byte = |i: u32| (i ^ (i >> 8) ^ (37 * tile)) as u8 ^ self.seed;
            writer.tile(Packing::None, &(0..4 * 32 * 32).map(byte).collect::<Vec<u8>>())?;
        }
        Ok(())
    }
}

impl fmt::Display for Sample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.tiles, self.seed)
    }
}

impl FromStr for Sample {
    type Err = Box<dyn std::error::Error>;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (tiles, seed) = text.split_once(':').ok_or("no colon")?;
        Ok(Self { tiles: tiles.parse()?, seed: seed.parse()? })
    }
}

/// Which of the samples a whole file is. It must be one of them, and valid.
#[track_caller]
pub(crate) fn identify(bytes: &[u8], among: &[Sample]) -> Sample {
    let file = Container::parse(bytes, &Limits::default()).unwrap_or_else(|error| panic!("torn: {error}"));
    file.verify(|error| panic!("torn: {error}"));
    let found = among.iter().find(|sample| sample.bytes() == bytes);
    *found.unwrap_or_else(|| panic!("valid, but none of {among:?}"))
}

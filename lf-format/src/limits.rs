//! How large a file the caller is willing to deal with.

use lf_math::{LightFieldGeometry, SampledAxis};

use crate::{FormatError, SlabTiling};

/// Upper bounds that a file is held to before anything is allocated for it (spec §9).
///
/// The defaults suit a desktop machine and are the values that the specification recommends. [`Writer`](crate::Writer)
/// keeps to them, so that a reader with default limits accepts every file it makes. To change one, set the field:
///
/// ```
/// let mut limits = lf_format::Limits::default();
/// limits.max_raw_bytes = 64 << 20;
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Limits {
    /// Length of the file, bytes. Default 4 GiB.
    pub max_file_bytes: u64,
    /// Number of chunks. Default 65,536, a directory of 3 MiB.
    pub max_entries: u32,
    /// Length of the metadata chunk, bytes. Default 1 MiB.
    pub max_metadata_bytes: u64,
    /// Length of all tiles together when unpacked, bytes. Default 4 GiB.
    pub max_raw_bytes: u64,
    /// Number of samples along any axis of a slab, and of cameras along a tile's edge. Default 65,536.
    pub max_axis_count: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_file_bytes: 4 << 30,
            max_entries: 1 << 16,
            max_metadata_bytes: 1 << 20,
            max_raw_bytes: 4 << 30,
            max_axis_count: 1 << 16,
        }
    }
}

impl Limits {
    pub(crate) fn file_bytes(&self, len: u64) -> Result<(), FormatError> {
        within("file length", len, self.max_file_bytes)
    }

    pub(crate) fn entries(&self, count: u64) -> Result<(), FormatError> {
        within("number of chunks", count, self.max_entries.into())
    }

    pub(crate) fn metadata_bytes(&self, len: u64) -> Result<(), FormatError> {
        within("length of the metadata", len, self.max_metadata_bytes)
    }

    /// Holds the axis counts and the unpacked size of all tiles to the limits.
    pub(crate) fn geometry(&self, geometry: &LightFieldGeometry, tilings: &[SlabTiling]) -> Result<(), FormatError> {
        let counts = geometry.slabs().iter().flat_map(|slab| slab.st().into_iter().chain(slab.uv()));
        for count in counts.map(|axis: SampledAxis| axis.count()) {
            within("number of samples along an axis", count.into(), self.max_axis_count.into())?;
        }
        for count in tilings.iter().flat_map(SlabTiling::cameras_per_tile) {
            within("number of cameras along a tile", count.into(), self.max_axis_count.into())?;
        }
        let slab_bytes = |tiling: &SlabTiling| tiling.raw_len().saturating_mul(tiling.tile_count().into());
        let raw = tilings.iter().map(slab_bytes).fold(0, u64::saturating_add);
        within("unpacked length of all tiles", raw, self.max_raw_bytes)
    }
}

fn within(what: &'static str, value: u64, limit: u64) -> Result<(), FormatError> {
    if value <= limit { Ok(()) } else { Err(FormatError::LimitExceeded { what, value, limit }) }
}

//! Where each camera image lies in the volume texture (§7 and Fig. 8 of the paper).
//!
//! A *slice* is a picture of `cameras_per_slice` neighbouring camera images; a slab fills consecutive slices in the
//! order `idx.y·groups_s + idx.x`, `idx` being the camera index divided by the cameras per slice; each slab has a *slot*
//! of equally many slices. All sizes of the volume are powers of two, as the paper's hardware wanted: six slabs of
//! 32×32 cameras × 128×128 texels take 8 slots of 1024×1024×16 in 1024×1024×128, 64 MiB in BC1.

use lf_math::{LightFieldGeometry, Slab};
use thiserror::Error;

/// Edge length in texels that a slice has where camera images are small enough: the paper's 1024.
///
/// Smaller slices would mean more of them (3D textures end at 2048); larger ones make tiles coarser to load.
const SLICE_EDGE: u32 = 1024;

/// The volume would be larger than its coordinates can say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("the packed volume would exceed 2^31 texels along an axis; use fewer cameras or smaller images")]
pub struct VolumeTooLarge;

/// The place of every texel of a light field in one power-of-two volume.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VolumeLayout {
    size: [u32; 3],
    slabs: Vec<SlabLayout>,
}

/// One slab's part of the volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SlabLayout {
    cameras: [u32; 2],
    resolution: [u32; 2],
    pitch: [u32; 2],
    cameras_per_slice: [u32; 2],
    groups: [u32; 2],
    first_slice: u32,
}

/// A texel of the light field by its integer indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sample {
    /// Position of the slab in the light field.
    pub slab: usize,
    /// Camera (s, t).
    pub camera: [u32; 2],
    /// Texel (u, v).
    pub texel: [u32; 2],
}

/// How many camera images a slice holds along s and t: the largest power of two that fits in 1024 texels, at least
/// one, and not more than the grid needs.
#[must_use]
pub fn cameras_per_slice(slab: &Slab) -> [u32; 2] {
    let [cameras, resolution] = [slab.cameras(), slab.resolution()];
    [0, 1].map(|i| {
        let fitting = SLICE_EDGE / padded(resolution[i]).unwrap_or(u32::MAX);
        let largest = if fitting == 0 { 1 } else { 1 << fitting.ilog2() };
        cameras[i].checked_next_power_of_two().unwrap_or(u32::MAX).min(largest)
    })
}

/// Images start on BC1 block borders, so that no block holds texels of two cameras.
fn padded(resolution: u32) -> Option<u32> {
    resolution.checked_next_multiple_of(4)
}

impl VolumeLayout {
    /// The layout of a light field with [`cameras_per_slice`] of each slab.
    ///
    /// # Errors
    /// If an axis of the volume would reach 2³¹ texels.
    pub fn new(geometry: &LightFieldGeometry) -> Result<Self, VolumeTooLarge> {
        Self::with_cameras_per_slice(geometry, |i| cameras_per_slice(&geometry.slabs()[i]))
    }

    /// The layout with given numbers of camera images per slice (at least 1), by position of the slab.
    ///
    /// # Errors
    /// If an axis of the volume would reach 2³¹ texels.
    pub fn with_cameras_per_slice(
        geometry: &LightFieldGeometry,
        cameras_per_slice: impl Fn(usize) -> [u32; 2],
    ) -> Result<Self, VolumeTooLarge> {
        let layouts = geometry.slabs().iter().enumerate().map(|(i, slab)| SlabLayout::new(slab, cameras_per_slice(i)));
        let mut slabs = layouts.collect::<Option<Vec<_>>>().ok_or(VolumeTooLarge)?;
        let size = Self::place(&mut slabs).ok_or(VolumeTooLarge)?;
        Ok(Self { size, slabs })
    }

    /// Gives each slab its slot; returns the size of the volume.
    fn place(slabs: &mut [SlabLayout]) -> Option<[u32; 3]> {
        let power_of_two = |f: &dyn Fn(&SlabLayout) -> Option<u32>| {
            slabs.iter().map(f).try_fold(0, |most, n| Some(n?.max(most)))?.checked_next_power_of_two()
        };
        let width = power_of_two(&|slab| slab.slice_size(0))?;
        let height = power_of_two(&|slab| slab.slice_size(1))?;
        let slot = power_of_two(&|slab| Some(slab.slices()))?;
        for (slab, position) in slabs.iter_mut().zip(0..) {
            slab.first_slice = slot.checked_mul(position)?;
        }
        let depth = u32::try_from(slabs.len()).ok()?.checked_next_power_of_two()?.checked_mul(slot)?;
        Some([width, height, depth]).filter(|size| size.iter().all(|&n| n < 1 << 31))
    }

    /// Width, height and depth in texels, all powers of two.
    #[must_use]
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// The parts, by position of the slab.
    #[must_use]
    pub fn slabs(&self) -> &[SlabLayout] {
        &self.slabs
    }

    /// Where a sample lies: texel x, y and slice z. `None` for indices outside the light field.
    #[must_use]
    pub fn texel(&self, sample: &Sample) -> Option<[u32; 3]> {
        let slab = self.slabs.get(sample.slab)?;
        let inside = |i: usize| sample.camera[i] < slab.cameras[i] && sample.texel[i] < slab.resolution[i];
        (inside(0) && inside(1)).then(|| {
            let place = |i: usize| sample.camera[i] % slab.cameras_per_slice[i] * slab.pitch[i] + sample.texel[i];
            let [group_s, group_t] = [0, 1].map(|i| sample.camera[i] / slab.cameras_per_slice[i]);
            [place(0), place(1), slab.first_slice + group_t * slab.groups[0] + group_s]
        })
    }

    /// The sample at a texel of the volume; `None` where no camera image lies. Inverse of [`Self::texel`].
    #[must_use]
    pub fn sample(&self, texel: [u32; 3]) -> Option<Sample> {
        let inside = |slab: &&SlabLayout| texel[2].checked_sub(slab.first_slice).is_some_and(|z| z < slab.slices());
        let (slab, part) = self.slabs.iter().enumerate().find(|(_, slab)| inside(slab))?;
        let slice = texel[2] - part.first_slice;
        let group = [slice % part.groups[0], slice / part.groups[0]];
        let image = [0, 1].map(|i| texel[i] / part.pitch[i]);
        if image[0] >= part.cameras_per_slice[0] || image[1] >= part.cameras_per_slice[1] {
            return None;
        }
        let camera = [0, 1].map(|i| group[i] * part.cameras_per_slice[i] + image[i]);
        let texel = [0, 1].map(|i| texel[i] % part.pitch[i]);
        Some(Sample { slab, camera, texel }).filter(|found| self.texel(found).is_some())
    }
}

impl SlabLayout {
    fn new(slab: &Slab, cameras_per_slice: [u32; 2]) -> Option<Self> {
        let [cameras, resolution] = [slab.cameras(), slab.resolution()];
        let cameras_per_slice = cameras_per_slice.map(|n| n.max(1));
        let groups = [0, 1].map(|i| cameras[i].div_ceil(cameras_per_slice[i]));
        groups[0].checked_mul(groups[1])?;
        let pitch = [padded(resolution[0])?, padded(resolution[1])?];
        Some(Self { cameras, resolution, pitch, cameras_per_slice, groups, first_slice: 0 })
    }

    /// Texels that the camera images of a slice take along one axis.
    fn slice_size(&self, axis: usize) -> Option<u32> {
        self.pitch[axis].checked_mul(self.cameras_per_slice[axis])
    }

    /// Distance between neighbouring camera images in a slice, texels: the resolution rounded up to whole blocks.
    #[must_use]
    pub fn pitch(&self) -> [u32; 2] {
        self.pitch
    }

    /// Camera images in a slice along s and t.
    #[must_use]
    pub fn cameras_per_slice(&self) -> [u32; 2] {
        self.cameras_per_slice
    }

    /// Groups of cameras, one per slice, along s and t.
    #[must_use]
    pub fn groups(&self) -> [u32; 2] {
        self.groups
    }

    /// Number of slices used, at most the slot's.
    #[must_use]
    pub fn slices(&self) -> u32 {
        self.groups[0] * self.groups[1]
    }

    /// The volume slice where the slab begins.
    #[must_use]
    pub fn first_slice(&self) -> u32 {
        self.first_slice
    }
}

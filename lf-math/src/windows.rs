//! The parts of images that are kept, one axis at a time.

use alloc::vec::Vec;
use core::ops::Range;

/// The window of each camera along one axis: of the columns of cameras along u, or of the rows along v.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Windows {
    texels: u32,
    cameras: u32,
    /// Empty if all images are whole, which is the usual case and so takes no memory.
    each: Vec<Range<u32>>,
}

impl Windows {
    /// Whole images of so many texels.
    pub(crate) fn whole(cameras: u32, texels: u32) -> Self {
        Self { texels, cameras, each: Vec::new() }
    }

    /// A window for each camera, within images of so many texels. There are at most 2²⁴ cameras.
    pub(crate) fn new(windows: impl IntoIterator<Item = Range<u32>>, texels: u32) -> Self {
        // One way to say that a window is empty, and one that all are whole.
        let plain = |window: Range<u32>| if window.is_empty() { 0..0 } else { window };
        let each: Vec<_> = windows.into_iter().map(plain).collect();
        let cameras = each.len() as u32;
        if each.iter().all(|window| *window == (0..texels)) {
            Self::whole(cameras, texels)
        } else {
            Self { texels, cameras, each }
        }
    }

    /// Number of cameras along the axis.
    #[must_use]
    #[inline]
    pub fn cameras(&self) -> u32 {
        self.cameras
    }

    /// Texels of a whole image along the axis.
    #[must_use]
    #[inline]
    pub fn texels(&self) -> u32 {
        self.texels
    }

    /// Whether all of every image is kept.
    #[must_use]
    #[inline]
    pub fn is_whole(&self) -> bool {
        self.each.is_empty()
    }

    /// The window of a camera, texels; `None` if there is no such camera. An empty one is 0..0.
    #[must_use]
    #[inline]
    pub fn get(&self, camera: u32) -> Option<Range<u32>> {
        if self.is_whole() {
            return (camera < self.cameras).then_some(0..self.texels);
        }
        self.each.get(camera as usize).cloned()
    }

    /// All windows in the order of the cameras.
    pub fn iter(&self) -> impl Iterator<Item = Range<u32>> + Clone {
        (0..self.cameras).filter_map(|camera| self.get(camera))
    }

    /// Texels in all windows together, less than 2⁴⁸.
    pub(crate) fn total(&self) -> u64 {
        if self.is_whole() {
            return u64::from(self.cameras) * u64::from(self.texels);
        }
        self.each.iter().map(|window| window.len() as u64).sum()
    }

    /// Whether any window holds a texel.
    pub(crate) fn any(&self) -> bool {
        if self.is_whole() {
            self.cameras > 0 && self.texels > 0
        } else {
            self.each.iter().any(|window| !window.is_empty())
        }
    }

    /// The same with windows rounded out to multiples of `block` texels, as far as the images reach.
    pub(crate) fn aligned(self, block: u32) -> Self {
        let texels = self.texels;
        let round = |window: Range<u32>| {
            let end = window.end.checked_next_multiple_of(block).unwrap_or(texels);
            window.start / block * block..end.min(texels)
        };
        if self.is_whole() { self } else { Self::new(self.each.into_iter().map(round), texels) }
    }

    /// What is in the windows of both.
    pub(crate) fn intersection(&self, other: &Self) -> Self {
        let common = |(a, b): (Range<u32>, Range<u32>)| a.start.max(b.start)..a.end.min(b.end);
        Self::new(self.iter().zip(other.iter()).map(common), self.texels)
    }
}

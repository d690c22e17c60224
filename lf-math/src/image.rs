//! A plain image: rows of texels, top row first.

use alloc::vec::Vec;

use crate::error::GeometryError;

/// `width × height` texels in row order, top row first. Both sizes are at least 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Image<T> {
    width: u32,
    height: u32,
    texels: Vec<T>,
}

impl<T: Copy> Image<T> {
    /// An image from its texels.
    ///
    /// # Errors
    /// Sizes must be at least 1 and `texels` must hold exactly `width · height`.
    pub fn new(width: u32, height: u32, texels: Vec<T>) -> Result<Self, GeometryError> {
        if width == 0 || height == 0 {
            return Err(GeometryError::ZeroCount { what: "image size" });
        }
        // A product past the address space cannot equal any length.
        let expected = (width as usize).saturating_mul(height as usize);
        if texels.len() != expected {
            return Err(GeometryError::Length { what: "image", len: texels.len(), expected });
        }
        Ok(Self { width, height, texels })
    }

    /// An image of one value. Sizes of 0 are raised to 1.
    ///
    /// # Panics
    /// If the memory cannot be had.
    #[must_use]
    pub fn filled(width: u32, height: u32, value: T) -> Self {
        let (width, height) = (width.max(1), height.max(1));
        Self { width, height, texels: alloc::vec![value; width as usize * height as usize] }
    }

    /// Width in texels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in texels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All texels, row after row.
    #[must_use]
    pub fn texels(&self) -> &[T] {
        &self.texels
    }

    /// All texels, row after row.
    #[must_use]
    pub fn texels_mut(&mut self) -> &mut [T] {
        &mut self.texels
    }

    /// The texel in column `x`, row `y`.
    ///
    /// # Panics
    /// If the position is outside the image.
    #[must_use]
    pub fn get(&self, x: u32, y: u32) -> T {
        assert!(x < self.width, "column {x} of {}", self.width);
        self.texels[y as usize * self.width as usize + x as usize]
    }

    /// Copies `source` so that its top left texel comes to (`x`, `y`); what does not fit is left out.
    pub fn blit(&mut self, source: &Self, x: u32, y: u32) {
        self.blit_rows(&source.texels, source.width, x, y);
    }

    /// Like [`Self::blit`], for the bare texels of an image of the given width; an incomplete last row is left out.
    pub fn blit_rows(&mut self, source: &[T], source_width: u32, x: u32, y: u32) {
        let columns = source_width.min(self.width.saturating_sub(x)) as usize;
        if columns == 0 {
            return;
        }
        for (row, from) in (y..self.height).zip(source.chunks_exact(source_width.max(1) as usize)) {
            let to = row as usize * self.width as usize + x as usize;
            self.texels[to..to + columns].copy_from_slice(&from[..columns]);
        }
    }

    /// The image with every texel mapped.
    #[must_use]
    pub fn map<U>(&self, f: impl FnMut(T) -> U) -> Image<U> {
        Image { width: self.width, height: self.height, texels: self.texels.iter().copied().map(f).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn shape_is_checked() {
        assert!(Image::new(2, 2, vec![0u8; 4]).is_ok());
        assert!(Image::new(2, 2, vec![0u8; 5]).is_err());
        assert!(Image::new(0, 2, Vec::<u8>::new()).is_err());
    }

    #[test]
    fn blit_clips() {
        let mut canvas = Image::filled(3, 2, 0u8);
        canvas.blit(&Image::filled(2, 2, 7), 2, 1);
        canvas.blit(&Image::filled(2, 2, 9), 7, 0);
        assert_eq!(canvas.texels(), [0, 0, 0, 0, 0, 7]);
    }
}

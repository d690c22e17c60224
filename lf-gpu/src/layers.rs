//! Where slices lie in an array texture whose layers are fewer than they.

/// Slices as layers of a texture: one to a layer, or a grid of them to each where the device has too few layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layers {
    slice: [u32; 2],
    grid: [u32; 2],
    count: u32,
}

impl Layers {
    /// One slice to a layer.
    pub(crate) fn plain([width, height, count]: [u32; 3]) -> Self {
        Self { slice: [width, height], grid: [1, 1], count }
    }

    /// The smallest grid with which `size` (width, height, slices) fits into `most` layers of edge `edge`; `None` if none does.
    pub(crate) fn within([width, height, slices]: [u32; 3], edge: u32, most: u32) -> Option<Self> {
        let [columns, rows] = [width, height].map(|texels| edge.checked_div(texels).unwrap_or(0));
        let needed = slices.div_ceil(most.max(1)).max(1);
        let across = needed.min(columns).max(1);
        let down = needed.div_ceil(across);
        let grid = [across, down];
        let count = slices.div_ceil(across.checked_mul(down)?);
        (columns >= across && rows >= down && count <= most).then_some(Self { slice: [width, height], grid, count })
    }

    /// Width, height and layers of the texture.
    pub(crate) fn size(&self) -> [u32; 3] {
        [self.slice[0] * self.grid[0], self.slice[1] * self.grid[1], self.count]
    }

    /// Slices along the rows and columns of a layer.
    pub(crate) fn grid(&self) -> [u32; 2] {
        self.grid
    }

    /// Texel and layer where a slice begins. Mirrored by `fetch` in shared.wgsl.
    pub(crate) fn place(&self, slice: u32) -> [u32; 3] {
        let [across, down] = self.grid;
        let within = slice % (across * down);
        [within % across * self.slice[0], within / across * self.slice[1], slice / (across * down)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_share_layers_only_where_they_must() {
        let size = [1024, 512, 96];
        assert_eq!(Layers::within(size, 8192, 256), Some(Layers::plain(size)));
        let shared = Layers::within(size, 2048, 20).unwrap();
        assert_eq!((shared.grid(), shared.size()), ([2, 3], [2048, 1536, 16]));
        assert_eq!(Layers::within(size, 1023, 256), None);
        assert_eq!(Layers::within(size, 2048, 10), None);
        assert_eq!(Layers::within([1024, 512, 80], 2048, 10).map(|layers| layers.grid()), Some([2, 4]));
    }

    #[test]
    fn every_slice_has_a_place_of_its_own() {
        let layers = Layers::within([8, 4, 23], 24, 5).unwrap();
        let places: Vec<_> = (0..23).map(|slice| layers.place(slice)).collect();
        let [width, height, count] = layers.size();
        for (i, place) in places.iter().enumerate() {
            assert!(place[0] + 8 <= width && place[1] + 4 <= height && place[2] < count);
            assert!(!places[..i].contains(place));
        }
    }
}

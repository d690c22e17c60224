//! Light fields of any shape, small enough to be tried by the thousand.

use std::ops::Range;

use arbitrary::Arbitrary;
use glam::{DVec3, Vec3};
use lf_math::{Cell, Coverage, Face, LightFieldGeometry, SampledAxis, Slab};

/// What a light field's shape is made from.
#[derive(Arbitrary, Debug)]
pub(crate) struct Shape {
    center: [f64; 3],
    half_extent: [f32; 3],
    slabs: [Option<SlabShape>; 6],
}

#[derive(Arbitrary, Debug)]
struct SlabShape {
    plane: f32,
    firsts: [f32; 4],
    steps: [f32; 4],
    counts: [u8; 4],
    focal_depth: Option<f32>,
    windows: Option<[Vec<[u8; 2]>; 2]>,
    kept: Option<Vec<bool>>,
}

impl Shape {
    /// The geometry and what is kept of each slab; `None` if the numbers make none.
    pub(crate) fn geometry(&self) -> Option<(LightFieldGeometry, Vec<Coverage>)> {
        let cell = Cell::new(DVec3::from(self.center), Vec3::from(self.half_extent)).ok()?;
        let (mut slabs, mut coverages) = (Vec::new(), Vec::new());
        for (face, shape) in Face::ALL.into_iter().zip(&self.slabs) {
            let Some(shape) = shape else { continue };
            let slab = shape.slab(face)?;
            coverages.push(shape.coverage(&slab, &cell)?);
            slabs.push(slab);
        }
        Some((LightFieldGeometry::new(cell, slabs).ok()?, coverages))
    }
}

impl SlabShape {
    fn slab(&self, face: Face) -> Option<Slab> {
        let axis = |i: usize| {
            let most = if i < 2 { 6 } else { 12 };
            SampledAxis::new(self.firsts[i], self.steps[i], u32::from(self.counts[i] % most) + 1).ok()
        };
        Slab::new(face, self.plane, [axis(0)?, axis(1)?], [axis(2)?, axis(3)?], self.focal_depth).ok()
    }

    fn coverage(&self, slab: &Slab, cell: &Cell) -> Option<Coverage> {
        let coverage = match &self.windows {
            None => Coverage::of_cell(slab, cell),
            Some(windows) => {
                let [columns, rows] =
                    [0, 1].map(|i: usize| ranges(&windows[i], slab.cameras()[i], slab.resolution()[i]));
                Coverage::new(slab, columns, rows).ok()?
            }
        };
        match &self.kept {
            None => Some(coverage),
            Some(bits) => {
                let count = (slab.cameras()[0] * slab.cameras()[1]) as usize;
                let kept = bits.iter().copied().chain(std::iter::repeat(true)).take(count).collect();
                coverage.with_cameras(kept).ok()
            }
        }
    }
}

/// A window within the image for each camera.
fn ranges(numbers: &[[u8; 2]], cameras: u32, texels: u32) -> Vec<Range<u32>> {
    let window = |i: u32| {
        let [a, b] = numbers.get(i as usize).copied().unwrap_or([0, 255]).map(|n| u32::from(n) % (texels + 1));
        a.min(b)..a.max(b)
    };
    (0..cameras).map(window).collect()
}

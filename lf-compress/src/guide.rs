//! What a device holds to reflect by guided cubes: a few distance cubes, and slabs of inverse depth that say where to look in them.

use half::f16;
use lf_math::{GeometryError, LightFieldGeometry, SlabTexels};

use crate::packed_cube::PackedCube;

/// The largest half float: what stands on the camera plane has no inverse depth.
const MAX: f32 = 65504.0;
/// What is infinitely far is taken to be at least this many times as far as rays start from cubes: they all see it in one direction.
const SKY: f32 = 1e3;

/// A light field of inverse depths: 1/m along the face's axis from the camera plane, negative behind it, 0 where nothing is met.
#[derive(Debug, Clone)]
pub struct DepthGuide {
    geometry: LightFieldGeometry,
    texels: Vec<SlabTexels<f16>>,
}

/// Distance cubes of one size and a guide through them.
#[derive(Debug, Clone)]
pub struct GuidedCubes {
    cubes: Vec<PackedCube>,
    guide: DepthGuide,
    reach: f32,
    far: f32,
}

impl DepthGuide {
    /// A guide with the inverse depths of each slab.
    ///
    /// # Errors
    /// There must be whole images for every slab, with its numbers of cameras and texels, and all numbers. They are rounded to half floats.
    pub fn new(geometry: LightFieldGeometry, texels: &[SlabTexels<f32>]) -> Result<Self, GeometryError> {
        let expected = geometry.slabs().len();
        if texels.len() != expected {
            return Err(GeometryError::Length { what: "guide slabs", len: texels.len(), expected });
        }
        for (slab, texels) in geometry.slabs().iter().zip(texels) {
            texels.check(slab)?;
            if let Some(&value) = texels.texels().iter().find(|inverse| inverse.is_nan()) {
                return Err(GeometryError::NotFinite { what: "inverse depth", value });
            }
            let whole = slab.cameras().iter().chain(&slab.resolution()).map(|&n| n as usize).product();
            if texels.texels().len() != whole {
                return Err(GeometryError::Length {
                    what: "guide texels",
                    len: texels.texels().len(),
                    expected: whole,
                });
            }
        }
        let rounded = |texels: &SlabTexels<f32>| texels.map(|inverse| f16::from_f32(inverse.clamp(-MAX, MAX)));
        Ok(Self { geometry, texels: texels.iter().map(rounded).collect() })
    }

    /// Bytes of the half floats.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.texels.iter().map(|texels| 2 * texels.texels().len()).sum()
    }

    /// The cell and the slabs.
    #[must_use]
    pub fn geometry(&self) -> &LightFieldGeometry {
        &self.geometry
    }

    /// The inverse depths of a slab, by its position in the geometry: image after image, row after row.
    #[must_use]
    pub fn inverse_depths(&self, slab: usize) -> &[f16] {
        self.texels[slab].texels()
    }
}

impl GuidedCubes {
    /// Cubes with the guide that says where rays end in them.
    ///
    /// # Errors
    /// There must be at least one cube, all of one size, and as many texels of depth in each as of its picture.
    pub fn new(cubes: Vec<PackedCube>, guide: DepthGuide) -> Result<Self, GeometryError> {
        let size = cubes.first().ok_or(GeometryError::ZeroCount { what: "number of cubes" })?.size();
        for cube in &cubes {
            for have in [cube.size(), cube.inverse_depths()[0].width()] {
                if have != size {
                    let what = "face of a guided cube";
                    return Err(GeometryError::Size { what, have: [have; 2], want: [size; 2] });
                }
            }
        }
        let corner = guide.geometry().cell().half_extent();
        let reach = |cube: &PackedCube| (cube.position().abs() + corner).length();
        let reach = cubes.iter().map(reach).fold(0.0, f32::max);
        let depth = cubes.iter().map(PackedCube::largest_depth).fold(0.0, f32::max);
        Ok(Self { far: (4.0 * depth).max(SKY * reach), cubes, guide, reach })
    }

    /// The cubes.
    #[must_use]
    pub fn cubes(&self) -> &[PackedCube] {
        &self.cubes
    }

    /// The guide.
    #[must_use]
    pub fn guide(&self) -> &DepthGuide {
        &self.guide
    }

    /// Texels along the edge of a face of each cube.
    #[must_use]
    pub fn size(&self) -> u32 {
        self.cubes[0].size()
    }

    /// The largest distance of a cube from where a ray may start, metres: those start anywhere in the cell.
    #[must_use]
    pub fn reach(&self) -> f32 {
        self.reach
    }

    /// How far what is infinitely far is taken to be, metres.
    #[must_use]
    pub fn far(&self) -> f32 {
        self.far
    }

    /// Bytes of all blocks and half floats.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.cubes.iter().map(PackedCube::bytes).sum::<usize>() + self.guide.bytes()
    }
}

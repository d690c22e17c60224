//! Mirrors among what guided cubes show.
//!
//! What a curved mirror shows depends on where it is seen from, and neither pictures from a few places nor slabs of affordable size know it:
//! no focal plane, no depth makes its texels agree. So their texels hold what the mirror reflects of its light instead, and a ray that ends
//! on one goes on through the same cubes, as rays go on through layered depth images (Lischinski & Rappoport 1998, §4.3). The mirror's normal
//! is that of the planes which blocks of depths hold anyway, blended between the blocks around: the plane that fits a curved surface best has its
//! normal in the block's middle. So mirrors cost two bits a block.
//!
//! Behind a mirror rays start outside the cell, where the guide says nothing: they are followed by steps alone. What no cube sees (the back
//! of things) is not found, as elsewhere.

use glam::Vec3;
use lf_math::{Ray, normalized};

use crate::frame::decoded;
use crate::surface::SurfaceCube;

/// Mirrors that a ray is followed over. What the last one shows is its own colour.
pub(crate) const MAX_MIRRORS: u32 = 4;
/// Steps of a ray that a mirror reflects.
pub(crate) const MIRROR_STEPS: u32 = 24;
/// Such a ray starts so far from the mirror, as a share of its distance from the first cube: closer than that it meets the mirror again, by the
/// rounding of depths.
pub(crate) const START: f32 = 0.01;
/// Planes of neighbouring blocks belong to one mirror if a place on it has the same depth by both, to this share.
const SAME: f32 = 0.03;

/// A mirror where a ray meets it.
pub(crate) struct Mirror {
    /// Unit normal.
    pub(crate) normal: Vec3,
    /// The share of light that it reflects, linear.
    pub(crate) reflectance: Vec3,
}

impl Mirror {
    /// The mirror at a place, if most of the cubes that see the place, to a share of its depth, show one.
    pub(crate) fn at(place: Vec3, cubes: &[SurfaceCube], seen: f32) -> Option<Self> {
        let (mut normal, mut color, mut mirrors, mut others) = (Vec3::ZERO, Vec3::ZERO, 0, 0);
        for cube in cubes {
            if (cube.relative_depth(place) - 1.0).abs() >= seen {
                continue;
            }
            if cube.is_mirror(place) {
                mirrors += 1;
                normal += cube.mirror_normal(place, SAME);
                color += cube.nearest_color(place);
            } else {
                others += 1;
            }
        }
        let normal = normalized(normal).filter(|_| mirrors > 0 && mirrors >= others)?;
        Some(Self { normal, reflectance: decoded(color / mirrors as f32) })
    }

    /// The ray that goes on from a place, from [`START`] on; none for one that comes from behind.
    pub(crate) fn reflected(&self, place: Vec3, direction: Vec3) -> Option<Ray> {
        let along = direction.dot(self.normal);
        (along < 0.0).then(|| Ray { origin: place, direction: direction - 2.0 * along * self.normal })
    }
}

//! Distance cubes whose depths stay planes.
//!
//! A block of depths ([`lf_compress::planes`]) is two planes of the scene and a bit for each texel that says which one it shows. Where a
//! ray meets what a texel shows then has a closed form: the place is not bound to texels' middles, and there is nothing to search for.

use glam::{Vec2, Vec3};
use lf_compress::PackedCube;
use lf_compress::bc1::BLOCK_BYTES;
use lf_compress::planes::{BLOCK_EDGE, PlaneImage};
use lf_math::{CubeCoord, Face, Ray, cube_direction};

use crate::palette::{self, Block, has_three_colors, words};

/// A ray along which the depth relative to a plane's changes by less than this a metre is taken to be parallel to it: they would meet beyond
/// any scene, and quotients stay finite, as shaders must have them.
const PARALLEL: f32 = 1e-20;
/// Texels along an edge of a block of depths.
pub(crate) const EDGE: u32 = BLOCK_EDGE as u32;

/// A block of depths: its planes, each as the vector whose dot product with a place, seen from the cube, is the place's depth relative to
/// the plane's, and the texels that show the second.
#[derive(Debug, Clone, Copy)]
struct DepthBlock {
    planes: [Vec3; 2],
    mask: u64,
}

/// A distance cube in blocks: planes, and BC1 for the picture.
#[derive(Debug, Clone)]
pub(crate) struct SurfaceCube {
    position: Vec3,
    /// Texels along an edge of a face, and blocks.
    size: u32,
    across: u32,
    /// Face after face, row after row.
    blocks: Vec<DepthBlock>,
    colors: Vec<Block>,
    /// Whether any block of the picture has three colours.
    three: bool,
    /// Which of each block's planes are mirrors; empty if none is.
    mirrors: Vec<[bool; 2]>,
}

/// Where a direction leads: a face and coordinates on it, in texels from its corner.
struct Spot {
    face: u32,
    at: Vec2,
}

impl SurfaceCube {
    /// A cube that has as many texels of depth as of its picture.
    pub(crate) fn new(cube: &PackedCube) -> Self {
        let (size, depths) = (cube.size(), cube.inverse_depths());
        let colors = cube.radiance().iter().flat_map(|face| face.as_chunks::<BLOCK_BYTES>().0);
        let colors: Vec<Block> = colors.map(words).collect();
        let blocks: Vec<_> = Face::ALL.into_iter().zip(depths).flat_map(|(face, image)| blocks(face, image)).collect();
        let marked = if cube.has_mirrors() { blocks.len() } else { 0 };
        Self {
            position: cube.position(),
            size,
            across: size.div_ceil(BLOCK_EDGE as u32),
            blocks,
            three: colors.iter().any(has_three_colors),
            colors,
            mirrors: (0..marked).map(|block| cube.mirrors(block)).collect(),
        }
    }

    pub(crate) fn position(&self) -> Vec3 {
        self.position
    }

    /// Texels along an edge of a face.
    pub(crate) fn size(&self) -> u32 {
        self.size
    }

    /// Blocks of depths along an edge of a face.
    pub(crate) fn across(&self) -> u32 {
        self.across
    }

    /// As `lf_math::cube_coord` has it. Of no direction, or what is not finite, it is anywhere.
    #[inline(always)]
    fn spot(&self, away: Vec3) -> Spot {
        let (a, Vec3 { x, y, z }) = (away.abs(), away);
        let (face, right, down, forward) = if a.x >= a.y && a.x >= a.z {
            if x < 0.0 { (1, z, -y, a.x) } else { (0, -z, -y, a.x) }
        } else if a.y >= a.z {
            if y < 0.0 { (3, x, -z, a.y) } else { (2, x, z, a.y) }
        } else if z < 0.0 {
            (5, -x, -y, a.z)
        } else {
            (4, x, -y, a.z)
        };
        let half = 0.5 * self.size as f32;
        Spot { face, at: half + Vec2::new(right, down) * (half / forward) }
    }

    /// The number of the block that holds a texel.
    #[inline(always)]
    fn block(&self, face: u32, [x, y]: [u32; 2]) -> usize {
        ((face * self.across + y / EDGE) * self.across + x / EDGE) as usize
    }

    /// One of the planes of a block, by its texel's bit.
    #[inline(always)]
    pub(crate) fn plane_of(&self, block: usize, bit: u32) -> Vec3 {
        self.blocks.get(block).map_or(Vec3::ZERO, |block| block.planes[(block.mask >> bit & 1) as usize])
    }

    /// Whether any block of the picture has three colours.
    pub(crate) fn has_three_colors(&self) -> bool {
        self.three
    }

    /// A block of the picture.
    #[inline(always)]
    pub(crate) fn color_block(&self, number: usize) -> Block {
        self.colors.get(number).copied().unwrap_or_default()
    }

    /// The face and the texel that a direction leads to.
    #[inline(always)]
    fn nearest(&self, away: Vec3) -> (u32, [u32; 2]) {
        let Spot { face, at } = self.spot(away);
        (face, at.to_array().map(|at| (at as u32).min(self.size - 1)))
    }

    /// The plane seen in the direction of a place.
    #[inline(always)]
    fn nearest_plane(&self, away: Vec3) -> Vec3 {
        let (face, texel) = self.nearest(away);
        self.plane_of(self.block(face, texel), bit(texel))
    }

    /// Whether any plane is a mirror.
    pub(crate) fn has_mirrors(&self) -> bool {
        !self.mirrors.is_empty()
    }

    /// Whether the texel in the direction of a place shows a mirror.
    pub(crate) fn is_mirror(&self, place: Vec3) -> bool {
        let (face, texel) = self.nearest(place - self.position);
        let block = self.block(face, texel);
        let marks = self.mirrors.get(block).zip(self.blocks.get(block));
        marks.is_some_and(|(marks, block)| marks[(block.mask >> bit(texel) & 1) as usize])
    }

    /// The colour of the texel in the direction of a place, 0 … 1.
    pub(crate) fn nearest_color(&self, place: Vec3) -> Vec3 {
        let (face, [x, y]) = self.nearest(place - self.position);
        let across = self.size.div_ceil(4);
        palette::color(&self.color_block(((face * across + y / 4) * across + x / 4) as usize), 4 * (y % 4) + x % 4)
    }

    /// The normal of a mirror at a place: the normals of the four blocks around, those of their planes that are mirrors and pass the place
    /// within a share of its depth, blended by how near to the blocks' middles it is and how many texels show the plane, and longer the more squarely
    /// it is seen.
    pub(crate) fn mirror_normal(&self, place: Vec3, same: f32) -> Vec3 {
        let away = place - self.position;
        let Spot { face, at } = self.spot(away);
        let among = at / EDGE as f32 - 0.5;
        let (low, distance) = (among.floor(), away.length());
        let mut sum = Vec3::ZERO;
        for corner in [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE] {
            let block = low + corner;
            if block.min_element() < 0.0 || block.max_element() >= self.across as f32 {
                continue;
            }
            let number = ((face * self.across + block.y as u32) * self.across + block.x as u32) as usize;
            let share = Vec2::ONE - (among - block).abs();
            let Some((marks, block)) = self.mirrors.get(number).zip(self.blocks.get(number)) else { continue };
            let texels = [block.mask.count_zeros(), block.mask.count_ones()];
            for ((plane, texels), _) in
                block.planes.into_iter().zip(texels).zip(marks).filter(|(_, is_mirror)| **is_mirror)
            {
                if (plane.dot(away) - 1.0).abs() < same {
                    // The plane's vector is as long as the inverse of its distance, and leads away.
                    let squarely = (plane.length() * distance).powi(-2);
                    sum -= share.x * share.y * texels as f32 * squarely * plane.normalize();
                }
            }
        }
        sum
    }

    /// How deep a place of cell space is, as a multiple of what the nearest texel shows: less than 1 in front of it.
    #[inline(always)]
    pub(crate) fn relative_depth(&self, place: Vec3) -> f32 {
        let away = place - self.position;
        self.nearest_plane(away).dot(away)
    }

    /// The same by the nearest thing that any of the four texels around shows: things are half a texel wider.
    #[inline(always)]
    pub(crate) fn largest_relative_depth(&self, place: Vec3) -> f32 {
        let away = place - self.position;
        let Spot { face, at } = self.spot(away);
        // Half a texel from the face's edge there is only one neighbour: the cast of −½ and of the 0 above it is 0.
        let low = (at - 0.5).to_array().map(|at| at as u32);
        let high = (at + 0.5).to_array().map(|at| (at as u32).min(self.size - 1));
        let texels = [low, [high[0], low[1]], [low[0], high[1]], high];
        if (low[0] ^ high[0] | low[1] ^ high[1]) < EDGE {
            // Mostly they are in one block.
            return self.largest_in_block(self.block(face, low), texels.map(bit), away);
        }
        texels.map(|texel| self.plane_of(self.block(face, texel), bit(texel)).dot(away)).into_iter().fold(0.0, f32::max)
    }

    /// The largest relative depth by some of a block's texels.
    #[inline(always)]
    fn largest_in_block(&self, block: usize, bits: [u32; 4], away: Vec3) -> f32 {
        let Some(DepthBlock { planes, mask }) = self.blocks.get(block) else { return 0.0 };
        match bits.map(|bit| mask >> bit & 1).into_iter().sum::<u64>() {
            0 => planes[0].dot(away),
            4 => planes[1].dot(away),
            _ => planes[0].dot(away).max(planes[1].dot(away)),
        }
    }

    /// How far along a ray it meets the plane that the cube sees in the direction of a place; infinitely far behind its start if it never
    /// does.
    #[inline(always)]
    pub(crate) fn meets(&self, ray: &Ray, place: Vec3) -> f32 {
        let plane = self.nearest_plane(place - self.position);
        let along = plane.dot(ray.direction);
        if along.abs() < PARALLEL {
            return f32::NEG_INFINITY;
        }
        (1.0 - plane.dot(ray.origin - self.position)) / along
    }
}

/// A texel's bit in its block's mask.
#[inline(always)]
fn bit([x, y]: [u32; 2]) -> u32 {
    y % EDGE * EDGE + x % EDGE
}

/// Unit vectors to a face's middle, and from there to the right and down.
#[inline]
fn axes(face: Face) -> [Vec3; 3] {
    let towards = |u: f32, v: f32| cube_direction(CubeCoord { face, uv: Vec2::new(u, v) });
    let forward = towards(0.5, 0.5);
    [forward, towards(1.0, 0.5) - forward, towards(0.5, 1.0) - forward]
}

/// The blocks of a face. Its image's function m + x·a + y·b of the texel, times the depth along the face's axis, is linear in the place.
fn blocks(face: Face, image: &PlaneImage) -> impl Iterator<Item = DepthBlock> {
    let (half, across) = (0.5 * image.width() as f32, image.width().div_ceil(BLOCK_EDGE as u32));
    let [forward, right, down] = axes(face);
    (0..).zip(image.blocks()).map(move |(number, block)| {
        let corner = Vec2::new((number % across) as f32, (number / across) as f32) * BLOCK_EDGE as f32;
        let middle = half - 0.5 - corner;
        let plane = |plane: lf_compress::planes::Plane| {
            let [first, dx, dy] = plane.coefficients().map(|value| value * image.scale());
            half * (dx * right + dy * down) + (first + middle.x * dx + middle.y * dy) * forward
        };
        DepthBlock { planes: block.planes.map(plane), mask: block.mask }
    })
}

//! Distance cubes whose depths stay planes.
//!
//! A block of depths ([`lf_compress::planes`]) is two planes of the scene and a bit for each texel that says which one it shows. Where a
//! ray meets what a texel shows then has a closed form: the place is not bound to texels' middles, and there is nothing to search for.

use glam::{Vec2, Vec3};
use lf_compress::PackedCube;
use lf_compress::bc1::{BLOCK_BYTES, decode_texel};
use lf_compress::planes::{BLOCK_EDGE, PlaneImage};
use lf_math::{CubeCoord, Face, Ray, cube_coord, cube_direction};

/// Samples closer to a place than this, in texels, count alike. Less picks the nearest sample and shows its noise, more blurs.
const SHARPNESS: f32 = 0.3;
/// A ray along which the depth relative to a plane's changes by less than this a metre is taken to be parallel to it: they would meet beyond
/// any scene, and quotients stay finite, as shaders must have them.
const PARALLEL: f32 = 1e-20;

/// A block: its planes, each as the vector whose dot product with a place, seen from the cube, is the place's depth relative to
/// the plane's, and the texels that show the second.
#[derive(Debug, Clone, Copy)]
struct Block {
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
    blocks: Vec<Block>,
    colors: Vec<[u8; BLOCK_BYTES]>,
}

/// A blend of samples, each weighted by its distance from a place.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Blend {
    sum: Vec3,
    weight: f32,
}

/// Where a direction leads: a face and index coordinates on it, from −½ to half a texel past the last.
struct Spot {
    face: usize,
    at: Vec2,
}

impl SurfaceCube {
    /// A cube that has as many texels of depth as of its picture.
    pub(crate) fn new(cube: &PackedCube) -> Self {
        let (size, depths) = (cube.size(), cube.inverse_depths());
        let colors = cube.radiance().iter().flat_map(|face| face.as_chunks().0);
        Self {
            position: cube.position(),
            size,
            across: size.div_ceil(BLOCK_EDGE as u32),
            blocks: Face::ALL.into_iter().zip(depths).flat_map(|(face, image)| blocks(face, image)).collect(),
            colors: colors.copied().collect(),
        }
    }

    pub(crate) fn position(&self) -> Vec3 {
        self.position
    }

    #[inline]
    fn spot(&self, away: Vec3) -> Option<Spot> {
        let CubeCoord { face, uv } = cube_coord(away)?;
        Some(Spot { face: usize::from(face.index()), at: uv * self.size as f32 - 0.5 })
    }

    /// The plane that a texel shows.
    fn plane(&self, face: usize, [x, y]: [u32; 2]) -> Vec3 {
        let edge = BLOCK_EDGE as u32;
        let block = &self.blocks[((face as u32 * self.across + y / edge) * self.across + x / edge) as usize];
        block.planes[(block.mask >> (y % edge * edge + x % edge) & 1) as usize]
    }

    /// The colour of a texel, 0 … 255.
    fn color(&self, face: usize, [x, y]: [u32; 2]) -> Vec3 {
        let across = self.size.div_ceil(4);
        let block = &self.colors[((face as u32 * across + y / 4) * across + x / 4) as usize];
        let [r, g, b, _] = decode_texel(block, x as usize % 4, y as usize % 4);
        Vec3::new(f32::from(r), f32::from(g), f32::from(b))
    }

    /// The plane seen in the direction of a place; none for the position itself or what is not finite.
    fn nearest_plane(&self, away: Vec3) -> Option<Vec3> {
        let Spot { face, at } = self.spot(away)?;
        Some(self.plane(face, (at + 0.5).to_array().map(|at| (at as u32).min(self.size - 1))))
    }

    /// The four texels around, their numbers kept within the face.
    fn around(&self, at: Vec2) -> [[u32; 2]; 4] {
        // Half a texel from the face's edge there is only one neighbour: the cast of −½ and of the 0 above it is 0.
        let low = at.to_array().map(|at| at as u32);
        let high = at.to_array().map(|at| ((at + 1.0) as u32).min(self.size - 1));
        [[low[0], low[1]], [high[0], low[1]], [low[0], high[1]], [high[0], high[1]]]
    }

    /// How deep a place of cell space is, as a multiple of what the nearest texel shows: less than 1 in front of it.
    pub(crate) fn relative_depth(&self, place: Vec3) -> f32 {
        let away = place - self.position;
        self.nearest_plane(away).map_or(0.0, |plane| plane.dot(away))
    }

    /// The same by the nearest thing that any of the four texels around shows: things are half a texel wider.
    pub(crate) fn largest_relative_depth(&self, place: Vec3) -> f32 {
        let away = place - self.position;
        let Some(Spot { face, at }) = self.spot(away) else { return 0.0 };
        self.around(at).map(|texel| self.plane(face, texel).dot(away)).into_iter().fold(0.0, f32::max)
    }

    /// How far along a ray it meets the plane that the cube sees in the direction of a place; infinitely far behind its start if it never
    /// does.
    pub(crate) fn meets(&self, ray: &Ray, place: Vec3) -> f32 {
        let plane = self.nearest_plane(place - self.position).unwrap_or(Vec3::ZERO);
        let along = plane.dot(ray.direction);
        if along.abs() < PARALLEL {
            return f32::NEG_INFINITY;
        }
        (1.0 - plane.dot(ray.origin - self.position)) / along
    }

    /// Adds the four texels around a place, each by its distance from it on the surface it shows (Shepard 1968, exponent 4): what lies on
    /// another surface is far away. `far` is the depth of what is deeper or infinitely deep, `unit` a length to measure in.
    pub(crate) fn add_samples(&self, place: Vec3, far: f32, unit: f32, blend: &mut Blend) {
        let away = place - self.position;
        let Some(Spot { face, at }) = self.spot(away) else { return };
        let (texel, scale, least) = (2.0 / self.size as f32, unit.recip(), far.recip());
        let place = scale * away;
        let blur = (SHARPNESS * texel * place.abs().max_element()).powi(2);
        let [forward, right, down] = axes(Face::ALL[face]);
        for [x, y] in self.around(at) {
            let of_middle = |i: u32| texel * (i as f32 + 0.5) - 1.0;
            let direction = forward + of_middle(x) * right + of_middle(y) * down;
            let seen = (scale / self.plane(face, [x, y]).dot(direction).max(least)) * direction;
            let apart = (seen - place).length_squared() + blur;
            let weight = (apart * apart).recip();
            blend.sum += weight * self.color(face, [x, y]);
            blend.weight += weight;
        }
    }
}

impl Blend {
    /// The blend, 0 … 1; `None` without samples.
    pub(crate) fn color(self) -> Option<Vec3> {
        (self.weight > 0.0).then(|| self.sum / (255.0 * self.weight))
    }
}

/// Unit vectors to a face's middle, and from there to the right and down.
#[inline]
fn axes(face: Face) -> [Vec3; 3] {
    let towards = |u: f32, v: f32| cube_direction(CubeCoord { face, uv: Vec2::new(u, v) });
    let forward = towards(0.5, 0.5);
    [forward, towards(1.0, 0.5) - forward, towards(0.5, 1.0) - forward]
}

/// The blocks of a face. Its image's function m + x·a + y·b of the texel, times the depth along the face's axis, is linear in the place.
fn blocks(face: Face, image: &PlaneImage) -> impl Iterator<Item = Block> {
    let (half, across) = (0.5 * image.width() as f32, image.width().div_ceil(BLOCK_EDGE as u32));
    let [forward, right, down] = axes(face);
    (0..).zip(image.blocks()).map(move |(number, block)| {
        let corner = Vec2::new((number % across) as f32, (number / across) as f32) * BLOCK_EDGE as f32;
        let middle = half - 0.5 - corner;
        let plane = |plane: lf_compress::planes::Plane| {
            let [first, dx, dy] = plane.coefficients().map(|value| value * image.scale());
            half * (dx * right + dy * down) + (first + middle.x * dx + middle.y * dy) * forward
        };
        Block { planes: block.planes.map(plane), mask: block.mask }
    })
}

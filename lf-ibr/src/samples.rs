//! The colours of places by the texels that distance cubes have around them: a place for each lane of a vector.
//!
//! Each sample counts by its distance from the place, on the surface it shows (Shepard 1968, exponent 4): what lies on another surface is
//! far away, and among the many samples of several cubes one is near, so that edges of patterns stay edges.

use fearless_simd::prelude::*;

use crate::lanes::{F, Lanes, M, MAX_LANES, U, lanes, load, load_u32, real, to_lanes, whole};
use crate::palette::Ends;
use crate::surface::{EDGE, SurfaceCube};

/// Samples closer to a place than this, in texels, count alike. Less picks the nearest sample and shows its noise, more blurs.
const SHARPNESS: f32 = 0.3;

/// Directions as the faces they lead to have them.
#[derive(Clone, Copy)]
struct Faced<S: Simd> {
    x_major: M<S>,
    y_major: M<S>,
    sign: F<S>,
    face: U<S>,
    /// To the right, down and forward.
    local: [F<S>; 3],
    known: M<S>,
}

/// Two neighbours along an edge of a face.
#[derive(Clone, Copy)]
struct Neighbours<S: Simd>([U<S>; 2]);

/// Weighted samples, by channel.
struct Blend<S: Simd> {
    sums: [F<S>; 3],
    weight: F<S>,
}

/// The colours of places, by axis and lane, as all cubes show them: by channel and lane, 0 … 1, and which lanes have one, by bit. `far`
/// is the depth of what is deeper or infinitely deep.
#[inline(always)]
pub(crate) fn colors<S: Simd>(
    simd: S,
    cubes: &[SurfaceCube],
    places: &[Lanes<f32>; 3],
    far: f32,
) -> ([Lanes<f32>; 3], u64) {
    let zero = F::<S>::splat(simd, 0.0);
    let mut blend = Blend { sums: [zero; 3], weight: zero };
    // Lengths are measured in that from the first cube, so that their powers stay in range.
    let mut unit = F::<S>::splat(simd, 1.0);
    for (number, cube) in cubes.iter().enumerate() {
        let away = away(simd, cube, places);
        if number == 0 {
            unit = away[0].abs().max(away[1].abs()).max(away[2].abs());
        }
        add(simd, cube, &faced(simd, away), far, unit, &mut blend);
    }
    let scale = F::<S>::splat(simd, 1.0) / (blend.weight * 255.0);
    let mut colors = [[0.0; MAX_LANES]; 3];
    for (sum, color) in blend.sums.into_iter().zip(&mut colors) {
        (sum * scale).store_slice(&mut color[..lanes::<S>()]);
    }
    (colors, blend.weight.simd_gt(0.0).to_bitmask())
}

#[inline(always)]
fn away<S: Simd>(simd: S, cube: &SurfaceCube, places: &[Lanes<f32>; 3]) -> [F<S>; 3] {
    let from = cube.position();
    [load(simd, &places[0]) - from.x, load(simd, &places[1]) - from.y, load(simd, &places[2]) - from.z]
}

/// As `lf_math::cube_coord` has it.
#[inline(always)]
fn faced<S: Simd>(simd: S, [x, y, z]: [F<S>; 3]) -> Faced<S> {
    let (ax, ay, az) = (x.abs(), y.abs(), z.abs());
    let x_major = ax.simd_ge(ay) & ax.simd_ge(az);
    let y_major = !x_major & ay.simd_ge(az);
    let along = x_major.select(x, y_major.select(y, z));
    let negative = along.simd_lt(0.0);
    let number = |n: u32| U::<S>::splat(simd, n);
    let axis = x_major.select(number(0), y_major.select(number(2), number(4)));
    let sign = negative.select(F::<S>::splat(simd, -1.0), F::<S>::splat(simd, 1.0));
    let right = x_major.select(-z * sign, y_major.select(x, x * sign));
    let down = y_major.select(z * sign, -y);
    // Not so of what is not a number.
    let known = along.abs().simd_gt(0.0) & (ax + ay + az).simd_lt(f32::INFINITY);
    Faced {
        x_major,
        y_major,
        sign,
        face: axis + negative.select(number(1), number(0)),
        local: [right, down, along.abs()],
        known,
    }
}

impl<S: Simd> Faced<S> {
    /// The direction whose component along the face's axis is 1.
    #[inline(always)]
    fn direction(&self, right: F<S>, down: F<S>) -> [F<S>; 3] {
        let (x_major, y_major, sign) = (self.x_major, self.y_major, self.sign);
        [
            x_major.select(sign, y_major.select(right, right * sign)),
            y_major.select(sign, -down),
            x_major.select(-right * sign, y_major.select(down * sign, sign)),
        ]
    }
}

/// The texels on both sides of a coordinate, −1 … 1, kept within the face.
#[inline(always)]
fn neighbours<S: Simd>(at: F<S>, size: u32) -> Neighbours<S> {
    let half = 0.5 * size as f32;
    let high = (at * half + (half + 0.5)).max(0.5);
    let last = (size - 1) as f32;
    Neighbours([whole::<S>((high - 1.0).max(0.0).min(last)), whole::<S>(high.min(last))])
}

/// Adds the four texels of a cube around each place.
#[inline(always)]
fn add<S: Simd>(simd: S, cube: &SurfaceCube, place: &Faced<S>, far: f32, unit: F<S>, blend: &mut Blend<S>) {
    let [right, down, forward] = place.local;
    let (zero, one) = (F::<S>::splat(simd, 0.0), F::<S>::splat(simd, 1.0));
    let (texel, scale, back) = (2.0 / cube.size() as f32, one / unit, one / forward);
    let place_at = [right * scale, down * scale, forward * scale];
    let blur = place_at[2] * (SHARPNESS * texel);
    let blur = blur * blur;
    let columns = neighbours::<S>(right * back, cube.size());
    let rows = neighbours::<S>(down * back, cube.size());
    for row in rows.0 {
        let mut weights = [one; 2];
        for (column, weight) in columns.0.into_iter().zip(&mut weights) {
            let [x, y] =
                [real::<S>(column) * texel + (0.5 * texel - 1.0), real::<S>(row) * texel + (0.5 * texel - 1.0)];
            let [a, b, c] = place.direction(x, y);
            let plane = planes(simd, cube, place.face, [column, row]);
            let inverse = (plane[0] * a + plane[1] * b + plane[2] * c).max(far.recip());
            let depth = scale / inverse;
            let apart = [depth * x - place_at[0], depth * y - place_at[1], depth - place_at[2]];
            let apart = apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2] + blur;
            *weight = place.known.select(one / (apart * apart), zero);
            blend.weight += *weight;
        }
        for (column, weight) in columns.0.into_iter().zip(weights) {
            let (ends, code) = coded(simd, cube, place.face, [column, row]);
            ends.accumulate(simd, code, cube.has_three_colors(), weight, &mut blend.sums);
        }
    }
}

/// The planes that texels show.
#[inline(always)]
fn planes<S: Simd>(simd: S, cube: &SurfaceCube, face: U<S>, [x, y]: [U<S>; 2]) -> [F<S>; 3] {
    const EDGE_BITS: u32 = EDGE.trailing_zeros();
    let across = cube.across();
    let blocks = to_lanes::<S>((face * across + (y >> EDGE_BITS)) * across + (x >> EDGE_BITS));
    let bits = to_lanes::<S>(((y & (EDGE - 1)) << EDGE_BITS) + (x & (EDGE - 1)));
    let mut planes = [[0.0; MAX_LANES]; 3];
    for lane in 0..lanes::<S>() {
        let plane = cube.plane_of(blocks[lane] as usize, bits[lane]);
        (planes[0][lane], planes[1][lane], planes[2][lane]) = (plane.x, plane.y, plane.z);
    }
    [load(simd, &planes[0]), load(simd, &planes[1]), load(simd, &planes[2])]
}

/// The endpoints of texels' blocks, and their codes.
#[inline(always)]
fn coded<S: Simd>(simd: S, cube: &SurfaceCube, face: U<S>, [x, y]: [U<S>; 2]) -> (Ends<S>, U<S>) {
    let across = cube.size().div_ceil(4);
    let places = to_lanes::<S>((face * across + (y >> 2)) * across + (x >> 2));
    let mut words = [[0; MAX_LANES]; 2];
    for lane in 0..lanes::<S>() {
        [words[0][lane], words[1][lane]] = cube.color_block(places[lane] as usize);
    }
    let code = load_u32(simd, &words[1]) >> (((y & 3) << 3) + ((x & 3) << 1)) & 3;
    (Ends::new(load_u32(simd, &words[0])), code)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};
    use glam::{DVec3, Vec2, Vec3};
    use lf_compress::PackedCube;
    use lf_compress::bc1::Quality;
    use lf_math::{CubeCoord, CubeMap, DistanceCube, Face, Image, cube_coord, cube_direction};

    const SIZE: u32 = 12;
    const FAR: f32 = 40.0;

    fn hash(i: u32) -> u32 {
        let mixed = (i ^ 0x9E37_79B9).wrapping_mul(0x85EB_CA6B);
        let mixed = (mixed ^ mixed >> 15).wrapping_mul(0xC2B2_AE35);
        mixed ^ mixed >> 13
    }

    fn number(i: u32) -> f32 {
        hash(i) as f32 / 2f32.powi(32)
    }

    /// Noise, in which some texels show nothing.
    fn cube(seed: u32) -> PackedCube {
        let texels = |face: usize| (0..SIZE * SIZE).map(move |i| seed + 1000 * face as u32 + i);
        let picture = |face| Image::new(SIZE, SIZE, texels(face).map(|i| hash(i).to_le_bytes()).collect()).unwrap();
        let depths = |face| Image::new(SIZE, SIZE, texels(face).map(|i| (number(i) - 0.1).max(0.0)).collect()).unwrap();
        let (position, faces) = (Vec3::new(number(seed), number(seed + 1), 0.3), [0, 1, 2, 3, 4, 5]);
        let radiance = CubeMap::new(faces.map(picture)).unwrap();
        PackedCube::encode(&DistanceCube::new(position, radiance, faces.map(depths)).unwrap(), Quality::Fast).unwrap()
    }

    /// By the decoded texels, in double precision.
    fn expected(cubes: &[DistanceCube], place: Vec3) -> DVec3 {
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        for cube in cubes {
            let away = place - cube.position();
            let CubeCoord { face, uv } = cube_coord(away).unwrap();
            let number = usize::from(face.index());
            let low = uv * SIZE as f32 - 0.5;
            let blur = f64::from(SHARPNESS * 2.0 / SIZE as f32 * away.abs().max_element());
            for corner in [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE] {
                let texel = (low.floor() + corner).clamp(Vec2::ZERO, Vec2::splat(SIZE as f32 - 1.0));
                let at = (texel.y as u32 * SIZE + texel.x as u32) as usize;
                let inverse = f64::from(cube.inverse_depths()[number].texels()[at].max(FAR.recip()));
                let seen = cube_direction(CubeCoord { face, uv: (texel + 0.5) / SIZE as f32 }).as_dvec3() / inverse;
                let weight = ((seen - away.as_dvec3()).length_squared() + blur * blur).powi(-2);
                let [r, g, b, _] = cube.radiance().faces()[number].texels()[at].map(f64::from);
                sum += weight * DVec3::new(r, g, b) / 255.0;
                weights += weight;
            }
        }
        sum / weights
    }

    #[inline(always)]
    fn all<S: Simd>(simd: S, cubes: &[SurfaceCube], places: &[Vec3]) -> Vec<Option<Vec3>> {
        let mut found = vec![];
        for chunk in places.chunks(lanes::<S>()) {
            let mut by_axis = [[f32::NAN; MAX_LANES]; 3];
            for (lane, place) in chunk.iter().enumerate() {
                [by_axis[0][lane], by_axis[1][lane], by_axis[2][lane]] = place.to_array();
            }
            let (colors, known) = colors(simd, cubes, &by_axis, FAR);
            let color = |lane: usize| Vec3::new(colors[0][lane], colors[1][lane], colors[2][lane]);
            found.extend((0..chunk.len()).map(|lane| (known >> lane & 1 == 1).then(|| color(lane))));
        }
        found
    }

    #[test]
    fn colors_are_those_of_the_decoded_texels() {
        let packed = [cube(0), cube(20_000), cube(40_000)];
        let decoded = packed.each_ref().map(|cube| cube.decode().unwrap());
        let cubes = packed.each_ref().map(SurfaceCube::new);
        let place = |i: u32| 6.0 * (Vec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2)) - 0.5);
        let places: Vec<Vec3> = (90_000..91_003).map(place).collect();
        let faces = places.iter().map(|place| Face::dominant(*place - cubes[0].position()));
        assert!(Face::ALL.into_iter().all(|face| faces.clone().any(|found| found == Some(face))));
        for level in [Level::new(), Level::baseline()] {
            let found = dispatch!(level, simd => all(simd, &cubes, &places));
            for (place, found) in places.iter().zip(found) {
                let error = (expected(&decoded, *place) - found.unwrap().as_dvec3()).abs().max_element();
                assert!(error < 1e-3, "{place} {error}");
            }
        }
    }

    #[test]
    fn what_is_no_place_has_no_color() {
        let cubes = [SurfaceCube::new(&cube(7))];
        let places = [Vec3::NAN, Vec3::new(0.0, f32::NAN, 1.0), Vec3::INFINITY, cubes[0].position(), Vec3::splat(2.0)];
        let found = dispatch!(Level::new(), simd => all(simd, &cubes, &places));
        assert_eq!(found.iter().map(Option::is_some).collect::<Vec<_>>(), [false, false, false, false, true]);
    }
}

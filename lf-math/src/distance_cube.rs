//! Cube maps that know how far everything is.

use alloc::vec::Vec;

use glam::{Vec2, Vec3};

use crate::error::finite;
use crate::{CubeCoord, CubeMap, Face, GeometryError, Image, cube_coord, cube_direction};

/// What is seen from a point in all directions, and how far it is: a *distance cube* (Szirmay-Kalos et al. 2005), or a light
/// field probe (McGuire et al. 2017).
///
/// Kept is the inverse of the depth along the axis of the face, 1/m: in a face's image that is an affine function of the place
/// wherever a plane is seen, and no division is needed to tell whether something lies in front of it. 0 is infinitely far. The faces
/// of depths may have another size than the picture's.
///
/// Texels may be marked as mirrors ([`Self::with_mirrors`]).
#[derive(Debug, Clone, PartialEq)]
pub struct DistanceCube {
    position: Vec3,
    radiance: CubeMap,
    inverse_depths: [Image<f32>; 6],
    mirrors: Option<[Image<bool>; 6]>,
}

/// How the end of a ray is looked for in a distance cube.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Search {
    /// So many steps of the fixed point: the ray meets a sphere as far away as what the cube shows where it met the last one
    /// (Szirmay-Kalos et al. 2005). Cheap; goes astray where the distance jumps.
    FixedPoint(u32),
    /// So many steps along the ray, then so many halvings (Umenhoffer et al. 2007).
    March {
        /// Steps from half of the least depth to four times the largest, even in the inverse.
        steps: u32,
        /// Halvings of the step in which it ends.
        halvings: u32,
    },
}

impl DistanceCube {
    /// A cube seen from a point of cell space, with the inverse depth that the ray through each texel's middle meets.
    ///
    /// # Errors
    /// The position must be finite, inverse depths finite and at least 0, their faces square and of one size.
    pub fn new(position: Vec3, radiance: CubeMap, inverse_depths: [Image<f32>; 6]) -> Result<Self, GeometryError> {
        for value in position.to_array() {
            finite("probe position", value)?;
        }
        let want = [inverse_depths[0].width(); 2];
        for face in &inverse_depths {
            let have = [face.width(), face.height()];
            if have != want {
                return Err(GeometryError::Size { what: "face of inverse depths", have, want });
            }
            for &value in face.texels() {
                finite("inverse depth", value)?;
                if value < 0.0 {
                    return Err(GeometryError::NotPositive { what: "inverse depth", value });
                }
            }
        }
        Ok(Self { position, radiance, inverse_depths, mirrors: None })
    }

    /// The same with texels that show perfect mirrors, by face. Their colours in the picture are what those reflect of the light that
    /// they get, not the light that comes from them: that depends on where it goes.
    ///
    /// # Errors
    /// Faces must be of the size of the depths'.
    pub fn with_mirrors(mut self, mirrors: [Image<bool>; 6]) -> Result<Self, GeometryError> {
        let want = [self.depth_size(); 2];
        for face in &mirrors {
            let have = [face.width(), face.height()];
            if have != want {
                return Err(GeometryError::Size { what: "face of mirrors", have, want });
            }
        }
        self.mirrors = Some(mirrors);
        Ok(self)
    }

    /// The texels that show mirrors, by face, if they were told.
    #[must_use]
    pub fn mirrors(&self) -> Option<&[Image<bool>; 6]> {
        self.mirrors.as_ref()
    }

    /// Where it was taken, cell space.
    #[must_use]
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// The picture.
    #[must_use]
    pub fn radiance(&self) -> &CubeMap {
        &self.radiance
    }

    /// The inverse depths, 1/m, by face.
    #[must_use]
    pub fn inverse_depths(&self) -> &[Image<f32>; 6] {
        &self.inverse_depths
    }

    /// Texels along the edge of a face of inverse depths.
    #[must_use]
    pub fn depth_size(&self) -> u32 {
        self.inverse_depths[0].width()
    }

    /// How deep a place is, given by where it lies from the cube's position, as a multiple of what the nearest texel shows: less than 1 in
    /// front of it, more behind. 0 for a place that is the position itself or not finite.
    #[must_use]
    #[inline]
    pub fn relative_depth(&self, away: Vec3) -> f32 {
        let Some((face, place)) = self.place(away) else { return 0.0 };
        let nearest = (place + 0.5).to_array().map(|at| (at as u32).min(self.depth_size() - 1));
        away[face.axis()].abs() * self.inverse_depths[usize::from(face.index())].get(nearest[0], nearest[1])
    }

    /// As [`Self::relative_depth`], by the nearest thing that any of the four texels around shows: things are half a texel wider.
    #[must_use]
    #[inline]
    pub fn largest_relative_depth(&self, away: Vec3) -> f32 {
        let Some((face, place)) = self.place(away) else { return 0.0 };
        let image = &self.inverse_depths[usize::from(face.index())];
        let last = image.width() - 1;
        // Half a texel from the face's edge there is only one neighbour: the cast of −1 is 0.
        let below = place.to_array().map(libm::floorf);
        let (low, high) = (below.map(|at| at as u32), below.map(|at| ((at + 1.0) as u32).min(last)));
        let rows = [low[1], high[1]].map(|y| image.get(low[0], y).max(image.get(high[0], y)));
        away[face.axis()].abs() * rows[0].max(rows[1])
    }

    /// A direction's face and its place among the depths, index units, from −½ to half a texel past the last.
    #[inline]
    fn place(&self, away: Vec3) -> Option<(Face, Vec2)> {
        let CubeCoord { face, uv } = cube_coord(away)?;
        Some((face, uv * self.depth_size() as f32 - 0.5))
    }

    /// The least and the largest depth of what is seen, metres along the axes of the faces; `None` if that is nothing.
    #[must_use]
    pub fn depth_range(&self) -> Option<[f32; 2]> {
        let met = self.inverse_depths.iter().flat_map(Image::texels).filter(|inverse| **inverse > 0.0);
        let range = met.map(|inverse| [inverse.recip(); 2]);
        range.reduce(|[least, largest], [depth, _]| [least.min(depth), largest.max(depth)])
    }

    /// Ways along rays, metres, within which they are looked for in these cubes: half of the least depth of any to four times the largest
    /// that is not infinite.
    #[must_use]
    pub fn search_span<'a>(cubes: impl IntoIterator<Item = &'a Self>) -> [f32; 2] {
        let all = cubes.into_iter().filter_map(Self::depth_range);
        let [least, largest] = all.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap_or([2.0, 0.5]);
        [0.5 * least, 4.0 * largest]
    }

    /// A box around what is seen, cell space: on each of its six sides the median of where the face's rays end, which may be infinitely
    /// far. It is what a person would set as the room's walls; a mean or an extreme would follow single things.
    #[must_use]
    pub fn median_box(&self) -> [Vec3; 2] {
        let mut corners = [self.position; 2];
        for face in Face::ALL {
            let inverse = median(self.inverse_depths[usize::from(face.index())].texels().to_vec());
            corners[usize::from(face.sign() > 0.0)][face.axis()] += face.sign() / inverse;
        }
        corners
    }

    /// The median distance of what is seen, metres; infinite if that is nothing.
    #[must_use]
    pub fn median_distance(&self) -> f32 {
        let size = self.depth_size();
        let distances = Face::ALL.into_iter().flat_map(|face| {
            let texels = self.inverse_depths[usize::from(face.index())].texels();
            (0..size * size)
                .zip(texels)
                .map(move |(index, inverse)| texel_direction(face, index, size).length() / inverse)
        });
        median(distances.collect())
    }
}

/// The direction, with a largest component of ±1, through the middle of a texel of a face, numbered row by row.
fn texel_direction(face: Face, index: u32, size: u32) -> Vec3 {
    let middle = Vec2::new((index % size) as f32, (index / size) as f32) + 0.5;
    cube_direction(CubeCoord { face, uv: middle / size as f32 })
}

fn median(mut values: Vec<f32>) -> f32 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn black() -> CubeMap {
        CubeMap::new(Face::ALL.map(|_| Image::filled(1, 1, [0; 4]))).unwrap()
    }

    /// What is seen from a point of an empty room.
    fn room(position: Vec3, [min, max]: [Vec3; 2], size: u32) -> DistanceCube {
        let depths = Face::ALL.map(|face| {
            let mut image = Image::filled(size, size, 0.0);
            for (index, texel) in (0u32..).zip(image.texels_mut()) {
                let direction = texel_direction(face, index, size);
                *texel = ((min - position) / direction).max((max - position) / direction).min_element().recip();
            }
            image
        });
        DistanceCube::new(position, black(), depths).unwrap()
    }

    #[test]
    fn walls_are_where_they_are() {
        let walls = [Vec3::new(-2.0, -1.0, -3.0), Vec3::new(4.0, 3.0, 2.0)];
        let at = Vec3::new(0.5, 0.25, -0.5);
        let cube = room(at, walls, 65);
        for (way, distance) in [(Vec3::X, 3.5), (Vec3::NEG_X, 2.5), (Vec3::Y, 2.75), (Vec3::NEG_Z, 2.5)] {
            for part in [0.5, 1.0, 1.5] {
                assert!((cube.relative_depth(way * distance * part) - part).abs() < 1e-5);
                assert!((cube.largest_relative_depth(way * distance * part) - part).abs() < 1e-5);
            }
        }
        assert_eq!((cube.relative_depth(Vec3::ZERO), cube.largest_relative_depth(Vec3::NAN)), (0.0, 0.0));
    }

    /// Texels are where `cube_coord` says, to the last, and the four around are those whose middles surround the place.
    #[test]
    fn depths_are_those_of_the_texels_around() {
        let size = 8;
        let number = |face: Face, x: u32, y: u32| (1 + y * size + x + 100 * u32::from(face.index())) as f32;
        let depths = Face::ALL.map(|face| {
            Image::new(size, size, (0..size * size).map(|i| number(face, i % size, i / size)).collect()).unwrap()
        });
        let cube = DistanceCube::new(Vec3::ONE, black(), depths).unwrap();
        for face in Face::ALL {
            for (x, y) in (0..40u32).flat_map(|y| (0..40).map(move |x| (x, y))) {
                // Five places a texel, none on an edge between two or in a middle.
                let uv = (Vec2::new(x as f32, y as f32) + 0.4) / 40.0;
                let away = 3.0 * cube_direction(CubeCoord { face, uv });
                let nearest = 3.0 * number(face, x / 5, y / 5);
                assert!((cube.relative_depth(away) - nearest).abs() < 1e-3);
                // Numbers grow to the right and down: the largest is that below and right of the place.
                let next = |i: u32| ((2 * i + 5) / 10).min(size - 1);
                let largest = 3.0 * number(face, next(x), next(y));
                assert!((cube.largest_relative_depth(away) - largest).abs() < 1e-3, "{face:?} {x} {y}");
            }
        }
    }

    #[test]
    fn the_box_of_an_empty_room_is_the_room() {
        let walls = [Vec3::new(-2.0, -2.5, -3.0), Vec3::new(3.0, 3.0, 2.0)];
        let [min, max] = room(Vec3::new(0.5, 0.25, -0.5), walls, 64).median_box();
        assert!(
            (min - walls[0]).abs().max_element() < 1e-4 && (max - walls[1]).abs().max_element() < 1e-4,
            "{min} {max}"
        );
    }

    #[test]
    fn depths_lie_between_the_nearest_wall_and_the_farthest() {
        // An even number of texels has none in the middle: corners are as deep as the wall they are on.
        let [least, largest] = room(Vec3::ZERO, [Vec3::splat(-2.0), Vec3::splat(4.0)], 16).depth_range().unwrap();
        assert!((least - 2.0).abs() < 1e-5 && (largest - 4.0).abs() < 1e-5, "{least} {largest}");
    }

    #[test]
    fn the_median_distance_lies_between_wall_and_corner() {
        let distance = room(Vec3::ZERO, [Vec3::splat(-2.0), Vec3::splat(2.0)], 32).median_distance();
        assert!((2.0..2.0 * 3.0f32.sqrt()).contains(&distance), "{distance}");
    }

    #[test]
    fn broken_depths_are_refused() {
        let faces = |value: f32| Face::ALL.map(|_| Image::filled(2, 2, value));
        for broken in [f32::NAN, f32::INFINITY, -1.0] {
            assert!(DistanceCube::new(Vec3::ZERO, black(), faces(broken)).is_err());
        }
        assert!(DistanceCube::new(Vec3::NAN, black(), faces(1.0)).is_err());
        let far = DistanceCube::new(Vec3::ZERO, black(), faces(0.0)).unwrap();
        assert_eq!((far.relative_depth(Vec3::X), far.median_distance()), (0.0, f32::INFINITY));
        assert_eq!(far.depth_range(), None);
        let mut uneven = faces(1.0);
        uneven[3] = Image::filled(2, 3, 1.0);
        assert!(DistanceCube::new(Vec3::ZERO, black(), uneven).is_err());
        let mirrors = |size: u32| far.clone().with_mirrors(Face::ALL.map(|_| Image::filled(size, size, true)));
        assert!(mirrors(3).is_err());
        assert!(mirrors(2).unwrap().mirrors().unwrap()[4].get(1, 1));
    }
}

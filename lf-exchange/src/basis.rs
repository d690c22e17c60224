//! From a slab's images to true pictures and back: which way is right and which way is down.

use glam::{DMat3, DVec3, Vec2};
use lf_math::{Face, SampledAxis};

/// How the pictures of a face lie against its slab images.
///
/// A slab's image runs along the two tangents of its face, the same for both faces of an axis, so that it may be mirrored,
/// upside down or transposed against what a camera there sees (`spec/conventions.md`). A *picture* is what the camera sees:
/// columns to its right, rows from the top. The camera looks along the face, and its basis is right-handed:
/// right × up = −forward.
///
/// | face | right | up | picture column | picture row |
/// |---|---|---|---|---|
/// | +X | +Z | +Y | v | u, reversed |
/// | −X | −Z | +Y | v, reversed | u, reversed |
/// | +Y | −Z | +X | u, reversed | v, reversed |
/// | −Y | +Z | +X | u | v, reversed |
/// | +Z | −X | +Y | u, reversed | v, reversed |
/// | −Z | +X | +Y | u | v, reversed |
///
/// Up is +Y, and +X where the camera looks along ±Y, as [`lf_math::Pinhole`] has it. Cameras of the grid are counted in the
/// same way, (s, t) in place of (u, v): column 0 is the leftmost, row 0 the highest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PictureBasis {
    face: Face,
    right: Tangent,
    down: Tangent,
}

/// One of the two tangents of a face, walked forwards or backwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Tangent {
    /// 0 for (s, u), 1 for (t, v).
    index: usize,
    forwards: bool,
}

impl PictureBasis {
    /// The basis of a face.
    #[must_use]
    pub fn new(face: Face) -> Self {
        let up = if face.axis() == 0 { 0 } else { 1 };
        let forwards = matches!(face, Face::PosX | Face::NegY | Face::NegZ);
        Self {
            face,
            right: Tangent { index: 1 - up, forwards },
            // Up is always the tangent itself.
            down: Tangent { index: up, forwards: false },
        }
    }

    /// The face the camera looks along.
    #[must_use]
    pub fn face(&self) -> Face {
        self.face
    }

    /// The camera's rotation: its columns are right, up and back, in cell or world space. This is the camera of OpenGL
    /// and Blender, which looks along its −Z axis with +Y up.
    #[must_use]
    pub fn world_from_camera(&self) -> DMat3 {
        let (right, up) = (self.vector(self.right), -self.vector(self.down));
        DMat3::from_cols(right, up, right.cross(up))
    }

    /// Width and height of the picture of a grid of samples, given their numbers along the two tangents.
    #[must_use]
    pub fn size(&self, counts: [u32; 2]) -> [u32; 2] {
        [counts[self.right.index], counts[self.down.index]]
    }

    /// The numbers of samples along the two tangents of a grid whose picture has this width and height.
    #[must_use]
    pub fn counts(&self, size: [u32; 2]) -> [u32; 2] {
        // The table above either keeps or swaps the pair, so that it is its own inverse.
        self.size(size)
    }

    /// Where the sample with these indices along the tangents lies in the picture: column and row.
    ///
    /// # Panics
    /// In debug builds, if the sample is outside the grid.
    #[must_use]
    pub fn pixel(&self, sample: [u32; 2], counts: [u32; 2]) -> [u32; 2] {
        [self.right, self.down].map(|tangent| tangent.walk(sample[tangent.index], counts[tangent.index]))
    }

    /// The sample, by its indices along the tangents, that lies in this column and row of the picture.
    ///
    /// # Panics
    /// In debug builds, if the pixel is outside the picture.
    #[must_use]
    pub fn sample(&self, pixel: [u32; 2], counts: [u32; 2]) -> [u32; 2] {
        let mut sample = [0; 2];
        for (tangent, position) in [self.right, self.down].into_iter().zip(pixel) {
            sample[tangent.index] = tangent.walk(position, counts[tangent.index]);
        }
        sample
    }

    /// Coordinates along right and down of a point given by its coordinates along the tangents.
    #[must_use]
    pub fn right_down(&self, tangential: Vec2) -> [f64; 2] {
        let tangential = tangential.to_array();
        [self.right, self.down].map(|tangent| tangent.sign() * f64::from(tangential[tangent.index]))
    }

    /// The samples of a pair of axes as the picture has them: first coordinate and step along right and along down.
    #[must_use]
    pub fn picture_axes(&self, axes: [SampledAxis; 2]) -> [PictureAxis; 2] {
        [self.right, self.down].map(|tangent| {
            let axis = axes[tangent.index];
            let first = if tangent.forwards { axis.first() } else { -axis.last() };
            PictureAxis { first: first.into(), step: axis.step().into(), count: axis.count() }
        })
    }

    /// The inverse of [`Self::picture_axes`], as far as `f32` allows.
    ///
    /// # Errors
    /// As [`SampledAxis::new`].
    pub fn sampled_axes(&self, picture: [PictureAxis; 2]) -> Result<[SampledAxis; 2], lf_math::GeometryError> {
        let [right, down] = [(self.right, picture[0]), (self.down, picture[1])].map(|(tangent, axis)| {
            let first = if tangent.forwards { axis.first } else { -axis.last() };
            SampledAxis::new(first as f32, axis.step as f32, axis.count)
        });
        Ok(if self.right.index == 0 { [right?, down?] } else { [down?, right?] })
    }

    fn vector(&self, tangent: Tangent) -> DVec3 {
        let mut tangential = Vec2::ZERO;
        tangential[tangent.index] = 1.0;
        tangent.sign() * self.face.vector(tangential, 0.0).as_dvec3()
    }
}

impl Tangent {
    fn sign(self) -> f64 {
        if self.forwards { 1.0 } else { -1.0 }
    }

    fn walk(self, index: u32, count: u32) -> u32 {
        debug_assert!(index < count, "sample {index} of {count}");
        if self.forwards { index } else { count - 1 - index }
    }
}

/// Regular samples along right or down of a picture: camera positions in metres, or slopes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureAxis {
    /// Coordinate of the leftmost or topmost sample.
    pub first: f64,
    /// Distance to the next one, greater than 0.
    pub step: f64,
    /// How many there are.
    pub count: u32,
}

impl PictureAxis {
    /// The coordinate of a sample, counted from 0.
    #[must_use]
    pub fn coord(&self, index: u32) -> f64 {
        self.first + f64::from(index) * self.step
    }

    /// The coordinate of the last sample.
    #[must_use]
    pub fn last(&self) -> f64 {
        self.first + f64::from(self.count.saturating_sub(1)) * self.step
    }

    /// The coordinate in the middle between the first and the last sample.
    #[must_use]
    pub fn middle(&self) -> f64 {
        0.5 * (self.first + self.last())
    }
}

/// A pinhole camera without distortion, in pixels. Pixel centres lie at integers plus ½.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intrinsics {
    /// Width and height of the picture.
    pub size: [u32; 2],
    /// Focal length along x and y.
    pub focal: [f64; 2],
    /// The point straight ahead, x from the left and y from the top.
    pub principal: [f64; 2],
}

impl Intrinsics {
    /// The camera whose pixel centres have these slopes to the right and downwards.
    #[must_use]
    pub fn from_slopes(slopes: [PictureAxis; 2]) -> Self {
        Self {
            size: slopes.map(|axis| axis.count),
            focal: slopes.map(|axis| 1.0 / axis.step),
            principal: slopes.map(|axis| 0.5 - axis.first / axis.step),
        }
    }

    /// The slopes of the pixel centres, to the right and downwards.
    #[must_use]
    pub fn slopes(&self) -> [PictureAxis; 2] {
        [0, 1].map(|i| PictureAxis {
            first: (0.5 - self.principal[i]) / self.focal[i],
            step: 1.0 / self.focal[i],
            count: self.size[i],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use lf_math::Pinhole;

    const RIGHT_UP: [(Vec3, Vec3); 6] = [
        (Vec3::Z, Vec3::Y),
        (Vec3::NEG_Z, Vec3::Y),
        (Vec3::NEG_Z, Vec3::X),
        (Vec3::Z, Vec3::X),
        (Vec3::NEG_X, Vec3::Y),
        (Vec3::X, Vec3::Y),
    ];

    #[test]
    fn the_basis_is_the_table_s_and_right_handed() {
        for (face, (right, up)) in Face::ALL.into_iter().zip(RIGHT_UP) {
            let basis = PictureBasis::new(face).world_from_camera();
            assert_eq!((basis.x_axis, basis.y_axis), (right.as_dvec3(), up.as_dvec3()), "{face:?}");
            assert_eq!(basis.determinant(), 1.0);
            assert_eq!(-basis.z_axis, face.vector(Vec2::ZERO, face.sign()).as_dvec3(), "{face:?}");
        }
    }

    #[test]
    fn pixels_and_samples_are_inverse() {
        for face in Face::ALL {
            let basis = PictureBasis::new(face);
            let counts = [5, 3];
            assert_eq!(basis.counts(basis.size(counts)), counts);
            for sample in (0..5).flat_map(|u| (0..3).map(move |v| [u, v])) {
                let pixel = basis.pixel(sample, counts);
                assert!(pixel[0] < basis.size(counts)[0] && pixel[1] < basis.size(counts)[1]);
                assert_eq!(basis.sample(pixel, counts), sample, "{face:?}");
            }
        }
    }

    /// The oracle is `lf_math`'s pinhole, which knows neither slabs nor this table.
    #[test]
    fn pictures_are_what_a_pinhole_camera_sees() {
        let axis = SampledAxis::spanning(-1.0 + 1.0 / 8.0, 1.0 - 1.0 / 8.0, 8).unwrap();
        for face in Face::ALL {
            let forward = face.vector(Vec2::ZERO, face.sign());
            let camera = Pinhole::look_at(Vec3::ZERO, forward, core::f32::consts::FRAC_PI_2, 8, 8).unwrap();
            let basis = PictureBasis::new(face);
            for (x, y) in (0..8).flat_map(|x| (0..8).map(move |y| (x, y))) {
                let [u, v] = basis.sample([x, y], [8, 8]);
                let slopes = Vec2::new(axis.coord(u as f32), axis.coord(v as f32));
                let stored = face.vector(slopes, face.sign());
                assert!((stored - camera.ray(x, y).direction).length() < 1e-6, "{face:?} {x} {y}");
            }
        }
    }

    /// A point in space, projected by the camera matrix in double precision, lands on the texel that stores its ray.
    #[test]
    fn projection_by_the_camera_matrix_finds_the_texel() {
        let (u, v) = (SampledAxis::new(-0.7, 0.13, 12).unwrap(), SampledAxis::new(-0.4, 0.11, 9).unwrap());
        for face in Face::ALL {
            let basis = PictureBasis::new(face);
            let intrinsics = Intrinsics::from_slopes(basis.picture_axes([u, v]));
            for texel in [[0, 0], [11, 0], [3, 8], [7, 4]] {
                let slopes = Vec2::new(u.coord(texel[0] as f32), v.coord(texel[1] as f32));
                let point = 3.0 * face.vector(slopes, face.sign()).as_dvec3();
                let seen = basis.world_from_camera().transpose() * point;
                let pixel = basis.pixel(texel, [12, 9]);
                let x = intrinsics.principal[0] + intrinsics.focal[0] * seen.x / -seen.z;
                let y = intrinsics.principal[1] - intrinsics.focal[1] * seen.y / -seen.z;
                assert!((x - f64::from(pixel[0]) - 0.5).abs() < 1e-5, "{face:?} {texel:?} {x}");
                assert!((y - f64::from(pixel[1]) - 0.5).abs() < 1e-5, "{face:?} {texel:?} {y}");
            }
        }
    }

    #[test]
    fn axes_and_intrinsics_round_trip() {
        let (a, b) = (SampledAxis::new(-0.75, 0.125, 12).unwrap(), SampledAxis::new(0.5, 0.25, 9).unwrap());
        for face in Face::ALL {
            let basis = PictureBasis::new(face);
            let axes = basis.picture_axes([a, b]);
            assert_eq!(basis.sampled_axes(axes).unwrap(), [a, b], "{face:?}");
            assert_eq!(Intrinsics::from_slopes(axes).slopes(), axes, "{face:?}");
        }
    }
}

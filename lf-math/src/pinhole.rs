//! The viewer's camera.

use glam::{Mat4, Vec3, Vec4};

use crate::error::{GeometryError, finite, positive};
use crate::{Ray, length, normalized};

/// A pinhole camera in cell space, looking from `eye` along its forward axis, with square pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole {
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    tan_half_y: f32,
    width: u32,
    height: u32,
}

impl Pinhole {
    /// A camera at `eye` that looks at `target` with +Y up, or +X up if it looks straight along ±Y.
    ///
    /// `fov_y` is the vertical field of view in radians, `width × height` the image in pixels.
    ///
    /// # Errors
    /// `eye` and `target` must be finite and distinct, `fov_y` in 0 … π, the sizes at least 1.
    pub fn look_at(eye: Vec3, target: Vec3, fov_y: f32, width: u32, height: u32) -> Result<Self, GeometryError> {
        let apart = target - eye;
        let forward = normalized(apart)
            .ok_or(GeometryError::NotPositive { what: "distance from eye to target", value: length(apart) })?;
        Self::looking(eye, forward, Vec3::Y, fov_y, width, height)
    }

    /// A camera at `eye` that looks along `forward`, which needs no unit length, with `up` as far up as that allows; if it looks
    /// straight along `up`, with +X up.
    ///
    /// # Errors
    /// As [`Self::look_at`].
    pub fn looking(
        eye: Vec3,
        forward: Vec3,
        up: Vec3,
        fov_y: f32,
        width: u32,
        height: u32,
    ) -> Result<Self, GeometryError> {
        for value in eye.to_array() {
            finite("eye", value)?;
        }
        let long = length(forward);
        let forward = normalized(forward)
            .ok_or(GeometryError::NotPositive { what: "length of the view direction", value: long })?;
        let right =
            normalized(up).and_then(|up| normalized(forward.cross(up))).unwrap_or(Vec3::Z * -forward.y.signum());
        let tan_half_y = positive("tangent of half the field of view", libm::tanf(0.5 * fov_y))?;
        positive("what the field of view leaves of a half circle", core::f32::consts::PI - fov_y)?;
        if width == 0 || height == 0 {
            return Err(GeometryError::ZeroCount { what: "image size" });
        }
        Ok(Self { eye, right, up: right.cross(forward), forward, tan_half_y, width, height })
    }

    /// Where the camera stands, cell space.
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        self.eye
    }

    /// Image width in pixels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Image height in pixels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The ray through the centre of pixel (`x`, `y`); its direction has a forward component of 1.
    #[must_use]
    pub fn ray(&self, x: u32, y: u32) -> Ray {
        let scale = 2.0 * self.tan_half_y / self.height as f32;
        let dx = (x as f32 + 0.5 - 0.5 * self.width as f32) * scale;
        let dy = (0.5 * self.height as f32 - (y as f32 + 0.5)) * scale;
        Ray { origin: self.eye, direction: self.forward + dx * self.right + dy * self.up }
    }

    /// The view rays as a grid: the direction through the picture's upper left corner, and what it changes by for a pixel to the
    /// right and for one down. The forward component is 1, as of [`Self::ray`].
    #[must_use]
    pub fn ray_grid(&self) -> [Vec3; 3] {
        let scale = 2.0 * self.tan_half_y / self.height as f32;
        let (right, down) = (scale * self.right, -scale * self.up);
        let half = |pixels: u32| 0.5 * pixels as f32;
        [self.forward - half(self.width) * right - half(self.height) * down, right, down]
    }

    /// The matrix from cell space to clip space: x right, y up, depth `near/z` falling from 1 at the near plane to 0 at
    /// infinity ("reversed z"), which spends the precision of floats evenly over the distance.
    #[must_use]
    pub fn clip_from_cell(&self, near: f32) -> Mat4 {
        let sy = 1.0 / self.tan_half_y;
        let sx = sy * self.height as f32 / self.width as f32;
        let row = |axis: Vec3, scale: f32| (axis * scale).extend(-self.eye.dot(axis) * scale);
        let w = row(self.forward, 1.0);
        let z = Vec4::new(0.0, 0.0, 0.0, near);
        Mat4::from_cols(row(self.right, sx), row(self.up, sy), z, w).transpose()
    }
}

/// A near plane for drawing what lies in boxes: a thousandth of the distance from `eye` to the far side of the box around all of them.
///
/// Nearer parts are clipped; a smaller share would cost nothing in depth but let an eye inside the mesh see its inside.
#[must_use]
pub fn near_plane(eye: Vec3, boxes: impl IntoIterator<Item = (Vec3, Vec3)>) -> f32 {
    let (min, max) = boxes.into_iter().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default();
    let reach = length(0.5 * (min + max) - eye) + 0.5 * length(max - min);
    (1e-3 * reach).max(f32::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn refuses_what_cannot_look() {
        assert!(Pinhole::look_at(Vec3::ONE, Vec3::ONE, 1.0, 4, 4).is_err());
        assert!(Pinhole::look_at(Vec3::ONE, Vec3::ZERO, 0.0, 4, 4).is_err());
        assert!(Pinhole::look_at(Vec3::ONE, Vec3::ZERO, 40.0, 4, 4).is_err());
        assert!(Pinhole::look_at(Vec3::ONE, Vec3::ZERO, 1.0, 0, 4).is_err());
        assert!(Pinhole::look_at(Vec3::ZERO, Vec3::Y, 1.0, 4, 4).is_ok());
        assert!(Pinhole::look_at(Vec3::ZERO, Vec3::NAN, 1.0, 4, 4).is_err());
        assert!(Pinhole::look_at(Vec3::NAN, Vec3::ONE, 1.0, 4, 4).is_err());
        assert!(Pinhole::looking(Vec3::NAN, Vec3::Z, Vec3::Y, 1.0, 4, 4).is_err());
    }

    #[test]
    fn up_is_plus_x_straight_up_and_down() {
        for target in [Vec3::Y, Vec3::NEG_Y] {
            let camera = Pinhole::look_at(Vec3::ZERO, target, 1.0, 4, 4).unwrap();
            assert!(camera.ray(2, 0).direction.x > 0.0);
            assert_eq!(camera.ray(2, 0).direction.y, target.y);
        }
    }

    #[test]
    fn up_may_have_any_length() {
        let looking = |up| Pinhole::looking(Vec3::ZERO, Vec3::new(1.0, 2.0, -3.0), up, 1.0, 4, 4).unwrap();
        let up = Vec3::new(0.6, 0.8, 0.0);
        for exponent in [-120, -100, 100, 127] {
            assert_eq!(looking(up * 2.0f32.powi(exponent)), looking(up), "2^{exponent}");
        }
    }

    #[test]
    fn the_near_plane_does_not_depend_on_the_unit_of_length() {
        let near = |scale: f32| {
            near_plane(Vec3::new(3.0, 1.0, 2.0) * scale, [(Vec3::NEG_ONE * scale, Vec3::new(1.0, 2.0, 1.0) * scale)])
        };
        for exponent in [-100, -70, 70, 120] {
            let scale = 2.0f32.powi(exponent);
            assert_eq!(near(scale), near(1.0) * scale, "2^{exponent}");
        }
    }

    proptest! {
        #[test]
        fn rays_and_matrix_agree(x in 0u32..64, y in 0u32..48, depth in 0.2f32..50.0) {
            let camera = Pinhole::look_at(Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 0.5, 0.0), 0.8, 64, 48).unwrap();
            let clip = camera.clip_from_cell(0.1) * camera.ray(x, y).at(depth).extend(1.0);
            let pixel_x = (0.5 + 0.5 * clip.x / clip.w) * 64.0;
            let pixel_y = (0.5 - 0.5 * clip.y / clip.w) * 48.0;
            let [corner, right, down] = camera.ray_grid();
            let direction = corner + (x as f32 + 0.5) * right + (y as f32 + 0.5) * down;
            prop_assert!((direction - camera.ray(x, y).direction).length() < 1e-6);
            prop_assert!((pixel_x - (x as f32 + 0.5)).abs() < 1e-3);
            prop_assert!((pixel_y - (y as f32 + 0.5)).abs() < 1e-3);
            prop_assert!((clip.w - depth).abs() < 1e-4 * depth);
            prop_assert!(clip.z > 0.0 && clip.z < clip.w);
        }
    }
}

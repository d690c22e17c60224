//! Light from infinitely far away, all around.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use glam::{Vec2, Vec3};
use lf_math::{GeometryError, Image};

use crate::distribution::Distribution;
use crate::light::MAX_RADIANCE;
use crate::material::luminance;

/// The radiance that arrives from outside the scene.
#[derive(Debug, Clone, PartialEq)]
pub enum Environment {
    /// Radiance of the zenith; the horizon has three quarters of it, the nadir half.
    Sky(Vec3),
    /// A panorama.
    Map(Arc<EnvironmentMap>),
}

/// A panorama of radiance in equirectangular projection. The first row looks up (+Y); the middle column looks along −Z, as
/// a glTF camera does, and the columns to its right towards +X. A turn moves the middle column towards +X.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentMap {
    radiance: Image<Vec3>,
    turn: f32,
    /// `None` if nothing shines.
    light: Option<LightByCell>,
}

/// How much light each cell between texel centres sends. Row by row; one row more than texels, as the first and the last reach
/// from the centres to the poles.
#[derive(Debug, Clone, PartialEq)]
struct LightByCell {
    rows: Distribution,
    cells: Distribution,
}

impl Environment {
    /// Nothing shines.
    pub const BLACK: Self = Self::Sky(Vec3::ZERO);

    /// Radiance along a unit direction, linear RGB, W/(m²·sr).
    #[must_use]
    pub fn towards(&self, direction: Vec3) -> Vec3 {
        match self {
            Self::Sky(zenith) => zenith * (0.75 + 0.25 * direction.y),
            Self::Map(map) => map.towards(direction),
        }
    }

    /// Whether any direction has radiance.
    pub(crate) fn shines(&self) -> bool {
        match self {
            Self::Sky(zenith) => *zenith != Vec3::ZERO,
            Self::Map(map) => map.light.is_some(),
        }
    }

    /// A unit direction, picked by a point of the unit square about in proportion to its luminance, and the density there, 1/sr.
    pub(crate) fn sample(&self, [x, y]: [f64; 2]) -> Option<(Vec3, f32)> {
        match self {
            Self::Sky(_) => {
                // The integral of `pdf` below y, solved for y.
                let height = (4.0 + 12.0 * x).sqrt() - 3.0;
                let direction = at_height(height.clamp(-1.0, 1.0), TAU * y as f32);
                Some((direction, self.pdf(direction)))
            }
            Self::Map(map) => map.sample([x, y]),
        }
    }

    /// How densely [`Self::sample`] picks a unit direction, 1/sr.
    pub(crate) fn pdf(&self, direction: Vec3) -> f32 {
        match self {
            Self::Sky(_) => (3.0 + direction.y) / (12.0 * PI),
            Self::Map(map) => map.pdf(direction),
        }
    }
}

/// The unit vector of a height at an angle from −Z towards +X.
fn at_height(y: f64, angle: f32) -> Vec3 {
    // In `f64`: near the poles 1 − y² has few digits.
    let radius = (1.0 - y * y).max(0.0).sqrt() as f32;
    Vec3::new(radius * angle.sin(), y as f32, -radius * angle.cos())
}

impl EnvironmentMap {
    /// A panorama of linear RGB radiance, W/(m²·sr), turned about +Y by `turn` radians. Radiance above 10⁹ is taken for 10⁹.
    ///
    /// # Errors
    /// All values must be finite and none negative; the turn must be finite.
    pub fn new(mut radiance: Image<Vec3>, turn: f32) -> Result<Self, GeometryError> {
        let values = radiance.texels().iter().flat_map(Vec3::to_array).chain([turn.abs()]);
        for value in values {
            if !(value.is_finite() && value >= 0.0) {
                return Err(GeometryError::NotFinite { what: "radiance of the environment", value });
            }
        }
        for texel in radiance.texels_mut() {
            *texel = texel.min(Vec3::splat(MAX_RADIANCE));
        }
        let mut map = Self { radiance, turn, light: None };
        let columns = map.radiance.width();
        let weight = |row: u32, column: u32| f64::from(map.cell_luminance(column, row)) * map.cell_angle(row);
        let rows = 0..=map.radiance.height();
        let cells = Distribution::new(
            rows.flat_map(|row| (0..columns).map(move |column| (row, column))).map(|(row, column)| weight(row, column)),
        );
        map.light = cells.map(|cells| LightByCell { rows: cells.grouped(columns as usize), cells });
        Ok(map)
    }

    /// Radiance along a unit direction, bilinearly interpolated.
    fn towards(&self, direction: Vec3) -> Vec3 {
        let position = self.texel_of(direction);
        let base = position.floor();
        let [upper_left, upper_right, lower_left, lower_right] = self.corners(base.x as i64, base.y as i64);
        let across = position - base;
        upper_left.lerp(upper_right, across.x).lerp(lower_left.lerp(lower_right, across.x), across.y)
    }

    /// Position of a unit direction among texel centres: −½ is the edge of the first texel.
    fn texel_of(&self, direction: Vec3) -> Vec2 {
        let u = (direction.x.atan2(-direction.z) - self.turn) / TAU + 0.5;
        let v = direction.x.hypot(direction.z).atan2(direction.y) / PI;
        Vec2::new(u.rem_euclid(1.0) * self.radiance.width() as f32, v * self.radiance.height() as f32) - 0.5
    }

    /// The four texels around a cell; columns go round, rows end at the poles.
    fn corners(&self, column: i64, row: i64) -> [Vec3; 4] {
        let (width, height) = (i64::from(self.radiance.width()), i64::from(self.radiance.height()));
        let texel = |x: i64, y: i64| self.radiance.get(x.rem_euclid(width) as u32, y.clamp(0, height - 1) as u32);
        [texel(column, row), texel(column + 1, row), texel(column, row + 1), texel(column + 1, row + 1)]
    }

    /// Mean luminance of a cell, which is positive if any point of it has radiance.
    fn cell_luminance(&self, column: u32, row: u32) -> f32 {
        let corners = self.corners(i64::from(column), i64::from(row) - 1);
        0.25 * luminance(corners.into_iter().sum())
    }

    /// Heights (the sine of latitude) of a row's upper and lower edge.
    fn row_heights(&self, row: u32) -> [f64; 2] {
        let height = f64::from(self.radiance.height());
        let edge = |v: f64| (v.clamp(0.0, height) / height * std::f64::consts::PI).cos();
        [edge(f64::from(row) - 0.5), edge(f64::from(row) + 0.5)]
    }

    /// Solid angle of a cell, sr.
    fn cell_angle(&self, row: u32) -> f64 {
        let [upper, lower] = self.row_heights(row);
        (upper - lower) * std::f64::consts::TAU / f64::from(self.radiance.width())
    }

    /// Picks a row and a cell of it by their light, and a direction in it evenly.
    fn sample(&self, [x, y]: [f64; 2]) -> Option<(Vec3, f32)> {
        let LightByCell { rows, cells } = self.light.as_ref()?;
        let width = self.radiance.width() as usize;
        let (row, down) = rows.choose(x);
        let (cell, across) = cells.choose_among(row * width..(row + 1) * width, y);
        let (column, row) = ((cell % width) as u32, row as u32);
        let [upper, lower] = self.row_heights(row);
        let u = (column as f32 + 0.5 + across as f32) / width as f32;
        let direction = at_height(upper + (lower - upper) * down, (u - 0.5) * TAU + self.turn);
        Some((direction, self.cell_pdf(column, row)))
    }

    fn pdf(&self, direction: Vec3) -> f32 {
        let position = self.texel_of(direction).floor();
        let column = (position.x as i64).rem_euclid(i64::from(self.radiance.width()));
        let row = (position.y as i64 + 1).clamp(0, i64::from(self.radiance.height()));
        self.cell_pdf(column as u32, row as u32)
    }

    fn cell_pdf(&self, column: u32, row: u32) -> f32 {
        let total = self.light.as_ref().map_or(f64::INFINITY, |light| light.cells.total());
        (f64::from(self.cell_luminance(column, row)) / total) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chi_square::assert_picks;
    use crate::random::Random;

    /// A dim panorama with a few bright texels, among them some at the poles and at the seam. Its cells lie as the bins of the test do.
    fn panorama() -> Environment {
        let (width, height) = (40, 20);
        let texel = |i: u32| match i {
            0 | 39 | 100 | 289 | 780 => Vec3::new(20.0, 10.0, 5.0),
            i if i % 40 < 12 => Vec3::ZERO,
            i => Vec3::new(0.1, 0.2, 0.3) * (i % 7) as f32,
        };
        let image = Image::new(width, height, (0..width * height).map(texel).collect()).unwrap();
        Environment::Map(Arc::new(EnvironmentMap::new(image, 4.5 / 40.0 * TAU).unwrap()))
    }

    #[test]
    fn directions_are_picked_as_densely_as_told() {
        for (what, environment) in [("sky", Environment::Sky(Vec3::ONE)), ("panorama", panorama())] {
            let mut random = Random::of([1]);
            let sample = || environment.sample(random.fine()).map(|(direction, _)| direction);
            let total = assert_picks(what, sample, |direction| environment.pdf(direction));
            assert!((total - 1.0).abs() < 2e-3, "{what}: {total}");
        }
    }

    /// The density that comes with a direction is that of the direction, but for those on the edge of a cell; and it is positive where there is
    /// light.
    #[test]
    fn densities_agree_and_cover_all_light() {
        let environment = panorama();
        let mut random = Random::of([2]);
        let mut same = 0;
        for _ in 0..10_000 {
            let (direction, pdf) = environment.sample(random.fine()).unwrap();
            assert!((direction.length() - 1.0).abs() < 1e-5 && pdf > 0.0);
            same += u32::from(environment.pdf(direction) == pdf);
        }
        assert!(same > 9_990, "{same}");
        let sky = Environment::Sky(Vec3::ONE);
        for _ in 0..10_000 {
            let (direction, _) = sky.sample(random.fine()).unwrap();
            assert!(environment.towards(direction) == Vec3::ZERO || environment.pdf(direction) > 0.0);
        }
    }

    #[test]
    fn the_brightest_texels_leave_densities_that_are_numbers() {
        let texel = |i: u32| if i == 3 { Vec3::splat(f32::MAX) } else { Vec3::ONE };
        let image = Image::new(8, 4, (0..32).map(texel).collect()).unwrap();
        let environment = Environment::Map(Arc::new(EnvironmentMap::new(image, 0.0).unwrap()));
        let mut random = Random::of([3]);
        for _ in 0..1000 {
            let (direction, pdf) = environment.sample(random.fine()).unwrap();
            assert!(pdf.is_finite() && pdf > 0.0 && environment.pdf(direction).is_finite(), "{direction}: {pdf}");
            assert!(environment.towards(direction).max_element() <= 1e9);
        }
    }

    #[test]
    fn the_middle_looks_ahead_and_turns_towards_the_right() {
        let texel = |i: u32| Vec3::new((i % 4) as f32, (i / 4) as f32, 0.0);
        let image = Image::new(4, 2, (0..8).map(texel).collect()).unwrap();
        let map = |turn: f32| Environment::Map(Arc::new(EnvironmentMap::new(image.clone(), turn).unwrap()));
        let ahead = Vec3::new(0.0, 0.5, -1.0).normalize();
        // Between columns 1 and 2; a quarter turn puts that towards +X.
        let middle = map(0.0).towards(ahead);
        assert!((middle.x - 1.5).abs() < 1e-5, "{middle}");
        assert!((map(0.5 * PI).towards(Vec3::new(1.0, 0.5, 0.0).normalize()) - middle).length() < 1e-4);
        assert_eq!((map(0.0).towards(Vec3::Y).y, map(0.0).towards(Vec3::NEG_Y).y), (0.0, 1.0));
        let black = Environment::Map(Arc::new(EnvironmentMap::new(Image::filled(4, 2, Vec3::ZERO), 0.0).unwrap()));
        assert!(!black.shines() && black.sample([0.5; 2]).is_none() && map(0.0).shines());
    }
}

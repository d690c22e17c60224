//! Reflections from distance cubes: one, or several that fill each other's gaps.

use glam::Vec3;
use lf_math::{DistanceCube, GeometryError, Ray, Search, normalized, sphere_exit};

use crate::cube::CubeField;
use crate::frame::Environment;
use crate::march::{IN_FRONT, crossing};

/// How far behind a surface, as a share of its depth, a ray may be found that is taken to have met it. Farther behind, it passed in
/// the shadow of something nearer.
const THICKNESS: f32 = 0.03;

/// A distance cube with its picture ready for interpolation.
#[derive(Debug, Clone)]
pub(crate) struct LitCube {
    pub(crate) distances: DistanceCube,
    pub(crate) colors: CubeField,
}

/// Reflections from one distance cube.
#[derive(Debug, Clone)]
pub struct DistanceField {
    cube: LitCube,
    span: [f32; 2],
    start: f32,
    search: Search,
}

/// Reflections from several distance cubes in the manner of light field probes (McGuire et al. 2017), marched along rather than over
/// octahedral maps: the first cube, in the order of nearness to the ray, that saw where the ray ends gives the colour.
#[derive(Debug, Clone)]
pub struct ProbeField {
    cubes: Vec<LitCube>,
    span: [f32; 2],
    steps: u32,
    halvings: u32,
}

impl LitCube {
    pub(crate) fn new(distances: DistanceCube) -> Self {
        Self { colors: CubeField::new(distances.radiance()), distances }
    }

    /// The colour of a place of cell space as the cube sees it.
    fn color(&self, place: Vec3) -> Option<Vec3> {
        let origin = self.distances.position();
        self.colors.look_up(&Ray { origin, direction: place - origin })
    }
}

impl DistanceField {
    /// Reflections from one cube.
    #[must_use]
    pub fn new(cube: DistanceCube, search: Search) -> Self {
        let span = DistanceCube::search_span([&cube]);
        let start = cube.median_distance().min(span[1]);
        Self { cube: LitCube::new(cube), span, start, search }
    }

    /// How far along a ray of unit direction it ends.
    fn end(&self, ray: &Ray) -> f32 {
        let cube = &self.cube.distances;
        match self.search {
            Search::FixedPoint(steps) => {
                let from = ray.origin - cube.position();
                let meet = |t: f32| {
                    let away = from + t * ray.direction;
                    sphere_exit(from, ray.direction, away.length() / cube.relative_depth(away))
                };
                (0..steps).fold(self.start, |t, _| meet(t).filter(|t| t.is_finite()).unwrap_or(t))
            }
            Search::March { steps, halvings } => {
                let free = |p: Vec3| cube.largest_relative_depth(p - cube.position()) < IN_FRONT;
                crossing(ray, self.span, steps, halvings, free).map_or(self.span[1], |found| found.hidden)
            }
        }
    }
}

impl Environment for DistanceField {
    fn look_up(&self, ray: &Ray) -> Option<Vec3> {
        let ray = Ray { origin: ray.origin, direction: normalized(ray.direction)? };
        self.cube.color(ray.at(self.end(&ray)))
    }
}

impl ProbeField {
    /// Reflections from these cubes, by so many steps and halvings in each.
    ///
    /// # Errors
    /// There must be at least one.
    pub fn new(cubes: Vec<DistanceCube>, steps: u32, halvings: u32) -> Result<Self, GeometryError> {
        if cubes.is_empty() {
            return Err(GeometryError::ZeroCount { what: "number of probes" });
        }
        let span = DistanceCube::search_span(&cubes);
        Ok(Self { cubes: cubes.into_iter().map(LitCube::new).collect(), span, steps, halvings })
    }
}

impl Environment for ProbeField {
    /// Where no cube saw the ray's end, the one nearest to the ray answers.
    fn look_up(&self, ray: &Ray) -> Option<Vec3> {
        let ray = Ray { origin: ray.origin, direction: normalized(ray.direction)? };
        let beside = |cube: &LitCube| (cube.distances.position() - ray.origin).cross(ray.direction).length_squared();
        let mut order: Vec<&LitCube> = self.cubes.iter().collect();
        order.sort_by(|a, b| beside(a).total_cmp(&beside(b)));
        let mut fallback = None;
        for cube in order {
            let depth = |p: Vec3| cube.distances.relative_depth(p - cube.distances.position());
            let found = crossing(&ray, self.span, self.steps, self.halvings, |p| depth(p) < IN_FRONT);
            let place = ray.at(found.map_or(self.span[1], |found| found.hidden));
            if found.is_none() || depth(place) < 1.0 + THICKNESS {
                return cube.color(place);
            }
            fallback = fallback.or_else(|| cube.color(place));
        }
        fallback
    }
}

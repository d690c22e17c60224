//! All methods in a room with a ball, dull or a mirror, whose every ray has a closed form.

use glam::{DVec3, Vec2, Vec3};
use lf_compress::bc1::Quality;
use lf_compress::{DepthGuide, GuidedCubes, PackedCube};
use lf_ibr::{BoxCube, CubeField, DistanceField, Environment, GuidedField, ProbeField, SphereCube, guide_ends};
use lf_math::{
    Cell, CubeCoord, CubeMap, DistanceCube, Face, Image, LightFieldGeometry, PlanePlacement, Ray, Search, SlabTexels,
    cube_direction, linear_from_srgb, srgb_from_linear,
};

const WALLS: [Vec3; 2] = [Vec3::new(-2.5, -1.5, -2.0), Vec3::new(2.0, 2.0, 3.0)];
const BALL: (DVec3, f64) = (DVec3::new(1.2, 0.1, 0.4), 0.4);

/// How far along a ray it ends, in lengths of its direction, and whether at the ball. In double precision.
fn end(ray: &Ray) -> (f64, bool) {
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let wall = ((WALLS[0].as_dvec3() - o) / d).max((WALLS[1].as_dvec3() - o) / d).min_element();
    let (from, a) = (o - BALL.0, d.dot(d));
    let (b, c) = (from.dot(d), from.dot(from) - BALL.1 * BALL.1);
    let root = b * b - a * c;
    let ball = if root > 0.0 { (-b - root.sqrt()) / a } else { -1.0 };
    if ball > 0.0 && ball < wall { (ball, true) } else { (wall, false) }
}

/// What the ball is made of. Mirrors are what is seen in them, or marked as such.
#[derive(Clone, Copy, PartialEq)]
enum Ball {
    Red,
    Mirror,
    Marked,
}

/// The ball's colour; as a mirror it reflects so much of each channel, sRGB-encoded.
const RED: Vec3 = Vec3::new(0.9, 0.1, 0.1);
const REFLECTANCE: Vec3 = Vec3::new(0.9, 0.8, 0.7);

/// The ball is red, the walls have a smooth pattern.
fn color(ray: &Ray) -> Vec3 {
    seen(ray, Ball::Red)
}

fn seen(ray: &Ray, ball: Ball) -> Vec3 {
    let (t, at_ball) = end(ray);
    let place = (ray.origin.as_dvec3() + t * ray.direction.as_dvec3()).as_vec3();
    if !at_ball {
        return 0.5 + 0.35 * Vec3::from((1.7 * place).to_array().map(f32::sin));
    }
    if ball == Ball::Red {
        return RED;
    }
    let normal = (place - BALL.0.as_vec3()).normalize();
    let direction = ray.direction - 2.0 * ray.direction.dot(normal) * normal;
    // From a little in front, so that it does not end at once.
    let beyond = seen(&Ray { origin: place + 1e-4 * normal, direction }, Ball::Red);
    let channel = |c: usize| srgb_from_linear(linear_from_srgb(beyond[c]) * linear_from_srgb(REFLECTANCE[c]));
    Vec3::new(channel(0), channel(1), channel(2))
}

fn cube(position: Vec3, size: u32) -> DistanceCube {
    cube_with(position, size, Ball::Red)
}

fn cube_with(position: Vec3, size: u32, ball: Ball) -> DistanceCube {
    let ray = |face: Face, i: u32| {
        let middle = Vec2::new((i % size) as f32, (i / size) as f32) + 0.5;
        Ray { origin: position, direction: cube_direction(CubeCoord { face, uv: middle / size as f32 }) }
    };
    let texels = 0..size * size;
    let picture = |face: Face| {
        let shown = |ray: &Ray| if ball == Ball::Marked && end(ray).1 { REFLECTANCE } else { seen(ray, ball) };
        let texel = |i: u32| shown(&ray(face, i)).extend(1.0).to_array().map(|c| (255.0 * c).round() as u8);
        Image::new(size, size, texels.clone().map(texel).collect()).expect("square")
    };
    let depths = |face: Face| {
        Image::new(size, size, texels.clone().map(|i| end(&ray(face, i)).0.recip() as f32).collect()).expect("square")
    };
    let mirrors =
        |face: Face| Image::new(size, size, texels.clone().map(|i| end(&ray(face, i)).1).collect()).expect("square");
    let radiance = CubeMap::new(Face::ALL.map(picture)).expect("six squares");
    let cube = DistanceCube::new(position, radiance, Face::ALL.map(depths)).expect("depths");
    if ball == Ball::Marked { cube.with_mirrors(Face::ALL.map(mirrors)).expect("as large") } else { cube }
}

/// Centre and four corners of the cell, encoded.
fn guided(size: u32) -> GuidedField {
    guided_with(size, Ball::Red)
}

fn guided_with(size: u32, ball: Ball) -> GuidedField {
    let ends = [[0.0; 3], [1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let packed = |end: [f32; 3]| {
        PackedCube::encode(&cube_with(0.45 * Vec3::from(end), size, ball), Quality::Standard).expect("small")
    };
    GuidedField::new(&GuidedCubes::new(ends.map(packed).to_vec(), guide()).expect("five"))
}

fn guide() -> DepthGuide {
    let cell = Cell::cube(DVec3::ZERO, 1.0).expect("a cell");
    let geometry = LightFieldGeometry::around(cell, PlanePlacement::CellCenter, 6, 24).expect("slabs");
    let slab = |(number, slab): (usize, &lf_math::Slab)| {
        let inverse = |i: u32| {
            let index = |n: u32, size: u32| Vec2::new((n % size) as f32, (n / size) as f32);
            let ray = geometry.capture_ray(number, index(i / 576, 6), index(i % 576, 24));
            slab.depth((ray.origin.as_dvec3() + end(&ray).0 * ray.direction.as_dvec3()).as_vec3()).recip()
        };
        SlabTexels::new(slab, (0..36 * 24 * 24).map(inverse).collect()).expect("whole")
    };
    let texels: Vec<_> = geometry.slabs().iter().enumerate().map(slab).collect();
    DepthGuide::new(geometry, &texels).expect("whole slabs")
}

/// Rays from inside the cell in all directions.
fn rays() -> impl Iterator<Item = Ray> {
    // Korobov's lattice of powers of one irrational number spreads evenly enough in five dimensions.
    let number = |i: u32, k: i32| (f64::from(i) * 1.194_859_158_192_2f64.powi(-k)).fract() as f32;
    (1..20_000).map(move |i| {
        let place = 0.98 * (Vec3::new(number(i, 1), number(i, 2), number(i, 3)) - 0.5);
        let (z, turn) = (2.0 * number(i, 4) - 1.0, std::f32::consts::TAU * number(i, 5));
        let flat = (1.0 - z * z).sqrt();
        Ray { origin: place, direction: 2.5 * Vec3::new(flat * turn.cos(), flat * turn.sin(), z) }
    })
}

/// The share of rays whose colour is off by more than a tenth, and the mean squared error.
fn errors(environment: &dyn Environment) -> (f64, f64) {
    let (mut count, mut off, mut sum) = (0, 0, 0.0);
    for ray in rays() {
        let apart = (environment.look_up(&ray).expect("an answer") - color(&ray)).as_dvec3();
        count += 1;
        off += usize::from(apart.abs().max_element() > 0.1);
        sum += apart.length_squared() / 3.0;
    }
    (off as f64 / f64::from(count), sum / f64::from(count))
}

/// The corners of a smaller cell.
fn corners() -> impl Iterator<Item = Vec3> {
    (0..8).map(|i| 0.6 * Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.3)
}

/// Each method is better than the ones that know less, and those that know the shape are right nearly everywhere.
#[test]
fn who_knows_more_errs_less() {
    let center = || cube(Vec3::ZERO, 192);
    let map = || CubeField::new(center().radiance());
    let infinite = errors(&map());
    let sphere = errors(&SphereCube::new(map(), Vec3::ZERO, center().median_distance()));
    let walls = errors(&BoxCube::new(map(), Vec3::ZERO, WALLS));
    let fixed = errors(&DistanceField::new(center(), Search::FixedPoint(4)));
    let march = errors(&DistanceField::new(center(), Search::March { steps: 64, halvings: 8 }));
    let probes = errors(&ProbeField::new(corners().map(|at| cube(at, 192)).collect(), 64, 8).expect("eight"));
    let guided = errors(&guided(192));
    let order = [infinite, sphere, walls, march, probes];
    for pair in order.windows(2).chain([[fixed, march].as_slice(), [march, guided].as_slice()]) {
        assert!(pair[1].1 < pair[0].1, "{order:?}, {fixed:?}, {guided:?}");
    }
    assert!(probes.0 < 0.02, "{probes:?}");
    assert!(guided.0 < 1e-3, "{guided:?}");
}

/// What a curved mirror shows moves against it: no depth of its surface is right. Rays that go on over it are nearly as good as others.
#[test]
fn rays_go_on_over_mirrors() {
    let errors = |ball: Ball, at_ball: bool| {
        let field = guided_with(192, ball);
        let (mut count, mut sum) = (0, 0.0);
        for ray in rays().filter(|ray| end(ray).1 == at_ball) {
            let apart = field.look_up(&ray).expect("an answer") - seen(&ray, Ball::Mirror);
            count += 1;
            sum += f64::from(apart.length_squared()) / 3.0;
        }
        assert!(count > 500, "{count} rays");
        sum / f64::from(count)
    };
    let (shown, followed) = (errors(Ball::Mirror, true), errors(Ball::Marked, true));
    let beside = [errors(Ball::Mirror, false), errors(Ball::Marked, false)];
    println!("mirror shown: {shown:.6}, followed: {followed:.6}; beside it: {beside:?}");
    assert!(followed < 0.1 * shown, "{followed} {shown}");
    assert!(beside[1] < 1.1 * beside[0], "{beside:?}");
}

/// The same light in a unit of length that is a power of two larger or smaller changes no bit.
#[test]
fn the_unit_of_length_does_not_matter() {
    let search = Search::March { steps: 16, halvings: 4 };
    let plain = DistanceField::new(cube(Vec3::splat(0.25), 32), search);
    for scale in [2f32.powi(20), 2f32.powi(-20)] {
        let cube = cube(Vec3::splat(0.25), 32);
        let depths = cube.inverse_depths().clone().map(|face| face.map(|inverse: f32| inverse / scale));
        let scaled = DistanceCube::new(cube.position() * scale, cube.radiance().clone(), depths).expect("depths");
        let scaled = DistanceField::new(scaled, search);
        for ray in rays().take(2000) {
            let far = Ray { origin: ray.origin * scale, direction: ray.direction };
            assert_eq!(scaled.look_up(&far), plain.look_up(&ray));
        }
    }
}

#[test]
fn rays_without_a_direction_or_a_place_have_no_answer() {
    let field = guided(8);
    let probes = ProbeField::new(vec![cube(Vec3::ZERO, 8)], 8, 8).expect("one");
    for direction in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        let ray = Ray { origin: Vec3::ZERO, direction };
        assert_eq!((field.look_up(&ray), probes.look_up(&ray)), (None, None));
    }
    assert!(field.look_up(&Ray { origin: Vec3::NAN, direction: Vec3::X }).is_none());
    // From outside the cell there is an answer, if not a good one.
    assert!(field.look_up(&Ray { origin: Vec3::splat(1.4), direction: Vec3::X }).is_some());
}

/// The guide's bracket holds the end of nearly every ray; where it does not, an edge of the ball is less than a texel away.
#[test]
fn brackets_hold_the_ends() {
    let guide = guide();
    assert_eq!(guide.bytes(), 6 * 36 * 576 * 2);
    let held = |ray: Ray| {
        let ray = Ray { direction: ray.direction.normalize(), ..ray };
        let [near, far] = guide_ends(&guide, &ray).expect("walls all around");
        (0.94 * near..=1.06 * far).contains(&(end(&ray).0 as f32))
    };
    let (count, missed) = (rays().count(), rays().filter(|ray| !held(*ray)).count());
    assert!(missed * 100 < count, "{missed} of {count}");
}

#[test]
fn cubes_must_be_there() {
    assert!(ProbeField::new(vec![], 8, 8).is_err());
    assert!(GuidedCubes::new(vec![], guide()).is_err());
    // Depths coarser than the picture, and cubes of two sizes.
    let (fine, coarse) = (cube(Vec3::ZERO, 16), cube(Vec3::ZERO, 8));
    let uneven =
        DistanceCube::new(Vec3::ZERO, fine.radiance().clone(), coarse.inverse_depths().clone()).expect("a cube");
    let [fine, coarse, uneven] =
        [fine, coarse, uneven].map(|cube| PackedCube::encode(&cube, Quality::Standard).expect("small"));
    assert!(GuidedCubes::new(vec![uneven], guide()).is_err());
    assert!(GuidedCubes::new(vec![fine.clone(), coarse], guide()).is_err());
    assert_eq!(GuidedCubes::new(vec![fine.clone()], guide()).expect("one").bytes(), fine.bytes() + guide().bytes());
}

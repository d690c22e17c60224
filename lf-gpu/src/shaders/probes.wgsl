// Several distance cubes: the first, in the order of nearness to the ray, that saw where it ends gives the colour (after McGuire et al.
// 2017). CPU twin: lf-ibr/src/distance.rs. Steps come from crossing.wgsl, depths from plane_blocks.wgsl.

// Mirrors `MarchUniform` in several_cubes.rs.
struct March {
    // Ways along a ray between which it ends.
    near: f32,
    far: f32,
    steps: u32,
    halvings: u32,
}

// A cube and the square of its distance from a ray.
struct Beside {
    cube: u32,
    squared: f32,
}

@group(0) @binding(1) var pictures: texture_cube_array<f32>;
@group(0) @binding(2) var bilinear: sampler;
@group(0) @binding(3) var<uniform> march: March;

// How far behind a surface, as a share of its depth, a ray may be found that is taken to have met it.
const THICKNESS = 0.03;

fn relative_depth(cube: u32, away: vec3f) -> f32 {
    let spot = spot_of(away);
    let texel = nearest_texel(spot, cubes[cube].size);
    return spot.away.z * inverse_at(face_blocks(cube, spot.face), texel);
}

fn is_free(cube: u32, away: vec3f) -> bool {
    return relative_depth(cube, away) < IN_FRONT;
}

// The cube that comes after another in the order of nearness to a ray.
fn next_nearest(origin: vec3f, unit: vec3f, last: Beside) -> Beside {
    var nearest = Beside(0u, 1e30);
    for (var cube = 0u; cube < arrayLength(&cubes); cube++) {
        let apart = cross(cubes[cube].position - origin, unit);
        let squared = dot(apart, apart);
        let comes_after = squared > last.squared || (squared == last.squared && cube > last.cube);
        if comes_after && squared < nearest.squared {
            nearest = Beside(cube, squared);
        }
    }
    return nearest;
}

// Where no cube saw the ray's end, the one nearest to the ray answers.
fn look_up(origin: vec3f, direction: vec3f) -> vec3f {
    let unit = normalize(direction);
    var beside = Beside(0u, -1.0);
    var nearest_color = vec3f(0.0);
    for (var rank = 0u; rank < arrayLength(&cubes); rank++) {
        beside = next_nearest(origin, unit, beside);
        let cube = beside.cube;
        let start = origin - cubes[cube].position;
        let found = crossing(cube, start, unit, vec2f(march.near, march.far), march.steps, march.halvings);
        let away = start + unit * select(found, march.far, found == NOT_FOUND);
        let color = textureSampleLevel(pictures, bilinear, away, cube, 0.0).rgb;
        if found == NOT_FOUND || relative_depth(cube, away) < 1.0 + THICKNESS {
            return color;
        }
        nearest_color = select(nearest_color, color, rank == 0u);
    }
    return nearest_color;
}

// Distance cubes whose depths stay planes. CPU twin: lf-ibr/src/surface.rs. Blocks come from plane_blocks.wgsl.

// Six faces of each cube.
@group(0) @binding(3) var pictures: texture_2d_array<f32>;

const SHARPNESS = 0.3;
const PARALLEL = 1e-20;
// Shaders have no infinity; scenes end far before this.
const INFINITE = 1e30;

// The function of a block as a plane, along its face's right, down and forward: its dot product with a place is the place's depth relative to
// the plane's.
fn scene_plane(plane: vec3f, block: vec2u, size: u32) -> vec3f {
    let half_size = 0.5 * f32(size);
    let to_centre = half_size - 0.5 * f32(BLOCK_EDGE) - vec2f(block * BLOCK_EDGE);
    return vec3f(half_size * plane.yz, plane.x + dot(to_centre, plane.yz));
}

// The plane that a texel shows.
fn plane_at(face: FaceBlocks, size: u32, texel: vec2u) -> vec3f {
    return scene_plane(held(face, texel), texel / BLOCK_EDGE, size);
}

fn nearest_plane(cube: u32, spot: Spot) -> vec3f {
    let size = cubes[cube].size;
    return plane_at(face_blocks(cube, spot.face), size, nearest_texel(spot, size));
}

// One of the four texels around a place, its number kept within the face.
fn around(at: vec2f, corner: u32, size: u32) -> vec2u {
    let step = vec2f(f32(corner & 1u), f32(corner >> 1u));
    return min(vec2u(max(at + step, vec2f(0.0))), vec2u(size - 1u));
}

// How deep a place is, as a multiple of what the nearest texel shows.
fn relative_depth(cube: u32, place: vec3f) -> f32 {
    let spot = spot_of(place - cubes[cube].position);
    return dot(nearest_plane(cube, spot), spot.away);
}

// The same by the nearest thing that any of the four texels around shows.
fn largest_relative_depth(cube: u32, place: vec3f) -> f32 {
    let spot = spot_of(place - cubes[cube].position);
    let size = cubes[cube].size;
    let at = index_of(spot, size);
    let face = face_blocks(cube, spot.face);
    var largest = 0.0;
    for (var corner = 0u; corner < 4u; corner++) {
        largest = max(largest, dot(plane_at(face, size, around(at, corner, size)), spot.away));
    }
    return largest;
}

// How far along a ray it meets the plane that the cube sees in the direction of a place; infinitely far behind its start if it never does.
fn meets(cube: u32, origin: vec3f, direction: vec3f, place: vec3f) -> f32 {
    let spot = spot_of(place - cubes[cube].position);
    let plane = face_axes(spot.face) * nearest_plane(cube, spot);
    let along = dot(plane, direction);
    let is_parallel = abs(along) < PARALLEL;
    let met = (1.0 - dot(plane, origin - cubes[cube].position)) / select(along, 1.0, is_parallel);
    return select(met, -INFINITE, is_parallel);
}

// The four texels around a place, each by its distance from it on the surface it shows (Shepard 1968, exponent 4): their weighted sum and
// the sum of their weights.
fn samples(cube: u32, place: vec3f, far: f32, unit: f32) -> vec4f {
    let spot = spot_of(place - cubes[cube].position);
    let size = cubes[cube].size;
    let at = index_of(spot, size);
    let face = face_blocks(cube, spot.face);
    let texel_width = 2.0 / f32(size);
    let scaled = spot.away / unit;
    let blur = SHARPNESS * texel_width * scaled.z;
    var sum = vec4f(0.0);
    for (var corner = 0u; corner < 4u; corner++) {
        let texel = around(at, corner, size);
        let direction = vec3f(texel_width * (vec2f(texel) + 0.5) - 1.0, 1.0);
        let depth = 1.0 / max(dot(plane_at(face, size, texel), direction), 1.0 / far);
        let between = depth / unit * direction - scaled;
        let apart = dot(between, between) + blur * blur;
        let color = textureLoad(pictures, texel, 6u * cube + spot.face, 0).rgb;
        sum += vec4f(color, 1.0) / (apart * apart);
    }
    return sum;
}

// Distance cubes whose inverse depths are blocks of two planes. CPU twin: lf-compress/src/planes/mod.rs.

// Mirrors `CubeEntry` in plane_blocks.rs.
struct DistanceCube {
    // Where it was taken, cell space, metres.
    position: vec3f,
    // Texels along the edge of a face of depths.
    size: u32,
    // By face, what the values of its blocks are multiplied by.
    scales: array<f32, 6>,
    // Blocks lie row after row, face after face, cube after cube.
    first_block: u32,
    padding: u32,
}

// Six half floats, three for each plane (its value in the middle, what it grows by along x and along y), and a bit for each texel that says
// which plane it is on.
struct PlaneBlock {
    first: u32,
    both: u32,
    second: u32,
    upper_mask: u32,
    lower_mask: u32,
}

@group(0) @binding(4) var<storage, read> blocks: array<PlaneBlock>;
@group(0) @binding(5) var<storage, read> cubes: array<DistanceCube>;

const BLOCK_EDGE = 8u;

// The function that a texel is on: its value in the middle of the texel's block, what it grows by along x and along y.
fn held(cube: u32, face: u32, texel: vec2u) -> vec3f {
    let across = (cubes[cube].size + BLOCK_EDGE - 1u) / BLOCK_EDGE;
    let place = texel / BLOCK_EDGE;
    let block = blocks[cubes[cube].first_block + (face * across + place.y) * across + place.x];
    let inside = texel % BLOCK_EDGE;
    let mask = select(block.upper_mask, block.lower_mask, inside.y >= BLOCK_EDGE / 2u);
    let is_second = (mask >> (BLOCK_EDGE * (inside.y % (BLOCK_EDGE / 2u)) + inside.x) & 1u) == 1u;
    let both = unpack2x16float(block.both);
    let own = unpack2x16float(select(block.first, block.second, is_second));
    return cubes[cube].scales[face] * select(vec3f(own, both.x), vec3f(both.y, own), is_second);
}

// The inverse depth in the middle of a texel.
fn inverse_at(cube: u32, face: u32, texel: vec2u) -> f32 {
    let plane = held(cube, face, texel);
    let from_middle = vec2f(texel % BLOCK_EDGE) - 0.5 * f32(BLOCK_EDGE - 1u);
    return max(plane.x + dot(from_middle, plane.yz), 0.0);
}

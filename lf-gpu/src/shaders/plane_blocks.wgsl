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

// A block: three half floats for each of two planes (its value in the middle, what it grows by along x and along y), and a bit for each texel
// that says which plane it is on.
struct PlaneBlock {
    // The first two of the first plane; the third, and the first of the second plane; the rest.
    halves: array<u32, 3>,
    masks: array<u32, 2>,
}

@group(0) @binding(4) var<storage, read> blocks: array<PlaneBlock>;
@group(0) @binding(5) var<storage, read> cubes: array<DistanceCube>;

const BLOCK_EDGE = 8u;

// The blocks of a face: the number of the first, how many lie in a row, what their values are multiplied by.
struct FaceBlocks {
    first: u32,
    across: u32,
    scale: f32,
}

fn face_blocks(cube: u32, face: u32) -> FaceBlocks {
    let across = (cubes[cube].size + BLOCK_EDGE - 1u) / BLOCK_EDGE;
    return FaceBlocks(cubes[cube].first_block + face * across * across, across, cubes[cube].scales[face]);
}

// The number of a face's block.
fn block_number(face: FaceBlocks, place: vec2u) -> u32 {
    return face.first + place.y * face.across + place.x;
}

// Whether a texel is on the second plane of its block.
fn is_on_second(face: FaceBlocks, texel: vec2u) -> bool {
    let inside = texel % BLOCK_EDGE;
    let bit = BLOCK_EDGE * inside.y + inside.x;
    return (blocks[block_number(face, texel / BLOCK_EDGE)].masks[bit / 32u] >> (bit % 32u) & 1u) == 1u;
}

// A function of a block: its value in the middle of the block, what it grows by along x and along y.
fn plane_of(face: FaceBlocks, place: vec2u, is_second: bool) -> vec3f {
    let block = block_number(face, place);
    // Two words of the three are read.
    let both = unpack2x16float(blocks[block].halves[1]);
    let own = unpack2x16float(blocks[block].halves[select(0u, 2u, is_second)]);
    return face.scale * select(vec3f(own, both.x), vec3f(both.y, own), is_second);
}

// The function that a texel is on.
fn held(face: FaceBlocks, texel: vec2u) -> vec3f {
    return plane_of(face, texel / BLOCK_EDGE, is_on_second(face, texel));
}

// The inverse depth in the middle of a texel.
fn inverse_at(face: FaceBlocks, texel: vec2u) -> f32 {
    let plane = held(face, texel);
    let from_middle = vec2f(texel % BLOCK_EDGE) - 0.5 * f32(BLOCK_EDGE - 1u);
    return max(plane.x + dot(from_middle, plane.yz), 0.0);
}

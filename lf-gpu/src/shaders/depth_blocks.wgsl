// Inverse depths in blocks of two planes. CPU twin: lf-compress/src/planes/mod.rs; faces as lf-math/src/cube.rs has them.

// By face a factor; then, face after face, five words a block: three half floats for each of two planes (value in the middle, what it
// grows by along x and along y), and 64 bits that say which plane a texel is on.
@group(0) @binding(4) var<storage, read> depth_words: array<u32>;

const FACTORS = 6u;
const BLOCK_WORDS = 5u;
const BLOCK_EDGE = 8u;

fn stored_inverse(away: vec3f) -> f32 {
    let size = abs(away);
    let is_x = size.x >= size.y && size.x >= size.z;
    let is_y = !is_x && size.y >= size.z;
    let along = select(select(away.z, away.y, is_y), away.x, is_x);
    let facing = select(1.0, -1.0, along < 0.0);
    let axis = select(select(2u, 1u, is_y), 0u, is_x);
    let face = 2u * axis + u32(along < 0.0);
    let across = select(select(facing * away.x, away.x, is_y), -facing * away.z, is_x);
    let down = select(-away.y, facing * away.z, is_y);
    let uv = vec2f(across, down) / abs(along) * 0.5 + 0.5;
    return plane_at(face, min(vec2u(uv * f32(place.depth_size)), vec2u(place.depth_size - 1u)));
}

fn plane_at(face: u32, texel: vec2u) -> f32 {
    let blocks = (place.depth_size + BLOCK_EDGE - 1u) / BLOCK_EDGE;
    let block = texel / BLOCK_EDGE;
    let word = FACTORS + BLOCK_WORDS * ((face * blocks + block.y) * blocks + block.x);
    let inside = texel % BLOCK_EDGE;
    let bit = BLOCK_EDGE * inside.y + inside.x;
    let is_second = (depth_words[word + 3u + bit / 32u] >> (bit % 32u) & 1u) == 1u;
    let middle = unpack2x16float(depth_words[word + 1u]);
    let outer = unpack2x16float(depth_words[word + select(0u, 2u, is_second)]);
    // First plane: words 0 and the first half of 1; second: the second half of 1, and 2.
    let plane = select(vec3f(outer, middle.x), vec3f(middle.y, outer), is_second);
    let from_middle = vec2f(inside) - 0.5 * f32(BLOCK_EDGE - 1u);
    return bitcast<f32>(depth_words[face]) * max(plane.x + dot(from_middle, plane.yz), 0.0);
}

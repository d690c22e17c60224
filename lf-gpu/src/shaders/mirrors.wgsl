// Rays through guided cubes that go on where they end on mirrors. CPU twin: lf-ibr/src/mirrors.rs, with what its constants mean.
// Cubes come from surface.wgsl, the search from guided.wgsl, `encoded` and `decoded` from encode.wgsl.

// A mirror where a ray meets it.
struct Mirror {
    // Of unit length; 0 where there is none.
    normal: vec3f,
    // The share of light that it reflects, linear.
    reflectance: vec3f,
}

// Which planes of each block are mirrors: two bits a block, the first block's lowest.
@group(0) @binding(9) var<storage, read> mirrors: array<u32>;

const MAX_MIRRORS = 4u;
const MIRROR_STEPS = 24u;
const START = 0.01;
const SAME = 0.03;

fn look_up(origin: vec3f, direction: vec3f) -> vec3f {
    var search = Search(origin, normalize(direction), 0u, 0.0);
    var place = place_at(&search, end(&search));
    var reflected = vec3f(1.0);
    var is_reflected = false;
    for (var i = 0u; i < MAX_MIRRORS; i++) {
        let mirror = mirror_at(place);
        let along = dot(search.direction, mirror.normal);
        if !(along < 0.0) {
            break;
        }
        reflected *= mirror.reflectance;
        is_reflected = true;
        let ahead = length(place - cubes[0].position);
        search = Search(place, search.direction - 2.0 * along * mirror.normal, 0u, ahead);
        let far = max(guided.far, ahead);
        let found = steps(&search, START * ahead, far, MIRROR_STEPS);
        place = place_at(&search, select(found, far, found == NOT_FOUND));
    }
    let seen = color(place);
    return select(seen, encoded(reflected * decoded(seen)), is_reflected);
}

// The mirror at a place, if most of the cubes that see the place show one.
fn mirror_at(place: vec3f) -> Mirror {
    var normal = vec3f(0.0);
    var sum = vec3f(0.0);
    var count = 0u;
    var others = 0u;
    for (var cube = 0u; cube < arrayLength(&cubes); cube++) {
        if abs(relative_depth(cube, place) - 1.0) < SEEN {
            let spot = spot_of(place - cubes[cube].position);
            let texel = nearest_texel(spot, cubes[cube].size);
            let face = face_blocks(cube, spot.face);
            let block = texel / BLOCK_EDGE;
            if is_mirror(face, block, u32(is_on_second(face, texel))) {
                count += 1u;
                normal += mirror_normal(cube, spot);
                sum += textureLoad(pictures, texel, 6u * cube + spot.face, 0).rgb;
            } else {
                others += 1u;
            }
        }
    }
    let length = length(normal);
    if count == 0u || count < others || !(length > 0.0) {
        return Mirror();
    }
    return Mirror(normal / length, decoded(sum / f32(count)));
}

fn is_mirror(face: FaceBlocks, block: vec2u, plane: u32) -> bool {
    let number = block_number(face, block);
    return (mirrors[number / 16u] >> (2u * (number % 16u) + plane) & 1u) == 1u;
}

// How many texels show a plane of a block; those that a face lacks count for the first.
fn texels_of(face: FaceBlocks, place: vec2u, is_second: bool) -> u32 {
    let number = block_number(face, place);
    let second = countOneBits(blocks[number].masks[0]) + countOneBits(blocks[number].masks[1]);
    return select(BLOCK_EDGE * BLOCK_EDGE - second, second, is_second);
}

// The normal of a mirror at a place, blended from the planes of the four blocks around.
fn mirror_normal(cube: u32, spot: Spot) -> vec3f {
    let size = cubes[cube].size;
    let face = face_blocks(cube, spot.face);
    let among = (index_of(spot, size) + 0.5) / f32(BLOCK_EDGE) - 0.5;
    let low = floor(among);
    let distance = length(spot.away);
    var sum = vec3f(0.0);
    for (var corner = 0u; corner < 4u; corner++) {
        let block = low + vec2f(f32(corner & 1u), f32(corner >> 1u));
        if any(block < vec2f(0.0)) || any(block >= vec2f(f32(face.across))) {
            continue;
        }
        let share = 1.0 - abs(among - block);
        for (var second = 0u; second < 2u; second++) {
            let plane = scene_plane(plane_of(face, vec2u(block), second == 1u), vec2u(block), size);
            if is_mirror(face, vec2u(block), second) && abs(dot(plane, spot.away) - 1.0) < SAME {
                let inverse = 1.0 / length(plane);
                let cosine = inverse / distance;
                let texels = f32(texels_of(face, vec2u(block), second == 1u));
                sum -= share.x * share.y * texels * cosine * cosine * inverse * plane;
            }
        }
    }
    return face_axes(spot.face) * sum;
}

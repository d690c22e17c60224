// Slabs of inverse depth that tell a ray roughly where it ends. CPU twin: lf-ibr/src/guide.rs. `index_ray` comes from slab_geometry.wgsl.

// Half floats, two to a word: row after row, image after image, slab after slab.
@group(0) @binding(7) var<storage, read> guide: array<u32>;

// An image of the guide: number of its first texel, and texels along its edges.
struct GuideImage {
    first: u32,
    size: vec2u,
}

fn inverse_depth(image: GuideImage, texel: vec2u) -> f32 {
    let place = min(texel, image.size - 1u);
    let number = image.first + place.y * image.size.x + place.x;
    let pair = unpack2x16float(guide[number / 2u]);
    return select(pair.x, pair.y, number % 2u == 1u);
}

// The nearest and the farthest end of the stored rays around one of unit direction, the first larger than the second if none ends in front of
// it. From each of the four cameras around it: first the depth at the place that the focal plane says, then, at the place that this depth
// says, the four texels around.
fn guide_ends(origin: vec3f, direction: vec3f) -> vec2f {
    var ends = vec2f(INFINITE, -INFINITE);
    let ray = index_ray(origin, direction);
    if ray.face == NO_FACE {
        return ends;
    }
    let slab = slabs.faces[ray.face];
    let size = vec2u(slab.uv_last) + 1u;
    let columns = u32(slab.st_last.x) + 1u;
    let st = clamp(ray.st, vec2f(0.0), slab.st_last);
    let base = min(floor(st), max(slab.st_last - 1.0, vec2f(0.0)));
    // Texels that a point one metre away moves per camera.
    let disparity = slab.st_step / slab.uv_step;
    for (var i = 0u; i < 4u; i++) {
        let camera = min(base + vec2f(f32(i & 1u), f32(i >> 1u)), slab.st_last);
        let number = u32(camera.y) * columns + u32(camera.x);
        let image = GuideImage(slab.table.x + number * size.x * size.y, size);
        let tap = clamp(ray.uv + slab.disparity * (st - camera), vec2f(0.0), slab.uv_last);
        let first = inverse_depth(image, vec2u(tap + 0.5));
        let place = vec2u(clamp(ray.uv + disparity * first * (ray.st - camera), vec2f(0.0), slab.uv_last));
        for (var corner = 0u; corner < 4u; corner++) {
            let inverse = inverse_depth(image, place + vec2u(corner & 1u, corner >> 1u));
            let end = guide_end(ray.face, origin, direction, inverse);
            ends = select(ends, vec2f(min(ends.x, end), max(ends.y, end)), end > 0.0);
        }
    }
    return ends;
}

// How far along a ray it reaches an inverse depth: infinite for 0.
fn guide_end(face: u32, origin: vec3f, direction: vec3f, inverse: f32) -> f32 {
    let axis = face / 2u;
    let facing = 1.0 - 2.0 * f32(face % 2u);
    let depth = facing / select(inverse, 1.0, inverse == 0.0);
    let end = (slabs.faces[face].plane + depth - origin[axis]) / direction[axis];
    return select(end, INFINITE, inverse == 0.0);
}

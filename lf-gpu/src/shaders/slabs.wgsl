// Light field slabs: Figs. 6 and 8 of Yu, Yang & McMillan in one pass. CPU twins: lf-math/src/slab.rs, lf-ibr/src/slabs.rs.
// `face_of` comes from faces.wgsl or one_face.wgsl, `fetch` from volume.wgsl, array.wgsl or shared.wgsl, `lines`, `is_kept` and `make_up`
// from whole.wgsl or cropped.wgsl with unmasked.wgsl or masked.wgsl, `shifted` from focused.wgsl or unfocused.wgsl.

// One slab; pairs are along (s, t) or (u, v). Mirrors `SlabUniform` in uniforms.rs.
struct Slab {
    st_first: vec2f,
    st_step: vec2f,
    uv_first: vec2f,
    uv_step: vec2f,
    // Largest camera and texel index.
    st_last: vec2f,
    uv_last: vec2f,
    // Texels that a point of the focal plane moves per camera.
    disparity: vec2f,
    // Coordinate of the camera plane along the face's axis.
    plane: f32,
    // 1, or 0 if the light field has no slab for this face.
    present: u32,
    // Texels between neighbouring images in a slice.
    pitch: vec2f,
    cameras_per_slice: vec2f,
    // Slices from one group of cameras to the next.
    slices_per_group: vec2f,
    first_slice: f32,
    padding: f32,
    // For cropped slabs, rows of the window table: where those of the camera columns, of the camera rows and of the mask begin.
    table: vec4u,
}

struct Slabs {
    // One over the texture's size in texels.
    texel_scale: vec3f,
    padding: f32,
    // Slices along the rows and columns of a layer.
    grid: vec2u,
    more_padding: vec2u,
    // By face: +X -X +Y -Y +Z -Z.
    faces: array<Slab, 6>,
}

// A ray in the real-valued sample indices of the slab that answers it; its face is NO_FACE if there is none.
struct Indexed {
    face: u32,
    st: vec2f,
    uv: vec2f,
}

const NO_FACE = 6u;

@group(0) @binding(1) var<uniform> slabs: Slabs;
@group(0) @binding(2) var bilinear: sampler;

// Two neighbouring columns (axis 0) or rows (axis 1) of cameras and a tap in each. The four cameras around a ray are their products, and
// so are the places of their taps.
struct Lines {
    // Of the taps in their slices, index units.
    places: vec2f,
    // What the line adds to the number of the slice.
    slices: vec2f,
    // 0 if no camera of the line is there, else 1; then the line's weight.
    weights: vec2f,
}

// The axis of the component of largest magnitude; on a tie the first of x, y, z.
fn dominant_axis(direction: vec3f) -> u32 {
    let size = abs(direction);
    if size.x >= size.y && size.x >= size.z {
        return 0u;
    }
    return select(2u, 1u, size.y >= size.z);
}

// The component along an axis, then those along s and t, in cyclic order.
fn axis_first(v: vec3f, axis: u32) -> vec3f {
    return select(select(v.zxy, v.yzx, axis == 1u), v, axis == 0u);
}

fn index_ray(origin: vec3f, direction: vec3f) -> Indexed {
    let face = face_of(direction);
    if face == NO_FACE {
        return Indexed(NO_FACE, vec2f(0.0), vec2f(0.0));
    }
    let d = axis_first(direction, face / 2u);
    let o = axis_first(origin, face / 2u);
    let slab = slabs.faces[face];
    // Eqs. 3 and 4: where the ray crosses the camera plane, and its slope.
    let slope = d.yz / abs(d.x);
    let position = o.yz + sign(d.x) * (slab.plane - o.x) * slope;
    // Eq. 1.
    return Indexed(face, (position - slab.st_first) / slab.st_step, (slope - slab.uv_first) / slab.uv_step);
}

// The light along a ray, as its texels are stored.
fn answer(ray: Indexed) -> vec3f {
    if ray.face == NO_FACE {
        return vec3f(0.0);
    }
    let face = ray.face;
    let slab = slabs.faces[face];
    let st = clamp(ray.st, vec2f(0.0), slab.st_last);
    // Eq. 5: the four cameras around it; the last is reached with weight 1 from the last but one.
    let first = min(floor(st), max(slab.st_last - 1.0, vec2f(0.0)));
    let second = min(first + 1.0, slab.st_last);
    // Eq. 6, and never past the image's own texels.
    let first_tap = clamp(shifted(ray, st - first), vec2f(0.0), slab.uv_last);
    let second_tap = clamp(shifted(ray, st - second), vec2f(0.0), slab.uv_last);
    var columns = lines(face, 0u, vec2f(first.x, second.x), vec2f(first_tap.x, second_tap.x));
    var rows = lines(face, 1u, vec2f(first.y, second.y), vec2f(first_tap.y, second_tap.y));
    let fraction = st - first;
    columns.weights *= vec2f(1.0 - fraction.x, fraction.x);
    rows.weights *= vec2f(1.0 - fraction.y, fraction.y);
    let sum = tapped(face, first, columns, rows, 0u, 0u)
        + tapped(face, vec2f(second.x, first.y), columns, rows, 1u, 0u)
        + tapped(face, vec2f(first.x, second.y), columns, rows, 0u, 1u)
        + tapped(face, second, columns, rows, 1u, 1u);
    return make_up(sum);
}

fn look_up(origin: vec3f, direction: vec3f) -> vec3f {
    return answer(index_ray(origin, direction));
}

// The weighted tap of one camera and its weight; 0 if it is not there.
fn tapped(face: u32, camera: vec2f, columns: Lines, rows: Lines, column: u32, row: u32) -> vec4f {
    let weight = columns.weights[column] * rows.weights[row];
    let place = vec2f(columns.places[column], rows.places[row]);
    let slice = slabs.faces[face].first_slice + columns.slices[column] + rows.slices[row];
    let kept = select(0.0, weight, is_kept(face, camera));
    return kept * vec4f(fetch((place + 0.5) * slabs.texel_scale.xy, u32(max(slice, 0.0))), 1.0);
}

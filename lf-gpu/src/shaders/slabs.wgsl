// Light field slabs: Figs. 6 and 8 of Yu, Yang & McMillan in one pass. CPU twin: lf-ibr/src/slabs.rs. `index_ray` comes from
// slab_geometry.wgsl, `fetch` from volume.wgsl, array.wgsl or shared.wgsl, `lines`, `is_kept` and `make_up` from whole.wgsl or cropped.wgsl
// with unmasked.wgsl or masked.wgsl, `shifted` from focused.wgsl or unfocused.wgsl.

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

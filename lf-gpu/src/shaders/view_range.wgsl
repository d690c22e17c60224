// What is seen along a ray: its light, or paint if the slabs do not hold it. CPU twin: lf-math/src/view.rs.

const OUTSIDE = vec3f(1.0, 0.0, 1.0);

fn seen(ray: Indexed) -> vec3f {
    if ray.face == NO_FACE {
        return OUTSIDE;
    }
    let slab = slabs.faces[ray.face];
    let inside = holds(ray.st, slab.st_first, slab.st_step, slab.st_last)
        && holds(ray.uv, slab.uv_first, slab.uv_step, slab.uv_last);
    return select(OUTSIDE, displayed(answer(ray)), inside);
}

// Whether indices lie within the samples, but for the rounding of `index_ray`. CPU twin: lf-math/src/axis.rs.
fn holds(index: vec2f, first: vec2f, step: vec2f, last: vec2f) -> bool {
    let reach = (abs(first) + abs(first + last * step)) / step;
    let slack = 4.0 * 1.1920929e-7 * (last + 1.0 + reach);
    return all(index >= -slack) && all(index <= last + slack);
}

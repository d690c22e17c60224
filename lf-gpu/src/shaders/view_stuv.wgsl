// What is seen along a ray: its indices as colours (after Fig. 5c). CPU twin: lf-math/src/view.rs.

fn seen(ray: Indexed) -> vec3f {
    if ray.face == NO_FACE {
        return vec3f(0.0);
    }
    let slab = slabs.faces[ray.face];
    let st = clamp(ray.st / max(slab.st_last, vec2f(1.0)), vec2f(0.0), vec2f(1.0));
    let uv = clamp(ray.uv / max(slab.uv_last, vec2f(1.0)), vec2f(0.0), vec2f(1.0));
    return vec3f(st, 0.5 * (uv.x + uv.y));
}

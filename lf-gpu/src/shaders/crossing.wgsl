// Where a ray ends in a distance cube, by steps along it (Umenhoffer et al. 2007). CPU twin: lf-ibr/src/march.rs. `is_free` comes from
// march.wgsl or probes.wgsl.

const IN_FRONT = 1.0 - 1.0 / 2048.0;
const NOT_FOUND = -1.0;

// How far along a ray from a place seen from the cube is the first of `steps` points that is not free, after `halvings` of its step; NOT_FOUND
// if all are.
fn crossing(cube: u32, start: vec3f, unit: vec3f, span: vec2f, steps: u32, halvings: u32) -> f32 {
    let near = 1.0 / span.x;
    let step = (near - 1.0 / span.y) / f32(steps);
    var free = near;
    var hidden = near;
    var found = false;
    for (var i = 1u; i <= steps && !found; i++) {
        // The last of the steps may round to beyond infinity.
        hidden = max(near - f32(i) * step, 1.0 / span.y);
        found = !is_free(cube, start + unit / hidden);
        free = select(hidden, free, found);
    }
    for (var i = 0u; i < halvings && found; i++) {
        let middle = 0.5 * (free + hidden);
        let in_front = is_free(cube, start + unit / middle);
        free = select(free, middle, in_front);
        hidden = select(middle, hidden, in_front);
    }
    return select(NOT_FOUND, 1.0 / hidden, found);
}

// A distance cube, by steps along the ray (Umenhoffer et al. 2007). CPU twins: lf-ibr/src/march.rs, lf-ibr/src/distance.rs.

const IN_FRONT = 1.0 - 1.0 / 2048.0;

fn look_up(origin: vec3f, direction: vec3f) -> vec3f {
    let unit = normalize(direction);
    let start = origin - place.center;
    let near = 1.0 / place.near;
    let step = (near - 1.0 / place.far) / f32(place.steps);
    var free = near;
    var hidden = near;
    var found = false;
    for (var i = 1u; i <= place.steps && !found; i++) {
        hidden = near - f32(i) * step;
        found = largest_relative_depth(start + unit / hidden) >= IN_FRONT;
        free = select(hidden, free, found);
    }
    for (var i = 0u; i < place.halvings && found; i++) {
        let middle = 0.5 * (free + hidden);
        let in_front = largest_relative_depth(start + unit / middle) < IN_FRONT;
        free = select(free, middle, in_front);
        hidden = select(middle, hidden, in_front);
    }
    return seen(start + unit * select(place.far, 1.0 / hidden, found));
}

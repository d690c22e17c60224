// A distance cube, by steps along the ray, which come from crossing.wgsl. CPU twin: lf-ibr/src/distance.rs.

fn is_free(cube: u32, away: vec3f) -> bool {
    return largest_relative_depth(away) < IN_FRONT;
}

fn look_up(origin: vec3f, direction: vec3f) -> vec3f {
    let unit = normalize(direction);
    let start = origin - place.center;
    let found = crossing(0u, start, unit, vec2f(place.near, place.far), place.steps, place.halvings);
    return seen(start + unit * select(found, place.far, found == NOT_FOUND));
}

// A distance cube, by a fixed point (Szirmay-Kalos et al. 2005). CPU twin: lf-ibr/src/distance.rs.

fn look_up(origin: vec3f, direction: vec3f) -> vec3f {
    let unit = normalize(direction);
    let start = origin - place.center;
    var way = place.radius;
    for (var i = 0u; i < place.steps; i++) {
        let away = start + way * unit;
        let depth = relative_depth(away);
        // Nothing is met there, or the sphere is not: stay.
        let exit = sphere_exit(start, unit, length(away) / max(depth, 1e-30));
        way = select(way, exit, depth > 0.0 && exit != -1.0);
    }
    return seen(start + way * unit);
}

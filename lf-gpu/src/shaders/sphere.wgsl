// A cube map on a sphere (Bjorke 2004). CPU twin: lf-ibr/src/proxy.rs.

fn look_up(origin: vec3f, direction: vec3f) -> vec3f {
    let unit = normalize(direction);
    let start = origin - place.center;
    let exit = sphere_exit(start, unit, place.radius);
    return seen(select(unit, start + exit * unit, exit > 0.0));
}

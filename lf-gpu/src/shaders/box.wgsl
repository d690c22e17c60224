// A cube map on a box (Lagarde & Zanuttini 2012). CPU twin: lf-ibr/src/proxy.rs.

fn look_up(origin: vec3f, direction: vec3f) -> vec3f {
    let unit = normalize(direction);
    let towards = select(place.low, place.high, unit > vec3f(0.0));
    let parallel = unit == vec3f(0.0);
    // A ray that is parallel to a wall never meets it.
    let exits = select((towards - origin) / select(unit, vec3f(1.0), parallel), vec3f(1e30), parallel);
    let leave = min(exits.x, min(exits.y, exits.z));
    return seen(select(unit, origin + leave * unit - place.center, leave > 0.0));
}

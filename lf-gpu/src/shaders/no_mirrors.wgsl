// Rays through guided cubes that show no mirrors.

fn look_up(origin: vec3f, direction: vec3f) -> vec3f {
    var search = Search(origin, normalize(direction), 0u, 0.0);
    return color(place_at(&search, end(&search)));
}

// A mirror that reflects more the flatter it is looked at (Schlick 1994). CPU twin: lf-math/src/reflectance.rs.

fn mirrored(origin: vec3f, direction: vec3f, normal: vec3f, instance: u32) -> vec3f {
    let surface = instances[instance];
    let away = clamp(1.0 - abs(dot(direction, normal)) / length(direction), 0.0, 1.0);
    let squared = away * away;
    let share = surface.f0 + (1.0 - surface.f0) * squared * squared * away;
    return encoded(share * surface.tint * radiance(look_up(origin, direction)));
}

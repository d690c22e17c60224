// What the eye asks.

@fragment
fn stuv_fragment(@builtin(position) pixel: vec4f) -> Asked {
    return asked(index_ray(sight.eye, view_direction(pixel)));
}

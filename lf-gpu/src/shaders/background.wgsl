// The scene behind the mirrors, from the same slabs: view rays in place of mirrored ones (§6 of the paper). CPU twin:
// lf-ibr/src/scene.rs.

@fragment
fn background_fragment(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    return vec4f(seen(index_ray(sight.eye, view_direction(pixel))), 1.0);
}

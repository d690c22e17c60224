// Draws a mirror in one pass: `mirrored` of the surface's own file says what a ray shows.

@fragment
fn mirror_fragment(surface: Surface) -> @location(0) vec4f {
    let normal = unit_normal(surface);
    return vec4f(mirrored(surface.position, reflected(surface, normal), normal, surface.instance), 1.0);
}

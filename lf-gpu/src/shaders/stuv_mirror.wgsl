// What a mirror asks.

@fragment
fn stuv_fragment(surface: Surface) -> Asked {
    return asked(index_ray(surface.position, reflected(surface, unit_normal(surface))));
}

// Slabs with focal planes.

// Where a camera `offset` camera steps from the ray sees what the ray meets on the focal plane (Eq. 6).
fn shifted(ray: Indexed, offset: vec2f) -> vec2f {
    return ray.uv + slabs.faces[ray.face].disparity * offset;
}

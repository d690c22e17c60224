// Cameras are left out.

const NO_MASK = 0xffffffffu;

fn is_kept(face: u32, camera: vec2f) -> bool {
    let mask = slabs.faces[face].table.z;
    if mask == NO_MASK {
        return true;
    }
    let bit = u32(camera.y) * (u32(slabs.faces[face].st_last.x) + 1u) + u32(camera.x);
    let words = windows[mask + bit / 128u];
    return (u32(words[(bit / 32u) % 4u]) >> (bit % 32u) & 1u) == 1u;
}

// CPU twin: lf-math/src/face.rs.

// The axis of the component of largest magnitude; on a tie the first of x, y, z.
fn dominant_axis(direction: vec3f) -> u32 {
    let size = abs(direction);
    if size.x >= size.y && size.x >= size.z {
        return 0u;
    }
    return select(2u, 1u, size.y >= size.z);
}

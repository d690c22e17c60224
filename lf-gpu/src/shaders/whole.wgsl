// Slabs whose images are all there and whole.

// Taps within 0 … last have all four texels in their own image.
fn lines(face: u32, axis: u32, cameras: vec2f, taps: vec2f) -> Lines {
    let per_slice = slabs.faces[face].cameras_per_slice[axis];
    // Half a camera more: rounding of the quotient cannot reach a whole number.
    let group = floor((cameras + 0.5) / per_slice);
    let corner = (cameras - group * per_slice) * slabs.faces[face].pitch[axis];
    return Lines(corner + taps, group * slabs.faces[face].slices_per_group[axis], vec2f(1.0));
}

fn is_kept(face: u32, camera: vec2f) -> bool {
    return true;
}

fn make_up(sum: vec4f) -> vec3f {
    return sum.rgb;
}

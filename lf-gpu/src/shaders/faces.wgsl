// Several slabs: the one of the direction's largest component answers (§5 of the paper).

fn face_of(direction: vec3f) -> u32 {
    let axis = dominant_axis(direction);
    let along = direction[axis];
    let face = 2u * axis + select(0u, 1u, along < 0.0);
    return select(face, NO_FACE, slabs.faces[face].present == 0u || along == 0.0);
}

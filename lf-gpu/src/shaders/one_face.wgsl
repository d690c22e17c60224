// One slab, of the face ONLY_FACE: nothing to choose from.

fn face_of(direction: vec3f) -> u32 {
    let along = direction[ONLY_FACE / 2u] * (1.0 - 2.0 * f32(ONLY_FACE % 2u));
    return select(NO_FACE, ONLY_FACE, dominant_axis(direction) == ONLY_FACE / 2u && along > 0.0);
}

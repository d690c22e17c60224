// Inverse depths of one cube in blocks of two planes, which come from plane_blocks.wgsl.

fn stored_inverse(away: vec3f) -> f32 {
    let spot = spot_of(away);
    return inverse_at(face_blocks(0u, spot.face), nearest_texel(spot, place.depth_size));
}

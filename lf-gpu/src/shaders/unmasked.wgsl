// All cameras that have windows are there.

fn is_kept(face: u32, camera: vec2f) -> bool {
    return true;
}

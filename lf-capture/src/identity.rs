//! What a scene looks like and how a machine reckons, as numbers.

use glam::{Vec2, Vec3};
use lf_math::LightFieldGeometry;
use lf_scene::Tracer;
use rayon::prelude::*;
use xxhash_rust::xxh64::Xxh64;

/// Rays traced for one slab, and numbers that functions are tried at.
const PROBES: u32 = 4096;

/// The kind of machine, and the xxHash64 of what its mathematics library makes of some thousand numbers.
///
/// Sums, products and roots have the same bits everywhere. Sines, powers and the like are the system's, in the last bit
/// each library's own, and scenes and samples are made of them.
pub(crate) fn of_machine() -> String {
    let mut hash = Xxh64::new(0);
    for n in 0..PROBES {
        let double = 8.0 * (f64::from(n) * 2f64.sqrt()).fract();
        let x = double as f32;
        hash_numbers(&mut hash, &[x.sin(), x.cos(), x.tan(), x.exp(), x.ln(), x.powf(2.4), x.powi(5)]);
        hash_numbers(&mut hash, &[(x / 8.0).acos(), (x / 8.0).asin(), x.atan2(3.0), x.hypot(3.0)]);
        let doubles = [double.sin(), double.cos(), double.powf(2.4), double.powi(5), double.exp(), double.ln()];
        doubles.iter().for_each(|number| hash.update(&number.to_bits().to_le_bytes()));
    }
    format!("{} {}, arithmetic {:016x}", std::env::consts::ARCH, std::env::consts::OS, hash.digest())
}

/// The xxHash64 of all triangles and of the radiance along some thousand rays of each slab: whatever the scene is made of, what
/// changes the look of it changes the number, unless none of the rays meets it.
pub(crate) fn of_scene(tracer: &Tracer, geometry: &LightFieldGeometry) -> u64 {
    let mut hash = Xxh64::new(0);
    for (corners, material) in tracer.scene().triangles() {
        for corner in corners {
            hash_numbers(&mut hash, &corner.position.to_array());
            hash_numbers(&mut hash, &corner.normal.to_array());
            hash_numbers(&mut hash, &corner.uv.to_array());
        }
        hash.update(&material.to_le_bytes());
    }
    for slab in 0..geometry.slabs().len() {
        let probes: Vec<Vec3> = (0..PROBES).into_par_iter().map(|n| probe(tracer, geometry, slab, n)).collect();
        probes.iter().for_each(|radiance| hash_numbers(&mut hash, &radiance.to_array()));
    }
    hash.digest()
}

/// The radiance along a ray through the cell's middle.
fn probe(tracer: &Tracer, geometry: &LightFieldGeometry, slab: usize, n: u32) -> Vec3 {
    // Square roots of primes have no common measure: the points spread evenly.
    let place = |root: f64| (f64::from(n) * root).fract() as f32;
    let slopes = 2.0 * Vec2::new(place(2f64.sqrt()), place(3f64.sqrt())) - 1.0;
    let face = geometry.slabs()[slab].face();
    let direction = face.vector(slopes, face.sign());
    tracer.trace(geometry.cell().center().as_vec3(), direction).radiance
}

fn hash_numbers(hash: &mut Xxh64, numbers: &[f32]) {
    numbers.iter().for_each(|number| hash.update(&number.to_bits().to_le_bytes()));
}

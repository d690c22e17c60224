//! The instruction sets that tests compare.

use fearless_simd::Level;

/// Every level that this machine can run, the best first, and scalar code.
pub(super) fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![best];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    levels.extend(
        [best.as_avx2().map(Level::Avx2), best.as_sse4_2().map(Level::Sse4_2), best.as_sse2().map(Level::Sse2)]
            .into_iter()
            .flatten(),
    );
    levels.push(Level::fallback());
    levels
}

//! Optimal endpoints for a block of one colour.
//!
//! The 565 grid misses most 8-bit colours by up to 4, but an interpolated entry lies between grid points, and the
//! three channels choose their pairs of levels independently. So for each 8-bit value one table names the pair whose
//! index-2 entry `⌊(2·e0 + e1) / 3⌋` comes nearest. Equal pairs are in the search, so endpoints are covered too.

use super::decode::{expand5, expand6, third};

/// Levels of the first and second endpoint, per channel value.
type LevelTable = [[u8; 2]; 256];

const UNREACHED: u8 = u8::MAX;

static LEVELS5: LevelTable = nearest(reached::<32>(expand5));
static LEVELS6: LevelTable = nearest(reached::<64>(expand6));

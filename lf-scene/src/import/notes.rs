//! What an importer has to tell.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use crate::ImportError;

/// What a file holds that is not used as it should be, and how often.
#[derive(Default)]
pub(super) struct Notes {
    counts: BTreeMap<String, usize>,
}

impl Notes {
    /// Notes a thing.
    pub(super) fn add(&mut self, what: &str) {
        self.count(what, 1);
    }

    /// Notes a number of things, which may be none.
    pub(super) fn count(&mut self, what: &str, count: usize) {
        if count > 0 {
            *self.counts.entry(what.to_owned()).or_default() += count;
        }
    }

    /// A number brought into its range, which is noted.
    ///
    /// # Errors
    /// If the number is not finite.
    pub(super) fn within(&mut self, place: &str, value: f32, range: RangeInclusive<f32>) -> Result<f32, ImportError> {
        if !value.is_finite() {
            return Err(ImportError::malformed(place, format!("a number is not finite but {value}")));
        }
        self.count("numbers are out of their range and brought into it", usize::from(!range.contains(&value)));
        Ok(value.clamp(*range.start(), *range.end()))
    }

    /// One sentence for each kind of thing.
    pub(super) fn into_warnings(self) -> Vec<String> {
        self.counts.into_iter().map(|(what, count)| format!("{what} ({count})")).collect()
    }
}

//! What an importer has to tell.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use glam::Vec3;
use lf_math::normalized;

use crate::ImportError;

/// What a file holds that is not used as it should be, and how often.
#[derive(Default)]
pub(super) struct Notes {
    counts: BTreeMap<String, usize>,
    remarks: Vec<String>,
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

    /// Says a thing that is not counted: what was put in the place of what the file does not say.
    pub(super) fn inform(&mut self, what: impl Into<String>) {
        self.remarks.push(what.into());
    }

    /// Notes normals without a direction, in whose place computed ones are taken.
    pub(super) fn normals(&mut self, normals: &[Vec3]) {
        let broken = normals.iter().filter(|normal| normalized(**normal).is_none()).count();
        self.count("normals are zero or not finite, and computed instead", broken);
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

    /// One sentence for each kind of thing, then the remarks.
    pub(super) fn into_warnings(self) -> Vec<String> {
        let counts = self.counts.into_iter().map(|(what, count)| format!("{what} ({count})"));
        counts.chain(self.remarks).collect()
    }
}

//! Both readers on the same bytes: they must say the same.

use std::fmt::Debug;

use lf_format::{Container, FormatError, Limits, Rule};

/// What is wrong with a file: nothing more once opening it fails, else all that verifying it reports.
struct Findings {
    opens: bool,
    errors: Vec<FormatError>,
}

impl Findings {
    fn of_container(bytes: &[u8], limits: &Limits) -> Self {
        let mut errors = Vec::new();
        let opened = Container::parse(bytes, limits).map(|file| file.verify(|error| errors.push(error)));
        Self { opens: opened.is_ok(), errors: opened.err().into_iter().chain(errors).collect() }
    }

    #[cfg(feature = "std")]
    fn of_file(bytes: &[u8], limits: &Limits) -> Self {
        let mut errors = Vec::new();
        let opened = lf_format::FileReader::open(std::io::Cursor::new(bytes), limits);
        let opened = opened.map(|mut file| file.verify(|error| errors.push(error)).unwrap());
        Self { opens: opened.is_ok(), errors: opened.err().into_iter().chain(errors).collect() }
    }

    /// Message ids, rules with their bytes, and texts.
    fn texts(&self) -> Vec<impl Debug + PartialEq + use<>> {
        self.errors.iter().map(|error| (error.id(), error.broken_rule(), error.to_string())).collect()
    }
}

/// By both readers, where both are there.
fn findings(bytes: &[u8], limits: &Limits) -> Findings {
    let found = Findings::of_container(bytes, limits);
    #[cfg(feature = "std")]
    {
        let by_file = Findings::of_file(bytes, limits);
        assert_eq!((found.opens, found.texts()), (by_file.opens, by_file.texts()), "the readers disagree");
    }
    found
}

/// Opens a file that opens, with default limits.
#[track_caller]
pub(crate) fn parse(bytes: &[u8]) -> Container<'_> {
    Container::parse(bytes, &Limits::default()).unwrap()
}

/// Asserts that nothing at all is wrong with a file, and opens it.
#[track_caller]
pub(crate) fn sound(bytes: &[u8]) -> Container<'_> {
    assert!(findings(bytes, &Limits::default()).texts().is_empty());
    parse(bytes)
}

/// The first thing that is wrong with a file, if anything is.
pub(crate) fn first_error(bytes: &[u8], limits: &Limits) -> Option<FormatError> {
    findings(bytes, limits).errors.into_iter().next()
}

/// The error of a file that must be refused.
#[track_caller]
pub(crate) fn refusal(bytes: &[u8]) -> FormatError {
    first_error(bytes, &Limits::default()).expect("the file was accepted")
}

/// Asserts that a file does not open because it breaks one rule at one byte.
#[track_caller]
pub(crate) fn assert_breaks(bytes: &[u8], rule: Rule, at: usize) {
    match &findings(bytes, &Limits::default()) {
        Findings { opens: false, errors } => assert_malformed(&errors[0], rule, at),
        Findings { errors, .. } => panic!("expected a break of {rule:?}, but the file opens, with {errors:?}"),
    }
}

/// Asserts that a file opens, but breaks one rule at one byte where verifying looks.
#[track_caller]
pub(crate) fn assert_damaged(bytes: &[u8], rule: Rule, at: usize) {
    match &findings(bytes, &Limits::default()) {
        Findings { opens: true, errors } if errors.len() == 1 => assert_malformed(&errors[0], rule, at),
        Findings { errors, .. } => panic!("expected one break of {rule:?} when verified, got {errors:?}"),
    }
}

#[track_caller]
fn assert_malformed(error: &FormatError, expected: Rule, at: usize) {
    match *error {
        FormatError::Malformed { rule, offset, .. } if (rule, offset) == (expected, at as u64) => {
            assert!(error.to_string().contains(rule.clause()), "{error}");
            assert_eq!(error.id(), rule.id());
        }
        _ => panic!("expected a break of {expected:?} at byte {at}, got: {error}"),
    }
}

/// Asserts that a file is refused because of something at one byte that this reader does not know.
#[track_caller]
pub(crate) fn assert_unsupported(bytes: &[u8], expected: Rule, at: usize) {
    match refusal(bytes) {
        FormatError::Unsupported { rule, offset, .. } if (rule, offset) == (expected, at as u64) => {}
        other => panic!("expected something unsupported by {expected:?} at byte {at}, got: {other}"),
    }
}

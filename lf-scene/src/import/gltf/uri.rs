//! What a URI of a glTF file stands for: data within it, or a file beside the scene.

use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use super::super::budget::Budget;
use crate::ImportError;

/// Exporters are not at one about the padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The bytes that a URI stands for. Files must lie in the scene's folder or below: a scene from a stranger reads nothing else.
pub(super) fn load(place: &str, uri: &str, folder: Option<&Path>, budget: &mut Budget) -> Result<Vec<u8>, ImportError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, text) = data
            .split_once(";base64,")
            .ok_or_else(|| ImportError::malformed(place, "its data URI is not in base 64"))?;
        budget.take("the data within the JSON", text.len() as u64, 1)?;
        return BASE64.decode(text).map_err(|e| ImportError::malformed(place, e));
    }
    let shown: String = uri.chars().take(80).collect();
    let path = inside(uri).ok_or_else(|| {
        let problem = format!(
            "{shown:?} does not name a file in the scene's folder; move it there and name it by a relative path"
        );
        ImportError::malformed(place, problem)
    })?;
    let folder = folder.ok_or_else(|| ImportError::malformed(place, format!("{shown:?} is outside of the file")))?;
    budget.read(&folder.join(path))
}

/// A relative path that does not lead upwards.
fn inside(uri: &str) -> Option<PathBuf> {
    // A colon sets a scheme apart, also a Windows drive.
    if uri.contains(':') {
        return None;
    }
    let path = PathBuf::from(decoded(uri)?);
    let stays = |part| matches!(part, Component::Normal(_) | Component::CurDir);
    (path.components().all(stays) && path.file_name().is_some()).then_some(path)
}

/// Percent-encoding undone (RFC 3986, section 2.1).
fn decoded(uri: &str) -> Option<String> {
    let mut parts = uri.split('%');
    let mut bytes = parts.next()?.as_bytes().to_vec();
    for part in parts {
        let (digits, rest) = part.split_at_checked(2)?;
        bytes.push(u8::from_str_radix(digits, 16).ok()?);
        bytes.extend(rest.as_bytes());
    }
    String::from_utf8(bytes).ok().filter(|text| !text.contains('\0'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_in_the_folder() {
        assert_eq!(inside("textures/a%20wall.png"), Some(PathBuf::from("textures/a wall.png")));
        assert_eq!(inside("./a.bin"), Some(PathBuf::from("./a.bin")));
        let outside =
            ["../x", "a/../../x", "/etc/passwd", "%2e%2e/x", "file:///x", "C:x", "http://x/y", "", ".", "a%zz", "a%2"];
        for uri in outside.into_iter().chain(["a%00b", "%ff"]) {
            assert_eq!(inside(uri), None, "{uri}");
        }
    }

    #[test]
    fn data_uris_are_decoded() {
        let mut budget = Budget::new(1000);
        let mut load = |uri: &str| load("buffer 0", uri, None, &mut budget);
        assert_eq!(load("data:application/octet-stream;base64,AAEC").unwrap(), [0, 1, 2]);
        assert_eq!(load("data:;base64,AAE").unwrap(), [0, 1]);
        assert!(load("data:text/plain,hello").is_err());
        assert!(load("data:;base64,****").is_err());
        assert!(load("beside.bin").is_err(), "bytes in memory have no folder");
        assert!(matches!(load(&format!("data:;base64,{}", "A".repeat(1004))), Err(ImportError::LimitExceeded { .. })));
    }
}

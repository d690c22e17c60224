//! The `.glb` container (glTF 2.0, section 4) and the JSON in it.

use std::borrow::Cow;
use std::path::Path;

use gltf::Document;
use gltf::buffer::Source;
use gltf::json::Root;

use super::super::budget::Budget;
use super::uri;
use crate::ImportError;

/// The extensions that this importer knows.
pub(super) const EXTENSIONS: [&str; 6] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_texture_transform",
];

/// A file taken apart: all indices name something, all buffers have their length.
pub(super) struct Container<'a> {
    pub(super) document: Document,
    pub(super) buffers: Vec<Cow<'a, [u8]>>,
    /// Where the files lie that it names.
    pub(super) folder: Option<&'a Path>,
}

impl<'a> Container<'a> {
    pub(super) fn open(bytes: &'a [u8], folder: Option<&'a Path>, budget: &mut Budget) -> Result<Self, ImportError> {
        let (json, blob) = split(bytes)?;
        let document = parse(json, budget)?;
        let buffers = document.buffers().map(|buffer| load(&buffer, blob, folder, budget));
        let buffers = buffers.collect::<Result<_, _>>()?;
        Ok(Self { document, buffers, folder })
    }

    /// The bytes of a view.
    pub(super) fn view(&self, view: &gltf::buffer::View<'_>) -> Result<&[u8], ImportError> {
        let buffer = self.buffers.get(view.buffer().index()).map_or(&[][..], |bytes| bytes);
        let end = view.offset().checked_add(view.length());
        end.and_then(|end| buffer.get(view.offset()..end)).ok_or_else(|| {
            let problem = format!("{} bytes from {} on, in a buffer of {}", view.length(), view.offset(), buffer.len());
            ImportError::malformed(format!("buffer view {}", view.index()), problem)
        })
    }
}

/// The JSON and the binary chunk of a `.glb` file; a file that is none is JSON as a whole. Further chunks are passed over,
/// as the specification asks.
fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ImportError> {
    const PLACE: &str = "container";
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let cut_off = || ImportError::malformed(PLACE, "the file is cut off");
    let word = |at: usize| -> Option<u32> { Some(u32::from_le_bytes(bytes.get(at..)?.first_chunk().copied()?)) };
    let version = word(4).ok_or_else(cut_off)?;
    if version != 2 {
        return Err(ImportError::Unsupported { what: format!("it is of version {version} of the container") });
    }
    let chunk = |at: usize| -> Option<(u32, &[u8])> {
        let length = word(at)? as usize;
        let start = at.checked_add(8)?;
        Some((word(at.checked_add(4)?)?, bytes.get(start..start.checked_add(length)?)?))
    };
    let (kind, json) = chunk(12).ok_or_else(cut_off)?;
    if kind != u32::from_le_bytes(*b"JSON") {
        return Err(ImportError::malformed(PLACE, "the first chunk is not JSON"));
    }
    let next = 20 + json.len();
    if next >= bytes.len() {
        return Ok((json, None));
    }
    let (kind, blob) = chunk(next).ok_or_else(cut_off)?;
    Ok((json, (kind == u32::from_le_bytes(*b"BIN\0")).then_some(blob)))
}

/// Reads and validates the JSON. What the validation of the `gltf` crate stumbles over is looked for first.
fn parse(json: &[u8], budget: &mut Budget) -> Result<Document, ImportError> {
    const PLACE: &str = "JSON";
    // An object of a few characters, `{}`, becomes a few hundred bytes; of an array of numbers two characters four bytes.
    let objects = json.iter().filter(|&&byte| byte == b'{').count() as u64;
    budget.take("the objects of the JSON", objects, 512)?;
    budget.take("the characters of the JSON", json.len() as u64, 4)?;
    let root: Root = gltf::json::deserialize::from_slice(json).map_err(|e| ImportError::malformed(PLACE, e))?;
    if !root.asset.version.starts_with("2.") {
        return Err(ImportError::Unsupported { what: format!("it is glTF {:.20}", root.asset.version) });
    }
    if let Some(name) = root.extensions_required.iter().find(|name| !EXTENSIONS.contains(&name.as_str())) {
        return Err(ImportError::Unsupported { what: format!("it requires the extension {name:.60}") });
    }
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    for index in primitives.flat_map(|primitive| primitive.attributes.values()) {
        if index.value() >= root.accessors.len() {
            return Err(ImportError::malformed(
                PLACE,
                format!("an attribute names accessor {index}, which is missing"),
            ));
        }
    }
    Document::from_json(root).map_err(|error| match error {
        gltf::Error::Validation(list) => {
            let first = list.first().map_or(String::new(), |(path, problem)| format!("{path}: {problem}"));
            ImportError::malformed(PLACE, first)
        }
        other => ImportError::malformed(PLACE, other),
    })
}

fn load<'a>(
    buffer: &gltf::Buffer<'_>,
    blob: Option<&'a [u8]>,
    folder: Option<&Path>,
    budget: &mut Budget,
) -> Result<Cow<'a, [u8]>, ImportError> {
    let place = format!("buffer {}", buffer.index());
    let bytes: Cow<'a, [u8]> = match buffer.source() {
        Source::Uri(uri) => uri::load(&place, uri, folder, budget)?.into(),
        Source::Bin if buffer.index() == 0 => {
            blob.ok_or_else(|| ImportError::malformed(&place, "the file has no binary chunk"))?.into()
        }
        Source::Bin => return Err(ImportError::malformed(place, "it names no file")),
    };
    if bytes.len() < buffer.length() {
        let problem = format!("it has {} bytes instead of {}", bytes.len(), buffer.length());
        return Err(ImportError::malformed(place, problem));
    }
    Ok(bytes)
}

//! Which images are measured: light-field atlases, photographs and two synthetic images.

use std::path::{Path, PathBuf};

use crate::error::BenchError;
use crate::picture::Picture;
use crate::recorded::Setting;
use crate::synthetic::{gradient, noise};

/// Views taken of each photographed light field, spread evenly: its views hardly differ.
const VIEWS: usize = 8;
/// Side of the gradient in texels.
const GRADIENT_SIDE: u32 = 512;

/// Images that are judged together: one speed and one PSNR.
#[derive(Debug, Clone)]
pub struct Class {
    /// Short name, used in file names.
    pub name: &'static str,
    /// At least one picture.
    pub pictures: Vec<Picture>,
}

impl Class {
    /// Texels of all pictures.
    #[must_use]
    pub fn texels(&self) -> usize {
        self.pictures.iter().map(Picture::texels).sum()
    }

    /// The class of recorded measurements that this one can be set beside.
    #[must_use]
    pub fn setting(&self) -> Option<Setting> {
        match self.name {
            "lf" => Some(Setting::LightField),
            "photo" => Some(Setting::Photographs),
            _ => None,
        }
    }
}

/// Where images come from.
#[derive(Debug, Clone, Default)]
pub struct Sources {
    /// A folder of photographs; without one those of `shared/data` are taken.
    pub images: Option<PathBuf>,
}

/// The classes that there are images for, and what to tell the reader about those there are none for.
///
/// # Errors
///
/// [`BenchError::Io`] and [`BenchError::Image`] for files that are there but cannot be read,
/// [`BenchError::InvalidArgument`] for a folder of photographs that holds none.
pub fn gather(sources: &Sources) -> Result<(Vec<Class>, Vec<String>), BenchError> {
    let shared = shared_data();
    let mut notes = Vec::new();
    if shared.is_none() {
        notes.push("no folder shared/data in this folder's ancestors: no light-field atlases".to_owned());
    }
    let lf = shared.as_deref().map_or_else(|| Ok(Vec::new()), |data| pictures_in(&data.join("bc1")))?;
    let photo = match (&sources.images, &shared) {
        (Some(folder), _) => chosen(folder)?,
        (None, Some(data)) => photographs(data)?,
        (None, None) => Vec::new(),
    };
    let synthetic = |picture: Option<Picture>| picture.into_iter().collect();
    let all = [
        Class { name: "lf", pictures: lf },
        Class { name: "photo", pictures: photo },
        Class { name: "gradient", pictures: synthetic(gradient(GRADIENT_SIDE)) },
        Class { name: "noise", pictures: synthetic(noise()) },
    ];
    let (there, absent): (Vec<Class>, Vec<Class>) = all.into_iter().partition(|class| !class.pictures.is_empty());
    notes.extend(absent.iter().map(|class| format!("no images for the class {}: it is left out", class.name)));
    Ok((there, notes))
}

/// The folder `shared/data` beside this crate or beside one of the folders it lies in.
fn shared_data() -> Option<PathBuf> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().map(|folder| folder.join("shared").join("data")).find(|folder| folder.is_dir())
}

/// The user's own folder, which must hold something.
fn chosen(folder: &Path) -> Result<Vec<Picture>, BenchError> {
    let pictures = pictures_in(folder)?;
    if pictures.is_empty() {
        let text = format!("{} holds no PNG, JPEG or HDR image: name another folder with --images", folder.display());
        return Err(BenchError::InvalidArgument(text));
    }
    Ok(pictures)
}

/// What `shared/data` has of photographs: views of light fields taken with a camera, and panoramas.
fn photographs(data: &Path) -> Result<Vec<Picture>, BenchError> {
    let mut files = image_files(&data.join("hdri"))?;
    for folder in entries(&data.join("lightfields"))? {
        let taken_with_camera = folder.file_name().is_some_and(|name| name.to_string_lossy().starts_with("lytro-"));
        if taken_with_camera && folder.is_dir() {
            let views = image_files(&folder)?;
            files.extend(views.iter().step_by(views.len().div_ceil(VIEWS).max(1)).cloned());
        }
    }
    read_all(&files)
}

fn pictures_in(folder: &Path) -> Result<Vec<Picture>, BenchError> {
    read_all(&image_files(folder)?)
}

fn read_all(files: &[PathBuf]) -> Result<Vec<Picture>, BenchError> {
    files.iter().filter_map(|file| Picture::read(file).transpose()).collect()
}

/// The image files right in a folder, by name; none if there is no such folder in `shared/data`.
fn image_files(folder: &Path) -> Result<Vec<PathBuf>, BenchError> {
    let is_image = |path: &PathBuf| {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        ["png", "jpg", "jpeg", "hdr"].contains(&extension.as_str())
    };
    Ok(entries(folder)?.into_iter().filter(is_image).collect())
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, BenchError> {
    let listing = match std::fs::read_dir(folder) {
        Ok(listing) => listing,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(BenchError::io(folder)(error)),
    };
    let paths: Result<Vec<PathBuf>, _> = listing.map(|entry| entry.map(|e| e.path())).collect();
    let mut paths = paths.map_err(BenchError::io(folder))?;
    paths.sort();
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn synthetic_classes_are_always_there() {
        let (classes, _) = gather(&Sources::default()).unwrap();
        let names: Vec<&str> = classes.iter().map(|class| class.name).collect();
        assert!(names.ends_with(&["gradient", "noise"]), "{names:?}");
        assert!(classes.iter().all(|class| class.texels() > 0));
    }

    #[test]
    fn a_folder_without_images_is_refused() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let error = gather(&Sources { images: Some(folder) }).unwrap_err();
        assert!(error.to_string().contains("--images"), "{error}");
    }
}

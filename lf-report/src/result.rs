//! What was measured of one method on one reflector.

use lf_math::{GeometryError, Image, ImageError, VisibleError, image_error, visible_error};
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use crate::error::ReportError;
use crate::timing::Timing;

/// Name of the method that the others are compared with in the headline: reflections looked up by direction alone.
pub const BASELINE_METHOD: &str = "environment map";

/// What was drawn: results are only compared where all of this is the same.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Frames {
    /// Name of the scene, or the file it came from.
    pub scene: String,
    /// The reflector's name, such as `teapot`, and where it stands if there are several places.
    pub reflector: String,
    /// Width and height of the pictures in pixels.
    pub size: [u32; 2],
}

/// How far one eye's image is from the reference, over the reflector's pixels, on 8-bit display values.
///
/// An infinite `psnr_db` (no difference at all: `mse` is 0) becomes `null` in JSON, which has no infinity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EyeError {
    /// Number of the eye on its path, from 0.
    pub eye: usize,
    /// Peak signal-to-noise ratio in dB; infinite where the images are equal.
    pub psnr_db: f64,
    /// Mean squared error over all R, G and B values, in steps of 1/255 squared.
    pub mse: f64,
    /// Mean squared error relative to the reference, of linear light ([`ImageError::rel_mse`]).
    pub rel_mse: f64,
    /// Mean FLIP error, 0 … 1.
    pub flip: f64,
    /// Mean structural similarity, at most 1.
    pub ssim: f64,
    /// Share of the pixels with a component that is off by more than a tenth of the range, 0 … 1.
    pub share_over_tenth: f64,
    /// Largest difference of any component, 0 … 255.
    pub max_abs: u8,
    /// Number of pixels compared.
    pub pixels: usize,
}

impl EyeError {
    /// The error of eye number `eye`.
    #[must_use]
    pub fn new(eye: usize, error: ImageError, visible: VisibleError) -> Self {
        Self {
            eye,
            psnr_db: error.psnr_db(),
            mse: error.mse,
            rel_mse: error.rel_mse,
            flip: visible.flip,
            ssim: visible.ssim,
            share_over_tenth: error.share_over_tenth(),
            max_abs: error.max_abs,
            pixels: error.pixels,
        }
    }

    /// Compares the image of eye number `eye` with its reference where `mask` is true.
    ///
    /// # Errors
    /// As [`image_error`]: the images and the mask must have the same size, and the mask at least one true pixel.
    pub fn compare(
        eye: usize,
        reference: &Image<[u8; 4]>,
        test: &Image<[u8; 4]>,
        mask: &Image<bool>,
    ) -> Result<Self, GeometryError> {
        Ok(Self::new(eye, image_error(reference, test, mask)?, visible_error(reference, test, mask)?))
    }
}

/// One method with one set of parameters on one reflector: error, time and bytes.
///
/// Serialises as its fields, those of `frames` among them, and the means over the eyes.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodResult {
    /// What was drawn.
    pub frames: Frames,
    /// The method's name, such as `slabs`, `ray tracing` or [`BASELINE_METHOD`].
    pub method: String,
    /// What the method was run with, for people to read: `16×16 cameras of 64×64, BC1`.
    pub parameters: String,
    /// What drew the frames.
    pub device: String,
    /// Error of each eye; empty for the reference itself.
    pub eyes: Vec<EyeError>,
    /// Time of one frame.
    pub timing: Timing,
    /// Memory that holds the method's data while it draws.
    pub bytes_on_device: u64,
    /// The method's data as stored; `None` if it is never stored.
    pub bytes_on_disk: Option<u64>,
    /// Seconds spent once before the first frame: capturing, encoding, building.
    pub preparation_s: f64,
    /// Rays traced for it; `None` if it is not made of samples, or nobody counted.
    pub rays: Option<u64>,
}

impl MethodResult {
    /// Mean of the eyes' PSNR in dB; infinite as soon as one eye's is, `None` for the reference.
    #[must_use]
    pub fn mean_psnr_db(&self) -> Option<f64> {
        self.mean(|eye| eye.psnr_db)
    }

    /// Mean of the eyes' FLIP errors; `None` for the reference.
    #[must_use]
    pub fn mean_flip(&self) -> Option<f64> {
        self.mean(|eye| eye.flip)
    }

    /// Mean over the eyes of any of their numbers; `None` for the reference.
    #[must_use]
    pub fn mean(&self, number: impl Fn(&EyeError) -> f64) -> Option<f64> {
        let sum: f64 = self.eyes.iter().map(number).sum();
        (!self.eyes.is_empty()).then(|| sum / self.eyes.len() as f64)
    }

    /// Lowest and highest PSNR of the eyes in dB; `None` for the reference.
    #[must_use]
    pub fn psnr_range_db(&self) -> Option<(f64, f64)> {
        let psnr = || self.eyes.iter().map(|eye| eye.psnr_db);
        Some((psnr().min_by(f64::total_cmp)?, psnr().max_by(f64::total_cmp)?))
    }

    /// Whether this is the reference that the others are compared with: it has no error of its own.
    #[must_use]
    pub fn is_reference(&self) -> bool {
        self.eyes.is_empty()
    }

    /// Refuses numbers that would be nonsense on a plot or in JSON.
    pub(crate) fn validate(&self) -> Result<(), ReportError> {
        let refuse = |what: String, why: String| {
            let what = format!("{what} of {} on {}", self.method, self.frames.reflector);
            Err(ReportError::InvalidArgument { what, why })
        };
        if !(self.preparation_s.is_finite() && self.preparation_s >= 0.0) {
            return refuse("preparation time".to_owned(), format!("{} s is not a duration", self.preparation_s));
        }
        for eye in &self.eyes {
            let numbers = [
                ("mean squared error", eye.mse, 0.0..=f64::MAX),
                ("relative error", eye.rel_mse, 0.0..=f64::MAX),
                ("FLIP", eye.flip, 0.0..=1.0),
                ("SSIM", eye.ssim, -1.0..=1.0 + 1e-6),
                ("share of pixels far off", eye.share_over_tenth, 0.0..=1.0),
            ];
            for (name, number, range) in numbers {
                if !range.contains(&number) {
                    return refuse(format!("{name} of eye {}", eye.eye), format!("{number} is not one"));
                }
            }
            if eye.psnr_db.is_nan() || eye.psnr_db == f64::NEG_INFINITY {
                return refuse(format!("PSNR of eye {}", eye.eye), format!("{} dB is not one", eye.psnr_db));
            }
        }
        Ok(())
    }
}

impl Serialize for MethodResult {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("MethodResult", 16)?;
        fields.serialize_field("scene", &self.frames.scene)?;
        fields.serialize_field("reflector", &self.frames.reflector)?;
        fields.serialize_field("size", &self.frames.size)?;
        fields.serialize_field("method", &self.method)?;
        fields.serialize_field("parameters", &self.parameters)?;
        fields.serialize_field("device", &self.device)?;
        fields.serialize_field("mean_psnr_db", &self.mean_psnr_db())?;
        fields.serialize_field("mean_rel_mse", &self.mean(|eye| eye.rel_mse))?;
        fields.serialize_field("mean_ssim", &self.mean(|eye| eye.ssim))?;
        fields.serialize_field("mean_flip", &self.mean_flip())?;
        fields.serialize_field("eyes", &self.eyes)?;
        fields.serialize_field("timing", &self.timing)?;
        fields.serialize_field("bytes_on_device", &self.bytes_on_device)?;
        fields.serialize_field("bytes_on_disk", &self.bytes_on_disk)?;
        fields.serialize_field("preparation_s", &self.preparation_s)?;
        fields.serialize_field("rays", &self.rays)?;
        fields.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn mean_and_range_are_over_the_eyes() {
        let mut result = sample::result("teapot", "slabs", &[30.0, 34.0, 29.0], 1.0);
        assert_eq!(result.mean_psnr_db(), Some(31.0));
        assert_eq!(result.psnr_range_db(), Some((29.0, 34.0)));
        result.eyes[1].psnr_db = f64::INFINITY;
        assert_eq!(result.mean_psnr_db(), Some(f64::INFINITY));
        result.eyes.clear();
        assert_eq!((result.mean_psnr_db(), result.psnr_range_db()), (None, None));
    }

    #[test]
    fn equal_images_have_null_psnr_in_json() {
        let (image, mask) = (Image::filled(7, 1, [90, 120, 60, 255]), Image::filled(7, 1, true));
        let equal = EyeError::compare(3, &image, &image, &mask).unwrap();
        assert!(equal.psnr_db.is_infinite());
        let json = serde_json::to_value(EyeError { ssim: equal.ssim.round(), ..equal }).unwrap();
        let expected = serde_json::json!({
            "eye": 3, "psnr_db": null, "mse": 0.0, "rel_mse": 0.0, "flip": 0.0, "ssim": 1.0, "share_over_tenth": 0.0,
            "max_abs": 0, "pixels": 7
        });
        assert_eq!(json, expected);
    }

    #[test]
    fn nonsense_is_named_and_refused() {
        let mut result = sample::result("teapot", "slabs", &[30.0], 1.0);
        result.preparation_s = f64::NAN;
        let message = result.validate().unwrap_err().to_string();
        assert!(message.contains("preparation time of slabs on teapot"), "{message}");
        result.preparation_s = 0.0;
        result.eyes[0].psnr_db = f64::NAN;
        assert!(result.validate().is_err());
        result.eyes[0].psnr_db = f64::INFINITY;
        assert!(result.validate().is_ok());
        result.eyes[0].flip = 1.5;
        assert!(result.validate().unwrap_err().to_string().contains("FLIP of eye 0"));
    }
}

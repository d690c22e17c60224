//! Made-up results for the tests of this crate.

use lf_math::{ImageError, VisibleError};

use crate::machine::Machine;
use crate::report::{Report, Table};
use crate::result::{EyeError, Frames, MethodResult};
use crate::timing::Timing;

/// A result with the given PSNR of each eye and frames of about `seconds`.
pub(crate) fn result(reflector: &str, method: &str, psnr_db: &[f64], seconds: f64) -> MethodResult {
    let eye = |(eye, &psnr): (usize, &f64)| {
        let mse = 255.0 * 255.0 / 10f64.powf(psnr / 10.0);
        let error = ImageError { pixels: 51_000 + eye, mse, max_abs: 130, over_tenth: 900, rel_mse: 0.01 };
        EyeError { psnr_db: psnr, ..EyeError::new(eye, error, VisibleError { flip: 0.0625, ssim: 0.75 }) }
    };
    MethodResult {
        frames: Frames { scene: "museum".to_owned(), reflector: reflector.to_owned(), size: [512; 2] },
        method: method.to_owned(),
        parameters: "16×16 cameras of 64×64".to_owned(),
        device: "CPU, 2 threads".to_owned(),
        eyes: psnr_db.iter().enumerate().map(eye).collect(),
        timing: Timing::from_seconds([0.97, 1.0, 1.0, 1.02, 1.2].map(|f| f * seconds).to_vec()).unwrap(),
        bytes_on_device: 6 << 20,
        bytes_on_disk: (!psnr_db.is_empty()).then_some(1_234_567),
        preparation_s: 12.3,
        rays: (!psnr_db.is_empty()).then_some(6_000_000),
    }
}

/// Two reflectors, three methods.
pub(crate) fn report() -> Report {
    Report {
        title: "Reflections in the museum".to_owned(),
        generator: "lfslab 0.1.0".to_owned(),
        machine: Machine {
            cpu: "Some CPU".to_owned(),
            threads: 2,
            adapter: None,
            os: "linux x86_64".to_owned(),
            build_profile: "release".to_owned(),
        },
        reproduce: "lfslab demo --out lfslab-demo".to_owned(),
        facts: vec![("Slabs".to_owned(), "6 × 16×16 cameras".to_owned())],
        results: vec![
            result("sphere", "ray tracing", &[], 0.310),
            result("sphere", "environment map", &[21.2, 22.0], 0.0042),
            result("sphere", "slabs", &[31.0, 31.6], 0.0133),
            result("teapot", "ray tracing", &[], 0.350),
            result("teapot", "environment map", &[20.1, 20.5], 0.0040),
            result("teapot", "slabs", &[28.9, 28.5], 0.0129),
        ],
        tables: vec![Table {
            title: "Left out".to_owned(),
            caption: "In bytes.".to_owned(),
            columns: vec!["what".to_owned(), "saves".to_owned()],
            rows: vec![vec!["a|b".to_owned(), "3".to_owned()]],
        }],
        notes: vec!["Times are wall clock.".to_owned()],
    }
}

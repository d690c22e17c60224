//! Results as comma-separated values.

use csv::Writer;

use crate::error::ReportError;
use crate::result::{EyeError, MethodResult};

const COLUMNS: [&str; 20] = [
    "scene",
    "reflector",
    "width",
    "height",
    "method",
    "parameters",
    "device",
    "psnr_db",
    "rel_mse",
    "ssim",
    "flip",
    "share_over_tenth",
    "max_abs",
    "median_ms",
    "q1_ms",
    "q3_ms",
    "bytes_on_device",
    "bytes_on_disk",
    "preparation_s",
    "rays",
];

/// A header, then a line for each result. What a result has not is empty; an infinite PSNR is `inf`.
pub(crate) fn csv(results: &[MethodResult]) -> Result<String, ReportError> {
    let mut writer = Writer::from_writer(vec![]);
    let written = || -> Result<Vec<u8>, csv::Error> {
        writer.write_record(COLUMNS)?;
        for result in results {
            writer.write_record(record(result))?;
        }
        writer.into_inner().map_err(|error| error.into_error().into())
    };
    let bytes = written().map_err(|error| ReportError::Csv(error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| ReportError::Csv(error.to_string()))
}

fn record(result: &MethodResult) -> [String; COLUMNS.len()] {
    let mean = |number: fn(&EyeError) -> f64| result.mean(number).map_or_else(String::new, |mean| mean.to_string());
    let largest = result.eyes.iter().map(|eye| eye.max_abs).max();
    let (q1, q3) = result.timing.quartiles();
    let whole = |count: Option<u64>| count.map_or_else(String::new, |count| count.to_string());
    [
        result.frames.scene.clone(),
        result.frames.reflector.clone(),
        result.frames.size[0].to_string(),
        result.frames.size[1].to_string(),
        result.method.clone(),
        result.parameters.clone(),
        result.device.clone(),
        mean(|eye| eye.psnr_db),
        mean(|eye| eye.rel_mse),
        mean(|eye| eye.ssim),
        mean(|eye| eye.flip),
        mean(|eye| eye.share_over_tenth),
        whole(largest.map(u64::from)),
        (1e3 * result.timing.median()).to_string(),
        (1e3 * q1).to_string(),
        (1e3 * q3).to_string(),
        result.bytes_on_device.to_string(),
        whole(result.bytes_on_disk),
        result.preparation_s.to_string(),
        whole(result.rays),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn fields_survive_quotes_commas_and_line_ends() {
        let mut result = sample::result("tea, \"pot\"\n", "slabs", &[30.0, 32.0], 0.01);
        result.timing = crate::Timing::from_seconds(vec![0.5]).unwrap();
        let text = csv(&[result, sample::result("sphere", "ray tracing", &[], 0.5)]).unwrap();
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        assert_eq!(reader.headers().unwrap().iter().collect::<Vec<_>>(), COLUMNS);
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert_eq!(&rows[0][1], "tea, \"pot\"\n");
        assert_eq!([&rows[0][7], &rows[0][12], &rows[0][13], &rows[0][19]], ["31", "130", "500", "6000000"]);
        assert_eq!([&rows[1][7], &rows[1][12], &rows[1][17], &rows[1][19]], [""; 4]);
    }
}

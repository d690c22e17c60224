//! The sheet of pictures: every method beside the traced picture, and what is wrong with it.

use lf_math::Image;
use lf_report::MethodResult;

use super::shots::{Measured, Shot};
use crate::pictures::{Tile, difference, masked, mosaic, over, shrunk};

/// Pixels of a method's picture on the sheet, at most, and methods beside each other on it: both fit a page of documentation.
const TILE: u32 = 256;
const COLUMNS: usize = 4;

/// The first eye's pictures, and below each what is wrong with it. Of methods with as many bytes the best stands for all; a GPU draws the
/// same picture.
pub(crate) fn sheet(shot: &Shot, methods: &[&Measured]) -> Image<[u8; 4]> {
    let size = shot.truth[0].width();
    let (black, factor) = (Image::filled(size, size, [0, 0, 0, 255]), size.div_ceil(TILE));
    let truth = masked(&shot.truth[0], &shot.references[0].mask, &black);
    let mut tiles =
        vec![Tile { title: "ray traced".to_owned(), note: String::new(), pictures: vec![shrunk(&truth, factor)] }];
    for Measured { result, picture } in methods.iter().filter(|method| stands_for_all(&method.result, methods)) {
        let drawn = over(picture, &black);
        let apart = difference(&truth, &drawn);
        let [megabytes, psnr] = [result.bytes_on_device as f64 / 1e6, result.mean_psnr_db().unwrap_or(f64::NAN)];
        tiles.push(Tile {
            title: result.method.clone(),
            note: format!("{megabytes:.1} MB, {psnr:.1} dB"),
            pictures: vec![shrunk(&drawn, factor), shrunk(&apart, factor)],
        });
    }
    mosaic(&tiles, COLUMNS)
}

/// Whether a result is the best of its method, on the CPU, in its bytes.
fn stands_for_all(this: &MethodResult, methods: &[&Measured]) -> bool {
    let like = |other: &&MethodResult| {
        (&other.method, &other.device, other.bytes_on_device) == (&this.method, &this.device, this.bytes_on_device)
    };
    let mut twins = methods.iter().map(|method| &method.result).filter(like);
    this.device == "CPU" && twins.all(|other| other.mean_psnr_db() <= this.mean_psnr_db())
}

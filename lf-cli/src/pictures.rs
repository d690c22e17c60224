//! Pictures for people: layers, strips with titles, error images.

use font8x8::UnicodeFonts;
use glam::Vec3;
use lf_math::{Image, srgb8_from_linear};

/// Differences are shown this many times as bright.
pub(crate) const ERROR_GAIN: u8 = 4;
/// Pixels of a title's letters: 8 × 8 dots of 2 pixels, or half as wide.
const LETTER: u32 = 16;
const NARROW: u32 = LETTER / 2;
const TITLE: u32 = LETTER + 8;
const GAP: u32 = 4;
const PAPER: [u8; 4] = [24, 24, 28, 255];

/// A linear picture as opaque 8-bit sRGB.
pub(crate) fn display(linear: &Image<Vec3>) -> Image<[u8; 4]> {
    linear.map(|color| {
        let [r, g, b] = srgb8_from_linear(color);
        [r, g, b, 255]
    })
}

/// The mean standard error of radiances, as a share of their mean, an upper bound ([`Estimate::standard_error`](lf_scene::Estimate)); `None` if
/// it is not known. Takes radiances with their errors.
pub(crate) fn noise<'a>(known: impl Iterator<Item = (&'a Vec3, &'a Vec3)>) -> Option<f64> {
    let sum = |color: &Vec3| color.as_dvec3().element_sum();
    let add = |(radiance, error), (l, e): (&Vec3, &Vec3)| (radiance + sum(l), error + sum(e));
    let (radiance, error) = known.fold((0.0, 0.0), add);
    Some(error / radiance).filter(|share| share.is_finite())
}

/// `front` where it is opaque, `back` elsewhere. Both must have the same size.
pub(crate) fn over(front: &Image<[u8; 4]>, back: &Image<[u8; 4]>) -> Image<[u8; 4]> {
    masked(front, &front.map(|texel| texel[3] != 0), back)
}

/// `front` where the mask is true, `back` elsewhere.
pub(crate) fn masked(front: &Image<[u8; 4]>, mask: &Image<bool>, back: &Image<[u8; 4]>) -> Image<[u8; 4]> {
    let mut picture = back.clone();
    for ((pixel, &front), &inside) in picture.texels_mut().iter_mut().zip(front.texels()).zip(mask.texels()) {
        if inside {
            *pixel = front;
        }
    }
    picture
}

/// The absolute difference per channel, brightened.
pub(crate) fn difference(a: &Image<[u8; 4]>, b: &Image<[u8; 4]>) -> Image<[u8; 4]> {
    let mut picture = a.clone();
    for (pixel, other) in picture.texels_mut().iter_mut().zip(b.texels()) {
        let channel = |c: usize| pixel[c].abs_diff(other[c]).saturating_mul(ERROR_GAIN);
        *pixel = [channel(0), channel(1), channel(2), 255];
    }
    picture
}

/// The picture at `1 / factor` of its size, each pixel the mean of a square of encoded values; columns and rows that fill
/// no square are left out.
pub(crate) fn shrunk(picture: &Image<[u8; 4]>, factor: u32) -> Image<[u8; 4]> {
    let (width, height) = (picture.width() / factor, picture.height() / factor);
    let mut small = Image::filled(width, height, [0; 4]);
    for (i, pixel) in (0u32..).zip(small.texels_mut()) {
        let (x0, y0) = (i % width * factor, i / width * factor);
        let square = (0..factor * factor).map(|j| picture.get(x0 + j % factor, y0 + j / factor));
        let sums = square.fold([0u32; 4], |sums, texel| std::array::from_fn(|c| sums[c] + u32::from(texel[c])));
        *pixel = sums.map(|sum| ((sum + factor * factor / 2) / (factor * factor)) as u8);
    }
    small
}

/// The middle half of a picture.
pub(crate) fn middle(picture: &Image<[u8; 4]>) -> Image<[u8; 4]> {
    let (width, height) = (picture.width() / 2, picture.height() / 2);
    let mut part = Image::filled(width, height, [0; 4]);
    for (i, pixel) in (0u32..).zip(part.texels_mut()) {
        *pixel = picture.get(width / 2 + i % width, height / 2 + i / width);
    }
    part
}

/// Rows of equally large pictures, each row under its title.
pub(crate) fn sheet(rows: &[(String, Vec<Image<[u8; 4]>>)]) -> Image<[u8; 4]> {
    let columns = rows.iter().map(|(_, pictures)| pictures.len()).max().unwrap_or(0) as u32;
    let first = rows.iter().find_map(|(_, pictures)| pictures.first());
    let (width, height) = first.map_or((1, 1), |picture| (picture.width(), picture.height()));
    let row_height = TITLE + height + GAP;
    let mut sheet = Image::filled(columns * (width + GAP) + GAP, rows.len() as u32 * row_height + GAP, PAPER);
    for (row, (title, pictures)) in (0..).zip(rows) {
        write_text(&mut sheet, title, GAP, row * row_height + GAP);
        for (column, picture) in (0..).zip(pictures) {
            sheet.blit(picture, GAP + column * (width + GAP), row * row_height + TITLE);
        }
    }
    sheet
}

/// A column of pictures under a title and a note.
pub(crate) struct Tile {
    pub(crate) title: String,
    pub(crate) note: String,
    pub(crate) pictures: Vec<Image<[u8; 4]>>,
}

/// Tiles of equally large pictures, so many in each row.
pub(crate) fn mosaic(tiles: &[Tile], columns: usize) -> Image<[u8; 4]> {
    let first = tiles.iter().find_map(|tile| tile.pictures.first());
    let (width, height) = first.map_or((1, 1), |picture| (picture.width(), picture.height()));
    let deepest = tiles.iter().map(|tile| tile.pictures.len()).max().unwrap_or(0) as u32;
    let [across, down] = [width + GAP, TITLE + LETTER + deepest * (height + GAP)];
    let [columns, rows] = [columns.min(tiles.len()), tiles.len().div_ceil(columns.max(1))].map(|count| count as u32);
    let mut mosaic = Image::filled(columns * across + GAP, rows * down + GAP, PAPER);
    let fitting = |text: &str| text.chars().take((width / NARROW) as usize).collect::<String>();
    for (place, tile) in (0..).zip(tiles) {
        let (x, y) = (GAP + place % columns * across, place / columns * down + GAP);
        write_letters(&mut mosaic, &fitting(&tile.title), [x, y], NARROW);
        write_letters(&mut mosaic, &fitting(&tile.note), [x, y + LETTER], NARROW);
        for (row, picture) in (0..).zip(&tile.pictures) {
            mosaic.blit(picture, x, y + TITLE + LETTER - GAP + row * (height + GAP));
        }
    }
    mosaic
}

/// Pictures side by side, each under its title.
pub(crate) fn strip(panels: &[(&str, Image<[u8; 4]>)]) -> Image<[u8; 4]> {
    let pictures = panels.iter().map(|(_, picture)| picture.clone()).collect();
    let mut strip = sheet(&[(String::new(), pictures)]);
    let width = panels.first().map_or(0, |(_, picture)| picture.width());
    for (column, (title, _)) in (0..).zip(panels) {
        let fitting: String = title.chars().take((width / LETTER) as usize).collect();
        write_text(&mut strip, &fitting, GAP + column * (width + GAP), GAP);
    }
    strip
}

fn write_text(picture: &mut Image<[u8; 4]>, text: &str, x: u32, y: u32) {
    write_letters(picture, text, [x, y], LETTER);
}

/// Letters of a width, a multiple of 8 pixels. Those that the font lacks are left blank.
fn write_letters(picture: &mut Image<[u8; 4]>, text: &str, [x, y]: [u32; 2], width: u32) {
    let dot = Image::filled(width / 8, LETTER / 8, [225, 225, 230, 255]);
    for (column, letter) in (0..).zip(text.chars()) {
        let rows = font8x8::BASIC_FONTS.get(letter).or_else(|| font8x8::LATIN_FONTS.get(letter)).unwrap_or([0; 8]);
        for (dot_y, row) in (0..).zip(rows) {
            for dot_x in (0..8).filter(|bit| row >> bit & 1 == 1) {
                picture.blit(&dot, x + column * width + dot_x * width / 8, y + dot_y * LETTER / 8);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_brightened_and_layers_stack() {
        let a = Image::filled(2, 1, [10, 20, 30, 255]);
        let b = Image::filled(2, 1, [12, 20, 130, 255]);
        assert_eq!(difference(&a, &b).get(0, 0), [8, 0, 255, 255]);
        let clear = Image::filled(2, 1, [0; 4]);
        assert_eq!(over(&clear, &a), a);
        assert_eq!(over(&b, &a), b);
        assert_eq!(masked(&b, &Image::new(2, 1, vec![true, false]).unwrap(), &a).get(1, 0), [10, 20, 30, 255]);
    }

    #[test]
    fn shrinking_takes_means_and_sheets_hold_all_pictures() {
        let mut picture = Image::filled(4, 2, [0, 0, 0, 255]);
        picture.texels_mut()[0] = [200, 100, 0, 255];
        assert_eq!(shrunk(&picture, 2).texels(), [[50, 25, 0, 255], [0, 0, 0, 255]]);
        let sheet = sheet(&[("one".into(), vec![picture.clone(), picture.clone()]), ("two".into(), vec![picture])]);
        assert_eq!((sheet.width(), sheet.height()), (2 * 8 + 4, 2 * (24 + 2 + 4) + 4));
        assert_eq!(sheet.get(GAP, TITLE), [200, 100, 0, 255]);
    }

    #[test]
    fn mosaics_break_into_rows() {
        let picture = Image::filled(20, 10, [200, 100, 0, 255]);
        let tile = |count: usize| Tile {
            title: "a".to_owned(),
            note: "far too long for the width".to_owned(),
            pictures: vec![picture.clone(); count],
        };
        let mosaic = mosaic(&[tile(1), tile(2), tile(2)], 2);
        assert_eq!((mosaic.width(), mosaic.height()), (2 * 24 + 4, 2 * (40 + 2 * 14) + 4));
        // The third is in the second row, and its second picture ends where the sheet does.
        assert_eq!(mosaic.get(GAP, 2 * 68 - GAP - 1), [200, 100, 0, 255]);
        assert_eq!(mosaic.get(GAP + 24, 2 * 68 - GAP - 1), PAPER);
    }
}

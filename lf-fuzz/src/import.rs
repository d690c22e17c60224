//! Folders of pictures and quilts from anywhere: they are imported or refused, within the budget, and what is imported can be
//! stored.

use std::io::Cursor;
use std::path::Path;

use arbitrary::{Arbitrary, Unstructured};
use image::{ImageFormat, RgbaImage};
use lf_compress::PackedLightField;
use lf_compress::bc1::Quality;
use lf_compress::format::TexelEncoding;
use lf_exchange::{ImportOptions, QuiltLayout, Texels, import};

#[derive(Arbitrary, Debug)]
struct Input {
    files: Vec<FileInput>,
    /// `parameters.cfg`, if there is one; the lines of a sound one are shuffled in.
    config: Option<Vec<Line>>,
    /// A single file instead of a folder.
    quilt: Option<(u8, u8)>,
    focal_plane: Option<f64>,
    spacing: Option<f64>,
    flips: [bool; 2],
}

#[derive(Arbitrary, Debug)]
struct FileInput {
    kind: u8,
    place: [u8; 2],
    position: [f32; 2],
    name: String,
    size: [u8; 2],
    /// Bytes of the file instead of a sound picture.
    bytes: Option<Vec<u8>>,
}

#[derive(Arbitrary, Debug)]
struct Line {
    key: u8,
    number: f32,
    text: Option<String>,
}

const KEYS: [&str; 12] = [
    "[intrinsics]",
    "focal_length_mm",
    "image_resolution_x_px",
    "image_resolution_y_px",
    "sensor_size_mm",
    "[extrinsics]",
    "num_cams_x",
    "num_cams_y",
    "baseline_mm",
    "focus_distance_m",
    "center_cam_x_m",
    "center_cam_rx_rad",
];

/// Files of a folder at most.
const MOST_FILES: usize = 9;

/// See the module.
pub fn run(data: &[u8]) {
    let Ok(input) = Input::arbitrary_take_rest(Unstructured::new(data)) else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let mut options = ImportOptions::default();
    options.max_bytes = 16 << 20;
    options.focal_plane = input.focal_plane;
    options.spacing = input.spacing;
    [options.rows_upwards, options.columns_leftwards] = input.flips;
    for file in input.files.iter().take(MOST_FILES) {
        file.write(folder.path());
    }
    if let Some(lines) = &input.config {
        let text: Vec<String> = lines.iter().map(Line::text).collect();
        std::fs::write(folder.path().join("parameters.cfg"), text.join("\n")).expect("writes");
    }
    let mut path = folder.path().to_owned();
    if let (Some((columns, rows)), Some(file)) = (input.quilt, input.files.first()) {
        path.push("views_qs2x2a1.png");
        std::fs::write(&path, file.contents()).expect("writes");
        options.quilt = Some(QuiltLayout { columns: (columns % 5).into(), rows: (rows % 5).into() });
    }
    let Ok(imported) = import(&path, &options) else { return };
    let geometry = imported.geometry.clone();
    assert_eq!(imported.missing.len() as u32, geometry.slabs()[0].cameras().iter().product::<u32>());
    let packed = match &imported.texels {
        Texels::Srgb8(texels) => {
            PackedLightField::encode(geometry, std::slice::from_ref(texels), TexelEncoding::Rgba8, Quality::Fast)
        }
        Texels::Linear16(texels) => PackedLightField::encode_linear(geometry, std::slice::from_ref(texels)),
    };
    // Infinities in pictures are refused here.
    let _ = packed;
}

impl FileInput {
    fn write(&self, folder: &Path) {
        let ([row, column], [y, x]) = (self.place.map(|n| n % 4), self.position);
        let name = match self.kind % 5 {
            0 => format!("out_{row:02}_{column:02}_{y}_{x}_.png"),
            1 => format!("view_{row:02}_{column:02}.png"),
            2 => format!("{row}_{column}.png"),
            3 => format!("input_Cam{:03}.png", 4 * row + column),
            _ => self.name.chars().filter(|c| !matches!(c, '/' | '\0')).take(60).collect(),
        };
        if !matches!(name.as_str(), "" | "." | "..") {
            // A name that the system refuses is none to be met.
            let _ = std::fs::write(folder.join(name), self.contents());
        }
    }

    fn contents(&self) -> Vec<u8> {
        if let Some(bytes) = &self.bytes {
            return bytes.clone();
        }
        let [width, height] = self.size.map(|n| u32::from(n % 24) + 1);
        let mut out = Cursor::new(Vec::new());
        let picture = RgbaImage::from_fn(width, height, |x, y| image::Rgba([x as u8, y as u8, self.kind, 255]));
        picture.write_to(&mut out, ImageFormat::Png).expect("a picture");
        out.into_inner()
    }
}

impl Line {
    fn text(&self) -> String {
        let key = KEYS[usize::from(self.key) % KEYS.len()];
        match &self.text {
            Some(text) => text.clone(),
            None if key.starts_with('[') => key.to_owned(),
            None => format!("{key} = {}", self.number),
        }
    }
}

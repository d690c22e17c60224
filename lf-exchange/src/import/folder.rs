//! Folders of pictures with rows, columns and perhaps positions in their names.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use half::f16;
use lf_math::Face;

use crate::import::assemble::{
    CameraGrid, DEFAULT_SPACING, camera, centered, focal_plane, spacing, spacing_or_default,
};
use crate::import::decode::{self, Decode, EXTENSIONS};
use crate::import::names::{self, ViewName};
use crate::import::regular::{Line, Stride};
use crate::import::{ImportOptions, Imported, Lens};
use crate::{ExchangeError, PictureAxis};

/// Metres in a unit of the positions in names: millimetres.
const NAME_UNIT: f64 = 1e-3;
/// How far a position may be from the regular grid, as a share of the distance of neighbours, before it is noted.
const NOTED_ERROR: f64 = 0.02;
/// … and before the folder is refused: neighbours could then change places.
const REFUSED_ERROR: f64 = 0.5;

/// Imports a folder of pictures that have their camera's row and column in their names, and perhaps its position:
/// `…RR_CC…` or `…RR_CC_Y_X…`, as in the (New) Stanford Light Field Archive, Y pointing downwards and X to the right.
///
/// PNG and JPEG become sRGB texels, OpenEXR linear ones. Files with other names or extensions are ignored. Indices may
/// have strides (00, 02, 04); pictures may be missing. With positions a regular grid is fitted to them; a deviation of
/// more than 2 % of the distance between neighbours is noted, more than 50 % refused. Without, the grid is centred on
/// the world's origin.
///
/// LightPack's `.lif` and `.lid` files are not read.
///
/// # Errors
/// [`ExchangeError::Malformed`] if the folder holds no such pictures, or those of several series or sizes, or two of one
/// camera; [`ExchangeError::LimitExceeded`] before anything is decoded; others as their names say.
pub fn import_grid(folder: &Path, options: &ImportOptions) -> Result<Imported, ExchangeError> {
    let names = scan(folder)?;
    let views = Views::new(folder, &names, options)?;
    let mut notes = views.notes(names.len());
    let placed = views.place(folder, options, &mut notes)?;
    let first = views.by_index.values().next().ok_or_else(|| no_pictures(folder))?;
    let linear = decode::is_exr(&first.1);
    if linear && decode::has_other_primaries(&first.1)? {
        notes.push("the pictures have other primaries than Rec. 709; their values are kept as they are".into());
    }
    let size = decode::size(&first.1, options.max_bytes)?;
    let lens = first.0.lens.filter(|_| views.by_index.values().all(|(view, _)| view.lens == first.0.lens));
    let named = lens.map(|[focal, sensor]| Lens::FocalLength(focal / sensor * f64::from(size[0].max(size[1]))));
    let grid = CameraGrid {
        face: options.face.unwrap_or(Face::NegZ),
        plane: options.plane.unwrap_or(0.0),
        positions: placed.axes,
        camera: camera(size, options, (named, None), &mut notes)?,
        focal_plane: focal_plane(options)?,
        linear,
        notes,
    };
    grid.check_budget(options, size)?;
    if linear {
        load::<[f16; 3]>(grid, options, &views, &placed)
    } else {
        load::<[u8; 4]>(grid, options, &views, &placed)
    }
}

fn load<T: Decode>(
    grid: CameraGrid,
    options: &ImportOptions,
    views: &Views<'_>,
    placed: &Placed,
) -> Result<Imported, ExchangeError> {
    let size = grid.camera.size;
    grid.assemble(options, |column, row| {
        let rank = placed.rank([column, row]);
        views.at(rank).map(|path| T::decode(path, size)).transpose()
    })
}

fn no_pictures(folder: &Path) -> ExchangeError {
    let what = "it holds no PNG, JPEG or OpenEXR files with a row and a column in their names, such as out_00_00.png";
    ExchangeError::malformed(folder, what)
}

/// The stems and paths of the picture files in a folder.
pub(crate) fn scan(folder: &Path) -> Result<Vec<(String, PathBuf)>, ExchangeError> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(ExchangeError::io(folder))? {
        let path = entry.map_err(ExchangeError::io(folder))?.path();
        let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
        let stem = path.file_stem().and_then(|stem| stem.to_str()).map(str::to_owned);
        if let (Some(stem), Some(extension)) = (stem, extension)
            && EXTENSIONS.contains(&extension.as_str())
        {
            names.push((stem, path));
        }
    }
    names.sort();
    Ok(names)
}

/// The pictures of one series, by row and column as the names have them.
struct Views<'a> {
    by_index: BTreeMap<[u32; 2], (ViewName<'a>, PathBuf)>,
    strides: [Stride; 2],
}

/// Where the cameras are, and which way their indices run.
struct Placed {
    /// Along right and down.
    axes: [PictureAxis; 2],
    /// Whether columns, and rows, of the names descend along them.
    reversed: [bool; 2],
}

impl Placed {
    /// Row and column, as ranks of the names, of the camera in this column and row of the grid.
    fn rank(&self, [column, row]: [u32; 2]) -> [u32; 2] {
        let turn = |i: usize, at: u32| if self.reversed[i] { self.axes[i].count - 1 - at } else { at };
        [turn(1, row), turn(0, column)]
    }
}

impl<'a> Views<'a> {
    fn new(folder: &Path, names: &'a [(String, PathBuf)], options: &ImportOptions) -> Result<Self, ExchangeError> {
        let parsed = names.iter().filter_map(|(stem, path)| Some((names::parse(stem)?, path)));
        let wanted = |view: &ViewName<'_>| options.series.as_deref().is_none_or(|series| series == view.series);
        let mut by_index = BTreeMap::new();
        let mut series = BTreeSet::new();
        for (view, path) in parsed.filter(|(view, _)| wanted(view)) {
            series.insert(view.series);
            if by_index.insert([view.row, view.column], (view, path.clone())).is_some() && series.len() == 1 {
                let what = format!("it holds two pictures of row {}, column {}", view.row, view.column);
                return Err(ExchangeError::malformed(folder, what));
            }
        }
        if series.len() > 1 {
            let list: Vec<&str> = series.into_iter().collect();
            let what = format!("it holds pictures of several series: {}; choose one", list.join(", "));
            return Err(ExchangeError::malformed(folder, what));
        }
        let stride = |i: usize| Stride::of(by_index.keys().map(move |index| index[i]));
        let strides = stride(0).zip(stride(1)).ok_or_else(|| no_pictures(folder))?;
        Ok(Self { by_index, strides: strides.into() })
    }

    fn notes(&self, files: usize) -> Vec<String> {
        let ignored = files - self.by_index.len();
        let note = (ignored > 0)
            .then(|| format!("{ignored} pictures without a row and a column, or of another series, are ignored"));
        note.into_iter().collect()
    }

    /// The picture with these ranks of row and column.
    fn at(&self, [row, column]: [u32; 2]) -> Option<&PathBuf> {
        let index = [self.strides[0].index(row), self.strides[1].index(column)];
        self.by_index.get(&index).map(|(_, path)| path)
    }

    fn place(&self, folder: &Path, options: &ImportOptions, notes: &mut Vec<String>) -> Result<Placed, ExchangeError> {
        let placed = self.by_index.values().filter(|(view, _)| view.position.is_some()).count();
        if placed == self.by_index.len() {
            return self.place_by_positions(folder, spacing(options)?, notes);
        }
        if placed > 0 {
            return Err(ExchangeError::malformed(folder, "some names hold a position and others do not"));
        }
        let spacing = spacing_or_default(options, notes)?;
        let [rows, columns] = self.strides.map(|stride| stride.count);
        Ok(Placed {
            axes: [centered(columns, spacing), centered(rows, spacing)],
            reversed: [options.columns_leftwards, options.rows_upwards],
        })
    }

    fn place_by_positions(
        &self,
        folder: &Path,
        spacing: Option<f64>,
        notes: &mut Vec<String>,
    ) -> Result<Placed, ExchangeError> {
        let [down, right] = [0, 1].map(|i| self.line(i).ok_or_else(|| no_pictures(folder)));
        let lines = [right?, down?];
        let steps = lines.map(|line| line.step.map(f64::abs));
        let known = steps[0].or(steps[1]);
        let scale = spacing.zip(known).map_or(NAME_UNIT, |(spacing, step)| spacing / step);
        // A single row is as far from its neighbours as columns are, and the other way round.
        let single = known.map_or(spacing.unwrap_or(DEFAULT_SPACING), |step| step * scale);
        for (line, what) in lines.iter().zip(["X", "Y"]) {
            check_line(folder, line, what, known, notes)?;
        }
        let counts = [self.strides[1].count, self.strides[0].count];
        let [right, down] = [0, 1].map(|i| lines[i].axis(counts[i], scale, single));
        Ok(Placed { axes: [right.0, down.0], reversed: [right.1, down.1] })
    }

    /// The line through the positions of rows (0) or columns (1).
    fn line(&self, i: usize) -> Option<Line> {
        let stride = self.strides[i];
        let point = move |(index, (view, _)): (&[u32; 2], &(ViewName<'_>, PathBuf))| {
            Some((stride.rank(index[i]), view.position?[i]))
        };
        Line::fit(self.by_index.iter().filter_map(point))
    }
}

/// Refuses or notes positions off the regular grid. `step` is that of the other direction for a single row or column.
fn check_line(
    folder: &Path,
    line: &Line,
    what: &str,
    step: Option<f64>,
    notes: &mut Vec<String>,
) -> Result<(), ExchangeError> {
    if line.step.is_some_and(|step| !(step.abs() > 0.0 && step.is_finite())) {
        return Err(ExchangeError::malformed(
            folder,
            format!("the positions in the names have the same {what} everywhere"),
        ));
    }
    let share = line.step.map(f64::abs).or(step).map_or(0.0, |step| line.error / step);
    if share > REFUSED_ERROR {
        let what = format!(
            "the cameras are not on a regular grid: a position's {what} is {:.0} % of the camera spacing away from it",
            100.0 * share
        );
        return Err(ExchangeError::malformed(folder, what));
    }
    if share > NOTED_ERROR {
        notes.push(format!(
            "positions are up to {:.0} % of the camera spacing away from the regular grid in {what}; the grid is used",
            100.0 * share
        ));
    }
    Ok(())
}

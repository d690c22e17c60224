//! `lfslab holdout`: how well a light field's cameras predict those that were left out.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use lf_exchange::PictureBasis;
use lf_ibr::{Blend, HoldOut, LeftOut, Texel, depth_planes, focus_from_images, hold_out, view};
use lf_math::{Face, Image, ImageError, Slab, SlabTexels, image_error};

use crate::exchange::slab_of;
use crate::input::{MAX_DECODED_BYTES, load};
use crate::output::{check_writable, png, print, write};
use crate::pictures::{ERROR_GAIN, difference, middle, sheet};
use crate::refocus::{is_linear, told};
use crate::refocus_args::HoldoutArgs;

/// Pictures wider than this are shown by their middle half.
const WIDE: u32 = 512;

pub(crate) fn run(args: &HoldoutArgs) -> Result<()> {
    args.sheet.as_deref().map_or(Ok(()), check_writable)?;
    let field = load(&args.input)?;
    let number = slab_of(field.geometry(), args.face)?;
    let slab = &field.geometry().slabs()[number];
    if is_linear(&field) {
        measure(args, slab, &field.decode_linear(MAX_DECODED_BYTES)?[number])
    } else {
        measure(args, slab, &field.decode(MAX_DECODED_BYTES)?[number])
    }
}

fn measure<T: Texel>(args: &HoldoutArgs, slab: &Slab, texels: &SlabTexels<T>) -> Result<()> {
    let held = hold_out(slab, texels, args.every)?;
    let ([s, t], [all_s, all_t]) = (held.slab.cameras(), slab.cameras());
    if held.views.is_empty() {
        bail!("with {s}×{t} of {all_s}×{all_t} cameras kept, none is left out between them: give another --every");
    }
    eprintln!("holdout  {s}×{t} of {all_s}×{all_t} cameras are kept, {} between them left out", held.views.len());
    let mut methods = methods(args, &held);
    let stride = args.views.map_or(1, |most| held.views.len().div_ceil(most as usize));
    for left_out in held.views.iter().step_by(stride) {
        let (truth, stored) = truth(slab, texels, left_out)?;
        for method in &mut methods {
            method.measure(&held, left_out, &truth, &stored)?;
        }
    }
    let mut table = String::from(
        "| method | PSNR, dB: mean (min–max) | pixels off by more than a tenth | ms a view |\n|---|--:|--:|--:|\n",
    );
    for method in &methods {
        writeln!(table, "{}", method.row())?;
    }
    if let Some(path) = &args.sheet {
        write(path, &png(&pictures(slab, texels, &held, &methods)?)?)?;
    }
    print(table.trim_end())
}

/// A way to make the views that were left out.
struct Method {
    name: String,
    blend: Owned,
    errors: Vec<ImageError>,
    time: Duration,
}

/// A [`Blend`] with its planes.
enum Owned {
    Nearest,
    Plane(f32),
    Consensus(Vec<f32>),
}

impl Method {
    fn new(name: impl Into<String>, blend: Owned) -> Self {
        Self { name: name.into(), blend, errors: Vec::new(), time: Duration::ZERO }
    }

    fn draw<T: Texel>(&self, held: &HoldOut<T>, left_out: &LeftOut) -> Image<[u8; 4]> {
        let blend = match &self.blend {
            Owned::Nearest => Blend::Nearest,
            Owned::Plane(inverse_depth) => Blend::Plane(*inverse_depth),
            Owned::Consensus(planes) => Blend::Consensus(planes),
        };
        view(&held.slab, &held.texels, left_out.place, blend)
    }

    /// Makes a view that was left out, and compares it where the truth has texels.
    fn measure<T: Texel>(
        &mut self,
        held: &HoldOut<T>,
        left_out: &LeftOut,
        truth: &Image<[u8; 4]>,
        stored: &Image<bool>,
    ) -> Result<()> {
        let start = Instant::now();
        let made = self.draw(held, left_out);
        self.time += start.elapsed();
        self.errors.push(image_error(truth, &made, stored)?);
        Ok(())
    }

    /// A row of the table.
    fn row(&self) -> String {
        let count = self.errors.len() as f64;
        let psnr = || self.errors.iter().map(ImageError::psnr_db);
        let (least, most) = psnr().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), db| (a.min(db), b.max(db)));
        let share = 100.0 * self.errors.iter().map(ImageError::share_over_tenth).sum::<f64>() / count;
        let (mean, ms) = (psnr().sum::<f64>() / count, 1e3 * self.time.as_secs_f64() / count);
        format!("| {} | {mean:.2} ({least:.2}–{most:.2}) | {share:.2} % | {ms:.1} |", self.name)
    }
}

/// All that can be done, with what is found from the cameras that are kept.
fn methods<T: Texel>(args: &HoldoutArgs, held: &HoldOut<T>) -> Vec<Method> {
    let mut methods =
        vec![Method::new("nearest camera", Owned::Nearest), Method::new("bilinear, no focal plane", Owned::Plane(0.0))];
    if let Some(depth) = held.slab.focal_depth() {
        methods
            .push(Method::new(format!("bilinear, the file's focal plane: {depth:.4} m"), Owned::Plane(depth.recip())));
    }
    let start = Instant::now();
    let Some(found) = focus_from_images(&held.slab, &held.texels) else {
        eprintln!("note: too few cameras or texels are left to find a focal plane");
        return methods;
    };
    eprintln!("         {}, found in {:.1} s", told(&held.slab, &found), start.elapsed().as_secs_f64());
    let texels = |inverse_depth: f32| format!("{:.2}", farthest(held.slab.disparity_at(inverse_depth).to_array()));
    let name = format!("bilinear, focal plane by least squares: {} texels a camera", texels(found.best.inverse_depth));
    methods.push(Method::new(name, Owned::Plane(found.best.inverse_depth)));
    for &count in args.planes.iter().filter(|&&count| count > 0) {
        let planes = depth_planes(&held.slab, &held.texels, count.into());
        if let Some((&far, &near)) = planes.first().zip(planes.last()) {
            let name = format!("the best of {count} planes for each texel: {} to {} texels", texels(far), texels(near));
            methods.push(Method::new(name, Owned::Consensus(planes)));
        }
    }
    methods
}

/// Of the two, the one that is farther from 0.
fn farthest([u, v]: [f32; 2]) -> f32 {
    if u.abs() >= v.abs() { u } else { v }
}

/// The image of a camera, and where it has texels.
fn truth<T: Texel>(slab: &Slab, texels: &SlabTexels<T>, left_out: &LeftOut) -> Result<(Image<[u8; 4]>, Image<bool>)> {
    let [s, t] = left_out.camera;
    let image = texels.image([s, t]).context("a camera has lost its image")?;
    let [width, height] = slab.resolution();
    let stored = (0..height).flat_map(|v| (0..width).map(move |u| (u, v)));
    let stored = stored.map(|(u, v)| image.u.contains(&u) && image.v.contains(&v)).collect();
    let truth = view(slab, texels, glam::Vec2::new(s as f32, t as f32), Blend::Nearest);
    Ok((truth, Image::new(width, height, stored)?))
}

/// The left-out view nearest to the middle of the grid: under each method's name the truth, what it makes of it, and the difference.
fn pictures<T: Texel>(
    slab: &Slab,
    texels: &SlabTexels<T>,
    held: &HoldOut<T>,
    methods: &[Method],
) -> Result<Image<[u8; 4]>> {
    let from_middle = |left_out: &&LeftOut| {
        let offset = |i: usize| (2 * left_out.camera[i]).abs_diff(slab.cameras()[i] - 1);
        offset(0) + offset(1)
    };
    let left_out = held.views.iter().min_by_key(from_middle).context("no camera is left out")?;
    let shown = |image: &Image<[u8; 4]>| {
        let picture = upright(image, slab.face());
        if picture.width() > WIDE { middle(&picture) } else { picture }
    };
    let (truth, _) = truth(slab, texels, left_out)?;
    let row = |method: &Method| {
        let made = method.draw(held, left_out);
        let title = format!("{} (truth, made, difference x{ERROR_GAIN})", method.name);
        (title, vec![shown(&truth), shown(&made), shown(&difference(&truth, &made))])
    };
    Ok(sheet(&methods.iter().map(row).collect::<Vec<_>>()))
}

/// An image of a slab as its camera sees it.
fn upright(image: &Image<[u8; 4]>, face: Face) -> Image<[u8; 4]> {
    let (basis, counts) = (PictureBasis::new(face), [image.width(), image.height()]);
    let [width, height] = basis.size(counts);
    let mut picture = Image::filled(width, height, [0; 4]);
    for (pixel, i) in picture.texels_mut().iter_mut().zip(0u32..) {
        let [u, v] = basis.sample([i % width, i / width], counts);
        *pixel = image.get(u, v);
    }
    picture
}

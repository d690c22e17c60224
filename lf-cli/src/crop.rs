//! `lfslab crop`: what a light field needs of a file.

use anyhow::{Context, Result, bail};
use lf_compress::PackedLightField;
use lf_format::Writer;

use crate::args::CropArgs;
use crate::input::open;
use crate::output::{check_writable, megabytes, print};

pub(crate) fn run(args: &CropArgs) -> Result<()> {
    check_writable(&args.out)?;
    let path = args.input.file.display();
    let mut input = open(&args.input)?;
    let field = PackedLightField::read_file(&mut input).with_context(|| path.to_string())?;
    let (mut metadata, cell) = (input.metadata().clone(), *field.geometry().cell());
    let cropped = match &args.cube {
        None => field.cropped()?,
        Some(cube) => {
            let (center, half) = (cell.cell_from_world(cube.center), 0.5 * cube.size);
            let corners =
                [center - half, center + half].map(|corner| corner.clamp(-cell.half_extent(), cell.half_extent()));
            if corners[0].cmpge(corners[1]).any() {
                bail!("--box does not meet the cell of {path}");
            }
            let [least, most] = corners.map(|corner| cell.world_from_cell(corner));
            metadata.insert("coverage", format!("rays from the box {least} to {most}, world space, metres"))?;
            field.cropped_to(corners)?
        }
    };
    let texels = |field: &PackedLightField| field.tilings().iter().map(|t| t.coverage().texels() as f64).sum::<f64>();
    eprintln!("crop     {:.1} % of the texels are needed", 100.0 * texels(&cropped) / texels(&field));
    let mut contents = cropped.contents(metadata);
    // What this program does not know is kept where its maker allows it.
    contents.extra = input.copyable_chunks().with_context(|| path.to_string())?;
    let mut writer = Writer::create(&args.out, contents)?;
    cropped.write(&mut writer)?;
    let bytes = writer.save()?;
    print(&format!("{}: {}", args.out.display(), megabytes(bytes)))
}

//! `lfslab crop`: what a light field needs of a file.

use anyhow::{Context, Result};
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
    let cropped = field.cropped()?;
    let texels = |field: &PackedLightField| field.tilings().iter().map(|t| t.coverage().texels() as f64).sum::<f64>();
    eprintln!("crop     {:.1} % of the texels are needed", 100.0 * texels(&cropped) / texels(&field));
    let mut contents = cropped.contents(input.metadata().clone());
    // What this program does not know is kept where its maker allows it.
    contents.extra = input.copyable_chunks().with_context(|| path.to_string())?;
    let mut writer = Writer::create(&args.out, contents)?;
    cropped.write(&mut writer)?;
    let bytes = writer.save()?;
    print(&format!("{}: {}", args.out.display(), megabytes(bytes)))
}

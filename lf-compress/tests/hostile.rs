//! Light fields that are small in the file and huge in their numbers: read, decoded and cut within moments, or refused.

use std::time::{Duration, Instant};

use glam::DVec3;
use lf_compress::format::{
    Container, Contents, FormatError, Limits, Metadata, Packing, SlabTiling, TexelEncoding, Writer,
};
use lf_compress::{PackError, PackedLightField, Severity, check_tile, validate};
use lf_math::{Cell, Coverage, Face, LightFieldGeometry, SampledAxis, Slab};

/// A slab of 65,536 × 65,536 cameras of 4×4 texels, of which windows leave only the last: one tile of one block.
fn lone_camera() -> Vec<u8> {
    let st = SampledAxis::new(-1.0, 1e-5, 1 << 16).unwrap();
    let uv = SampledAxis::spanning(-1.0, 1.0, 4).unwrap();
    let slab = Slab::new(Face::PosZ, 0.5, [st; 2], [uv; 2], None).unwrap();
    let geometry = LightFieldGeometry::new(Cell::cube(DVec3::ZERO, 1.0).unwrap(), vec![slab]).unwrap();
    let windows = || (0..1 << 16).map(|i| if i == (1 << 16) - 1 { 0..4 } else { 0..0 }).collect();
    let coverage = Coverage::new(&slab, windows(), windows()).unwrap();
    let tiling = SlabTiling::covering(&slab, TexelEncoding::Bc1, [1 << 16, 1 << 16], coverage).unwrap();
    let contents = Contents::new(geometry, vec![tiling], Metadata::new());
    let mut writer = Writer::new(std::io::Cursor::new(Vec::new()), contents).unwrap();
    writer.tile(Packing::None, &[0x00, 0xF8, 0x1F, 0x00, 0, 0, 0, 0]).unwrap();
    writer.finish().unwrap().into_inner()
}

#[test]
fn four_billion_cameras_of_which_one_is_stored_take_no_time() {
    let bytes = lone_camera();
    let start = Instant::now();
    let container = Container::parse(&bytes, &Limits::default()).unwrap();
    let last = container.tilings()[0].stored_tiles().next().unwrap();
    check_tile(&container.tile(0, last).unwrap(), &container.tilings()[0], 0, last).unwrap();
    let mut errors = 0;
    let count = |found: lf_compress::Finding| errors += u32::from(found.severity == Severity::Error);
    validate(std::io::Cursor::new(&bytes), &Limits::default(), count).unwrap();
    assert_eq!(errors, 0);
    let field = PackedLightField::read(&container).unwrap();
    let texels = field.decode(1 << 20).unwrap();
    assert_eq!(texels[0].texel([65_535, 65_535], [3, 0]), Some([255, 0, 0, 255]));
    assert_eq!(texels[0].texel([65_534, 65_535], [3, 0]), None);
    assert_eq!(field.to_bytes(Metadata::new()).unwrap().len() % 64, 8);
    field.cropped().unwrap();
    assert!(matches!(field.whole(1 << 30), Err(PackError::TooLarge { .. })));
    // Far above what it takes, far below four billion steps.
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
}

/// A tile that says it holds a gibibyte is refused before memory is taken for it, whatever is in it.
#[test]
fn the_budget_covers_unpacked_tiles() {
    let axis = |count| SampledAxis::new(0.0, 1e-3, count).unwrap();
    let slab = Slab::new(Face::PosZ, 0.5, [axis(64); 2], [axis(1024), axis(512)], None).unwrap();
    let geometry = LightFieldGeometry::new(Cell::cube(DVec3::ZERO, 1.0).unwrap(), vec![slab]).unwrap();
    let tiling = SlabTiling::new(&slab, TexelEncoding::Bc1, [64, 64]).unwrap();
    assert_eq!(tiling.raw_len(0), 1 << 30);
    let mut writer =
        Writer::new(std::io::Cursor::new(Vec::new()), Contents::new(geometry, vec![tiling], Metadata::new()));
    writer.as_mut().unwrap().tile(Packing::Zstd, &[1, 2, 3]).unwrap();
    let bytes = writer.unwrap().finish().unwrap().into_inner();
    let limits = Limits { memory_bytes: (1 << 30) - 1 };
    let container = Container::parse(&bytes, &limits).unwrap();
    let refused = PackedLightField::read(&container);
    assert!(matches!(refused, Err(PackError::Format(FormatError::LimitExceeded { .. }))), "{refused:?}");
    let mut found = Vec::new();
    validate(std::io::Cursor::new(&bytes), &limits, |finding| found.push(finding.id)).unwrap();
    assert!(found.contains(&"limit"), "{found:?}");
}

//! Any light field that can be written comes back as it was, through both readers, and is written the same again.

use std::io::Cursor;

use arbitrary::{Arbitrary, Unstructured};
use half::f16;
use lf_compress::bc1::Quality;
use lf_compress::format::{Container, FileReader, Limits, Metadata, TexelEncoding};
use lf_compress::{PackedLightField, Severity, validate};
use lf_math::{Coverage, LightFieldGeometry, SlabTexels};

use crate::field::Shape;

#[derive(Arbitrary, Debug)]
struct Input {
    shape: Shape,
    encoding: u8,
    metadata: Vec<(String, String)>,
    texels: Vec<u8>,
}

/// See the module.
pub fn run(data: &[u8]) {
    let Ok(input) = Input::arbitrary_take_rest(Unstructured::new(data)) else { return };
    let Some(field) = input.field() else { return };
    let metadata = input.metadata();
    let bytes = field.to_bytes(metadata.clone()).expect("it fits");
    let limits = Limits::default();
    let container = Container::parse(&bytes, &limits).expect("it was written just now");
    assert_eq!(container.metadata(), &metadata);
    assert_eq!(container.geometry(), field.geometry());
    assert_eq!(container.tilings(), field.tilings());
    let read = PackedLightField::read(&container).expect("it was written just now");
    let mut file = FileReader::open(Cursor::new(&bytes), &limits).expect("it was written just now");
    let by_parts = PackedLightField::read_file(&mut file).expect("it was written just now");
    for slab in 0..field.tilings().len() {
        assert_eq!(read.tiles(slab), field.tiles(slab));
        assert_eq!(by_parts.tiles(slab), field.tiles(slab));
    }
    assert_eq!(read.to_bytes(metadata).expect("it fits"), bytes);
    let no_error = |found: lf_compress::Finding| assert_ne!(found.severity, Severity::Error, "{found:?}");
    validate(Cursor::new(&bytes), &limits, no_error).expect("there is no input error");
    let cropped = read.cropped().expect("it fits");
    assert_eq!(cropped.cropped().expect("it fits").tilings(), cropped.tilings());
}

impl Input {
    fn field(&self) -> Option<PackedLightField> {
        let (geometry, coverages) = self.shape.geometry()?;
        let coverages: Vec<_> = coverages.into_iter().map(|coverage| coverage.aligned(4)).collect();
        let packed = match self.encoding % 3 {
            0 => PackedLightField::encode(geometry.clone(), &self.srgb(&coverages), TexelEncoding::Bc1, Quality::Fast),
            1 => {
                PackedLightField::encode(geometry.clone(), &self.srgb(&coverages), TexelEncoding::Rgba8, Quality::Fast)
            }
            _ => PackedLightField::encode_linear(geometry.clone(), &self.linear(&coverages)),
        };
        let packed = packed.ok()?;
        self.check_texels(&geometry, &packed, &coverages);
        Some(packed)
    }

    /// Lossless encodings give back what they were given.
    fn check_texels(&self, geometry: &LightFieldGeometry, packed: &PackedLightField, coverages: &[Coverage]) {
        assert_eq!(packed.geometry(), geometry);
        match self.encoding % 3 {
            1 => assert_eq!(packed.decode(1 << 30).expect("it is small"), self.srgb(coverages)),
            2 => assert_eq!(packed.decode_linear(1 << 30).expect("it is small"), self.linear(coverages)),
            _ => assert!(packed.decode(1 << 30).is_ok()),
        }
    }

    fn byte(&self, i: usize) -> u8 {
        if self.texels.is_empty() { 0 } else { self.texels[i % self.texels.len()] }
    }

    fn srgb(&self, coverages: &[Coverage]) -> Vec<SlabTexels> {
        let texels = |coverage: &Coverage| {
            let texel = |i: usize| [self.byte(3 * i), self.byte(3 * i + 1), self.byte(3 * i + 2), 255];
            SlabTexels::covering(coverage.clone(), (0..coverage.texels() as usize).map(texel).collect())
                .expect("as many")
        };
        coverages.iter().map(texels).collect()
    }

    fn linear(&self, coverages: &[Coverage]) -> Vec<SlabTexels<[f16; 3]>> {
        let texels = |coverage: &Coverage| {
            let value = |i: usize| {
                let value = f16::from_le_bytes([self.byte(i), self.byte(i + 1)]);
                if value.is_finite() { value } else { f16::ONE }
            };
            let texel = |i: usize| [value(3 * i), value(3 * i + 1), value(3 * i + 2)];
            SlabTexels::covering(coverage.clone(), (0..coverage.texels() as usize).map(texel).collect())
                .expect("as many")
        };
        coverages.iter().map(texels).collect()
    }

    fn metadata(&self) -> Metadata {
        let mut metadata = Metadata::new();
        for (key, value) in &self.metadata {
            // What is refused is not there.
            let _ = metadata.insert(key.as_str(), value.as_str());
        }
        metadata
    }
}

//! Whole light fields through encoder, container and back.

use glam::DVec3;
use lf_compress::bc1::Quality;
use lf_compress::format::{Container, Limits, Metadata, TexelEncoding};
use lf_compress::tile::RdoOptions;
use lf_compress::{PackOptions, PackedLightField};
use lf_math::{Cell, Face, LightFieldGeometry, SampledAxis, Slab, SlabTexels};

/// Two slabs of uneven sizes with smooth texels.
fn field() -> (LightFieldGeometry, Vec<SlabTexels>) {
    let axis = |count| SampledAxis::spanning(-1.0, 1.0, count).expect("an axis");
    let slab = |face, [s, t]: [u32; 2], [u, v]: [u32; 2]| {
        Slab::new(face, 0.5, [axis(s), axis(t)], [axis(u), axis(v)], Some(2.0)).expect("a slab")
    };
    let slabs = vec![slab(Face::NegX, [3, 9], [130, 6]), slab(Face::PosZ, [5, 2], [16, 21])];
    let geometry = LightFieldGeometry::new(Cell::cube(DVec3::ONE, 1.0).expect("a cell"), slabs).expect("a field");
    let texels = geometry.slabs().iter().map(|slab| {
        let ([cameras_s, cameras_t], [width, height]) = (slab.cameras(), slab.resolution());
        let count = cameras_s * cameras_t * width * height;
        let texel = |i: u32| {
            let (x, y, camera) = (i % width, i / width % height, i / (width * height));
            [(x * 255 / width) as u8, (camera * 9 % 256) as u8, (y * 200 / height) as u8, 255]
        };
        SlabTexels::new(slab, (0..count).map(texel).collect()).expect("texels")
    });
    let texels = texels.collect();
    (geometry, texels)
}

#[test]
fn rgba_is_lossless_through_a_file() {
    let (geometry, texels) = field();
    let packed = PackedLightField::encode(geometry.clone(), &texels, TexelEncoding::Rgba8, Quality::Standard).unwrap();
    let bytes = packed.to_bytes(Metadata::new()).unwrap();
    let read = PackedLightField::read(&Container::parse(&bytes, &Limits::default()).unwrap()).unwrap();
    assert_eq!(read.geometry(), &geometry);
    assert_eq!(read.decode(1 << 30).unwrap(), texels);
}

#[test]
fn bc1_is_close_and_comes_back_bit_for_bit() {
    let (geometry, texels) = field();
    let packed = PackedLightField::encode(geometry, &texels, TexelEncoding::Bc1, Quality::Standard).unwrap();
    let decoded = packed.decode(1 << 30).unwrap();
    for (before, after) in texels.iter().zip(&decoded) {
        for (a, b) in before.texels().iter().zip(after.texels()) {
            assert!((0..4).all(|c| a[c].abs_diff(b[c]) <= 40), "{a:?} {b:?}");
        }
    }
    let bytes = packed.to_bytes(Metadata::new()).unwrap();
    let read = PackedLightField::read(&Container::parse(&bytes, &Limits::default()).unwrap()).unwrap();
    assert_eq!(read.decode(1 << 30).unwrap(), decoded);
    assert_eq!(read.layout(), packed.layout());
}

/// The whole way with rate–distortion optimisation: a smaller file, and the texels that the encoder settled on.
#[test]
fn optimised_blocks_make_a_smaller_file_that_comes_back() {
    let (geometry, smooth) = field();
    let grain = |i: usize| ((i as u32).wrapping_mul(0x9e37_79b1) >> 28) as u8;
    let grainy = |slab: &Slab, texels: &SlabTexels| {
        let texels = texels.texels().iter().enumerate();
        let texels = texels.map(|(i, t)| [t[0].saturating_add(grain(i)), t[1], t[2].saturating_add(grain(i / 3)), 255]);
        SlabTexels::new(slab, texels.collect()).expect("texels")
    };
    let texels: Vec<_> = geometry.slabs().iter().zip(&smooth).map(|(slab, texels)| grainy(slab, texels)).collect();
    let file = |lambda| {
        let options = PackOptions { quality: Quality::Standard, rdo: RdoOptions { lambda, ..RdoOptions::default() } };
        let packed =
            PackedLightField::encode_with(geometry.clone(), &texels, TexelEncoding::Bc1, &options).expect("encodes");
        let bytes = packed.to_bytes(Metadata::new()).expect("writes");
        let read = PackedLightField::read(&Container::parse(&bytes, &Limits::default()).expect("parses"));
        assert_eq!(read.expect("reads").decode(1 << 30).unwrap(), packed.decode(1 << 30).unwrap());
        bytes.len()
    };
    let (plain, optimised) = (file(0.0), file(20.0));
    assert!(10 * optimised < 9 * plain, "{optimised} against {plain}");
}

#[test]
fn texels_of_another_shape_are_refused() {
    let (geometry, mut texels) = field();
    texels.swap(0, 1);
    assert!(PackedLightField::encode(geometry.clone(), &texels, TexelEncoding::Bc1, Quality::Fast).is_err());
    texels.pop();
    assert!(PackedLightField::encode(geometry, &texels, TexelEncoding::Bc1, Quality::Fast).is_err());
}

#[test]
fn the_file_does_not_depend_on_the_threads() {
    let (geometry, texels) = field();
    let bytes = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let packed = PackedLightField::encode(geometry.clone(), &texels, TexelEncoding::Bc1, Quality::Standard);
            packed.unwrap().to_bytes(Metadata::new()).unwrap()
        })
    };
    assert_eq!(bytes(1), bytes(3));
}

#[test]
fn stored_bytes_lie_where_the_file_format_says() {
    let (geometry, texels) = field();
    let packed = PackedLightField::encode(geometry, &texels, TexelEncoding::Rgba8, Quality::Fast).unwrap();
    for (number, slab) in packed.geometry().slabs().iter().enumerate() {
        let ([cameras_s, cameras_t], [width, height]) = (slab.cameras(), slab.resolution());
        let [gs, gt] = packed.tilings()[number].cameras_per_tile();
        // Clause 7: images padded to whole blocks side by side, tiles with s fastest, four bytes a texel; the last tile of a row
        // as wide as the cameras that are left.
        let (pitch_u, pitch_v) = (width.div_ceil(4) * 4, height.div_ceil(4) * 4);
        let address = |[s, t]: [u32; 2], [u, v]: [u32; 2]| {
            let tile = (t / gt) * cameras_s.div_ceil(gs) + s / gs;
            let row_bytes = gs.min(cameras_s - s / gs * gs) * pitch_u * 4;
            ((tile as usize), (((t % gt) * pitch_v + v) * row_bytes + ((s % gs) * pitch_u + u) * 4) as usize)
        };
        let read = |(tile, byte): (usize, usize)| packed.tiles(number)[tile][byte..byte + 4].to_vec();
        for (t, s) in (0..cameras_t).flat_map(|t| (0..cameras_s).map(move |s| (t, s))) {
            for (v, u) in (0..pitch_v).flat_map(|v| (0..pitch_u).map(move |u| (v, u))) {
                let expected = texels[number].texel([s, t], [u.min(width - 1), v.min(height - 1)]).unwrap();
                assert_eq!(read(address([s, t], [u, v])), expected, "slab {number}, camera {s} {t}, texel {u} {v}");
                if u < width && v < height {
                    let sample = lf_compress::volume::Sample { slab: number, camera: [s, t], texel: [u, v] };
                    let [x, y, z] = packed.layout().texel(&sample).unwrap();
                    let slice = z - packed.layout().slabs()[number].first_slice();
                    let row_bytes = packed.tilings()[number].tile_size(slice)[0] * 4;
                    assert_eq!(address([s, t], [u, v]), (slice as usize, (y * row_bytes + 4 * x) as usize));
                }
            }
        }
    }
}

#[test]
fn alpha_is_stored_as_opaque_and_large_fields_are_refused() {
    let (geometry, texels) = field();
    let clear: Vec<_> = geometry
        .slabs()
        .iter()
        .zip(&texels)
        .map(|(slab, texels)| {
            let texels = texels.texels().iter().map(|&[r, g, b, _]| [r, g, b, 7]).collect();
            SlabTexels::new(slab, texels).unwrap()
        })
        .collect();
    let packed = PackedLightField::encode(geometry, &clear, TexelEncoding::Rgba8, Quality::Fast).unwrap();
    assert_eq!(packed.decode(1 << 30).unwrap(), texels);
    let bytes: usize = texels.iter().map(|slab| 4 * slab.texels().len()).sum();
    assert!(packed.decode(bytes as u64).is_ok());
    assert!(matches!(packed.decode(bytes as u64 - 1), Err(lf_compress::PackError::TooLarge { .. })));
}

#[test]
fn tiles_that_do_not_shrink_are_stored_plainly() {
    let (geometry, texels) = field();
    let noise: Vec<_> = geometry
        .slabs()
        .iter()
        .zip(&texels)
        .map(|(slab, texels)| {
            let hash = |i: usize| {
                (i as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29).wrapping_mul(0xBF58_476D_1CE4_E5B9)
            };
            let all = (0..texels.texels().len()).map(|i| hash(i).to_be_bytes()).map(|[r, g, b, ..]| [r, g, b, 255]);
            SlabTexels::new(slab, all.collect()).unwrap()
        })
        .collect();
    let packed = PackedLightField::encode(geometry, &noise, TexelEncoding::Bc1, Quality::Fast).unwrap();
    let bytes = packed.to_bytes(Metadata::new()).unwrap();
    let container = Container::parse(&bytes, &Limits::default()).unwrap();
    let packings: std::collections::HashSet<_> =
        container.chunks().iter().map(|chunk| format!("{:?}", chunk.packing)).collect();
    assert!(packings.contains("None"));
    assert_eq!(PackedLightField::read(&container).unwrap().decode(1 << 30).unwrap(), packed.decode(1 << 30).unwrap());
}

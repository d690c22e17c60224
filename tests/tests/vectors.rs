//! The test vectors of the file format: the files are those that the specification gives, and both readers say of each what
//! its index says.

use std::collections::BTreeSet;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use lf_compress::format::{
    CameraPlace, Container, FileReader, FormatError, Limits, Rule, SlabTiling, StoredTile, TexelEncoding,
};
use lf_compress::{PackError, PackedLightField, check_tile, decode_into, unpack_into};
use lf_tests::vectors::{self, Kind, Refusal, Stage, Vector};
use xxhash_rust::xxh64::Xxh64;

fn spec() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec")
}

fn read(path: &str) -> String {
    fs::read_to_string(spec().join(path)).unwrap()
}

fn committed() -> Vec<Vector> {
    let mut vectors: Vec<Vector> = serde_json::from_str(&read("vectors/index.json")).unwrap();
    for vector in &mut vectors {
        vector.bytes = fs::read(spec().join("vectors").join(vector.path())).unwrap();
    }
    vectors
}

fn valid() -> impl Iterator<Item = Vector> {
    committed().into_iter().filter(|vector| vector.valid)
}

fn invalid() -> impl Iterator<Item = (Vector, Refusal)> {
    committed().into_iter().filter_map(|mut vector| Some((vector.refusal.take()?, vector))).map(|(a, b)| (b, a))
}

#[test]
fn the_files_are_what_the_generator_writes() {
    let (committed, vectors) = (committed(), vectors::all());
    assert_eq!(read("vectors/index.json"), vectors::index(&vectors), "run the example write_vectors");
    for (found, expected) in committed.iter().zip(&vectors) {
        assert!(found.bytes == expected.bytes, "{} differs: run the example write_vectors", found.name);
    }
    let listed: BTreeSet<PathBuf> = vectors.iter().map(Vector::path).collect();
    assert_eq!(listed.len(), vectors.len(), "a name is there twice");
    for kind in ["valid", "invalid"] {
        for file in fs::read_dir(spec().join("vectors").join(kind)).unwrap() {
            let path = Path::new(kind).join(file.unwrap().file_name());
            assert!(listed.contains(&path), "{} is not in the index", path.display());
        }
    }
}

#[test]
fn together_they_are_small() {
    let bytes: usize = committed().iter().map(|vector| vector.bytes.len()).sum();
    assert!(bytes < 300 << 10, "{bytes}");
}

/// Message ids and texts of all that opening and verifying finds, by one reader; the file if it opens.
type Findings = (bool, Vec<(&'static str, String)>);

fn describe(errors: &[FormatError]) -> Vec<(&'static str, String)> {
    errors.iter().map(|error| (error.id(), error.to_string())).collect()
}

fn by_container(bytes: &[u8]) -> Findings {
    let mut errors = Vec::new();
    let opened = Container::parse(bytes, &Limits::default()).map(|file| file.verify(|error| errors.push(error)));
    let opens = opened.is_ok();
    errors.extend(opened.err());
    (opens, describe(&errors))
}

fn by_file_reader(bytes: &[u8]) -> Findings {
    let mut errors = Vec::new();
    let opened = FileReader::open(Cursor::new(bytes), &Limits::default());
    let opened = opened.map(|mut file| file.verify(|error| errors.push(error)).unwrap());
    let opens = opened.is_ok();
    errors.extend(opened.err());
    (opens, describe(&errors))
}

#[test]
fn both_readers_say_the_same() {
    for vector in committed() {
        assert_eq!(by_container(&vector.bytes), by_file_reader(&vector.bytes), "{}", vector.name);
    }
}

/// All tiles of a file with their slabs and numbers.
fn tiles<'a>(file: &Container<'a>) -> Vec<(usize, u32, StoredTile<'a>)> {
    let of_slab =
        |(slab, tiling): (usize, &SlabTiling)| tiling.stored_tiles().map(move |tile| (slab, tile)).collect::<Vec<_>>();
    let numbers = file.tilings().iter().enumerate().flat_map(of_slab);
    numbers.map(|(slab, tile)| (slab, tile, file.tile(slab, tile).unwrap())).collect()
}

#[test]
fn nothing_is_wrong_with_valid_files() {
    for vector in valid() {
        assert_eq!(by_container(&vector.bytes), (true, Vec::new()), "{}", vector.name);
        let file = Container::parse(&vector.bytes, &Limits::default()).unwrap();
        for (slab, tile, stored) in tiles(&file) {
            let checked = check_tile(&stored, &file.tilings()[slab], slab, tile);
            checked.unwrap_or_else(|error| panic!("{}: {error}", vector.name));
        }
    }
}

/// The colours of a tile's picture, as the digest takes them.
fn colours(raw: &[u8], tiling: &SlabTiling, tile: u32) -> Vec<Vec<u8>> {
    if tiling.encoding() == TexelEncoding::Rgb16F {
        return raw.chunks(6).map(<[u8]>::to_vec).collect();
    }
    let [width, height] = tiling.tile_size(tile).map(|n| n as usize);
    let mut texels = vec![[0; 4]; width * height];
    decode_into(raw, tiling, tile, &mut texels).unwrap();
    texels.iter().map(|texel| texel[..3].to_vec()).collect()
}

/// The digest of a slab whose raw tiles are given, by where the library says that each texel is.
fn digest(tiling: &SlabTiling, raw_tiles: &[Vec<u8>]) -> String {
    let numbers: Vec<u32> = tiling.stored_tiles().collect();
    let pictures: Vec<_> = numbers.iter().zip(raw_tiles).map(|(&tile, raw)| colours(raw, tiling, tile)).collect();
    let zero = vec![0; if tiling.encoding() == TexelEncoding::Rgb16F { 6 } else { 3 }];
    let ([cameras_s, cameras_t], [width, height]) = (tiling.cameras(), tiling.resolution());
    let mut checksum = Xxh64::new(0);
    for camera in (0..cameras_t).flat_map(|t| (0..cameras_s).map(move |s| [s, t])) {
        let place = tiling.place(camera);
        for at in (0..height).flat_map(|v| (0..width).map(move |u| [u, v])) {
            let found = place.as_ref().and_then(|CameraPlace { tile, corner, window }| {
                let inside = (0..2).all(|i| window[i].contains(&at[i]));
                let [x, y] = [0, 1].map(|i| corner[i] + at[i].wrapping_sub(window[i].start));
                let index = y as usize * tiling.tile_size(*tile)[0] as usize + x as usize;
                inside.then(|| &pictures[numbers.binary_search(tile).unwrap()][index])
            });
            checksum.update(found.unwrap_or(&zero));
        }
    }
    format!("{:016x}", checksum.digest())
}

#[test]
fn valid_files_decode_to_their_digests() {
    for vector in valid() {
        let file = Container::parse(&vector.bytes, &Limits::default()).unwrap();
        let mut reader = FileReader::open(Cursor::new(&vector.bytes), &Limits::default()).unwrap();
        let by_file = PackedLightField::read_file(&mut reader).unwrap();
        let in_memory = PackedLightField::read(&file).unwrap();
        let found: Vec<String> = file
            .tilings()
            .iter()
            .enumerate()
            .map(|(slab, tiling)| {
                assert_eq!(in_memory.tiles(slab), by_file.tiles(slab));
                digest(tiling, in_memory.tiles(slab))
            })
            .collect();
        assert_eq!(found, vector.digests, "{}", vector.name);
    }
}

/// The library's own writer makes the same file of the same tiles, but for chunks that are not to be copied.
#[test]
fn valid_files_are_written_again_as_they_are() {
    use lf_compress::format::{Contents, Writer};
    for vector in valid() {
        let file = Container::parse(&vector.bytes, &Limits::default()).unwrap();
        let dropped = file.chunks().iter().any(|chunk| !chunk.tag.is_known() && !chunk.safe_to_copy);
        if dropped || file.version() != (1, 0) {
            continue;
        }
        let contents = Contents::new(file.geometry().clone(), file.tilings().to_vec(), file.metadata().clone());
        let contents = Contents { extra: file.copyable_chunks().unwrap(), ..contents };
        let mut writer = Writer::new(Cursor::new(Vec::new()), contents).unwrap();
        for (_, _, stored) in tiles(&file) {
            writer.tile(stored.packing, stored.bytes).unwrap();
        }
        assert!(writer.finish().unwrap().into_inner() == vector.bytes, "{}", vector.name);
    }
}

/// The kind of refusal that an error of the container is.
fn kind(error: &FormatError) -> Kind {
    match error {
        FormatError::NotLfslab { .. } => Kind::Foreign,
        FormatError::Unsupported { .. } => Kind::Unsupported,
        FormatError::LimitExceeded { .. } => Kind::Limit,
        _ => Kind::Malformed,
    }
}

#[test]
fn what_is_wrong_with_the_structure_is_found_at_once() {
    for (vector, refusal) in invalid().filter(|(_, refusal)| refusal.stage == Stage::Open) {
        let error = Container::parse(&vector.bytes, &Limits::default()).unwrap_err();
        assert_eq!((error.id(), kind(&error)), (refusal.id.as_str(), refusal.refusal), "{}: {error}", vector.name);
        if let Some((rule, _)) = error.broken_rule() {
            let named = vector.clauses.iter().any(|clause| clause == rule.clause());
            assert!(named, "{} names {:?}: {error}", vector.name, vector.clauses);
        }
    }
}

/// What is wrong with the tiles of a file that opens: by their checksums, by unpacking them, by looking at their texels.
fn faults(
    file: &Container<'_>,
    look: impl Fn(&StoredTile<'_>, &SlabTiling, usize, u32) -> Result<(), PackError>,
) -> Vec<&'static str> {
    let mut found = Vec::new();
    file.verify(|error| found.push(error.id()));
    if found.is_empty() {
        for (slab, tile, stored) in tiles(file) {
            match look(&stored, &file.tilings()[slab], slab, tile) {
                Ok(()) => {}
                Err(PackError::Tile { rule, .. }) => found.push(rule.id()),
                Err(other) => panic!("{other}"),
            }
        }
    }
    found
}

/// Unpacks a tile to nowhere.
fn unpack(stored: &StoredTile<'_>, tiling: &SlabTiling, slab: usize, tile: u32) -> Result<(), PackError> {
    unpack_into(stored, tiling, slab, tile, &mut vec![0; stored.raw_len as usize])
}

#[test]
fn what_is_wrong_with_a_tile_is_found_when_it_is_read() {
    for (vector, refusal) in invalid().filter(|(_, refusal)| refusal.stage == Stage::Tile) {
        let file = Container::parse(&vector.bytes, &Limits::default()).unwrap();
        if refusal.memory_bytes.is_none() {
            assert_eq!(faults(&file, unpack), [refusal.id.as_str()], "{}", vector.name);
            assert_eq!(refusal.refusal, Kind::Malformed);
        }
    }
}

#[test]
fn what_is_wrong_with_texels_is_found_by_looking_at_them() {
    for (vector, refusal) in invalid().filter(|(_, refusal)| refusal.stage == Stage::Texels) {
        let file = Container::parse(&vector.bytes, &Limits::default()).unwrap();
        assert_eq!(faults(&file, unpack), [""; 0], "{}", vector.name);
        assert_eq!(faults(&file, check_tile), [refusal.id.as_str()], "{}", vector.name);
        // No reader may take a number that is not finite.
        if refusal.id == Rule::Finite.id() {
            let decoded = PackedLightField::read(&file).unwrap().decode_linear(1 << 20);
            assert!(matches!(decoded, Err(PackError::NotFinite)), "{}", vector.name);
        }
    }
}

#[test]
fn what_takes_too_much_memory_is_refused_before_it_is_taken() {
    for (vector, refusal) in invalid() {
        let Some(memory_bytes) = refusal.memory_bytes else { continue };
        assert_eq!(refusal.refusal, Kind::Limit);
        let file = Container::parse(&vector.bytes, &Limits { memory_bytes }).unwrap();
        match PackedLightField::read(&file) {
            Err(PackError::Format(error)) => assert_eq!(error.id(), refusal.id),
            other => panic!("{}: {other:?}", vector.name),
        }
    }
}

/// Rules that no small file can break.
const NOT_SHOWN: [(Rule, &str); 2] = [
    (Rule::Overflow, "what overflows 64 bits breaks the rule of the field that holds it first"),
    (Rule::MetadataLength, "takes a file of more than 1 MiB; lf-format tests it"),
];

#[test]
fn every_rule_has_a_file_that_breaks_it() {
    let ids: BTreeSet<String> = invalid().map(|(_, refusal)| refusal.id).collect();
    for rule in Rule::ALL {
        let excepted = NOT_SHOWN.iter().any(|(not_shown, _)| not_shown == rule);
        assert_eq!(ids.contains(rule.id()), !excepted, "{rule:?}");
    }
    let all: BTreeSet<&str> = Rule::ALL.iter().map(|rule| rule.id()).chain(["foreign", "limit"]).collect();
    assert!(ids.iter().all(|id| all.contains(id.as_str())));
}

/// Clauses with a "MUST" that no file can break, and why.
const NOT_FOR_FILES: [(&str, &str); 4] = [
    ("§1.2", "says what the words mean"),
    ("§6.4", "what a writer stores depends on what the file is for"),
    ("§7.7", "is how a reader answers rays"),
    ("§8", "takes a file of more than 1 MiB"),
];

/// The clauses of a text whose words "MUST" or "REQUIRED" occur in, by the first word of their headings.
fn clauses_with_must(text: &str, mark: &str) -> BTreeSet<String> {
    let mut clause = String::new();
    let mut found = BTreeSet::new();
    for line in text.lines() {
        if let Some(heading) = line.strip_prefix("### ").or_else(|| line.strip_prefix("## ")) {
            clause = format!("{mark}{}", heading.split(' ').next().unwrap());
        } else if line.contains("MUST") || line.contains("REQUIRED") {
            found.insert(clause.clone());
        }
    }
    found
}

#[test]
fn every_must_has_a_file_that_breaks_it() {
    let covered: BTreeSet<String> = invalid().flat_map(|(vector, _)| vector.clauses).collect();
    let mut needed = clauses_with_must(&read("lfslab-1.0.md"), "§");
    needed.extend(clauses_with_must(read("codecs.md").split("## Tile codec").nth(1).unwrap(), ""));
    for (clause, why) in NOT_FOR_FILES {
        assert!(needed.remove(clause) && !covered.contains(clause), "{clause} is no exception ({why})");
    }
    let missing: Vec<_> = needed.difference(&covered).collect();
    assert!(missing.is_empty(), "no file breaks {missing:?}");
}

#[test]
fn every_clause_named_is_there() {
    let (specification, codecs) = (read("lfslab-1.0.md"), read("codecs.md"));
    for clause in committed().iter().flat_map(|vector| &vector.clauses) {
        let found = match clause.strip_prefix('§') {
            Some(number) if number.contains('.') => specification.contains(&format!("\n### {number} ")),
            Some(number) => specification.contains(&format!("\n## {number} ")),
            None => codecs.contains(&format!("\n### {clause} ")),
        };
        assert!(found, "{clause}");
    }
}

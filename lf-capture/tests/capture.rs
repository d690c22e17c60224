//! Captures to disk: the same bytes whichever way, and the same answers to every ray as when everything is traced.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::{DVec3, Vec2, Vec3};
use lf_capture::{CaptureError, Journal, Options, Outcome, Plan, Progress, Shard, capture, write_files};
use lf_compress::{PackOptions, PackedLightField};
use lf_format::{Container, Limits, Metadata, TexelEncoding};
use lf_ibr::{Environment as _, SlabField};
use lf_math::{Cell, Face, LightFieldGeometry, NeededTexels, PlanePlacement, Ray, Slab};
use lf_scene::{Environment, Lighting, Material, SceneBuilder, TexelSampler, Tracer, capture_slabs, museum};
use tempfile::TempDir;

fn options(encoding: TexelEncoding) -> Options {
    Options { grid: 1, encoding, pack: PackOptions::default(), whole: false, depth: false }
}

fn geometry(placement: PlanePlacement, cameras: [u32; 2], resolution: [u32; 2]) -> LightFieldGeometry {
    LightFieldGeometry::around_with(museum::cell(), placement, cameras, resolution).unwrap()
}

/// Enough tiles to be lost and found: images of 260 texels make tiles of three cameras.
fn plan(tracer: &Tracer) -> Plan {
    let depth = Options { depth: true, ..options(TexelEncoding::Bc1) };
    Plan::survey(tracer, &geometry(PlanePlacement::CellCenter, [5, 6], [260, 8]), depth, Metadata::new()).unwrap()
}

fn run(tracer: &Tracer, journal: &mut Journal) {
    assert_eq!(capture(tracer, journal, &|_| (), &AtomicBool::new(false)).unwrap(), Outcome::Finished);
}

/// The two files of a plan, made in one run.
fn in_one_run(tracer: &Tracer, plan: &Plan, folder: &Path) -> [Vec<u8>; 2] {
    let mut journal = Journal::create(&folder.join("one.part"), plan, Shard::WHOLE).unwrap();
    run(tracer, &mut journal);
    let files = files(&mut [journal], folder);
    fs::remove_file(folder.join("one.part")).unwrap();
    files
}

fn files(journals: &mut [Journal], folder: &Path) -> [Vec<u8>; 2] {
    let paths = [folder.join("a.lfslab"), folder.join("b.lfslab")];
    write_files(journals, &paths[0], Some(&paths[1])).unwrap();
    paths.map(|path| fs::read(path).unwrap())
}

fn read(bytes: &[u8]) -> PackedLightField {
    PackedLightField::read(&Container::parse(bytes, &Limits::default()).unwrap()).unwrap()
}

/// Evenly spread rays through a cell, its faces, edges and corners above all.
fn rays(cell: &Cell, count: u32) -> impl Iterator<Item = Ray> {
    let half = cell.half_extent();
    (0..count).map(move |n| {
        let at = |root: f64| 2.4 * (f64::from(n) * root.sqrt()).fract() as f32 - 1.2;
        let place = Vec3::new(at(2.0), at(3.0), at(5.0)).clamp(Vec3::NEG_ONE, Vec3::ONE);
        Ray { origin: half * place, direction: Vec3::new(at(7.0), at(11.0), at(13.0)) }
    })
}

/// How many texels rays through the cell ask for, counted one by one, whatever the windows are.
fn needed_texels(field: &LightFieldGeometry) -> u64 {
    let of_slab = |slab: &Slab| {
        let needed = NeededTexels::of_cell(slab, field.cell());
        let pairs = |[a, b]: [u32; 2]| (0..b).flat_map(move |j| (0..a).map(move |i| [i, j]));
        let texels =
            pairs(slab.cameras()).flat_map(|camera| pairs(slab.resolution()).map(move |texel| (camera, texel)));
        texels.filter(|(camera, texel)| needed.contains(*camera, *texel)).count() as u64
    };
    field.slabs().iter().map(of_slab).sum()
}

#[test]
fn every_ray_finds_the_bits_of_a_capture_that_traces_everything() {
    let tracer = Tracer::new(museum::scene());
    let flat = Cell::new(museum::cell().center(), Vec3::new(0.5, 0.3, 0.1)).unwrap();
    for (cell, placement, cameras, resolution) in [
        (museum::cell(), PlanePlacement::CellFaces, [9, 8], [20, 27]),
        (museum::cell(), PlanePlacement::CellCenter, [6, 9], [30, 16]),
        (museum::cell(), PlanePlacement::Offset(1.1), [12, 12], [17, 17]),
        (museum::cell(), PlanePlacement::Offset(-0.3), [8, 7], [16, 9]),
        (flat, PlanePlacement::CellFaces, [8, 8], [24, 24]),
    ] {
        let field = LightFieldGeometry::around_with(cell, placement, cameras, resolution).unwrap();
        let plan = Plan::survey(&tracer, &field, options(TexelEncoding::Rgba8), Metadata::new()).unwrap();
        assert!(plan.geometry().slabs().iter().all(|slab| slab.focal_depth().is_some()));
        let folder = TempDir::new().unwrap();
        let mut journal = Journal::create(&folder.path().join("x.part"), &plan, Shard::WHOLE).unwrap();
        run(&tracer, &mut journal);
        let out = folder.path().join("x.lfslab");
        let totals = write_files(&mut [journal], &out, None).unwrap();
        assert!(totals.psnr().is_infinite());
        let stored = read(&fs::read(out).unwrap());
        let found = SlabField::new(stored.geometry().clone(), stored.decode(1 << 30).unwrap()).unwrap();
        let all = capture_slabs(&tracer, &field, 1, &|_| ()).unwrap();
        assert_eq!(&all.geometry, stored.geometry());
        assert!(totals.traced < all.rays, "{placement:?}: all {} texels are traced", all.rays);
        assert_eq!(totals.traced, needed_texels(stored.geometry()), "{placement:?}");
        let all = SlabField::new(all.geometry, all.texels).unwrap();
        for ray in rays(&cell, 150_000).filter(|ray| ray.direction != Vec3::ZERO) {
            assert_eq!(found.look_up(&ray), all.look_up(&ray), "{placement:?} {ray:?}");
        }
    }
}

#[test]
fn nothing_is_left_out_of_a_whole_capture() {
    let tracer = Tracer::new(museum::scene());
    let field = geometry(PlanePlacement::CellFaces, [5, 5], [9, 12]);
    let whole = Options { whole: true, grid: 2, ..options(TexelEncoding::Rgba8) };
    let plan = Plan::survey(&tracer, &field, whole, Metadata::new()).unwrap();
    let folder = TempDir::new().unwrap();
    let mut journal = Journal::create(&folder.path().join("x.part"), &plan, Shard::WHOLE).unwrap();
    run(&tracer, &mut journal);
    let out = folder.path().join("x.lfslab");
    let totals = write_files(&mut [journal], &out, None).unwrap();
    assert_eq!(totals.traced, plan.all_texels());
    let in_memory = capture_slabs(&tracer, &field, 2, &|_| ()).unwrap();
    assert_eq!(read(&fs::read(out).unwrap()).decode(1 << 30).unwrap(), in_memory.texels);
}

#[test]
fn threads_do_not_change_the_bytes() {
    let tracer = Tracer::new(museum::scene());
    let files = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let folder = TempDir::new().unwrap();
        pool.install(|| in_one_run(&tracer, &plan(&tracer), folder.path()))
    });
    assert!(files[0] == files[1]);
}

/// A journal as it is after so many camera images.
fn stopped(tracer: &Tracer, plan: &Plan, path: &Path, shard: Shard, images: u64) -> usize {
    let mut journal = Journal::create(path, plan, shard).unwrap();
    let (stop, done) = (AtomicBool::new(false), AtomicU64::new(0));
    let progress = |_: Progress| {
        if done.fetch_add(1, Ordering::Relaxed) + 1 >= images {
            stop.store(true, Ordering::Relaxed);
        }
    };
    assert_eq!(capture(tracer, &mut journal, &progress, &stop).unwrap(), Outcome::Stopped);
    journal.totals().tiles
}

#[test]
fn a_stopped_capture_goes_on_to_the_same_bytes() {
    let (tracer, folder) = (Tracer::new(museum::scene()), TempDir::new().unwrap());
    let (plan, path) = (plan(&tracer), folder.path().join("x.part"));
    let expected = in_one_run(&tracer, &plan, folder.path());
    let tiles = stopped(&tracer, &plan, &path, Shard::WHOLE, 60);
    assert!(tiles > 0 && tiles < plan.tiles().len(), "{tiles}");
    let mut journal = Journal::resume(&path, &plan, Shard::WHOLE).unwrap();
    assert_eq!(journal.totals().tiles, tiles);
    run(&tracer, &mut journal);
    assert!(files(&mut [journal], folder.path()) == expected);
}

/// What a kill at any moment leaves: a journal that ends anywhere. Also bytes that rot.
#[test]
fn a_journal_that_ends_anywhere_goes_on_to_the_same_bytes() {
    let (tracer, folder) = (Tracer::new(museum::scene()), TempDir::new().unwrap());
    let (plan, path) = (plan(&tracer), folder.path().join("x.part"));
    let expected = in_one_run(&tracer, &plan, folder.path());
    let mut journal = Journal::create(&path, &plan, Shard::WHOLE).unwrap();
    let begin = fs::metadata(&path).unwrap().len() as usize;
    run(&tracer, &mut journal);
    drop(journal);
    let whole = fs::read(&path).unwrap();
    let goes_on = |bytes: &[u8], tiles: std::ops::RangeInclusive<usize>| {
        fs::write(&path, bytes).unwrap();
        let mut journal = Journal::resume(&path, &plan, Shard::WHOLE).unwrap();
        assert!(tiles.contains(&journal.totals().tiles), "{} of {tiles:?}", journal.totals().tiles);
        run(&tracer, &mut journal);
        assert!(files(&mut [journal], folder.path()) == expected);
    };
    let count = plan.tiles().len();
    for end in [begin, begin + 1, begin + 55, begin + 56, begin + (whole.len() - begin) / 2, whole.len() - 1] {
        goes_on(&whole[..end], 0..=count - 1);
    }
    goes_on(&whole, count..=count);
    let mut rotten = whole.clone();
    rotten[begin + (whole.len() - begin) / 3] ^= 16;
    goes_on(&rotten, 0..=count / 2);
    // A length that would reach beyond all memory.
    let mut absurd = whole.clone();
    absurd[begin + 32..begin + 40].fill(0xFF);
    goes_on(&absurd, 0..=0);
    for end in [0, 7, 19, 20, begin - 1] {
        fs::write(&path, &whole[..end]).unwrap();
        let error = Journal::resume(&path, &plan, Shard::WHOLE).unwrap_err();
        assert!(matches!(error, CaptureError::NotAJournal { .. }), "{error}");
    }
}

/// Tiles at the rim of a slab are small; each shard gets its share of large ones.
#[test]
fn shards_have_about_as_much_to_do() {
    let tracer = Tracer::new(glowing_box(0.5));
    let field = geometry(PlanePlacement::CellFaces, [32, 32], [128, 128]);
    let plan = Plan::survey(&tracer, &field, options(TexelEncoding::Bc1), Metadata::new()).unwrap();
    let size = |id: &lf_capture::TileId| plan.tilings()[id.slab].raw_len(id.tile);
    let tiles = plan.tiles();
    let work = [0, 1, 2, 3].map(|shard| tiles.iter().skip(shard).step_by(4).map(size).sum::<u64>());
    let [least, most] = [work.iter().min().unwrap(), work.iter().max().unwrap()];
    assert!(10 * most <= 11 * least, "{work:?}");
}

/// Changes the header of a journal, and its checksum with it.
fn write_header(path: &Path, json: &str) {
    let checksum = xxhash_rust::xxh64::xxh64(json.as_bytes(), 0).to_le_bytes();
    let bytes = [b"LFSPART1", &(json.len() as u32).to_le_bytes()[..], &checksum, json.as_bytes()].concat();
    fs::write(path, bytes).unwrap();
}

/// Headers whose checksum is right and whose numbers are not.
#[test]
fn headers_are_not_believed() {
    let (tracer, folder) = (Tracer::new(museum::scene()), TempDir::new().unwrap());
    let path = folder.path().join("x.part");
    drop(Journal::create(&path, &plan(&tracer), Shard::WHOLE).unwrap());
    let json = String::from_utf8(fs::read(&path).unwrap()[20..].to_vec()).unwrap();
    for (from, to) in [
        ("\"count\": 260", "\"count\": 16777216"),
        ("\"count\": 260", "\"count\": 0"),
        ("\"face\": 0", "\"face\": 9"),
        ("\"encoding\": \"bc1\"", "\"encoding\": \"bc9\""),
        ("\"shard\": 1", "\"shard\": 2"),
        ("\"whole\"", "\"hole\""),
    ] {
        let json = json.replacen(from, to, 1);
        assert!(json.contains(to), "{from}");
        write_header(&path, &json);
        let error = Journal::open(&path).unwrap_err();
        assert!(matches!(error, CaptureError::NotAJournal { .. }), "{to}: {error}");
    }
}

/// Sines and powers are those of the system's library: what two of them made may differ in its last bits.
#[test]
fn a_journal_of_another_kind_of_machine_is_refused() {
    let (tracer, folder) = (Tracer::new(museum::scene()), TempDir::new().unwrap());
    let (plan, path) = (plan(&tracer), folder.path().join("2.part"));
    drop(Journal::create(&path, &plan, shard(2)).unwrap());
    let json = String::from_utf8(fs::read(&path).unwrap()[20..].to_vec()).unwrap();
    write_header(&path, &json.replacen("arithmetic ", "arithmetic f", 1));
    let refused = Journal::resume(&path, &plan, shard(2)).unwrap_err();
    assert!(matches!(refused, CaptureError::Foreign { .. }), "{refused}");
    let first = Journal::create(&folder.path().join("1.part"), &plan, shard(1)).unwrap();
    let mut journals = [first, Journal::open(&path).unwrap()];
    let error = write_files(&mut journals, &folder.path().join("x.lfslab"), None).unwrap_err().to_string();
    assert!(error.contains("2.part belongs to another capture: machine is "), "{error}");
}

fn shard(number: u32) -> Shard {
    Shard::new(number, 3).unwrap()
}

fn shards(tracer: &Tracer, plan: &Plan, folder: &Path) -> Vec<PathBuf> {
    let path = |number: u32| folder.join(format!("{number}.part"));
    for number in 1..=3 {
        let mut journal = Journal::create(&path(number), plan, shard(number)).unwrap();
        run(tracer, &mut journal);
    }
    (1..=3).map(path).collect()
}

fn open(paths: &[&PathBuf]) -> Vec<Journal> {
    paths.iter().map(|path| Journal::open(path).unwrap()).collect()
}

#[test]
fn shards_make_the_same_bytes_in_any_order() {
    let (tracer, folder) = (Tracer::new(museum::scene()), TempDir::new().unwrap());
    let plan = plan(&tracer);
    let expected = in_one_run(&tracer, &plan, folder.path());
    let paths = shards(&tracer, &plan, folder.path());
    // One of them was stopped and resumed.
    fs::remove_file(&paths[1]).unwrap();
    assert!(stopped(&tracer, &plan, &paths[1], shard(2), 20) > 0);
    run(&tracer, &mut Journal::resume(&paths[1], &plan, shard(2)).unwrap());
    assert!(files(&mut open(&[&paths[2], &paths[0], &paths[1]]), folder.path()) == expected);
}

#[test]
fn what_does_not_belong_together_is_refused_by_name() {
    let (tracer, folder) = (Tracer::new(museum::scene()), TempDir::new().unwrap());
    let plan = plan(&tracer);
    let [a, b, c] = shards(&tracer, &plan, folder.path()).try_into().unwrap();
    let out = folder.path().join("x.lfslab");
    let refused = |paths: &[&PathBuf], depth: bool| {
        write_files(&mut open(paths), &out, depth.then_some(&folder.path().join("d.lfslab"))).unwrap_err().to_string()
    };
    assert_eq!(refused(&[&a, &c], true), "the journals of shards 2 of 3 are missing");
    let copy = folder.path().join("copy.part");
    fs::copy(&a, &copy).unwrap();
    let twice = refused(&[&a, &b, &copy, &c], true);
    assert!(twice.starts_with("shard 1/3 is there twice: ") && twice.contains("copy.part"), "{twice}");
    assert!(refused(&[&a, &b, &c], false).contains("need a file"));
    assert!(refused(&[], false).contains("missing"));
    // A journal without its last record.
    let bytes = fs::read(&b).unwrap();
    fs::write(&b, &bytes[..bytes.len() - 1]).unwrap();
    let unfinished = refused(&[&a, &b, &c], true);
    assert!(unfinished.contains("2.part lacks 1 of its ") && unfinished.contains("not finished"), "{unfinished}");
    // A shard of a capture at another quality, and one of another division.
    fs::remove_file(&b).unwrap();
    let quality = lf_compress::bc1::Quality::Fast;
    let pack = PackOptions { quality, ..PackOptions::default() };
    let other = Options { pack, ..*plan.options() };
    let foreign = Plan::survey(&tracer, plan.geometry(), other, Metadata::new()).unwrap();
    drop(Journal::create(&b, &foreign, shard(2)).unwrap());
    let differs = refused(&[&a, &b, &c], true);
    assert!(differs.contains("2.part belongs to another capture: quality is \"fast\" there"), "{differs}");
    fs::remove_file(&b).unwrap();
    drop(Journal::create(&b, &plan, Shard::new(2, 4).unwrap()).unwrap());
    assert!(refused(&[&a, &b, &c], true).contains("shards is 4 there and 3 here"));
    assert!(!out.exists());
}

#[test]
fn a_journal_is_resumed_by_its_own_capture_alone() {
    let (tracer, folder) = (Tracer::new(museum::scene()), TempDir::new().unwrap());
    let (plan, path) = (plan(&tracer), folder.path().join("x.part"));
    let journal = Journal::create(&path, &plan, Shard::WHOLE).unwrap();
    assert!(matches!(Journal::resume(&path, &plan, Shard::WHOLE), Err(CaptureError::InUse { .. })));
    assert!(matches!(Journal::discard(&path), Err(CaptureError::InUse { .. })));
    drop(journal);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    assert!(matches!(Journal::create(&path, &plan, Shard::WHOLE), Err(CaptureError::Io { .. })));
    let refused = |plan: &Plan, shard| Journal::resume(&path, plan, shard).unwrap_err().to_string();
    assert!(refused(&plan, shard(1)).contains("shards is 1 there and 3 here"));
    let finer = Options { grid: 2, ..*plan.options() };
    let finer = Plan::survey(&tracer, plan.geometry(), finer, Metadata::new()).unwrap();
    assert!(refused(&finer, Shard::WHOLE).contains("rays per texel and axis is 1 there and 2 here"));
    let named = {
        let mut metadata = Metadata::new();
        metadata.insert("scene", "another").unwrap();
        Plan::survey(&tracer, plan.geometry(), *plan.options(), metadata).unwrap()
    };
    assert!(refused(&named, Shard::WHOLE).contains("metadata is {} there and {\"scene\":\"another\"} here"));
    // The same triangles in another light.
    let dark = Tracer::new(glowing_box(0.5));
    let darker = Tracer::new(glowing_box(0.25));
    let field = geometry(PlanePlacement::CellCenter, [2, 2], [8, 8]);
    let survey = |tracer: &Tracer| Plan::survey(tracer, &field, options(TexelEncoding::Bc1), Metadata::new()).unwrap();
    let path = folder.path().join("dark.part");
    drop(Journal::create(&path, &survey(&dark), Shard::WHOLE).unwrap());
    let error = Journal::resume(&path, &survey(&darker), Shard::WHOLE).unwrap_err().to_string();
    assert!(error.contains("the scene differs"), "{error}");
    assert!(Journal::resume(&path, &survey(&dark), Shard::WHOLE).is_ok());
    Journal::discard(&path).unwrap();
    Journal::discard(&path).unwrap();
    assert!(!path.exists());
}

/// A box of half extent 3 around the museum's cell, glowing.
fn glowing_box(strength: f32) -> lf_scene::Scene {
    let mut builder = SceneBuilder::default();
    let material = builder.material(Material::glowing(Vec3::splat(strength)));
    let center = museum::cell().center().as_vec3();
    for face in Face::ALL {
        let corner = center + face.vector(Vec2::splat(-3.0), 3.0 * face.sign());
        builder.parallelogram(
            corner,
            face.vector(Vec2::X * 6.0, 0.0),
            face.vector(Vec2::Y * 6.0, 0.0),
            Vec2::ONE,
            material,
        );
    }
    builder.build("box", Lighting::from_environment(Environment::BLACK)).unwrap()
}

/// Closed form: the walls of a box.
#[test]
fn depth_is_the_inverse_distance_from_the_camera_plane() {
    let (tracer, folder) = (Tracer::new(glowing_box(0.5)), TempDir::new().unwrap());
    let field = geometry(PlanePlacement::CellFaces, [4, 5], [8, 9]);
    let deep = Options { depth: true, whole: true, ..options(TexelEncoding::Rgba8) };
    let plan = Plan::survey(&tracer, &field, deep, Metadata::new()).unwrap();
    let mut journal = Journal::create(&folder.path().join("x.part"), &plan, Shard::WHOLE).unwrap();
    run(&tracer, &mut journal);
    let [_, depth] = files(&mut [journal], folder.path());
    let stored = read(&depth);
    assert_eq!(stored.geometry(), plan.geometry());
    let container = Container::parse(&depth, &Limits::default()).unwrap();
    // Keys without a dot are the registry's.
    assert!(container.metadata().get("lfslab.texels").is_some_and(|text| text.starts_with("inverse depth")));
    let texels = stored.decode_linear(1 << 30).unwrap();
    for (number, slab) in plan.geometry().slabs().iter().enumerate() {
        for camera in (0..5).flat_map(|t| (0..4).map(move |s| [s, t])) {
            for texel in (0..9).flat_map(|v| (0..8).map(move |u| [u, v])) {
                let index = |i: [u32; 2]| Vec2::new(i[0] as f32, i[1] as f32);
                let ray = plan.geometry().capture_ray(number, index(camera), index(texel));
                let walls = (Vec3::splat(3.0) * ray.direction.signum() - ray.origin) / ray.direction;
                let inverse = 1.0 / slab.depth(ray.at(walls.min_element()));
                let [r, g, b] = texels[number].texel(camera, texel).unwrap().map(f32::from);
                assert!((r - inverse).abs() <= 1e-3 * inverse.abs() && r == g && g == b, "{r} {inverse}");
            }
        }
    }
    // Where nothing is met.
    let mut builder = SceneBuilder::default();
    let material = builder.material(Material::glowing(Vec3::ONE));
    builder.cuboid(Vec3::splat(50.0), Vec3::splat(51.0), material);
    let lighting = Lighting::from_environment(Environment::Sky(Vec3::ONE));
    let open = Tracer::new(builder.build("open", lighting).unwrap());
    let cell = Cell::cube(DVec3::ZERO, 1.0).unwrap();
    let field = LightFieldGeometry::around(cell, PlanePlacement::CellFaces, 2, 4).unwrap();
    assert_eq!(TexelSampler::new(&open, &field, 1).inverse_depth(1, [0, 0], [2, 2]), 0.0);
}

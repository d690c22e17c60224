//! Throughput of all encoders and decoders in texels per second, one thread, on one image.
//!
//! The image is the first light-field atlas where there is one, else the gradient. Every answer is checked by
//! `texture2ddecoder` before it is timed; a codec that fails the check is left out with a note.

use criterion::{Criterion, Throughput};
use lf_bench::measure::one_thread;
use lf_bench::quality::{SquaredError, largest_difference};
use lf_bench::{
    BenchError, Encoded, Job, Picture, REFERENCE_DECODER, Sources, UNIT_ENCODER, decoders, encoders, gather,
};

/// Crops to this side: an atlas in full takes the slowest encoders several seconds a pass.
const SIDE: u32 = 256;

fn picture() -> Result<Picture, BenchError> {
    let (classes, notes) = gather(&Sources::default())?;
    for note in notes {
        eprintln!("note: {note}");
    }
    let whole = &classes[0].pictures[0];
    let texel = |x: u32, y: u32| {
        let start = 4 * (y * whole.width() + x) as usize;
        [whole.rgba()[start], whole.rgba()[start + 1], whole.rgba()[start + 2]]
    };
    let cropped = Picture::from_fn(whole.name(), whole.width().min(SIDE), whole.height().min(SIDE), texel);
    Ok(cropped.unwrap_or_else(|| whole.clone()))
}

/// Times a job that has run well once.
fn time(group: &mut criterion::BenchmarkGroup<'_, criterion::measurement::WallTime>, name: &str, job: &mut dyn Job) {
    group.bench_function(name, |bencher| bencher.iter(|| job.run()));
}

fn encode(criterion: &mut Criterion, picture: &Picture) -> Result<(), BenchError> {
    let mut group = criterion.benchmark_group("encode");
    group.sample_size(10).throughput(Throughput::Elements(picture.texels() as u64));
    for encoder in encoders(0) {
        let checked = encoder.encode(picture).map_err(|error| error.to_string());
        match checked.and_then(|blocks| SquaredError::of(&blocks, picture)) {
            Ok(error) => {
                eprintln!("encode/{}: {:.3} dB on {}", encoder.name(), error.psnr_db(), picture.name());
                time(&mut group, encoder.name(), &mut *encoder.job(picture)?);
            }
            Err(why) => eprintln!("note: encode/{} is left out: {why}", encoder.name()),
        }
    }
    group.finish();
    Ok(())
}

fn decode(criterion: &mut Criterion, picture: &Picture) -> Result<(), BenchError> {
    let unit = encoders(0).into_iter().find(|encoder| encoder.name() == UNIT_ENCODER);
    let blocks = unit.map_or_else(|| Ok(vec![0; picture.block_bytes()]), |encoder| encoder.encode(picture))?;
    let (name, width, height) = (picture.name().to_owned(), picture.width(), picture.height());
    let encoded = Encoded { name, width, height, blocks };

    let all = decoders();
    let mut group = criterion.benchmark_group("decode");
    group.throughput(Throughput::Elements(encoded.texels() as u64));
    let (source, mut copy) = (picture.rgba().to_vec(), vec![0; picture.rgba().len()]);
    group.bench_function("memcpy", |b| b.iter(|| copy.copy_from_slice(std::hint::black_box(&source))));
    let reference = all[0].decode(&encoded)?;
    for decoder in &all {
        let steps = largest_difference(&decoder.decode(&encoded)?, &reference).color;
        if steps > 1 {
            eprintln!("note: decode/{} is left out: {steps}/255 from {REFERENCE_DECODER}", decoder.name());
            continue;
        }
        time(&mut group, decoder.name(), &mut *decoder.job(&encoded)?);
    }
    group.finish();
    Ok(())
}

fn all() -> Result<(), BenchError> {
    let mut criterion = Criterion::default().configure_from_args();
    let picture = picture()?;
    encode(&mut criterion, &picture)?;
    decode(&mut criterion, &picture)?;
    criterion.final_summary();
    Ok(())
}

fn main() -> Result<(), BenchError> {
    // Everything runs on the one thread of a pool, so that parallel code stays on it.
    one_thread(all)?
}

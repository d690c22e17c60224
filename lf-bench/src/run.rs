//! The two comparisons: everything between the command line and the files.

use std::path::{Path, PathBuf};

use crate::chart::{self, Kind, Mark};
use crate::class::{Class, Sources, gather};
use crate::codec::{Codec, Encoded, Input, Job, Maker};
use crate::decoders::{REFERENCE_DECODER, copying, decoders};
use crate::encoders::{UNIT_ENCODER, encoders};
use crate::error::BenchError;
use crate::measure::{Contestant, interleaved, one_thread};
use crate::picture::Picture;
use crate::quality::{SquaredError, checked_difference};
use crate::recorded::recorded_peers;
use crate::report::{self, ClassResult, DecoderClass, DecoderResult, EncoderResult};

/// Name of the line for plain copying.
const COPYING: &str = "memcpy";

/// How far below the unit's PSNR the second plot begins: it spreads the encoders that compete in quality.
const BELOW_DB: f64 = 0.8;

/// What to measure, how long, and where the results go.
#[derive(Debug, Clone)]
pub struct Options {
    /// Folder of photographs; see [`Sources`].
    pub images: Option<PathBuf>,
    /// Folder for the results; made if it is not there.
    pub out: PathBuf,
    /// Parts of names; empty for all. The unit and the reference are measured in any case.
    pub only: Vec<String>,
    /// CPU seconds for each codec on each class, as far as three rounds allow.
    pub seconds: f64,
    /// Distance in blocks of nearly equal pictures side by side; adds our encoders that make use of it, where not 0.
    pub repeat_blocks: u32,
    /// The command line, for the report.
    pub command: String,
}

/// Measures every encoder on every class and writes `front.md`, `front.csv` and two plots for each class.
///
/// Returns the Markdown. Progress goes to standard error.
///
/// # Errors
///
/// [`BenchError::InvalidArgument`] for names that fit no encoder, [`BenchError::Io`] and [`BenchError::Image`] for
/// files, [`BenchError::Codec`] if the unit cannot be measured. Any other encoder that fails is left out with a note.
pub fn compare_encoders(options: &Options) -> Result<String, BenchError> {
    let chosen = chosen(encoders(options.repeat_blocks), &options.only, UNIT_ENCODER)?;
    let classes = classes(options)?;
    let measure = || classes.iter().map(|class| encode_class(class, &chosen, options.seconds)).collect();
    let results: Result<Vec<ClassResult>, BenchError> = one_thread(measure)?;
    let results = results?;
    let markdown = report::encoders_markdown(&results, &options.command);
    write(&options.out, "front.md", &markdown)?;
    write(&options.out, "front.csv", &report::encoders_csv(&results))?;
    for class in &results {
        plots(class, &options.out)?;
    }
    Ok(markdown)
}

/// Measures every decoder on every class and writes `decoders.md` and `decoders.csv`.
///
/// Returns the Markdown. Progress goes to standard error.
///
/// # Errors
///
/// As [`compare_encoders`].
pub fn compare_decoders(options: &Options) -> Result<String, BenchError> {
    let chosen = chosen(decoders(), &options.only, REFERENCE_DECODER)?;
    let classes = classes(options)?;
    let measure = || classes.iter().map(|class| decode_class(class, &chosen, options.seconds)).collect();
    let results: Result<Vec<DecoderClass>, BenchError> = one_thread(measure)?;
    let results = results?;
    let markdown = report::decoders_markdown(&results, &options.command);
    write(&options.out, "decoders.md", &markdown)?;
    write(&options.out, "decoders.csv", &report::decoders_csv(&results))?;
    Ok(markdown)
}

fn classes(options: &Options) -> Result<Vec<Class>, BenchError> {
    let (classes, notes) = gather(&Sources { images: options.images.clone() })?;
    for note in notes {
        eprintln!("note: {note}");
    }
    Ok(classes)
}

/// The codecs whose names hold one of the words, and the one that the others are set against.
fn chosen<I>(all: Vec<Codec<I>>, only: &[String], always: &str) -> Result<Vec<Codec<I>>, BenchError> {
    for word in only {
        if !all.iter().any(|codec| codec.name().contains(word)) {
            let names: Vec<&str> = all.iter().map(Codec::name).collect();
            let text = format!("--only {word}: no such name; there are {}", names.join(", "));
            return Err(BenchError::InvalidArgument(text));
        }
    }
    let is_chosen = |name: &str| only.is_empty() || only.iter().any(|word| name.contains(word));
    Ok(all.into_iter().filter(|codec| codec.name() == always || is_chosen(codec.name())).collect())
}

fn encode_class(class: &Class, encoders: &[Codec<Picture>], seconds: f64) -> Result<ClassResult, BenchError> {
    let mut contestants = Vec::new();
    let mut kept = Vec::new();
    for (number, encoder) in encoders.iter().enumerate() {
        eprintln!("{}: checking encoder {} of {}, {}", class.name, number + 1, encoders.len(), encoder.name());
        let checked = admitted(encoder, &class.pictures).and_then(|contestant| {
            let error = class_error(encoder, &class.pictures, &contestant.outputs())?;
            Ok((contestant, error))
        });
        match checked {
            Ok((contestant, error)) => {
                contestants.push(contestant);
                kept.push((encoder, error));
            }
            Err(error) if encoder.name() == UNIT_ENCODER => return Err(error),
            Err(error) => eprintln!("note: left out: {error}"),
        }
    }
    let timings = timed(class, &mut contestants, seconds)?;
    let result = |((encoder, error), timing): (&(&Codec<Picture>, SquaredError), _)| EncoderResult {
        name: encoder.name().to_owned(),
        package: encoder.package(),
        maker: encoder.maker(),
        timing,
        texels: class.texels(),
        error: *error,
    };
    let results = kept.iter().zip(timings).map(result).collect();
    let recorded = class.setting().map_or_else(|| Ok(Vec::new()), recorded_peers)?;
    let missing = || BenchError::InvalidArgument(format!("{UNIT_ENCODER} was not measured"));
    ClassResult::new(class, results, recorded).ok_or_else(missing)
}

fn class_error(
    encoder: &Codec<Picture>,
    pictures: &[Picture],
    outputs: &[Vec<u8>],
) -> Result<SquaredError, BenchError> {
    pictures.iter().zip(outputs).try_fold(SquaredError::default(), |total, (picture, blocks)| {
        let error = SquaredError::of(blocks, picture).map_err(|why| encoder.failure(picture, why))?;
        Ok(total.plus(&error))
    })
}

fn decode_class(class: &Class, decoders: &[Codec<Encoded>], seconds: f64) -> Result<DecoderClass, BenchError> {
    let inputs = encoded(class)?;
    let copies: Vec<Box<dyn Job + '_>> = inputs.iter().map(|input| copying(input)).collect();
    let copying = Contestant::warmed_up(copies).map_err(|why| failure(COPYING, class, why))?;
    let mut contestants = vec![copying];
    let mut kept = vec![(COPYING, None, Maker::Peer, 0)];
    for decoder in decoders {
        let checked = admitted(decoder, &inputs).and_then(|contestant| {
            let difference = class_difference(decoder, &inputs, &contestant.outputs())?;
            Ok((contestant, difference))
        });
        match checked {
            Ok((contestant, difference)) => {
                contestants.push(contestant);
                kept.push((decoder.name(), Some(decoder.package()), decoder.maker(), difference));
            }
            Err(error) if decoder.name() == REFERENCE_DECODER => return Err(error),
            Err(error) => eprintln!("note: left out: {error}"),
        }
    }
    let timings = timed(class, &mut contestants, seconds)?;
    // The copy is the first; the reference is the second, since it leads the table of decoders.
    let (copying_s, reference_s) = (timings[0].median(), timings[1].median());
    let result = |((name, package, maker, difference), timing): ((&str, _, _, _), _)| DecoderResult {
        name: name.to_owned(),
        package,
        maker,
        timing,
        difference,
    };
    let mut results: Vec<DecoderResult> = kept.into_iter().zip(timings).map(result).collect();
    results.sort_by(|a, b| a.timing.median().total_cmp(&b.timing.median()));
    Ok(DecoderClass { class: class.name, texels: class.texels(), copying_s, reference_s, results })
}

/// The class as blocks of the unit encoder.
fn encoded(class: &Class) -> Result<Vec<Encoded>, BenchError> {
    let encoders = encoders(0);
    let encode = |picture: &Picture| {
        let blocks = encoders[0].encode(picture)?;
        Ok(Encoded { name: picture.name().to_owned(), width: picture.width(), height: picture.height(), blocks })
    };
    class.pictures.iter().map(encode).collect()
}

fn class_difference(decoder: &Codec<Encoded>, inputs: &[Encoded], outputs: &[Vec<u8>]) -> Result<u8, BenchError> {
    inputs.iter().zip(outputs).try_fold(0, |worst, (input, rgba)| {
        if rgba.len() != 4 * input.texels() {
            let why = format!("{} bytes of texels instead of {}", rgba.len(), 4 * input.texels());
            return Err(decoder.failure(input, why));
        }
        let difference = checked_difference(rgba, input).map_err(|why| decoder.failure(input, why))?;
        Ok(difference.color.max(worst))
    })
}

/// A codec's work on all inputs, done once.
fn admitted<'a, I: Input>(codec: &Codec<I>, inputs: &'a [I]) -> Result<Contestant<'a>, BenchError> {
    let jobs: Result<Vec<Box<dyn Job + 'a>>, BenchError> = inputs.iter().map(|input| codec.job(input)).collect();
    Contestant::warmed_up(jobs?).map_err(|why| codec.failure(&inputs[0], why))
}

fn timed(
    class: &Class,
    contestants: &mut [Contestant<'_>],
    seconds: f64,
) -> Result<Vec<lf_report::Timing>, BenchError> {
    let mut told = 0;
    let progress = |round, left| {
        // A line for every round would scroll away what matters.
        if left != told || round % 10 == 0 {
            told = left;
            eprintln!("{}: round {round}, {left} codecs", class.name);
        }
    };
    interleaved(contestants, seconds, progress).map_err(|why| failure("a codec", class, why))
}

fn failure(codec: &str, class: &Class, why: String) -> BenchError {
    BenchError::Codec { codec: codec.to_owned(), input: class.name.to_owned(), why }
}

/// All encoders of a class, and again those that compete in quality.
fn plots(class: &ClassResult, folder: &Path) -> Result<(), BenchError> {
    let title = format!("BC1 encoders on {} ({})", class.class, class.inputs);
    let name = format!("front-{}", class.class);
    let mut marks = marks(class);
    write(folder, &format!("{name}.svg"), &chart::svg(&title, &marks)?)?;
    marks.retain(|mark| mark.at.psnr_db > class.unit.psnr_db - BELOW_DB);
    write(folder, &format!("{name}-top.svg"), &chart::svg(&title, &marks)?)
}

/// What the plot of a class shows. Of the recorded peers only those on their front are named, or names would cover all.
fn marks(class: &ClassResult) -> Vec<Mark> {
    let measured = class.results.iter().map(|result| Mark {
        label: Some(result.name.clone()),
        kind: Kind::Measured(result.maker),
        at: class.relative(result),
    });
    let recorded = class.recorded.iter().map(|peer| Mark {
        label: peer.on_front.then(|| peer.name.clone()),
        kind: Kind::Recorded,
        at: class.placed(peer),
    });
    measured.chain(recorded).collect()
}

fn write(folder: &Path, name: &str, text: &str) -> Result<(), BenchError> {
    std::fs::create_dir_all(folder).map_err(BenchError::io(folder))?;
    let path = folder.join(name);
    std::fs::write(&path, text).map_err(BenchError::io(&path))?;
    eprintln!("wrote {}", path.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_choose_encoders_and_keep_the_unit() {
        let names = |only: &[&str]| -> Result<Vec<String>, String> {
            let only: Vec<String> = only.iter().map(|&word| word.to_owned()).collect();
            let codecs = chosen(encoders(0), &only, UNIT_ENCODER).map_err(|error| error.to_string())?;
            Ok(codecs.iter().map(|codec| codec.name().to_owned()).collect())
        };
        assert_eq!(names(&["tbc", "dds-fast"]).unwrap(), [UNIT_ENCODER, "tbc", "dds-fast"]);
        assert_eq!(names(&[]).unwrap().len(), encoders(0).len());
        assert!(names(&["nothing"]).unwrap_err().contains("there are intel_tex_2, etcpak"));
    }

    #[test]
    fn a_class_is_measured_from_picture_to_table() {
        let pictures = crate::synthetic::gradient(32).into_iter().collect();
        let class = Class { name: "gradient", pictures };
        let fast = chosen(encoders(0), &["etcpak".to_owned()], UNIT_ENCODER).unwrap();
        let result = encode_class(&class, &fast, 0.0).unwrap();
        assert_eq!(result.results.len(), 2);
        assert!(result.results.iter().all(|r| r.point().psnr_db > 25.0 && r.point().speed > 0.0));
        let decoded = decode_class(&class, &decoders(), 0.0).unwrap();
        assert_eq!(decoded.results.len(), decoders().len() + 1);
        assert!(decoded.results.iter().all(|r| r.difference <= 1));
    }
}

//! `lfslab report`: error against run time and bytes, of what people use today and of our own methods, on the same frames.

pub(crate) mod args;
mod contenders;
mod left_out;
mod sheet;
mod shots;
mod spec;
mod tables;

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use lf_gpu::Gpu;
use lf_report::{Baseline, Figure, Machine, Plot, Report};

use crate::demo::command_line;
use crate::device::open_gpu;
use crate::output::{jpeg, print, write};
use crate::sources::Source;
use args::{ReportArgs, ScenePlace};
use contenders::{Budget, contenders};
use shots::{Measured, Shot, shots};
use spec::{Preset, Spec};

pub(crate) fn run(args: &ReportArgs) -> Result<()> {
    if args.print {
        return print(args.preset.unwrap_or(Preset::Quick).toml().trim_end());
    }
    // Read first, so that a bad file is known before long work.
    let base = args.check.as_deref().map(read_baseline).transpose()?;
    let finished = args.spec.as_deref().filter(|path| path.extension().is_some_and(|ending| ending == "json"));
    let later = match finished {
        Some(path) if base.is_none() => bail!("{} is a finished report: name another by --check", path.display()),
        Some(path) => read_baseline(path)?,
        None => measure(args)?,
    };
    base.map_or(Ok(()), |base| check(&base, &later))
}

/// Measures and writes a report; what it says, to be held to another.
fn measure(args: &ReportArgs) -> Result<Baseline> {
    let start = Instant::now();
    let spec = spec(args)?;
    std::fs::create_dir_all(&args.out).with_context(|| format!("cannot make the folder {}", args.out.display()))?;
    let gpu = open_gpu(args.cpu);
    let mut report = Report {
        title: spec.title.clone(),
        generator: concat!("lfslab ", env!("CARGO_PKG_VERSION")).to_owned(),
        machine: Machine::detect(gpu.as_ref().map(Gpu::description)),
        reproduce: command_line(),
        facts: vec![],
        results: vec![],
        tables: vec![],
        notes: vec![],
    };
    let mut figures = vec![];
    for scene in &spec.scenes {
        figures.extend(in_scene(args, &spec, scene, gpu.as_ref(), &mut report)?);
        // A long run that is stopped leaves the scenes that were done.
        save(args, &finished(&report, &spec, start), &figures)?;
    }
    let report = finished(&report, &spec, start);
    let lines = [report.to_markdown(), report.notes.join("\n\n"), report.headlines().join("\n")];
    print(&format!("{}\n\nopen {}", lines.join("\n"), args.out.join("report.html").display()))?;
    Ok(Baseline::from_json(&report.to_json()?)?)
}

/// The report with what follows from its results.
fn finished(report: &Report, spec: &Spec, start: Instant) -> Report {
    let mut report = report.clone();
    let own = tables::tables(&report);
    report.tables.splice(0..0, own);
    let timed = format!("{} of each eye, after one that is not; of what takes more than a second, one", spec.repeats);
    report.facts.push(("Frames timed".to_owned(), timed));
    report.facts.push(("Took".to_owned(), format!("{:.0} s", start.elapsed().as_secs_f64())));
    report
}

/// What is to be measured: the file or preset, with what the command line says otherwise.
fn spec(args: &ReportArgs) -> Result<Spec> {
    let mut spec = match &args.spec {
        Some(path) => Spec::read(path)?,
        None => Spec::parse(args.preset.unwrap_or(Preset::Quick).toml())?,
    };
    if !args.scenes.is_empty() {
        spec.scenes.clone_from(&args.scenes);
    }
    spec.eyes = args.eyes.unwrap_or(spec.eyes);
    spec.budget = args.budget.unwrap_or(spec.budget);
    if let Some(size) = args.size {
        spec.sizes = vec![size];
    }
    spec.check()?;
    Ok(spec)
}

/// All methods on all reflectors of one scene. Results, tables and notes go into the report, sheets of pictures come back.
fn in_scene(
    args: &ReportArgs,
    spec: &Spec,
    scene: &ScenePlace,
    gpu: Option<&Gpu>,
    report: &mut Report,
) -> Result<Vec<Figure>> {
    let mut source = Source::load(&scene.in_light(&args.light))?;
    let shots = shots(args, spec, &mut source)?;
    let budget = Budget { bytes: (spec.budget * 1e6) as u64, folder: &args.out };
    let mut methods: Vec<Measured> = vec![];
    contenders(&source, &spec.methods, &budget, gpu, &mut |contender| {
        eprintln!("method   {}, {}", contender.name, contender.parameters);
        for shot in &shots {
            methods.push(shot.measured(contender, spec.repeats)?);
        }
        Ok(())
    })?;
    report.tables.extend(left_out::table(&source, &shots[0], &spec.methods, gpu, spec.repeats, &args.out)?);
    let mut figures = vec![];
    for shot in &shots {
        let own: Vec<&Measured> = methods.iter().filter(|method| method.result.frames == shot.frames).collect();
        report.results.extend(own.iter().map(|method| method.result.clone()));
        report.results.push(shot.traced(&source));
        report.notes.push(conditions(shot, spec, report));
        figures.push(Figure {
            title: format!("{} in {}, {2}×{2}", shot.frames.reflector, shot.frames.scene, shot.frames.size[0]),
            caption: "Traced, and by each method; below, the difference to the traced picture, four times as bright."
                .to_owned(),
            picture: jpeg(&sheet::sheet(shot, &own))?,
        });
    }
    Ok(figures)
}

/// What some frames were measured on.
fn conditions(shot: &Shot, spec: &Spec, report: &Report) -> String {
    let noise = shot.noise().map_or_else(String::new, |share| {
        format!(", their standard error at most {:.2} % of the radiance", 100.0 * share)
    });
    let Machine { cpu, threads, adapter, .. } = &report.machine;
    format!(
        "{} in {}, {} triangles, {} eyes, {}×{} pixels; samples of each traced ray: {}{noise}. {cpu}, {threads} threads; GPU: {}.",
        shot.frames.reflector,
        shot.frames.scene,
        shot.mesh.triangles().len(),
        spec.eyes,
        shot.frames.size[0],
        shot.frames.size[1],
        shot.samples,
        adapter.as_deref().unwrap_or("none"),
    )
}

/// Writes everything into the folder.
fn save(args: &ReportArgs, report: &Report, figures: &[Figure]) -> Result<()> {
    let file = |name: &str| args.out.join(name);
    let markdown = format!("{}\n{}\n", report.to_markdown(), report.notes.join("\n\n"));
    write(&file("report.json"), report.to_json()?.as_bytes())?;
    write(&file("report.csv"), report.to_csv()?.as_bytes())?;
    write(&file("report.md"), markdown.as_bytes())?;
    write(&file("report.html"), report.to_html(figures)?.as_bytes())?;
    for (frames, figure) in report.frames().into_iter().zip(figures) {
        let name = file_name(&format!("{}-{}-{}", frames.scene, frames.reflector, frames.size[0]));
        write(&file(&format!("{name}.jpg")), &figure.picture)?;
        for plot in Plot::ALL {
            if let Some(svg) = report.plot(frames, plot)? {
                write(&file(&format!("{name}-{}.svg", plot.name())), svg.as_bytes())?;
            }
        }
    }
    Ok(())
}

/// Letters and digits of a name; what else it has becomes a dash.
fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || c == '.' { c } else { '-' }).collect()
}

fn read_baseline(path: &Path) -> Result<Baseline> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    Baseline::from_json(&text).with_context(|| path.display().to_string())
}

/// Says what got worse; an error if anything did.
fn check(base: &Baseline, later: &Baseline) -> Result<()> {
    if !base.same_machine(later) {
        eprintln!("note: the reports are of different machines or builds; their times are not compared");
    }
    let worse = base.worse_in(later);
    if worse.is_empty() {
        return print("nothing got worse by more than the noise");
    }
    let lines: Vec<String> = worse.iter().map(|change| format!("worse: {change}")).collect();
    print(&lines.join("\n"))?;
    bail!("results that got worse: {}", worse.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_have_no_paths_in_them() {
        assert_eq!(file_name("museum-../a b@0.5,1-512"), "museum-..-a-b-0.5-1-512");
        assert_eq!(file_name("forêt-sphere:6-64"), "forêt-sphere-6-64");
    }
}

//! The paper's two tables, from what was measured: what slabs cost beside an environment map, and what each method holds.

use lf_report::{BASELINE_METHOD, Frames, MethodResult, Report, Table};

/// Frames a second of slabs and of an environment map in the paper's Table 1 (ATI Radeon 9700 Pro), by triangles.
const PAPER: [(&str, usize, [f64; 2]); 4] = [
    ("teapot", 2_256, [80.0, 400.0]),
    ("sphere", 19_800, [90.0, 340.0]),
    ("hippo", 51_584, [70.0, 260.0]),
    ("skull", 60_339, [70.0, 200.0]),
];

/// What a method can show, and what it needs: distant, near, touching and self-reflection (the paper's comparison).
const KINDS: [(&str, [&str; 4], &str); 8] = [
    ("environment map", ["yes", "no", "no", "no"], "no"),
    ("sphere-projected map", ["yes", "on a sphere", "no", "no"], "its size"),
    ("box-projected map", ["yes", "on a box", "no", "no"], "its size"),
    ("distance cube", ["yes", "what one point sees", "no", "no"], "depths"),
    ("8 distance cubes", ["yes", "what eight points see", "no", "no"], "depths"),
    ("slabs", ["yes", "yes", "no", "no"], "no"),
    ("guided cubes (ours)", ["yes", "what five points see", "no", "no"], "depths"),
    ("ray tracing", ["yes", "yes", "not traced", "not traced"], "all of it"),
];

pub(crate) fn tables(report: &Report) -> Vec<Table> {
    [costs(report), comparison(report)].into_iter().flatten().collect()
}

fn texts<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(str::to_owned).to_vec()
}

/// Table 1: slabs beside the environment map, on each device. The paper's own ratios stand in a row of their own each.
fn costs(report: &Report) -> Option<Table> {
    let mut rows = vec![];
    for frames in report.frames() {
        let results = report.results_of(frames);
        for base in results.iter().filter(|result| result.method == BASELINE_METHOD) {
            let slabs = results.iter().filter(|result| result.method == "slabs" && result.device == base.device);
            rows.extend(slabs.map(|slabs| cost(report, frames, slabs, base)));
        }
    }
    if rows.is_empty() {
        return None;
    }
    rows.extend(PAPER.iter().map(|(name, triangles, [slabs, map])| {
        let ms = |fps: &f64| format!("{:.1}", 1e3 / fps);
        let what = format!("the paper's {name}, {triangles} triangles");
        [
            what,
            "BC1 volume texture".to_owned(),
            "Radeon 9700 Pro".to_owned(),
            ms(slabs),
            ms(map),
            format!("{:.1}", map / slabs),
        ]
        .to_vec()
    }));
    Some(Table {
        title: "Slabs beside the environment map".to_owned(),
        caption: "Medians of milliseconds a frame, and their ratio; the paper's from its Table 1.".to_owned(),
        columns: texts(["frames", "slabs", "device", "slabs, ms", "map, ms", "ratio"]),
        rows,
    })
}

fn cost(report: &Report, frames: &Frames, slabs: &MethodResult, base: &MethodResult) -> Vec<String> {
    let [slabs_ms, map_ms] = [slabs, base].map(|result| 1e3 * result.timing.median());
    [
        report.label(frames),
        slabs.parameters.clone(),
        slabs.device.clone(),
        format!("{slabs_ms:.1}"),
        format!("{map_ms:.1}"),
        format!("{:.2}", slabs_ms / map_ms),
    ]
    .to_vec()
}

/// The comparison: what a method can reflect, and what it takes; of each method its best result on the first frames.
fn comparison(report: &Report) -> Option<Table> {
    let results = report.results_of(report.frames().first()?);
    let best = |name: &str| {
        let own = results.iter().filter(|result| result.method == name);
        own.max_by(|a, b| a.mean_psnr_db().unwrap_or(0.0).total_cmp(&b.mean_psnr_db().unwrap_or(0.0)))
    };
    let row = |(name, holds, needs): &(&str, [&str; 4], &str)| {
        let result = best(name)?;
        let pixels = result.eyes.iter().map(|eye| eye.pixels as f64).sum::<f64>() / result.eyes.len().max(1) as f64;
        let per_pixel =
            if pixels > 0.0 { format!("{:.0}", 1e9 * result.timing.median() / pixels) } else { "–".to_owned() };
        let stored = format!("{:.1}", result.bytes_on_device as f64 / 1e6);
        let prepared = format!("{:.1}", result.preparation_s);
        let device = format!("{}; {}", result.parameters, result.device);
        let cells = [*name].into_iter().chain(*holds).map(str::to_owned);
        Some(cells.chain([(*needs).to_owned(), stored, per_pixel, prepared, device]).collect())
    };
    let rows: Vec<Vec<String>> = KINDS.iter().filter_map(row).collect();
    (!rows.is_empty()).then(|| Table {
        title: "What each method holds, and takes".to_owned(),
        caption: "D, N, T, S: reflections of what is distant, near, touching, and of the reflector in itself. Preparation is once for a scene; \
                  a moving reflector costs none, a moving scene all of it again. Of each method its best result on the first frames; ns a pixel: \
                  time of a frame by pixels of the reflector."
            .to_owned(),
        columns: texts(["method", "D", "N", "T", "S", "needs of the scene", "MB", "ns a pixel", "preparation, s", "measured with"]),
        rows,
    })
}

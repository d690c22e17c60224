//! Writes a report with made-up numbers, to look at its layout:
//! `cargo run -p lf-report --example sample_report -- OUT.html [FIGURE.png …]`. `OUT.svg` and `OUT.json` go beside it.

use std::error::Error;
use std::path::PathBuf;

use lf_report::{BASELINE_METHOD, EyeError, Figure, Frames, Machine, MethodResult, Plot, Report, Table, Timing};

fn result(reflector: &str, method: &str, psnr_db: Option<f64>, ms: f64) -> Option<MethodResult> {
    let eye = |(psnr, eye): (f64, usize)| {
        let psnr_db = psnr + (eye as f64 * 1.7).sin();
        let mse = 255.0 * 255.0 / 10f64.powf(psnr_db / 10.0);
        EyeError {
            eye,
            psnr_db,
            mse,
            rel_mse: mse / 5000.0,
            flip: mse.sqrt() / 200.0,
            ssim: 1.0 - mse.sqrt() / 100.0,
            share_over_tenth: mse / 5000.0,
            max_abs: 120 + eye as u8,
            pixels: 51_234 + 10 * eye,
        }
    };
    let slabs = method == "slabs";
    Some(MethodResult {
        frames: Frames { scene: "museum".to_owned(), reflector: reflector.to_owned(), size: [512; 2] },
        method: method.to_owned(),
        parameters: if slabs { "16×16 cameras of 64×64, BC1" } else { "" }.to_owned(),
        device: "llvmpipe (LLVM 15.0.6, 256 bits), Vulkan".to_owned(),
        eyes: psnr_db.map_or_else(Vec::new, |psnr| (0..8).map(|i| eye((psnr, i))).collect()),
        timing: Timing::from_seconds([0.96, 0.99, 1.0, 1.03, 1.3].map(|f| f * ms * 1e-3).to_vec())?,
        bytes_on_device: if slabs { 4_194_304 } else { 1_572_864 },
        bytes_on_disk: psnr_db.map(|_| if slabs { 3_511_200 } else { 911_002 }),
        preparation_s: if slabs { 71.3 } else { 0.42 },
        rays: psnr_db.map(|_| if slabs { 6_300_000 } else { 1_572_864 }),
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let out = arguments.next().ok_or("usage: sample_report OUT.html [FIGURE.png …]")?;
    let rows = [
        ("sphere", "ray tracing", None, 412.0),
        ("sphere", BASELINE_METHOD, Some(21.6), 4.11),
        ("sphere", "slabs", Some(31.2), 13.4),
        ("teapot", "ray tracing", None, 455.0),
        ("teapot", BASELINE_METHOD, Some(20.8), 4.02),
        ("teapot", "slabs", Some(29.4), 13.1),
    ];
    let report = Report {
        title: "Reflections in the museum: a sample with made-up numbers".to_owned(),
        generator: format!("sample_report {}", env!("CARGO_PKG_VERSION")),
        machine: Machine::detect(None),
        reproduce: "cargo run -p lf-report --example sample_report -- sample.html".to_owned(),
        facts: vec![
            ("Slabs".to_owned(), "6 × 16×16 cameras of 64×64 rays".to_owned()),
            ("File".to_owned(), "museum.lfslab, 3.35 MiB".to_owned()),
        ],
        results: rows
            .into_iter()
            .filter_map(|(reflector, method, psnr, ms)| result(reflector, method, psnr, ms))
            .collect(),
        tables: vec![Table {
            title: "Left out".to_owned(),
            caption: "What this scene does not need.".to_owned(),
            columns: ["what", "saves"].map(str::to_owned).to_vec(),
            rows: vec![["texels that no ray asks for", "69 % of the bytes"].map(str::to_owned).to_vec()],
        }],
        notes: vec!["All numbers of this page are made up; only its layout is real.".to_owned()],
    };
    let figure = |path: PathBuf| {
        let title = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Figure { title, caption: "A figure with its caption.".to_owned(), picture: std::fs::read(path)? })
    };
    let figures = arguments.map(figure).collect::<Result<Vec<_>, std::io::Error>>()?;
    std::fs::write(&out, report.to_html(&figures)?)?;
    std::fs::write(out.with_extension("svg"), report.plot(&report.results[0].frames, Plot::Time)?.unwrap_or_default())?;
    std::fs::write(out.with_extension("json"), report.to_json()?)?;
    print!("{}", report.to_markdown());
    Ok(())
}

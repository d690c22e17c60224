//! Results as Markdown and CSV.

use lf_report::{Machine, Timing};

use crate::class::Class;
use crate::codec::Maker;
use crate::encoders::UNIT_ENCODER;
use crate::front::{Point, beaten_by, front};
use crate::quality::SquaredError;
use crate::recorded::RecordedPeer;

const LOCK_FILE: &str = include_str!("../../Cargo.lock");

/// An encoder on one class.
#[derive(Debug, Clone)]
pub(crate) struct EncoderResult {
    pub(crate) name: String,
    pub(crate) package: &'static str,
    pub(crate) maker: Maker,
    /// Seconds for all pictures of the class.
    pub(crate) timing: Timing,
    pub(crate) texels: usize,
    pub(crate) error: SquaredError,
}

impl EncoderResult {
    /// Place on the plot, in texels per second. PSNR counts to the 0.001 dB that the tables show, so that nobody wins by
    /// a difference nobody sees.
    pub(crate) fn point(&self) -> Point {
        let psnr_db = (self.error.psnr_db() * 1e3).round() * 1e-3;
        Point { speed: self.texels as f64 / self.timing.median(), psnr_db }
    }
}

/// All encoders on one class.
#[derive(Debug, Clone)]
pub(crate) struct ClassResult {
    pub(crate) class: &'static str,
    /// How many pictures and texels.
    pub(crate) inputs: String,
    pub(crate) results: Vec<EncoderResult>,
    /// Texels per second of the unit.
    pub(crate) unit: Point,
    pub(crate) recorded: Vec<RecordedPeer>,
}

impl ClassResult {
    /// The results by falling speed. `None` if the unit is not among them.
    pub(crate) fn new(class: &Class, mut results: Vec<EncoderResult>, recorded: Vec<RecordedPeer>) -> Option<Self> {
        results.sort_by(|a, b| b.point().speed.total_cmp(&a.point().speed));
        let unit = results.iter().find(|result| result.name == UNIT_ENCODER)?.point();
        let pictures = match class.pictures.len() {
            1 => "1 picture".to_owned(),
            count => format!("{count} pictures"),
        };
        let inputs = format!("{pictures}, {:.2} Mtexel", class.texels() as f64 * 1e-6);
        Some(Self { class: class.name, inputs, results, unit, recorded })
    }

    /// A result's place with its speed as a ratio to the unit's.
    pub(crate) fn relative(&self, result: &EncoderResult) -> Point {
        let point = result.point();
        Point { speed: point.speed / self.unit.speed, psnr_db: point.psnr_db }
    }

    /// A recorded peer's place as far as it can be told from its distance to the unit.
    pub(crate) fn placed(&self, peer: &RecordedPeer) -> Point {
        Point { speed: peer.from_unit.speed, psnr_db: self.unit.psnr_db + peer.from_unit.psnr_db }
    }

    fn made_by(&self, maker: Maker) -> Vec<&EncoderResult> {
        self.results.iter().filter(|result| result.maker == maker).collect()
    }

    /// Names on the front of the peers measured here.
    fn peers_front(&self) -> Vec<&str> {
        let peers = self.made_by(Maker::Peer);
        let points: Vec<Point> = peers.iter().map(|peer| peer.point()).collect();
        front(&points).into_iter().map(|i| peers[i].name.as_str()).collect()
    }

    /// Which of ours beat a point given relative to the unit; `NOT BEATEN` if none.
    fn verdict(&self, peer: &Point) -> String {
        let ours = self.made_by(Maker::Ours);
        let points: Vec<Point> = ours.iter().map(|result| self.relative(result)).collect();
        let names: Vec<&str> = beaten_by(peer, &points).into_iter().map(|i| ours[i].name.as_str()).collect();
        if names.is_empty() { "NOT BEATEN".to_owned() } else { names.join(", ") }
    }

    fn front_mark(&self, result: &EncoderResult) -> &'static str {
        match result.maker {
            Maker::Peer if self.peers_front().contains(&result.name.as_str()) => "●",
            Maker::Ours if !self.results.iter().any(|other| other.point().beats(&result.point())) => "◆",
            _ => "",
        }
    }

    fn beaten(&self, result: &EncoderResult) -> String {
        match self.front_mark(result) {
            "●" => self.verdict(&self.relative(result)),
            _ => String::new(),
        }
    }

    fn markdown(&self) -> String {
        let mut text = format!("## {}: {}\n\n", self.class, self.inputs);
        text += "| encoder | Mtexel/s [quartiles] | × intel_tex_2 | PSNR, dB | front | beaten by |\n";
        text += "|---|--:|--:|--:|:-:|---|\n";
        for result in &self.results {
            let at = self.relative(result);
            let mark = self.front_mark(result);
            let name = bold_if(result.maker == Maker::Ours, &transparency_noted(result));
            let (speed, ratio, beaten) =
                (speeds(&result.timing, result.texels), significant(at.speed), self.beaten(result));
            text += &format!("| {name} | {speed} | {ratio} | {:.3} | {mark} | {beaten} |\n", at.psnr_db);
        }
        text + &self.recorded_markdown()
    }

    fn recorded_markdown(&self) -> String {
        let on_front: Vec<&RecordedPeer> = self.recorded.iter().filter(|peer| peer.on_front).collect();
        if on_front.is_empty() {
            return String::new();
        }
        let mut text =
            "\nRecorded elsewhere, on the front of all encoders there, placed relative to intel_tex_2 (another \
                        machine, AVX-512, other pictures: for orientation):\n\n"
                .to_owned();
        text += "| encoder | × intel_tex_2 | dB over intel_tex_2 | beaten by |\n|---|--:|--:|---|\n";
        for peer in on_front {
            let Point { speed, psnr_db } = peer.from_unit;
            let verdict = self.verdict(&self.placed(peer));
            text += &format!("| {} | {} | {psnr_db:+.3} | {verdict} |\n", peer.name, significant(speed));
        }
        text
    }

    fn csv(&self) -> String {
        let line = |result: &EncoderResult| {
            let (mtexels, (q1, q3)) = (|s: f64| result.texels as f64 * 1e-6 / s, result.timing.quartiles());
            let at = self.relative(result);
            let maker = if result.maker == Maker::Ours { "ours" } else { "peer" };
            let mark = if self.front_mark(result).is_empty() { "no" } else { "yes" };
            let (median, rounds) = (mtexels(result.timing.median()), result.timing.samples().len());
            format!(
                "{},{},{},{},{maker},{median:.4},{:.4},{:.4},{rounds},{:.6},{:.4},{},{mark},{}\n",
                self.class,
                result.name,
                result.package,
                locked_version(result.package),
                mtexels(q3),
                mtexels(q1),
                at.speed,
                at.psnr_db,
                result.error.transparent_texels(),
                self.beaten(result).replace(", ", " "),
            )
        };
        self.results.iter().map(line).collect()
    }
}

/// All classes as one page.
pub(crate) fn encoders_markdown(classes: &[ClassResult], command: &str) -> String {
    let mut text = format!("# BC1 encoders: speed and PSNR\n\n{}\n", preamble(command));
    text += "●: on the speed–PSNR front of all peers measured here. ◆: ours, not beaten by any encoder measured here. \
             \"Beaten by\": those of ours that are faster at no lower PSNR or better at no lower speed. \
             α: codes some texels of the opaque input as transparent black.\n\n";
    text += &overview(classes);
    for class in classes {
        text += "\n";
        text += &class.markdown();
    }
    text
}

/// One line for each encoder with its speed and PSNR on every class.
fn overview(classes: &[ClassResult]) -> String {
    let Some(first) = classes.first() else { return String::new() };
    let heads: String = classes.iter().map(|c| format!(" {0}, × | {0}, dB |", c.class)).collect();
    let mut text = format!("| encoder | crate |{heads}\n|---|---|{}\n", "--:|--:|".repeat(classes.len()));
    for result in &first.results {
        let cell = |class: &ClassResult| match class.results.iter().find(|other| other.name == result.name) {
            Some(found) => {
                let at = class.relative(found);
                format!(" {} | {:.3}{} |", significant(at.speed), at.psnr_db, spaced(class.front_mark(found)))
            }
            None => " – | – |".to_owned(),
        };
        let name = bold_if(result.maker == Maker::Ours, &result.name);
        let cells: String = classes.iter().map(cell).collect();
        text += &format!("| {name} | {} {} |{cells}\n", result.package, locked_version(result.package));
    }
    text
}

/// All classes as comma-separated values.
pub(crate) fn encoders_csv(classes: &[ClassResult]) -> String {
    let head = "class,encoder,crate,version,maker,mtexel_per_s,mtexel_per_s_q1,mtexel_per_s_q3,rounds,ratio_to_intel_tex_2,\
                psnr_db,transparent_texels,on_front,beaten_by\n";
    classes.iter().fold(head.to_owned(), |text, class| text + &class.csv())
}

/// A decoder on one class.
#[derive(Debug, Clone)]
pub(crate) struct DecoderResult {
    pub(crate) name: String,
    /// `None` for plain copying.
    pub(crate) package: Option<&'static str>,
    pub(crate) maker: Maker,
    pub(crate) timing: Timing,
    /// Largest difference from the reference decoder in R, G, B, in steps of 1/255.
    pub(crate) difference: u8,
}

/// All decoders on one class, by falling speed.
#[derive(Debug, Clone)]
pub(crate) struct DecoderClass {
    pub(crate) class: &'static str,
    pub(crate) texels: usize,
    pub(crate) copying_s: f64,
    pub(crate) reference_s: f64,
    pub(crate) results: Vec<DecoderResult>,
}

/// All classes as one page.
pub(crate) fn decoders_markdown(classes: &[DecoderClass], command: &str) -> String {
    let mut text = format!("# BC1 decoders: speed\n\n{}", preamble(command));
    for class in classes {
        text += &format!("\n## {}: {:.2} Mtexel, blocks of intel_tex_2\n\n", class.class, class.texels as f64 * 1e-6);
        text +=
            "| decoder | crate | Mtexel/s [quartiles] | × memcpy | × texture2ddecoder | largest difference, 1/255 |\n";
        text += "|---|---|--:|--:|--:|--:|\n";
        for result in &class.results {
            let package = result.package.map_or_else(String::new, |name| format!("{name} {}", locked_version(name)));
            let name = bold_if(result.maker == Maker::Ours, &result.name);
            let speed = speeds(&result.timing, class.texels);
            let ratio = |other: f64| significant(other / result.timing.median());
            let (copying, reference) = (ratio(class.copying_s), ratio(class.reference_s));
            text += &format!("| {name} | {package} | {speed} | {copying} | {reference} | {} |\n", result.difference);
        }
    }
    text
}

/// All classes as comma-separated values.
pub(crate) fn decoders_csv(classes: &[DecoderClass]) -> String {
    let mut text =
        "class,decoder,crate,version,mtexel_per_s,ratio_to_memcpy,ratio_to_texture2ddecoder,difference\n".to_owned();
    for class in classes {
        for result in &class.results {
            let (package, median) = (result.package.unwrap_or(""), result.timing.median());
            let version = result.package.map_or("", locked_version);
            let mtexels = class.texels as f64 * 1e-6 / median;
            let (copying, reference) = (class.copying_s / median, class.reference_s / median);
            let (name, step) = (&result.name, result.difference);
            text += &format!(
                "{},{name},{package},{version},{mtexels:.4},{copying:.6},{reference:.6},{step}\n",
                class.class
            );
        }
    }
    text
}

/// Machine, method and command, for the top of a page.
fn preamble(command: &str) -> String {
    let Machine { cpu, threads, os, build_profile, .. } = Machine::detect(None);
    format!(
        "{cpu}, {os}, {threads} threads of which one is used, SIMD: {}, {build_profile} build. Thread CPU time, \
         interleaved rounds, median. Command: `{command}`\n",
        instruction_sets()
    )
}

/// The vector extensions that encoders choose among at run time.
fn instruction_sets() -> String {
    #[cfg(target_arch = "x86_64")]
    let there = [
        ("SSE4.1", is_x86_feature_detected!("sse4.1")),
        ("AVX2", is_x86_feature_detected!("avx2")),
        ("AVX-512F", is_x86_feature_detected!("avx512f")),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    let there = [(std::env::consts::ARCH, true)];
    let names: Vec<&str> = there.into_iter().filter(|(_, is_there)| *is_there).map(|(name, _)| name).collect();
    names.join(", ")
}

/// The version of a crate that this program was built with.
fn locked_version(package: &str) -> &'static str {
    let head = format!("name = \"{package}\"\nversion = \"");
    let version = LOCK_FILE.split_once(&head).and_then(|(_, rest)| rest.split_once('"'));
    version.map_or("?", |(version, _)| version)
}

/// Median with quartiles in Mtexel/s.
fn speeds(timing: &Timing, texels: usize) -> String {
    let speed = |seconds: f64| significant(texels as f64 * 1e-6 / seconds);
    let (q1, q3) = timing.quartiles();
    format!("{} [{}–{}]", speed(timing.median()), speed(q3), speed(q1))
}

/// Three significant digits, never in exponent form.
fn significant(value: f64) -> String {
    if !(value.is_finite() && value > 0.0) {
        return format!("{value}");
    }
    let decimals = (2 - value.log10().floor() as i32).clamp(0, 9) as usize;
    format!("{value:.decimals$}")
}

fn transparency_noted(result: &EncoderResult) -> String {
    let mark = if result.error.transparent_texels() > 0 { " α" } else { "" };
    format!("{}{mark}", result.name)
}

fn bold_if(condition: bool, text: &str) -> String {
    if condition { format!("**{text}**") } else { text.to_owned() }
}

fn spaced(mark: &str) -> String {
    if mark.is_empty() { String::new() } else { format!(" {mark}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::gradient;

    fn result(name: &str, maker: Maker, seconds: f64, off_by: u8) -> EncoderResult {
        let error = SquaredError::between(&[off_by, 0, 0, 255], &[0, 0, 0, 255]);
        let timing = Timing::from_seconds(vec![seconds]).unwrap();
        EncoderResult { name: name.to_owned(), package: "tbc", maker, timing, texels: 16, error }
    }

    fn class_of(results: Vec<EncoderResult>) -> ClassResult {
        let class = Class { name: "gradient", pictures: gradient(16).into_iter().collect() };
        ClassResult::new(&class, results, Vec::new()).unwrap()
    }

    #[test]
    fn tables_say_who_beats_whom() {
        let class = class_of(vec![
            result(UNIT_ENCODER, Maker::Peer, 1.0, 3),
            result("quick", Maker::Peer, 0.5, 9),
            result("dominated", Maker::Peer, 2.0, 3),
            result("lf-a", Maker::Ours, 0.9, 3),
        ]);
        let text = encoders_markdown(std::slice::from_ref(&class), "test");
        let line = |name: &str| text.lines().rfind(|line| line.starts_with(&format!("| {name} "))).unwrap().to_owned();
        assert!(line(UNIT_ENCODER).ends_with("| ● | lf-a |"), "{text}");
        assert!(line("quick").ends_with("| ● | NOT BEATEN |"), "{text}");
        assert!(line("dominated").ends_with("|  |  |"), "{text}");
        assert!(line("**lf-a**").ends_with("| ◆ |  |"), "{text}");
        let csv = encoders_csv(&[class]);
        let fields: Vec<usize> = csv.lines().map(|line| line.split(',').count()).collect();
        assert_eq!(fields, [14; 5]);
    }

    #[test]
    fn without_the_unit_there_is_no_table() {
        let class = Class { name: "gradient", pictures: Vec::new() };
        assert!(ClassResult::new(&class, vec![result("quick", Maker::Peer, 1.0, 1)], Vec::new()).is_none());
    }

    #[test]
    fn numbers_have_three_digits_and_versions_are_found() {
        let texts = [1423.0, 387.4, 12.34, 1.0, 0.000_712_3].map(significant);
        assert_eq!(texts, ["1423", "387", "12.3", "1.00", "0.000712"]);
        assert_eq!(locked_version("lf-compress"), env!("CARGO_PKG_VERSION"));
        assert_eq!(locked_version("no-such-crate"), "?");
    }
}

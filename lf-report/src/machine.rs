//! The machine a report was measured on.

use serde::Serialize;

/// What the times in a report depend on besides the program.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Name of the processor, see [`cpu_name`].
    pub cpu: String,
    /// Threads the program could run at once.
    pub threads: usize,
    /// Graphics adapter with its driver; `None` where there was none.
    pub adapter: Option<String>,
    /// Operating system and architecture, such as `linux x86_64`.
    pub os: String,
    /// Cargo profile of the program: `release` or `debug`.
    pub build_profile: String,
}

impl Machine {
    /// The machine this program runs on. The adapter is the caller's to name.
    #[must_use]
    pub fn detect(adapter: Option<String>) -> Self {
        Self {
            cpu: cpu_name(),
            threads: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            adapter,
            os: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            build_profile: if cfg!(debug_assertions) { "debug" } else { "release" }.to_owned(),
        }
    }
}

/// Name of the processor: its model name in Linux' `/proc/cpuinfo` where there is one, else the architecture.
#[must_use]
pub fn cpu_name() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    model_name(&info).unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

/// The first `model name` (x86) or, failing that, `Model` (single-board computers) of a cpuinfo text.
fn model_name(cpuinfo: &str) -> Option<String> {
    let value_of = |key: &str| {
        let mut fields = cpuinfo.lines().filter_map(|line| line.split_once(':'));
        fields.find(|(name, value)| name.trim() == key && !value.trim().is_empty()).map(|(_, value)| value)
    };
    let words = value_of("model name").or_else(|| value_of("Model"))?.split_whitespace();
    Some(words.collect::<Vec<_>>().join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn model_name_is_found_and_tidied() {
        let x86 = "processor\t: 0\nmodel\t\t: 85\nmodel name\t: Some(R)   CPU @ 2.00GHz\nmodel name\t: Other\n";
        assert_eq!(model_name(x86).as_deref(), Some("Some(R) CPU @ 2.00GHz"));
        assert_eq!(model_name("processor\t: 0\nModel\t\t: Board 4\n").as_deref(), Some("Board 4"));
        assert_eq!(model_name("processor : 0\nmodel name :  \n"), None);
    }

    #[test]
    fn detects_something() {
        let machine = Machine::detect(None);
        assert!(!machine.cpu.is_empty() && machine.threads > 0 && !machine.os.is_empty());
    }
}

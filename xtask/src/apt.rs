//! Debian packages, installed where that is possible.

use std::process::Command;

use crate::steps::CommandLine;

/// Installs packages, named with spaces between them, on Debian and its relatives; elsewhere, or without the right to, the
/// error is `how_to_install`.
pub(crate) fn install(packages: &str, how_to_install: &str) -> Result<(), String> {
    let release = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
    if !is_debian_like(&release) || !is_root() {
        return Err(how_to_install.to_owned());
    }
    println!("installing {packages}");
    for line in ["apt-get update", &format!("apt-get install -y --no-install-recommends {packages}")] {
        let line = CommandLine::new(line).with("DEBIAN_FRONTEND", "noninteractive");
        line.run().map_err(|error| format!("{error}\n{how_to_install}"))?;
    }
    Ok(())
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output();
    id.is_ok_and(|output| output.status.success() && output.stdout.trim_ascii() == b"0")
}

/// Whether an os-release text names Debian, Ubuntu or something that says it is like one (os-release(5)).
fn is_debian_like(os_release: &str) -> bool {
    let value = |line: &str| {
        let (name, value) = line.trim().split_once('=')?;
        let value = value.trim_matches(['"', '\'']).to_owned();
        matches!(name, "ID" | "ID_LIKE").then_some(value)
    };
    let values: Vec<String> = os_release.lines().filter_map(value).collect();
    values.iter().flat_map(|value| value.split_whitespace()).any(|id| matches!(id, "debian" | "ubuntu"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn os_release() {
        let cases = [
            ("PRETTY_NAME=\"Debian GNU/Linux 12\"\nID=debian\n", true),
            ("ID=ubuntu\nID_LIKE=debian\n", true),
            ("ID=linuxmint\nID_LIKE=\"ubuntu debian\"\n", true),
            ("ID='pop'\nID_LIKE='ubuntu debian'\n", true),
            ("NAME=Fedora\nID=fedora\n", false),
            ("ID=arch\nHOME_URL=\"https://debian.example\"\nVARIANT_ID=debian\n", false),
            ("ID=nodebian\n", false),
            ("", false),
        ];
        for (text, expected) in cases {
            assert_eq!(is_debian_like(text), expected, "{text}");
        }
    }
}

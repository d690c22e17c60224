//! A graphics device for the tests: the machine's own, or else Mesa's software Vulkan driver (lavapipe).

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use crate::apt;
use crate::steps::CommandLine;

const ADAPTERS: &str = "cargo run -q -p lf-gpu --example adapters --locked";
/// Which drivers the Vulkan loader uses, instead of all it finds.
const DRIVER_FILES: &str = "VK_DRIVER_FILES";

/// What to do where this program cannot do it itself.
const HOW_TO_INSTALL: &str = "\
no graphics adapter was found, and the tests draw on one. A software driver is enough; install Mesa's:
  Debian, Ubuntu:  sudo apt-get update && sudo apt-get install --no-install-recommends mesa-vulkan-drivers libvulkan1
  Fedora:          sudo dnf install mesa-vulkan-drivers vulkan-loader
  Arch:            sudo pacman -S vulkan-swrast vulkan-icd-loader
then run `cargo xtask test` again";

/// Makes sure that there is an adapter, installing a driver where that is possible, and returns the variables that
/// the tests need to use it.
pub(crate) fn prepare() -> Result<Vec<(&'static str, OsString)>, String> {
    let adapters = match find_adapters()? {
        Some(adapters) => adapters,
        None => {
            println!("no graphics adapter found: a software Vulkan driver will do");
            apt::install("mesa-vulkan-drivers libvulkan1", HOW_TO_INSTALL)?;
            let still = "still no graphics adapter after mesa-vulkan-drivers was installed";
            find_adapters()?.ok_or_else(|| format!("{still}\nlook again: {ADAPTERS}"))?
        }
    };
    print!("{adapters}");
    let chosen = [DRIVER_FILES, "VK_ICD_FILENAMES"].iter().any(|name| std::env::var_os(name).is_some());
    if has_hardware(&adapters) || chosen {
        return Ok(Vec::new());
    }
    // Software only: name the driver, so that the results do not hang on what else is installed.
    let drivers = lavapipe_files(&[Path::new("/usr/share/vulkan/icd.d"), Path::new("/etc/vulkan/icd.d")]);
    let list = std::env::join_paths(&drivers).map_err(|error| error.to_string())?;
    if list.is_empty() {
        return Ok(Vec::new());
    }
    println!("{DRIVER_FILES}={}", list.to_string_lossy());
    Ok(vec![(DRIVER_FILES, list)])
}

/// One line for each adapter that can be used; `None` if there is none.
fn find_adapters() -> Result<Option<String>, String> {
    let line = CommandLine::new(ADAPTERS);
    let output =
        line.command().stderr(Stdio::inherit()).output().map_err(|error| format!("cannot run cargo: {error}"))?;
    match output.status.code() {
        Some(0) => Ok(Some(String::from_utf8_lossy(&output.stdout).into_owned())),
        Some(1) => Ok(None),
        _ => Err(format!("{}\nrun it again: {}", output.status, line.shell_line())),
    }
}

/// Whether the list of adapters has one that is not a program.
fn has_hardware(adapters: &str) -> bool {
    ["DiscreteGpu", "IntegratedGpu", "VirtualGpu"].iter().any(|kind| adapters.contains(kind))
}

/// Lavapipe's driver descriptions in `folders`, for whichever architectures; the loader skips those of others.
fn lavapipe_files(folders: &[&Path]) -> Vec<PathBuf> {
    let entries = folders.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().filter_map(Result::ok);
    let is_lavapipe = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("lvp_icd") && name.ends_with(".json")
    };
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_lavapipe).collect();
    files.sort_unstable();
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hardware_is_told_from_software() {
        assert!(has_hardware("llvmpipe, Cpu, Vulkan\nSome card, DiscreteGpu, Vulkan\n"));
        assert!(!has_hardware("llvmpipe (LLVM 15.0.6, 256 bits), Cpu, Vulkan\n"));
    }

    #[test]
    fn only_lavapipe_is_picked() {
        let folder = std::env::temp_dir().join(format!("xtask-icd-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for name in ["lvp_icd.x86_64.json", "lvp_icd.aarch64.json", "radeon_icd.x86_64.json", "lvp_icd.txt"] {
            std::fs::write(folder.join(name), "{}").unwrap();
        }
        let found = lavapipe_files(&[&folder, Path::new("/no/such/folder")]);
        std::fs::remove_dir_all(&folder).unwrap();
        assert_eq!(found, [folder.join("lvp_icd.aarch64.json"), folder.join("lvp_icd.x86_64.json")]);
    }
}

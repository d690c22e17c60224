//! Other people's programs on our files: the checks in `tests/third_party`, with the Python packages and Node modules that they
//! need, pinned there and installed under `target/third-party`.

use std::path::{Path, PathBuf};

use crate::apt;
use crate::steps::{CommandLine, workspace_root};

/// A command that shows a tool to be there, and the Debian package that has it. What the commands print is part of the
/// stamp: another Python does not find the packages of this one.
const TOOLS: [(&str, &str); 5] = [
    ("python3 --version", "python3"),
    ("python3 -m ensurepip --version", "python3-venv"),
    ("node --version", "nodejs"),
    ("npm --version", "npm"),
    ("povray --version", "povray povray-includes"),
];

/// What to do where this program cannot do it itself.
const HOW_TO_INSTALL: &str = "\
the checks with other people's programs need Python 3.11 or newer with venv, Node 18 or newer, npm and POV-Ray 3.7:
  Debian, Ubuntu:  sudo apt-get update && sudo apt-get install --no-install-recommends python3-venv nodejs npm povray povray-includes
  Fedora:          sudo dnf install python3 nodejs npm povray
  Arch:            sudo pacman -S python nodejs npm povray
then run `cargo xtask test` again";

const PYTHON_REQUIREMENTS: &str = "requirements.txt";
const NODE_REQUIREMENTS: [&str; 2] = ["package.json", "package-lock.json"];
const NODE: &str = "target/third-party/node";
const STAMP: &str = "target/third-party/stamp";
/// What our tracer and Mitsuba both trace: folder and options.
const GROUND_TRUTH: [[&str; 2]; 3] = [
    ["museum-direct", "--scene museum --bounces 1 --rays 1000 --samples 256"],
    ["museum-global", "--scene museum --bounces 6 --rays 400 --samples 256"],
    ["mirror-box-global", "--scene mirror-box --bounces 6 --rays 400 --samples 256"],
];
const SAMPLES: &str = "target/third-party/samples";

/// Runs every check in `tests/third_party`, installing first what is missing.
pub(crate) fn run() -> Result<(), String> {
    let tools = match find_tools() {
        Ok(tools) => tools,
        Err(missing) => {
            apt::install(&missing, HOW_TO_INSTALL)?;
            find_tools().map_err(|missing| format!("still missing: {missing}\n{HOW_TO_INSTALL}"))?
        }
    };
    let root = workspace_root();
    install_once(&root, &tools)?;
    write_samples(&root)?;
    venv_python(&root, &format!("tests/third_party/run.py {SAMPLES}")).run()
}

/// What the tools say of themselves, or the packages of those that are missing.
fn find_tools() -> Result<String, String> {
    let (mut versions, mut missing) = (String::new(), Vec::new());
    for (line, package) in TOOLS {
        match CommandLine::new(line).command().output() {
            Ok(output) if output.status.success() => versions += &String::from_utf8_lossy(&output.stdout),
            _ => missing.push(package),
        }
    }
    if missing.is_empty() { Ok(versions) } else { Err(missing.join(" ")) }
}

/// Installs packages and modules unless a stamp says that just these are there, so that no network is needed then.
fn install_once(root: &Path, tools: &str) -> Result<(), String> {
    let (wanted, stamp) = (wanted(root, tools)?, root.join(STAMP));
    if is_installed(&stamp, &wanted) {
        return Ok(());
    }
    // An installation that stops half-way must not leave a stamp.
    if stamp.exists() {
        std::fs::remove_file(&stamp).map_err(|error| format!("cannot remove {}: {error}", stamp.display()))?;
    }
    install(root).map_err(|error| format!("{error}\n{HOW_TO_INSTALL}"))?;
    std::fs::write(&stamp, wanted).map_err(|error| format!("cannot write {}: {error}", stamp.display()))
}

/// All that decides what is installed.
fn wanted(root: &Path, tools: &str) -> Result<String, String> {
    let names = [PYTHON_REQUIREMENTS].into_iter().chain(NODE_REQUIREMENTS);
    let texts: Vec<String> = names.map(|name| read(&source(root, name))).collect::<Result<_, _>>()?;
    Ok(tools.to_owned() + &texts.concat())
}

fn is_installed(stamp: &Path, wanted: &str) -> bool {
    read(stamp).is_ok_and(|installed| installed == wanted)
}

fn install(root: &Path) -> Result<(), String> {
    CommandLine::new("python3 -m venv --clear target/third-party/venv").run()?;
    let pip = "-m pip install --quiet --disable-pip-version-check --only-binary :all: --requirement";
    venv_python(root, &format!("{pip} tests/third_party/{PYTHON_REQUIREMENTS}")).run()?;
    // npm installs beside package.json; the source tree is to stay clean.
    make_folder(&root.join(NODE))?;
    for name in NODE_REQUIREMENTS {
        let (from, to) = (source(root, name), root.join(NODE).join(name));
        std::fs::copy(from, &to).map_err(|error| format!("cannot write {}: {error}", to.display()))?;
    }
    CommandLine::new(&format!("npm ci --prefix {NODE} --ignore-scripts --no-audit --no-fund")).run()
}

/// Writes the files that the checks open, in place of those of an earlier run.
fn write_samples(root: &Path) -> Result<(), String> {
    let folder = root.join(SAMPLES);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).map_err(|error| format!("cannot remove {}: {error}", folder.display()))?;
    }
    make_folder(&folder)?;
    CommandLine::new(&format!("cargo run -q -p lf-exchange --example export_samples --locked -- {SAMPLES}")).run()?;
    for [name, options] in GROUND_TRUTH {
        let out = format!("{SAMPLES}/ground-truth/{name}");
        CommandLine::new(&format!("cargo run -q -p lf-tests --example ground_truth --locked -- {out} {options}"))
            .run()?;
    }
    Ok(())
}

/// A command of the virtual environment's Python. Its path is absolute, as commands run in another folder should have it.
fn venv_python(root: &Path, words: &str) -> CommandLine {
    let mut line = CommandLine::new(words);
    line.words.insert(0, root.join("target/third-party/venv/bin/python").to_string_lossy().into_owned());
    line
}

fn source(root: &Path, name: &str) -> PathBuf {
    root.join("tests/third_party").join(name)
}

fn make_folder(path: &Path) -> Result<(), String> {
    std::fs::create_dir_all(path).map_err(|error| format!("cannot create {}: {error}", path.display()))
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|error| format!("cannot read {}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [&str; 3] = ["requirements.txt", "package.json", "package-lock.json"];

    #[test]
    fn requirements_are_pinned_and_name_no_registry() {
        let texts = NAMES.map(|name| read(&source(&workspace_root(), name)).unwrap());
        assert!(texts[0].lines().all(|line| line.contains("==")), "{}", texts[0]);
        assert!(!texts[1].contains(['^', '~', '*', '>', '<']), "{}", texts[1]);
        // `npm install --package-lock-only --omit-lockfile-registry-resolved` writes the lock file so.
        assert!(texts.iter().all(|text| !text.contains("://")), "{texts:?}");
    }

    #[test]
    fn a_stamp_of_the_same_requirements_saves_the_installation() {
        let root = std::env::temp_dir().join(format!("xtask-stamp-{}", std::process::id()));
        for folder in ["tests/third_party", "target/third-party"] {
            make_folder(&root.join(folder)).unwrap();
        }
        for name in NAMES {
            std::fs::write(source(&root, name), name).unwrap();
        }
        let wanted = wanted(&root, "Python 3\n").unwrap();
        let stamp = root.join(STAMP);
        assert!(!is_installed(&stamp, &wanted));
        std::fs::write(&stamp, &wanted).unwrap();
        assert!(is_installed(&stamp, &wanted));
        assert_ne!(super::wanted(&root, "Python 4\n").unwrap(), wanted);
        for name in NAMES {
            std::fs::write(source(&root, name), "another").unwrap();
            assert_ne!(super::wanted(&root, "Python 3\n").unwrap(), wanted, "{name}");
            std::fs::write(source(&root, name), name).unwrap();
        }
        std::fs::remove_dir_all(&root).unwrap();
    }
}

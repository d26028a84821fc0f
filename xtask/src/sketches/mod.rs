//! `cargo xtask sketches`: Arduino sketches compiled as the Arduino IDE does, without it.
//!
//! Debian's `arduino-core-avr`, `gcc-avr` and `avr-libc`, with the options of the core's `platform.txt` for the Mega:
//! core -> archive; libraries that a sketch includes and its own files -> objects; all of it -> `target/sketches/NAME.elf`.
//! A product carries the hash of all that went into it, and is built again only when that changes.

mod compiler;
mod preprocess;

use std::path::{Path, PathBuf};

use crate::project::Project;
use crate::test::{Stop, tools};
use compiler::Compiler;

/// Folders of sketches: each sketch is a folder with a file of its name.
const FOLDERS: [&str; 3] = [
    "crates/emulator/tests/sketches",
    "crates/experiment/tests/sketches",
    "examples/arduino",
];

/// One of the images of a sketch with build-time options: the suffix of its name, and the macros.
type Variant = (&'static str, &'static [&'static str]);

/// Sketches that make several images.
const VARIANTS: [(&str, &[Variant]); 1] = [(
    "memoria",
    &[
        ("-mode1", &["-DMODE=1"]),
        ("-mode2", &["-DMODE=2"]),
        ("-mode3", &["-DMODE=3"]),
        ("-mode4", &["-DMODE=4"]),
        ("-mode5", &["-DMODE=5"]),
        ("-mode6", &["-DMODE=6"]),
        ("-mode7", &["-DMODE=7"]),
        ("-mode8", &["-DMODE=8"]),
        ("-lane", &["-DMODE=8", "-DLANE=1"]),
    ],
)];

/// Builds every sketch, or reports the missing tool.
pub(crate) fn run(project: &Project) -> Result<bool, String> {
    match build(project) {
        Ok(()) => Ok(true),
        Err(Stop::Failed(error) | Stop::Missing(error)) => Err(error),
    }
}

/// Builds every sketch that has changed.
pub(crate) fn build(project: &Project) -> Result<(), Stop> {
    let core = tools::arduino_core(project)?;
    let out = project.target.join("sketches");
    let libraries = [
        core.join("libraries"),
        project.root.join(FOLDERS[0]).join("libraries"),
    ];
    let compiler = Compiler::new(&core, libraries.into(), out.clone())?;
    compiler.build_core()?;
    let (mut built, mut fresh) = (0, 0);
    for sketch in sketches(project)? {
        for (ending, macros) in variants(&sketch) {
            let name = format!("{}{ending}", name_of(&sketch));
            if compiler.build_sketch(&sketch, &name, macros)? {
                println!("built {name}.elf");
                built += 1;
            } else {
                fresh += 1;
            }
        }
    }
    println!("{}: {built} built, {fresh} fresh", out.display());
    Ok(())
}

fn variants(sketch: &Path) -> Vec<Variant> {
    let name = name_of(sketch);
    VARIANTS
        .iter()
        .find(|(known, _)| *known == name)
        .map_or_else(|| vec![("", [].as_slice())], |(_, all)| all.to_vec())
}

fn name_of(folder: &Path) -> String {
    folder
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default()
}

/// The folders of all sketches.
fn sketches(project: &Project) -> Result<Vec<PathBuf>, String> {
    let mut found = Vec::new();
    let folders = FOLDERS.map(|folder| project.root.join(folder));
    for folder in folders.iter().filter(|folder| folder.is_dir()) {
        for path in files_of(folder)? {
            if path.join(format!("{}.ino", name_of(&path))).is_file() {
                found.push(path);
            }
        }
    }
    Ok(found)
}

/// What lies in a folder, sorted.
fn files_of(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries =
        std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    Ok(paths)
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

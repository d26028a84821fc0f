//! `cargo xtask sketches`: every Arduino sketch of the project, compiled to `target/sketches/NAME.elf` by `rumbo-sketch`.

use std::path::{Path, PathBuf};

use crate::project::Project;
use crate::tools::{self, Stop};
use rumbo_sketch::limits::Limits;
use rumbo_sketch::sandbox::Sandbox;
use rumbo_sketch::{BOARDS, Board, Compiler, Given, SketchError, Toolchain, given};

/// Folders of sketches: each sketch is a folder with a file of its name.
const FOLDERS: [&str; 4] = [
    "crates/emulator/tests/sketches",
    "crates/experiment/tests/sketches",
    "examples/arduino",
    LIBRARY,
];
/// The examples of the library, which are for every board.
const LIBRARY: &str = "examples/arduino/RumboRobot/examples";
/// The sketches for an Uno.
const OF_UNO: [&str; 2] = ["wall_uno", "line"];

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
    build(project)?;
    Ok(true)
}

/// Builds every sketch that has changed.
pub(crate) fn build(project: &Project) -> Result<(), Stop> {
    tools::arduino_core(project)?;
    tools::bubblewrap(project)?;
    let out = project.target.join("sketches");
    let failed = |error: SketchError| Stop::Failed(error.to_string());
    let compilers = compilers(&out.join("cache")).map_err(failed)?;
    let (mut built, mut fresh) = (0, 0);
    for sketch in sketches(project)? {
        let Given::Sketch(source) = given(&sketch, true).map_err(failed)? else {
            continue;
        };
        let of_library = sketch.starts_with(project.root.join(LIBRARY));
        let is_of_uno = OF_UNO.contains(&source.name.as_str());
        let is_for = |board: &Board| match board.name {
            "uno" => of_library || is_of_uno,
            // The Uno's chip and pins.
            "nano" => false,
            _ => !is_of_uno,
        };
        let compilers = compilers.iter().filter(|(board, _)| is_for(board));
        let images = compilers.flat_map(|(board, compiler)| {
            let variants = variants(&sketch).into_iter();
            variants.map(move |variant| (board, compiler, variant))
        });
        for (board, compiler, (ending, macros)) in images {
            let on = match board.name {
                "uno" => "-uno",
                _ => "",
            };
            let name = format!("{}{ending}{on}", source.name);
            let image = compiler.compile(&source, macros).map_err(failed)?;
            image
                .warnings
                .iter()
                .for_each(|warning| println!("{warning}"));
            let product = out.join(format!("{name}.elf"));
            std::fs::copy(&image.path, &product)
                .map_err(|error| format!("{}: {error}", product.display()))?;
            match image.fresh {
                true => fresh += 1,
                false => {
                    println!("built {name}.elf");
                    built += 1;
                }
            }
        }
    }
    println!("{}: {built} built, {fresh} fresh", out.display());
    Ok(())
}

/// A compiler for each board.
fn compilers(cache: &Path) -> Result<Vec<(Board, Compiler)>, SketchError> {
    let toolchain = Toolchain::find()?;
    println!("{}", toolchain.in_words());
    let sandbox = Sandbox::trusting(Limits::default());
    let compilers = BOARDS.into_iter().map(|board| {
        let (toolchain, sandbox) = (toolchain.clone(), sandbox.clone());
        let compiler = Compiler::new(board, toolchain, sandbox, cache.to_owned())?;
        Ok((board, compiler))
    });
    compilers.collect()
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

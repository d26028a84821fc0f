//! From the sources to an image: compiled, squeezed, assembled, linked.
//!
//! cargo builds the image as it would anywhere, and leaves the assembly of all that became one program by optimising at link time.
//! That is what [`squeeze`] works on. What it makes is linked with what cargo's own image is linked with: the arithmetic
//! that `firmware/build.rs` has laid out, and Rust's own for the rest.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use super::squeeze::{self, Options};
use super::toolchain::Toolchain;
use crate::project::{Project, output, run};

/// Names of functions, or parts of them, in which cycles count.
const HOT: &str = "firmware/hot.txt";
/// The chip, for the linker.
const CHIP: &str = "-mmcu=atmega2560";

/// An image, and what was wrong in it.
pub(crate) struct Linked {
    pub(crate) image: PathBuf,
    pub(crate) repaired: usize,
}

/// Builds the image.
pub(crate) fn build(
    project: &Project,
    toolchain: &Toolchain,
    build: &Path,
) -> Result<Linked, String> {
    let assembly = build.join(assembly(project, toolchain)?);
    let messages = output(
        toolchain
            .command("cargo")
            .current_dir(project.root.join("firmware"))
            .args([
                "rustc",
                "--release",
                "--locked",
                "--quiet",
                "--message-format=json",
                "--",
            ])
            .arg(format!("--emit=link,asm={}", assembly.display()))
            .env("CARGO_TARGET_DIR", build),
    )?;
    let read = |path: &Path| {
        std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
    };
    let [hot, warm] = heat(&read(&project.root.join(HOT))?);
    let squeezed = squeeze::squeeze(
        &read(&assembly)?,
        &Options {
            repair: toolchain.misplaces_stack_arguments(build)?,
            hot: &hot,
            warm: &warm,
        },
    )?;
    let source = build.join("rumbo.s");
    std::fs::write(&source, squeezed.assembly)
        .map_err(|error| format!("{}: {error}", source.display()))?;
    let object = source.with_extension("o");
    run(Command::new("avr-gcc")
        .args([CHIP, "-c", "-o"])
        .args([&object, &source]))?;
    let image = build.join("rumbo.elf");
    run(Command::new("avr-gcc")
        .args([CHIP, "-nodefaultlibs", "-Wl,--gc-sections", "-o"])
        .args([&image, &object])
        .args(libraries(&messages)?)
        .arg("-lgcc"))?;
    Ok(Linked {
        image,
        repaired: squeezed.repaired,
    })
}

/// The file of the assembly. Each compiler and each set of its options has one: cargo keeps what it has built of each, and when one comes
/// back, it writes nothing.
fn assembly(project: &Project, toolchain: &Toolchain) -> Result<String, String> {
    let mut hasher = DefaultHasher::new();
    output(toolchain.command("rustc").arg("-vV"))?.hash(&mut hasher);
    for file in ["firmware/.cargo/config.toml", "firmware/Cargo.toml"] {
        let path = project.root.join(file);
        std::fs::read(&path)
            .map_err(|error| format!("{}: {error}", path.display()))?
            .hash(&mut hasher);
    }
    Ok(format!("compiled-{:016x}.s", hasher.finish()))
}

/// Hot and warm paths as they are in the names of the compiler's symbols: each word behind its length.
fn heat(text: &str) -> [Vec<String>; 2] {
    let mut heat = [Vec::new(), Vec::new()];
    let lines = text.lines().filter_map(|line| line.split('#').next());
    for line in lines.map(str::trim).filter(|line| !line.is_empty()) {
        let warm = line.strip_prefix("warm ");
        let words = warm.unwrap_or(line).trim().split("::");
        let path = words.map(|word| format!("{}{word}", word.len())).collect();
        heat[usize::from(warm.is_some())].push(path);
    }
    heat
}

/// What cargo links with the program: objects of the build script, and Rust's arithmetic.
fn libraries(messages: &str) -> Result<Vec<PathBuf>, String> {
    let messages = messages
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let mut found = Vec::new();
    let mut arithmetic = Vec::new();
    for message in messages {
        let of = |name: &str| {
            message["package_id"]
                .as_str()
                .is_some_and(|id| id.contains(name))
        };
        if message["reason"] == "build-script-executed" && of("rumbo-firmware") {
            let folder = Path::new(message["out_dir"].as_str().unwrap_or_default());
            let files = std::fs::read_dir(folder)
                .map_err(|error| format!("{}: {error}", folder.display()))?;
            let paths = files.filter_map(|file| file.ok().map(|file| file.path()));
            found.extend(
                paths.filter(|path| path.extension().is_some_and(|extension| extension == "o")),
            );
            found.sort();
        }
        if message["reason"] == "compiler-artifact"
            && message["target"]["name"] == "compiler_builtins"
        {
            let files = message["filenames"]
                .as_array()
                .into_iter()
                .flatten()
                .filter_map(Value::as_str);
            arithmetic.extend(
                files
                    .filter(|file| file.ends_with(".rlib"))
                    .map(PathBuf::from),
            );
        }
    }
    if found.is_empty() || arithmetic.is_empty() {
        return Err("cargo does not say what the image is linked with".to_owned());
    }
    found.extend(arithmetic);
    Ok(found)
}

impl Toolchain {
    /// Whether the compiler reads arguments on the stack one byte too low: asked by a function that does nothing else.
    fn misplaces_stack_arguments(&self, build: &Path) -> Result<bool, String> {
        let source = build.join("stack_argument.rs");
        let assembly = build.join("stack_argument.s");
        std::fs::write(&source, include_str!("stack_argument.txt"))
            .map_err(|error| format!("{}: {error}", source.display()))?;
        output(
            self.command("rustc")
                .args([
                    "--target=avr-none",
                    "-Ctarget-cpu=atmega2560",
                    "-O",
                    "--emit=asm",
                    "-Awarnings",
                    "-o",
                ])
                .args([&assembly, &source]),
        )?;
        let text = std::fs::read_to_string(&assembly)
            .map_err(|error| format!("{}: {error}", assembly.display()))?;
        // Two bytes pushed, and the return address of three: the argument begins at 6.
        if text.contains("ldd\tr22, Y+5") {
            Ok(true)
        } else if text.contains("ldd\tr22, Y+6") {
            Ok(false)
        } else {
            Err(format!(
                "{}: not the code that is known",
                assembly.display()
            ))
        }
    }
}

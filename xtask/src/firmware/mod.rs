//! `cargo xtask firmware`: the image for the Mega, whole, with its sizes.
//!
//! cargo builds `firmware/` with a Rust for the AVR ([`toolchain`]). Then the image is checked for forbidden content
//! ([`image`], [`stack_arguments`], [`indirect`]), its debugging information is corrected ([`debugging`]) and its hash is written
//! into it. The product is `target/firmware/rumbo.elf` and `rumbo.hex`. More flash or SRAM than the robot file allows
//! is an error ([`sizes`]).

mod debugging;
mod image;
mod indirect;
mod sizes;
mod stack_arguments;
pub(crate) mod toolchain;

use std::path::Path;

use crate::project::{Project, output, run as run_command};
use crate::tools::Stop;
use sizes::Sizes;
use toolchain::Toolchain;

/// The robot whose caps hold.
const ROBOT: &str = "robots/memoria.toml";

/// Builds the image, or reports the missing tool.
pub(crate) fn run(project: &Project) -> Result<bool, String> {
    build(project)?;
    Ok(true)
}

/// Builds the image and checks it.
pub(crate) fn build(project: &Project) -> Result<(), Stop> {
    let toolchain = Toolchain::find(project)?;
    println!("{}", toolchain.describe()?);
    let build = project.target.join("firmware/build");
    run_command(
        toolchain
            .command("cargo")
            .current_dir(project.root.join("firmware"))
            .args(["build", "--release", "--locked", "--quiet"])
            .env("CARGO_TARGET_DIR", &build),
    )?;
    let linked = build.join("avr-none/release/rumbo.elf");
    let sizes = check(project, &linked)?;
    let elf = project.target.join("firmware/rumbo.elf");
    let hash = finish(&linked, &elf)?;
    let hex = elf.with_extension("hex");
    run_command(
        project
            .command("avr-objcopy")
            .args(["-O", "ihex", "-R", ".eeprom"])
            .args([&elf, &hex]),
    )?;
    println!("{sizes}hash {hash:08x}");
    println!("{}\n{}", elf.display(), hex.display());
    Ok(within_caps(project, &sizes)?)
}

/// Rejects forbidden content; measures the image.
fn check(project: &Project, linked: &Path) -> Result<Sizes, String> {
    let disassembly = output(
        project
            .command("avr-objdump")
            .args(["-d", "--no-show-raw-insn"])
            .arg(linked),
    )?;
    stack_arguments::check(&disassembly)?;
    indirect::check(&disassembly)?;
    let bytes = read(linked)?;
    let wrong = |error: object::read::Error| format!("{}: {error}", linked.display());
    let file = object::File::parse(&*bytes).map_err(wrong)?;
    image::check(&file)?;
    Sizes::of(&file).map_err(wrong)
}

/// Turns the linked image into the final one; returns its hash.
fn finish(linked: &Path, elf: &Path) -> Result<u32, String> {
    let mut bytes = debugging::mend(&read(linked)?)?;
    let hash = image::stamp(&mut bytes)?;
    std::fs::write(elf, bytes).map_err(|error| format!("{}: {error}", elf.display()))?;
    Ok(hash)
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// The caps of the robot file.
fn within_caps(project: &Project, sizes: &Sizes) -> Result<(), String> {
    let text = std::fs::read_to_string(project.root.join(ROBOT))
        .map_err(|error| format!("{ROBOT}: {error}"))?;
    let robot: toml::Table = text.parse().map_err(|error| format!("{ROBOT}: {error}"))?;
    for (key, used) in [
        ("flash_bytes", sizes.whole.flash),
        ("sram_bytes", sizes.whole.sram),
    ] {
        let cap = robot.get("firmware").and_then(|table| table.get(key));
        let cap = cap.and_then(toml::Value::as_integer);
        let cap = cap.ok_or_else(|| format!("{ROBOT}: no `{key}` in [firmware]"))?;
        println!("{key}: {used} of {cap}");
        if used > cap.unsigned_abs() {
            return Err(format!(
                "the image takes {used} {key}, {ROBOT} allows {cap}"
            ));
        }
    }
    Ok(())
}

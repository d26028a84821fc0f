//! `cargo xtask firmware`: the image for the Mega, whole, with its sizes.
//!
//! `firmware/` is built by cargo with a Rust for the AVR ([`toolchain`]); then the image is finished ([`image`]): its hash
//! written into it, and what must not be in it looked for. The product is `target/firmware/rumbo.elf` and `rumbo.hex`. More
//! flash or SRAM than the robot file allows is an error.

mod image;
mod toolchain;

use std::path::Path;

use crate::project::{Project, run as run_command};
use crate::test::Stop;
use toolchain::Toolchain;

/// The robot whose caps hold.
const ROBOT: &str = "robots/memoria.toml";

/// Builds the image; says which tool is missing otherwise.
pub(crate) fn run(project: &Project) -> Result<bool, String> {
    match build(project) {
        Ok(()) => Ok(true),
        Err(Stop::Failed(error) | Stop::Missing(error)) => Err(error),
    }
}

/// Builds the image and checks its sizes.
pub(crate) fn build(project: &Project) -> Result<(), Stop> {
    let toolchain = Toolchain::find(project)?;
    let build = project.target.join("firmware/build");
    run_command(
        toolchain
            .command("cargo")
            .current_dir(project.root.join("firmware"))
            .args(["build", "--release", "--locked", "--quiet"])
            .env("CARGO_TARGET_DIR", &build),
    )?;
    let mut bytes = read(&build.join("avr-none/release/rumbo.elf"))?;
    let report = image::finish(&mut bytes)?;
    let elf = project.target.join("firmware/rumbo.elf");
    let hex = elf.with_extension("hex");
    std::fs::write(&elf, bytes).map_err(|error| format!("{}: {error}", elf.display()))?;
    run_command(
        project
            .command("avr-objcopy")
            .args(["-O", "ihex", "-R", ".eeprom"])
            .args([&elf, &hex]),
    )?;
    println!("{report}");
    println!("{}\n{}", elf.display(), hex.display());
    Ok(check(project, &report)?)
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// The caps of the robot file.
fn check(project: &Project, report: &image::Report) -> Result<(), String> {
    let text = std::fs::read_to_string(project.root.join(ROBOT))
        .map_err(|error| format!("{ROBOT}: {error}"))?;
    for (key, used) in [
        ("flash_bytes", report.flash_bytes()),
        ("sram_bytes", report.sram_bytes()),
    ] {
        let cap = cap(&text, key).ok_or_else(|| format!("{ROBOT}: no `{key}` in [firmware]"))?;
        println!("{key}: {used} of {cap}");
        if used > cap {
            return Err(format!(
                "the image takes {used} {key}, {ROBOT} allows {cap}"
            ));
        }
    }
    Ok(())
}

/// A number of the table `[firmware]`.
fn cap(robot: &str, key: &str) -> Option<u64> {
    let (_, table) = robot.split_once("[firmware]")?;
    let lines = table.lines().take_while(|line| !line.starts_with('['));
    lines
        .filter_map(|line| line.split_once('='))
        .find(|(name, _)| name.trim() == key)
        .and_then(|(_, value)| value.trim().parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn caps_come_from_the_firmware_table() {
        let robot = "flash_bytes = 1\n[firmware]\nflash_bytes = 131072\nsram_bytes = 3072\n[parameters]\nx = 2\n";
        assert_eq!(cap(robot, "flash_bytes"), Some(131_072));
        assert_eq!(cap(robot, "sram_bytes"), Some(3_072));
        assert_eq!(cap(robot, "x"), None);
    }
}

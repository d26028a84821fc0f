//! Links the arithmetic of avr-libc and libgcc.
//!
//! The functions that come with Rust's library for the AVR are written for any processor and take four to seven times
//! as long. Both are there under the same names; those here are strong symbols, which win over the weak ones of Rust's.
//! Sums and comparisons, of which a tick has the most, are our own (`src/float.S`), with avr-libc's for what is rare.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The functions taken from a library, and its members that contain them.
const LIBRARIES: [(&str, &[&str]); 3] = [
    (
        "libm.a",
        &[
            "addsf3",
            "addsf3x",
            "divsf3",
            "divsf3x",
            "fixsfsi",
            "fixunssfsi",
            "floatsisf",
            "fp_inf",
            "fp_mintl",
            "fp_mpack",
            "fp_nan",
            "fp_norm2",
            "fp_pscA",
            "fp_pscB",
            "fp_round",
            "fp_split3",
            "fp_trunc",
            "fp_zero",
            "mulsf3",
            "mulsf3x",
            "negsf2",
            "sqrt",
        ],
    ),
    ("libc.a", &["memcmp", "memcpy", "memmove", "memset"]),
    (
        "libgcc.a",
        &[
            "_divmodhi4",
            "_divmodqi4",
            "_divmodsi4",
            "_muldi3",
            "_muldi3_6",
            "_negsi2",
            "_udivmodhi4",
            "_udivmodqi4",
            "_udivmodsi4",
        ],
    ),
];

/// What avr-libc's sum is called, for our own to call it.
const RENAMED: [&str; 2] = [
    "--redefine-sym=__addsf3=__addsf3_any",
    "--redefine-sym=__subsf3=__subsf3_any",
];

fn main() -> Result<(), String> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=src/float.S");
    // `cargo xtask firmware` corrects the debugging information with the relocations.
    println!("cargo::rustc-link-arg=-Wl,--emit-relocs");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").ok_or("cargo gives no OUT_DIR")?);
    for (library, members) in LIBRARIES {
        let archive = find(library)?;
        for member in members {
            let object = extract(&archive, member, &out)?;
            if member == &"addsf3" {
                run(Command::new("avr-objcopy").args(RENAMED).arg(&object))?;
            }
            println!("cargo::rustc-link-arg={}", object.display());
        }
    }
    let float = out.join("float.o");
    run(Command::new("avr-gcc")
        .args(["-mmcu=atmega2560", "-c", "src/float.S", "-o"])
        .arg(&float))?;
    println!("cargo::rustc-link-arg={}", float.display());
    Ok(())
}

fn run(command: &mut Command) -> Result<(), String> {
    let name = command.get_program().to_string_lossy().into_owned();
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(format!("{name} failed")),
        Err(error) => Err(format!("{name}: {error}; install gcc-avr and binutils-avr")),
    }
}

/// Where avr-gcc has a library for this chip.
fn find(library: &str) -> Result<PathBuf, String> {
    let asked = Command::new("avr-gcc")
        .args(["-mmcu=atmega2560", &format!("-print-file-name={library}")])
        .output()
        .map_err(|error| format!("avr-gcc: {error}; install gcc-avr and avr-libc"))?;
    let path = PathBuf::from(String::from_utf8_lossy(&asked.stdout).trim());
    if path.is_absolute() {
        Ok(path)
    } else {
        Err(format!(
            "avr-gcc has no {library} for the ATmega2560; install avr-libc"
        ))
    }
}

fn extract(archive: &Path, member: &str, out: &Path) -> Result<PathBuf, String> {
    let file = format!("{member}.o");
    let done = Command::new("avr-ar")
        .current_dir(out)
        .arg("x")
        .arg(archive)
        .arg(&file)
        .status()
        .map_err(|error| format!("avr-ar: {error}; install binutils-avr"))?;
    if done.success() {
        Ok(out.join(file))
    } else {
        Err(format!("{} has no {file}", archive.display()))
    }
}

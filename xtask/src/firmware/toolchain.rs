//! Compilers that can build for the AVR: Debian's packages, or a nightly of rustup.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::project::{Project, find_program, output};
use crate::test::{Stop, tools};

const DEBIAN: [&str; 6] = [
    "rustc-web",
    "cargo-web",
    "rust-web-src",
    "gcc-avr",
    "avr-libc",
    "binutils-avr",
];

/// A Rust for the AVR.
#[derive(Debug)]
pub(crate) enum Toolchain {
    /// In `/usr/bin`, from Debian's packages.
    Debian,
    /// rustup's nightly, with the sources of the library.
    Nightly(PathBuf),
}

impl Toolchain {
    /// Finds one, or installs Debian's where that is possible.
    pub(crate) fn find(project: &Project) -> Result<Self, Stop> {
        let find = || {
            find_program("avr-gcc")?;
            debian().or_else(nightly)
        };
        tools::install(
            project,
            "Rust for the AVR (and avr-gcc, avr-libc)",
            &DEBIAN,
            "`rustup toolchain install nightly --component rust-src`, and avr-gcc with avr-libc",
            find,
        )
    }

    /// A command of this toolchain, `cargo` or `rustc`, free of what the cargo around us has set.
    pub(crate) fn command(&self, program: &str) -> Command {
        let mut command = match self {
            Self::Debian => {
                let mut command = Command::new(Path::new("/usr/bin").join(program));
                // The package is a release; only a nightly may build its own library.
                command
                    .env("RUSTC_BOOTSTRAP", "1")
                    .env("PATH", "/usr/bin:/bin");
                command
            }
            Self::Nightly(rustup) => {
                let mut command = Command::new(rustup);
                command.args(["run", "nightly", program]);
                command
            }
        };
        for name in [
            "CARGO",
            "RUSTC",
            "RUSTDOC",
            "RUSTFLAGS",
            "RUSTUP_TOOLCHAIN",
            "CARGO_ENCODED_RUSTFLAGS",
        ] {
            command.env_remove(name);
        }
        command
    }
}

fn debian() -> Option<Toolchain> {
    has_sources(&Toolchain::Debian).then_some(Toolchain::Debian)
}

fn nightly() -> Option<Toolchain> {
    let toolchain = Toolchain::Nightly(find_program("rustup")?);
    has_sources(&toolchain).then_some(toolchain)
}

/// Whether it is there, knows the chip, and has the sources of the library.
fn has_sources(toolchain: &Toolchain) -> bool {
    let ask = |what: &str| output(toolchain.command("rustc").args(["--print", what]));
    let knows = ask("target-list").is_ok_and(|list| list.lines().any(|line| line == "avr-none"));
    let sources = ask("sysroot").is_ok_and(|root| {
        Path::new(root.trim())
            .join("lib/rustlib/src/rust/library/core")
            .is_dir()
    });
    knows && sources
}

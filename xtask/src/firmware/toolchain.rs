//! Compilers that can build for the AVR: the nightly that `firmware/rust-toolchain.toml` names, or Debian's packages.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::project::{Project, find_program, output};
use crate::tools::{self, Stop};

/// The file that pins the nightly; cargo in that folder obeys it too.
const PIN: &str = "firmware/rust-toolchain.toml";
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
    /// The pinned nightly, with the sources of the library: rustup, and its name there.
    Nightly(PathBuf, String),
    /// In `/usr/bin`, from Debian's packages.
    Debian,
}

impl Toolchain {
    /// Finds one, or installs Debian's where that is possible.
    pub(crate) fn find(project: &Project) -> Result<Self, Stop> {
        let pinned = pinned(project)?;
        let find = || {
            find_program("avr-gcc")?;
            let nightly = find_program("rustup").map(|it| Self::Nightly(it, pinned.clone()));
            nightly.into_iter().chain([Self::Debian]).find(has_sources)
        };
        let nightly = format!(
            "or `rustup toolchain install {pinned} --component rust-src`, and avr-gcc with avr-libc"
        );
        let name = "Rust for the AVR (and avr-gcc, avr-libc)";
        tools::install(project, name, &DEBIAN, &nightly, find)
    }

    /// The compiler's description, in one line.
    pub(crate) fn describe(&self) -> Result<String, String> {
        let version = output(self.command("rustc").arg("-vV"))?;
        let mut lines = version.lines();
        let rustc = lines.next().unwrap_or_default();
        let llvm = lines.next_back().unwrap_or_default();
        Ok(match self {
            Self::Nightly(_, name) => format!("{rustc}, {llvm}: {name}, as {PIN} pins it"),
            Self::Debian => format!("{rustc}, {llvm}: Debian's rustc-web, not the pinned nightly"),
        })
    }

    /// A command of this toolchain, `cargo` or `rustc`, without the environment set by the outer cargo.
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
            Self::Nightly(rustup, name) => {
                let mut command = Command::new(rustup);
                command.args(["run", name, program]);
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

/// The name of the pinned nightly.
fn pinned(project: &Project) -> Result<String, String> {
    let text = std::fs::read_to_string(project.root.join(PIN));
    let text = text.map_err(|error| format!("{PIN}: {error}"))?;
    let table: toml::Table = text.parse().map_err(|error| format!("{PIN}: {error}"))?;
    let channel = table.get("toolchain").and_then(|it| it.get("channel"));
    let channel = channel.and_then(toml::Value::as_str);
    let missing = || format!("{PIN}: no `channel` in [toolchain]; it names a nightly");
    Ok(channel.ok_or_else(missing)?.to_owned())
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

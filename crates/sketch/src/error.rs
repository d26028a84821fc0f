//! Why a sketch did not become an image.

use crate::diagnostics::Diagnostic;
use std::fmt;
use std::path::Path;
use std::time::Duration;

/// Why a sketch did not become an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SketchError {
    /// No compiler with an Arduino core is installed.
    NoCompiler,
    /// The source is not trusted and cannot be isolated: why.
    NoSandbox(String),
    /// A file or folder cannot be read or written.
    File {
        /// Its path.
        path: String,
        /// The system's error.
        reason: String,
    },
    /// There is no sketch at this path.
    NoSketch(String),
    /// The source is larger than a sketch can be, or holds something that no sketch holds: what.
    Refused(String),
    /// The compiler or the linker rejected it; at least one error.
    Rejected(Vec<Diagnostic>),
    /// The compiler exceeded a limit: which.
    Exceeded(String),
    /// No example has this name; those there are.
    NoExample(String, Vec<String>),
}

impl SketchError {
    pub(crate) fn file(path: &Path, reason: impl fmt::Display) -> Self {
        Self::File {
            path: path.display().to_string(),
            reason: reason.to_string(),
        }
    }

    pub(crate) fn too_slow(allowed: Duration) -> Self {
        Self::Exceeded(format!(
            "the compiler was not done after {} s; does a template or an #include call itself?",
            allowed.as_secs()
        ))
    }
}

impl fmt::Display for SketchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoCompiler => f.write_str(
                "no compiler for Arduino boards is installed: `apt install gcc-avr avr-libc arduino-core-avr`, \
                 or `arduino-cli core install arduino:avr`",
            ),
            Self::NoSandbox(reason) => write!(
                f,
                "untrusted source is compiled in a sandbox only, and there is none ({reason}): `apt install bubblewrap`, \
                 or --trust if you know who wrote it"
            ),
            Self::File { path, reason } => write!(f, "{path}: {reason}"),
            Self::NoSketch(path) => write!(
                f,
                "{path}: no sketch here; give a folder with an .ino file, an .ino, or the .elf or .hex that a compiler made"
            ),
            Self::Refused(what) | Self::Exceeded(what) => f.write_str(what),
            Self::Rejected(diagnostics) => {
                for (index, diagnostic) in diagnostics.iter().enumerate() {
                    let separator = if index == 0 { "" } else { "\n" };
                    write!(f, "{separator}{diagnostic}")?;
                }
                Ok(())
            }
            Self::NoExample(name, known) => {
                write!(f, "no example `{name}`; there are {}", known.join(", "))
            }
        }
    }
}

impl std::error::Error for SketchError {}

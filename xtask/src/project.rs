//! Where the project is, its files, and how programs are run in it.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

/// The compiler with clippy's lints.
const CLIPPY: &str = "clippy-driver";

/// The checkout that the chores work on.
pub(crate) struct Project {
    /// Folder of the root `Cargo.toml`.
    pub(crate) root: PathBuf,
    /// Where cargo puts what it builds.
    pub(crate) target: PathBuf,
    /// `cargo metadata` without dependencies.
    pub(crate) metadata: Value,
    /// `CI=true` is set: what cannot be checked is a failure.
    pub(crate) ci: bool,
    /// The full check, not the gate.
    pub(crate) full: bool,
}

impl Project {
    /// The project that this program was built from.
    pub(crate) fn find() -> Result<Self, String> {
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        let root = here.parent().unwrap_or(here).to_owned();
        let metadata = metadata(&root.join("Cargo.toml"))?;
        let target = metadata["target_directory"]
            .as_str()
            .ok_or("cargo metadata gives no target directory")?
            .into();
        let ci = std::env::var("CI").is_ok_and(|value| value == "true" || value == "1");
        Ok(Self {
            root,
            target,
            metadata,
            ci,
            full: false,
        })
    }

    /// A program started in the project's root; a `rumbo` in it records outside the developer's own logs.
    pub(crate) fn command(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.root);
        command.env("RUMBO_LOGS", self.target.join("logs"));
        command
    }

    /// The cargo that runs this program, started in the project's root.
    pub(crate) fn cargo(&self, args: &[&str]) -> Command {
        let mut command = self.command(cargo_program());
        command.args(args);
        command
    }

    /// A command of cargo that builds libraries, programs and tests in one go, which share all crates: any part of it by
    /// itself has other features, and with them other crates.
    pub(crate) fn build_all(&self) -> Command {
        self.linted(&["build", "--workspace", "--all-targets", "--locked"])
    }

    /// A command of cargo in whose builds clippy's compiler takes the place of rustc for the project's own crates, where
    /// it is installed: it finds what clippy finds while it compiles, so that nothing is read a second time for the lints.
    pub(crate) fn linted(&self, args: &[&str]) -> Command {
        let mut command = self.cargo(args);
        if self.builds_lint() {
            command.env("RUSTC_WORKSPACE_WRAPPER", CLIPPY);
        }
        command
    }

    /// Whether [`Self::linted`] builds find what clippy finds. Not on Windows, which keeps the file of a running program:
    /// this one is built again too.
    pub(crate) fn builds_lint(&self) -> bool {
        cfg!(not(windows)) && find_program(CLIPPY).is_some()
    }

    /// Builds a program of the workspace beside the tests, and returns its path.
    pub(crate) fn program(&self, name: &str) -> Result<PathBuf, String> {
        run(self.build_all().arg("--quiet"))?;
        let name = format!("{name}{}", std::env::consts::EXE_SUFFIX);
        Ok(self.target.join("debug").join(name))
    }

    /// The `rumbo` of the tests.
    pub(crate) fn rumbo(&self) -> Result<PathBuf, String> {
        self.program("rumbo")
    }

    /// Builds the release binary of `rumbo` (does nothing when it is fresh) and returns its path.
    pub(crate) fn release_binary(&self) -> Result<PathBuf, String> {
        run(&mut self.cargo(&["build", "--release", "--locked"]))?;
        Ok(self.release_binary_path())
    }

    /// Where [`Self::release_binary`] puts it.
    pub(crate) fn release_binary_path(&self) -> PathBuf {
        let name = format!("rumbo{}", std::env::consts::EXE_SUFFIX);
        self.target.join("release").join(name)
    }

    /// Paths, relative to the root, of the files under version control or about to be.
    pub(crate) fn files(&self) -> Result<Vec<PathBuf>, String> {
        let list = output(self.command("git").args([
            "ls-files",
            "-z",
            "--cached",
            "--others",
            "--exclude-standard",
        ]))?;
        let mut files: Vec<PathBuf> = list
            .split('\0')
            .filter(|path| !path.is_empty())
            .map(PathBuf::from)
            .collect();
        files.retain(|path| self.root.join(path).is_file());
        files.sort();
        files.dedup();
        Ok(files)
    }
}

/// `cargo metadata` of the workspace of `manifest`, without dependencies.
pub(crate) fn metadata(manifest: &Path) -> Result<Value, String> {
    metadata_with(manifest, &["--no-deps"])
}

/// The same with all dependencies, of all features.
pub(crate) fn all_metadata(manifest: &Path) -> Result<Value, String> {
    metadata_with(manifest, &["--all-features", "--locked"])
}

/// The same with the dependencies that default features have on this machine.
pub(crate) fn host_metadata(project: &Project) -> Result<Value, String> {
    let host = output(project.command("rustc").args(["--print", "host-tuple"]))?;
    let options = ["--locked", "--filter-platform", host.trim()];
    metadata_with(&project.root.join("Cargo.toml"), &options)
}

fn metadata_with(manifest: &Path, options: &[&str]) -> Result<Value, String> {
    let mut command = Command::new(cargo_program());
    command
        .args(["metadata", "--format-version", "1", "--manifest-path"])
        .arg(manifest)
        .args(options);
    serde_json::from_str(&output(&mut command)?).map_err(|error| format!("cargo metadata: {error}"))
}

/// Runs a program to its end with its output shown; an error names the program and its failure.
pub(crate) fn run(command: &mut Command) -> Result<(), String> {
    let status = command
        .stdin(Stdio::null())
        .status()
        .map_err(|error| format!("{}: {error}", shown(command)))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("`{}` failed: {status}", shown(command)))
    }
}

/// Runs a program to its end and returns its standard output.
pub(crate) fn output(command: &mut Command) -> Result<String, String> {
    let output = command
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("{}: {error}", shown(command)))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        let errors = String::from_utf8_lossy(&output.stderr);
        Err(format!(
            "`{}` failed: {}\n{}",
            shown(command),
            output.status,
            errors.trim_end()
        ))
    }
}

/// The place of a program on the search path.
pub(crate) fn find_program(name: &str) -> Option<PathBuf> {
    let paths = std::env::var_os("PATH")?;
    std::env::split_paths(&paths)
        .map(|folder| folder.join(name))
        .find(|program| program.is_file())
}

/// A command as one would type it.
pub(crate) fn shown(command: &Command) -> String {
    let program = Path::new(command.get_program())
        .file_name()
        .unwrap_or(command.get_program());
    let words: Vec<_> = std::iter::once(program)
        .chain(command.get_args())
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    words.join(" ")
}

fn cargo_program() -> std::ffi::OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

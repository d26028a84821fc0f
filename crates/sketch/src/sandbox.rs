//! Runs a compiler on untrusted source.
//!
//! Its author controls the compiler: `#include`, `.incbin` and templates can read files, fill disks and never end.
//! Every run is bounded in time, memory, size of files and output, and is ended with all its children. For source that
//! is not trusted, `bwrap` also takes away network, processes, and every file but the compiler, the core and the
//! sketch.

use crate::error::SketchError;
use crate::toolchain::{Toolchain, on_path};
use std::ffi::OsString;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Interval at which a compiler is polled.
const LOOK: Duration = Duration::from_millis(4);
/// Path of the build in the sandbox.
const INSIDE: &str = "/build";

/// Limits of a compilation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// For all of a sketch.
    pub time: Duration,
    /// Of each process [MB].
    pub memory_mb: u64,
    /// Of each file it writes [MB].
    pub file_mb: u64,
    /// Of what it prints [bytes].
    pub output: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            time: Duration::from_secs(180),
            memory_mb: 1024,
            file_mb: 32,
            output: 256 << 10,
        }
    }
}

/// How a compiler is run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sandbox {
    /// `bwrap` with what it shows; `None` for source that is trusted.
    walls: Option<Vec<OsString>>,
    limits: Limits,
}

/// How a run ended.
pub(crate) struct Done {
    pub(crate) status: ExitStatus,
    /// What it printed, to stdout and then stderr.
    pub(crate) output: String,
}

impl Sandbox {
    /// Without isolation, for trusted source.
    #[must_use]
    pub fn trusting(limits: Limits) -> Self {
        Self {
            walls: None,
            limits,
        }
    }

    /// Isolated with `bwrap`.
    ///
    /// # Errors
    /// If there is no `bwrap`, or it does not work here.
    pub fn walled(toolchain: &Toolchain, limits: Limits) -> Result<Self, SketchError> {
        let no = |why: &str| SketchError::NoSandbox(why.to_owned());
        let bwrap = on_path("bwrap").ok_or_else(|| no("bwrap is not installed"))?;
        let sandbox = Self {
            walls: Some(walls(bwrap, toolchain)?),
            limits,
        };
        let folder = tempfile::tempdir().map_err(|error| no(&error.to_string()))?;
        let probe = sandbox.run(
            (folder.path(), Path::new(".")),
            &[],
            &toolchain.gcc,
            &["--version".into()],
            Instant::now() + limits.time,
        )?;
        match probe.status.success() {
            true => Ok(sandbox),
            false => Err(no(probe.output.lines().next().unwrap_or("bwrap fails"))),
        }
    }

    /// Limits of a compilation.
    pub(crate) fn limits(&self) -> Limits {
        self.limits
    }

    /// Runs a program in `inner` of the folder `build`, the only one that it may write; it sees the folders of
    /// `libraries` too.
    pub(crate) fn run(
        &self,
        (build, inner): (&Path, &Path),
        libraries: &[PathBuf],
        program: &Path,
        args: &[OsString],
        deadline: Instant,
    ) -> Result<Done, SketchError> {
        let mut line: Vec<OsString> = Vec::new();
        if let Some(walls) = &self.walls {
            line.extend_from_slice(walls);
            for folder in libraries {
                line.extend(["--ro-bind".into(), folder.into(), folder.into()]);
            }
            line.extend(["--bind".into(), build.into(), INSIDE.into()]);
            line.extend(["--chdir".into(), Path::new(INSIDE).join(inner).into()]);
        }
        line.push(program.into());
        line.extend_from_slice(args);
        let mut command = self.limited(&line);
        command
            .current_dir(build.join(inner))
            .env("LC_ALL", "C")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let child = command
            .spawn()
            .map_err(|error| SketchError::file(program, error))?;
        self.watch(child, deadline)
    }

    /// The command line behind limits that its children have too; a shell's `ulimit` sets them.
    fn limited(&self, line: &[OsString]) -> Command {
        if !cfg!(target_os = "linux") {
            let mut command = Command::new(&line[0]);
            command.args(&line[1..]);
            return command;
        }
        let Limits {
            time,
            memory_mb,
            file_mb,
            ..
        } = self.limits;
        let mut command = Command::new("/bin/sh");
        command
            .args([
                "-c",
                r#"ulimit -c 0 && ulimit -t "$1" && ulimit -v "$2" && ulimit -f "$3" && shift 3 && exec "$@""#,
                "sh",
            ])
            .args([
                time.as_secs().max(1).to_string(),
                (memory_mb << 10).to_string(),
                // In blocks of 512 bytes.
                (file_mb << 11).to_string(),
            ])
            .args(line);
        command
    }

    /// Waits for the end, and kills it where it is late or prints too much.
    fn watch(&self, mut child: Child, deadline: Instant) -> Result<Done, SketchError> {
        let most = self.limits.output;
        let reader = |pipe: Option<Box<dyn Read + Send>>| {
            std::thread::spawn(move || {
                let (mut text, mut full) = (Vec::new(), false);
                if let Some(mut pipe) = pipe {
                    // Unreadable output is skipped; excess output is still read, so that the child does not block.
                    let _ = (&mut pipe).take(most as u64).read_to_end(&mut text);
                    full =
                        std::io::copy(&mut pipe, &mut std::io::sink()).is_ok_and(|more| more > 0);
                }
                (text, full)
            })
        };
        let out = reader(child.stdout.take().map(|pipe| Box::new(pipe) as _));
        let err = reader(child.stderr.take().map(|pipe| Box::new(pipe) as _));
        let status = loop {
            match child.try_wait() {
                Ok(Some(status)) => break Some(status),
                Ok(None) if Instant::now() < deadline => std::thread::sleep(LOOK),
                Ok(None) | Err(_) => break None,
            }
        };
        // Also after the child has ended: its own children do not go on.
        end(&mut child);
        let pieces = [out.join(), err.join()].map(Result::unwrap_or_default);
        let Some(status) = status else {
            return Err(SketchError::too_slow(self.limits.time));
        };
        let output: Vec<u8> = pieces.iter().flat_map(|(text, _)| text.clone()).collect();
        let full = pieces.iter().any(|(_, full)| *full);
        let mut output = String::from_utf8_lossy(&output).into_owned();
        if full {
            output += "\nthe compiler printed more than is kept\n";
        }
        Ok(Done { status, output })
    }
}

/// Kills a process and its children.
fn end(child: &mut Child) {
    #[cfg(unix)]
    {
        use rustix::process::{Pid, Signal, kill_process_group};
        // It may have ended by itself.
        let _ = kill_process_group(Pid::from_child(child), Signal::KILL);
    }
    let _ = child.kill();
    let _ = child.wait();
}

/// `bwrap` with everything but the folder of the build.
fn walls(bwrap: PathBuf, toolchain: &Toolchain) -> Result<Vec<OsString>, SketchError> {
    let mut line: Vec<OsString> = vec![bwrap.into()];
    for option in [
        "--unshare-all",
        "--die-with-parent",
        "--new-session",
        "--clearenv",
    ] {
        line.push(option.into());
    }
    for (name, value) in [("LC_ALL", "C"), ("PATH", "/nowhere"), ("TMPDIR", "/tmp")] {
        line.extend(["--setenv", name, value].map(OsString::from));
    }
    line.extend(["--size", "134217728", "--tmpfs", "/tmp"].map(OsString::from));
    line.extend(["--dev", "/dev"].map(OsString::from));
    // Not the user's own libraries: they may hold private files.
    let shown = [toolchain.core.clone()];
    let shown = toolchain.visible.iter().chain(&shown).cloned();
    for path in shown.chain(shared_libraries(toolchain)?) {
        line.extend(["--ro-bind".into(), path.clone().into(), path.into()]);
    }
    Ok(line)
}

/// The libraries that the compiler's programs load.
fn shared_libraries(toolchain: &Toolchain) -> Result<Vec<PathBuf>, SketchError> {
    let no = |error: &dyn std::fmt::Display| SketchError::NoSandbox(format!("ldd: {error}"));
    let mut programs = vec![toolchain.gcc.clone()];
    for name in [
        "cc1",
        "cc1plus",
        "lto1",
        "collect2",
        "lto-wrapper",
        "as",
        "ld",
    ] {
        let output = Command::new(&toolchain.gcc)
            .arg(format!("-print-prog-name={name}"))
            .output()
            .map_err(|error| no(&error))?;
        let path = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        if path.starts_with('/') {
            programs.push(path.into());
        }
    }
    let output = Command::new("ldd")
        .args(&programs)
        .env("LC_ALL", "C")
        .output()
        .map_err(|error| no(&error))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let mut found: Vec<PathBuf> = text
        .lines()
        .filter(|line| line.starts_with(char::is_whitespace))
        .filter_map(|line| line.split_whitespace().find(|word| word.starts_with('/')))
        .map(PathBuf::from)
        .collect();
    found.sort();
    found.dedup();
    Ok(found)
}

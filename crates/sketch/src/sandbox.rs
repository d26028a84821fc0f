//! Runs a compiler on untrusted source.
//!
//! Its author controls the compiler: `#include`, `.incbin` and templates can read files, fill disks and never end.
//! Every run is bounded in time, memory, processes, size of files and output, and is ended with all its children. For
//! source that is not trusted, `bwrap` also takes away network, processes, and every file but the compiler, the core
//! and the sketch. All of them are read-only: a run writes one file, which we have made, and its own bounded `/tmp`,
//! which ends with it. Where a container allows no `bwrap` and is thrown away afterwards, root compiles as the user
//! `nobody`: a run reads what everybody may, so that what it must not see is closed to others.

use crate::census;
use crate::diagnostics::plain;
use crate::error::SketchError;
use crate::limits::Limits;
use crate::toolchain::{Toolchain, on_path};
use std::ffi::OsString;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Interval at which a compiler is polled.
const LOOK: Duration = Duration::from_millis(4);
/// Its processes and memory are counted at every so many looks.
const COUNT: u32 = 5;
/// Path of the build in the sandbox.
const INSIDE: &str = "/build";

/// The user and the group `nobody`, and what makes a process theirs; it is of util-linux, which every Linux has.
#[cfg(unix)]
const NOBODY: u32 = 65_534;
#[cfg(unix)]
const AS_NOBODY: [&str; 6] = [
    "setpriv",
    "--reuid=65534",
    "--regid=65534",
    "--clear-groups",
    "--no-new-privs",
    "--",
];

/// How a compiler is run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sandbox {
    walls: Walls,
    limits: Limits,
}

/// What keeps a compiler from what is not its own.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Walls {
    /// Nothing: the source is trusted.
    None,
    /// `bwrap` with what it shows.
    Bwrap(Vec<OsString>),
    /// It runs as `nobody`.
    User,
}

/// A run of a program.
pub(crate) struct Task<'a, R> {
    /// Folder of the build, which the program sees.
    pub(crate) build: &'a Path,
    /// Folder in it where the program runs.
    pub(crate) inner: &'a str,
    /// The file in it that the program makes.
    pub(crate) writes: Option<&'a Path>,
    /// Files and folders elsewhere that it sees.
    pub(crate) reads: R,
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
            walls: Walls::None,
            limits,
        }
    }

    /// Without namespaces, as the user `nobody`: for root in a container that is thrown away.
    ///
    /// # Errors
    /// If this process is not root's, or the compiler does not run for that user.
    pub fn as_nobody(toolchain: &Toolchain, limits: Limits) -> Result<Self, SketchError> {
        let sandbox = Self {
            walls: Walls::User,
            limits,
        };
        sandbox.probe(toolchain).map(|()| sandbox)
    }

    /// Isolated with `bwrap`.
    ///
    /// # Errors
    /// If there is no `bwrap`, or it does not work here.
    pub fn walled(toolchain: &Toolchain, limits: Limits) -> Result<Self, SketchError> {
        let no = |why: &str| SketchError::NoSandbox(why.to_owned());
        let bwrap = on_path("bwrap").ok_or_else(|| no("bwrap is not installed"))?;
        if cfg!(target_os = "linux") && !Path::new("/proc/thread-self/children").exists() {
            return Err(no("this system does not list the children of a process"));
        }
        let walls = walls(bwrap, toolchain, limits)?;
        let sandbox = |more: &[&str]| Self {
            walls: Walls::Bwrap(
                walls
                    .iter()
                    .cloned()
                    .chain(more.iter().map(OsString::from))
                    .collect(),
            ),
            limits,
        };
        // From version 0.8 of bwrap, and not in every container.
        let strict = sandbox(&["--unshare-user", "--disable-userns"]);
        if strict.probe(toolchain).is_ok() {
            return Ok(strict);
        }
        let sandbox = sandbox(&[]);
        sandbox.probe(toolchain).map(|()| sandbox)
    }

    /// Whether a compiler runs in it.
    fn probe(&self, toolchain: &Toolchain) -> Result<(), SketchError> {
        let no = |why: &str| SketchError::NoSandbox(why.to_owned());
        let folder = tempfile::tempdir().map_err(|error| no(&error.to_string()))?;
        let task = Task {
            build: folder.path(),
            inner: ".",
            writes: None,
            reads: std::iter::empty(),
        };
        let version = ["--version".into()];
        let deadline = Instant::now() + self.limits.time;
        let probe = self.run(task, &toolchain.gcc, &version, deadline)?;
        match probe.status.success() {
            true => Ok(()),
            false => Err(no(probe.output.lines().next().unwrap_or("bwrap fails"))),
        }
    }

    /// Limits of a compilation.
    pub(crate) fn limits(&self) -> Limits {
        self.limits
    }

    /// Runs a program.
    pub(crate) fn run<'a>(
        &self,
        task: Task<'a, impl Iterator<Item = &'a Path>>,
        program: &Path,
        args: &[OsString],
        deadline: Instant,
    ) -> Result<Done, SketchError> {
        let place = task.build.join(task.inner);
        let mut line = match &self.walls {
            Walls::None => Vec::new(),
            Walls::Bwrap(walls) => shown(walls, task)?,
            Walls::User => given_to_nobody(task)?,
        };
        line.push(program.into());
        line.extend_from_slice(args);
        let mut command = self.limited(&line);
        command
            .current_dir(place)
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
                r#"ulimit -c 0 && ulimit -n 256 && ulimit -t "$1" && ulimit -v "$2" && ulimit -f "$3" && shift 3 && exec "$@""#,
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
        let mut looks = 0;
        let ended = loop {
            match child.try_wait() {
                Ok(Some(status)) => break Ok(status),
                Ok(None) if Instant::now() < deadline => {}
                Ok(None) | Err(_) => break Err(SketchError::too_slow(self.limits.time)),
            }
            looks += 1;
            if looks % COUNT == 0
                && let Some(what) = census::excess(child.id(), &self.limits)
            {
                break Err(SketchError::Exceeded(format!(
                    "the compiler was ended: it took {what}"
                )));
            }
            std::thread::sleep(LOOK);
        };
        // Also after the child has ended: its own children do not go on.
        end(&mut child);
        let pieces = [out.join(), err.join()].map(Result::unwrap_or_default);
        let status = ended?;
        let output: Vec<u8> = pieces.iter().flat_map(|(text, _)| text.clone()).collect();
        let full = pieces.iter().any(|(_, full)| *full);
        let mut output = plain(&String::from_utf8_lossy(&output));
        if full {
            output += "\nthe compiler printed more than is kept\n";
        }
        Ok(Done { status, output })
    }
}

/// `bwrap` with what it shows of a build.
fn shown<'a>(
    walls: &[OsString],
    task: Task<'a, impl Iterator<Item = &'a Path>>,
) -> Result<Vec<OsString>, SketchError> {
    let mut line = walls.to_vec();
    for path in task.reads {
        line.extend(["--ro-bind".into(), path.into(), path.into()]);
    }
    line.extend(["--ro-bind".into(), task.build.into(), INSIDE.into()]);
    if let Some(product) = task.writes {
        let path = made(task.build, product)?;
        let inside = Path::new(INSIDE).join(product);
        line.extend(["--bind".into(), path.into(), inside.into()]);
    }
    // The root of all of these, where it could make files without bound.
    line.extend(["--remount-ro", "/"].map(OsString::from));
    line.extend(["--chdir".into(), Path::new(INSIDE).join(task.inner).into()]);
    Ok(line)
}

/// What makes the next command `nobody`'s, who may read the build and write its product.
#[cfg(unix)]
fn given_to_nobody<R>(task: Task<'_, R>) -> Result<Vec<OsString>, SketchError> {
    use std::os::unix::fs::{PermissionsExt, chown};
    let build = task.build;
    std::fs::set_permissions(build, std::fs::Permissions::from_mode(0o755))
        .map_err(|error| SketchError::file(build, error))?;
    if let Some(product) = task.writes {
        let path = made(build, product)?;
        chown(&path, Some(NOBODY), Some(NOBODY)).map_err(|error| {
            SketchError::NoSandbox(format!("only root may compile as another user: {error}"))
        })?;
    }
    Ok(AS_NOBODY.map(OsString::from).into())
}

#[cfg(not(unix))]
fn given_to_nobody<R>(_: Task<'_, R>) -> Result<Vec<OsString>, SketchError> {
    Err(SketchError::NoSandbox(
        "this system has no user nobody".into(),
    ))
}

/// The file that a run is to write, which it cannot make by itself.
fn made(build: &Path, product: &Path) -> Result<PathBuf, SketchError> {
    let path = build.join(product);
    File::create_new(&path).map_err(|error| SketchError::file(&path, error))?;
    Ok(path)
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
fn walls(
    bwrap: PathBuf,
    toolchain: &Toolchain,
    limits: Limits,
) -> Result<Vec<OsString>, SketchError> {
    let mut line: Vec<OsString> = vec![bwrap.into()];
    line.extend(
        [
            "--unshare-all",
            "--die-with-parent",
            "--new-session",
            "--clearenv",
            // Who runs us as root has none there either: they would make what is read-only writable again.
            "--cap-drop",
            "ALL",
        ]
        .map(OsString::from),
    );
    for (name, value) in [("LC_ALL", "C"), ("PATH", "/nowhere"), ("TMPDIR", "/tmp")] {
        line.extend(["--setenv", name, value].map(OsString::from));
    }
    // Its intermediate files: preprocessed, assembler, objects of the link.
    let tmp = ((4 * limits.file_mb) << 20).to_string();
    line.extend(["--size", &tmp, "--tmpfs", "/tmp"].map(OsString::from));
    line.extend(["--dev-bind", "/dev/null", "/dev/null"].map(OsString::from));
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

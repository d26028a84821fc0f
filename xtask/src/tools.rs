//! Tools that the checks need: found, installed where that is possible, else named with the remedy.

use std::path::{Path, PathBuf};

use std::time::Duration;

use crate::project::{Project, find_program, output, run};

/// Why a step did not pass.
pub(crate) enum Stop {
    /// The check ran, or should have run, and failed.
    Failed(String),
    /// A tool is missing and cannot be installed from here: its name and how to get it.
    Missing(String),
}

impl From<Stop> for String {
    fn from(stop: Stop) -> Self {
        match stop {
            Stop::Failed(error) | Stop::Missing(error) => error,
        }
    }
}

impl From<String> for Stop {
    fn from(error: String) -> Self {
        Self::Failed(error)
    }
}

/// Interval and number of checks for another running apt.
const AGAIN: Duration = Duration::from_secs(5);
const PATIENCE: u32 = 120;

/// Makes sure that `cargo <subcommand>` exists; rustup installs the component otherwise.
pub(crate) fn component(project: &Project, subcommand: &str, component: &str) -> Result<(), Stop> {
    if output(&mut project.cargo(&[subcommand, "--version"])).is_ok() {
        return Ok(());
    }
    let remedy = format!("cargo {subcommand} is missing: `rustup component add {component}`");
    let rustup = find_program("rustup").ok_or_else(|| Stop::Missing(remedy.clone()))?;
    run(project
        .command(rustup)
        .args(["component", "add", component]))
    .map_err(|_| Stop::Missing(remedy))
}

/// The browser of the environment variable `CHROMIUM`, or an installed one; installs Debian's otherwise.
pub(crate) fn chromium(project: &Project) -> Result<PathBuf, Stop> {
    if let Some(path) = std::env::var_os("CHROMIUM").map(PathBuf::from) {
        let error = || Stop::Failed(format!("CHROMIUM={} is not a file", path.display()));
        return if path.is_file() {
            Ok(path)
        } else {
            Err(error())
        };
    }
    installed_chromium().map_or_else(
        || {
            program(
                project,
                "chromium",
                &["chromium"],
                "or set CHROMIUM to the path of a Chromium",
            )
        },
        Ok,
    )
}

/// A Chromium on the search path.
pub(crate) fn installed_chromium() -> Option<PathBuf> {
    ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find_map(find_program)
}

/// The emulator that ours is compared with, as a separate program.
pub(crate) fn simavr(project: &Project) -> Result<PathBuf, Stop> {
    program(
        project,
        "simavr",
        &["simavr"],
        "https://github.com/buserror/simavr",
    )
}

/// The folder `avr` of the Arduino core; the compiler and its library come with the package.
pub(crate) fn arduino_core(project: &Project) -> Result<PathBuf, Stop> {
    let core = PathBuf::from("/usr/share/arduino/hardware/arduino/avr");
    let find = || (core.is_dir() && find_program("avr-gcc").is_some()).then(|| core.clone());
    install(
        project,
        "the Arduino core",
        &["arduino-core-avr", "gcc-avr", "avr-libc"],
        "Debian's and Ubuntu's packages",
        find,
    )
}

/// The sandbox for sketches that are not trusted.
pub(crate) fn bubblewrap(project: &Project) -> Result<PathBuf, Stop> {
    program(project, "bwrap", &["bubblewrap"], "Linux only")
}

/// What makes a system with nothing else on it.
pub(crate) fn debootstrap(project: &Project) -> Result<PathBuf, Stop> {
    program(project, "debootstrap", &["debootstrap"], "Debian only")
}

/// What unpacks a zip archive with the modes of its files.
pub(crate) fn unzip(project: &Project) -> Result<PathBuf, Stop> {
    program(project, "unzip", &["unzip"], "Debian's package")
}

/// What counts instructions.
pub(crate) fn valgrind(project: &Project) -> Result<PathBuf, Stop> {
    program(project, "valgrind", &["valgrind"], "Linux only")
}

/// The debugger that the tests attach to the emulated chip.
pub(crate) fn avr_gdb(project: &Project) -> Result<PathBuf, Stop> {
    program(project, "avr-gdb", &["gdb-avr"], "GDB for the AVR")
}

/// Python 3 with its environments.
pub(crate) fn python(project: &Project) -> Result<PathBuf, Stop> {
    program(
        project,
        "python3",
        &["python3", "python3-venv"],
        "Python 3.10 or newer",
    )
}

/// A Python with these packages of PyPI, in an environment of this name below the target folder, made once.
pub(crate) fn python_with(
    project: &Project,
    name: &str,
    packages: &[&str],
) -> Result<PathBuf, Stop> {
    let system = python(project)?;
    let folder = project.target.join(name);
    let python = folder.join("bin/python");
    let list = folder.join("packages");
    // What is not there is made.
    if std::fs::read_to_string(&list).is_ok_and(|made| made == packages.join("\n")) {
        return Ok(python);
    }
    let remedy = || {
        Stop::Missing(format!(
            "the packages {} could not be installed; is PyPI reachable, and Debian's python3-venv installed?",
            packages.join(", ")
        ))
    };
    run(project
        .command(system)
        .args(["-m", "venv", "--clear"])
        .arg(&folder))
    .map_err(|_| remedy())?;
    let mut install = project.command(&python);
    install.args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
    ]);
    run(install.args(packages)).map_err(|_| remedy())?;
    std::fs::write(&list, packages.join("\n")).map_err(|error| error.to_string())?;
    Ok(python)
}

/// A C++ compiler, and what it needs of Python.
pub(crate) fn compiler(project: &Project) -> Result<PathBuf, Stop> {
    let packages = ["g++", "python3-dev"];
    program(project, "g++", &packages, "a C++ compiler")
}

/// Node and npm, with the packages of `web/package-lock.json` installed.
pub(crate) fn node(project: &Project) -> Result<PathBuf, Stop> {
    let node = program(project, "node", &["nodejs", "npm"], "Node 20 or newer")?;
    let npm = program(project, "npm", &["npm"], "it comes with Node")?;
    let web = project.root.join("web");
    if !up_to_date(
        &web.join("node_modules/.package-lock.json"),
        &web.join("package-lock.json"),
    ) {
        run(project
            .command(npm)
            .current_dir(&web)
            .args(["ci", "--no-audit", "--no-fund"]))?;
    }
    Ok(node)
}

/// A program on the search path; as root on Debian, `packages` are installed to get it.
fn program(project: &Project, name: &str, packages: &[&str], hint: &str) -> Result<PathBuf, Stop> {
    install(project, name, packages, hint, || find_program(name))
}

/// What `find` finds; as root on Debian, `packages` are installed to get it.
pub(crate) fn install<T>(
    project: &Project,
    name: &str,
    packages: &[&str],
    hint: &str,
    find: impl Fn() -> Option<T>,
) -> Result<T, Stop> {
    if let Some(path) = find() {
        return Ok(path);
    }
    let remedy = format!(
        "{name} is missing: `apt-get install {}` as root ({hint})",
        packages.join(" ")
    );
    let (Some(apt), true) = (find_program("apt-get"), is_root()) else {
        return Err(Stop::Missing(remedy));
    };
    let apt = |arguments: &[&str]| {
        let run = || {
            output(
                project
                    .command(&apt)
                    .envs([("DEBIAN_FRONTEND", "noninteractive"), ("LC_ALL", "C")])
                    .args(arguments),
            )
        };
        when_unlocked(run, PATIENCE, || std::thread::sleep(AGAIN))
    };
    let install = ["-qq", "install", "--yes", "--no-install-recommends"];
    let install = apt(&["-qq", "update"]).and_then(|_| apt(&[&install[..], packages].concat()));
    match (install, find()) {
        (Ok(_), Some(path)) => Ok(path),
        (Err(error), _) => Err(Stop::Missing(format!("{remedy}; {error}"))),
        _ => Err(Stop::Missing(remedy)),
    }
}

/// Runs apt, again while another one holds a lock. apt's own option for it covers the lock of its lists in newer versions
/// only.
fn when_unlocked<T>(
    run: impl Fn() -> Result<T, String>,
    tries: u32,
    wait: impl Fn(),
) -> Result<T, String> {
    for number in 0..tries {
        match run() {
            Err(error) if error.contains("Could not get lock") => {
                if number == 0 {
                    eprintln!("another apt is at work; waiting for it, up to ten minutes");
                }
                wait();
            }
            done => return done,
        }
    }
    run()
}

fn is_root() -> bool {
    output(std::process::Command::new("id").arg("-u")).is_ok_and(|id| id.trim() == "0")
}

fn up_to_date(product: &Path, source: &Path) -> bool {
    let time = |path: &Path| path.metadata().and_then(|data| data.modified()).ok();
    time(product).is_some_and(|made| time(source).is_some_and(|wanted| made >= wanted))
}

#[cfg(test)]
mod tests {
    use super::when_unlocked;
    use std::cell::Cell;

    #[test]
    fn apt_is_run_again_while_another_one_holds_a_lock_and_any_other_failure_is_one() {
        let (runs, waits) = (Cell::new(0), Cell::new(0));
        let apt = |free_after: u32, error: &'static str| {
            runs.set(0);
            waits.set(0);
            let run = || {
                runs.set(runs.get() + 1);
                match runs.get() > free_after {
                    true => Ok(()),
                    false => Err(error.to_owned()),
                }
            };
            let done = when_unlocked(run, 5, || waits.set(waits.get() + 1));
            (done.is_ok(), runs.get(), waits.get())
        };
        let lock = "E: Could not get lock /var/lib/apt/lists/lock. It is held by process 12 (apt)";
        assert_eq!(apt(0, lock), (true, 1, 0));
        assert_eq!(apt(3, lock), (true, 4, 3));
        assert_eq!(apt(99, lock), (false, 6, 5));
        assert_eq!(apt(1, "E: Unable to locate package"), (false, 1, 0));
    }
}

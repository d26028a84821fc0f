//! The Python package: its wheel and its source archive are built, and the wheel is installed and tested, in an environment
//! made for it.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::{Stop, tools};
use crate::project::{Project, output, run};

/// Packages of PyPI; what type checkers find depends on their versions. They need Python 3.11, the wheel itself 3.10.
const PACKAGES: [&str; 11] = [
    "maturin==1.16.0",
    "numpy==2.4.6",
    "gymnasium==1.4.0",
    "jax==0.10.2",
    "optax==0.2.8",
    "pettingzoo==1.27.0",
    "matplotlib==3.11.2",
    "pytest==9.2.0",
    "rosbags==0.11.9",
    "mypy==2.4.1",
    "ruff==0.17.6",
];

/// For its tests and figures on Ray.
const RAY_PACKAGES: [&str; 3] = ["numpy==2.4.6", "pytest==9.2.0", "ray==2.60.0"];

/// Builds the package, installs it, and runs its tests and type checks.
pub(super) fn check(project: &Project) -> Result<(), Stop> {
    let python = tools::python_with(project, "wheel", &PACKAGES)?;
    install(project, &python, &wheel(project)?)?;
    let sources = package(project, &python, &["sdist"], "gz")?;
    let rumbo = project.release_binary()?;
    let module = |words: &[&str]| module(project, &python, words);
    let mut tests = module(&["pytest", "--quiet", "-p", "no:cacheprovider"]);
    tests
        .env("RUMBO_COMMAND", rumbo)
        .env("RUMBO_SDIST", sources);
    run(&mut tests)?;
    run(&mut module(&[
        "ruff",
        "format",
        "--no-cache",
        "--check",
        "python",
        "examples/python",
    ]))?;
    run(&mut module(&[
        "ruff",
        "check",
        "--no-cache",
        "--quiet",
        "python",
        "examples/python",
    ]))?;
    let cache = project.target.join("tmp/mypy");
    run(module(&["mypy", "--cache-dir"]).arg(cache))?;
    // Whether the stub of the Rust part is true.
    let mut stub = module(&["mypy.stubtest", "rumbo._rumbo"]);
    Ok(run(stub.current_dir(project.target.join("tmp")))?)
}

/// Builds the package, installs it beside Ray, and runs its tests on clusters of two workers, then its figures.
pub(crate) fn on_ray(project: &Project) -> Result<(), Stop> {
    let python = tools::python_with(project, "ray", &RAY_PACKAGES)?;
    install(project, &python, &wheel(project)?)?;
    let rumbo = project.release_binary()?;
    let file = "python/tests/test_ray.py";
    run(&mut module(
        project,
        &python,
        &["pytest", "--quiet", "-p", "no:cacheprovider", file],
    ))?;
    let mut bench = project.command(&python);
    bench
        .env("RUMBO_COMMAND", rumbo)
        .arg("python/benches/on_ray.py");
    Ok(run(&mut bench)?)
}

/// Builds the package, installs it, and learns a policy as the example does, whole; it fails where too few goals are
/// reached.
pub(crate) fn learning(project: &Project) -> Result<(), Stop> {
    let python = tools::python_with(project, "wheel", &PACKAGES)?;
    install(project, &python, &wheel(project)?)?;
    let folder = project.target.join("tmp/learning");
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let example = project.root.join("examples/python/ppo.py");
    let mut learning = project.command(&python);
    // It leaves the network here.
    learning.current_dir(&folder).arg(example);
    Ok(run(&mut learning)?)
}

/// A module of Python, as a program.
fn module(project: &Project, python: &Path, words: &[&str]) -> Command {
    let mut command = project.command(python);
    // Nothing of it beside the sources.
    command.env("PYTHONDONTWRITEBYTECODE", "1");
    command.arg("-m").args(words);
    command
}

/// Builds the wheel.
fn wheel(project: &Project) -> Result<PathBuf, Stop> {
    let python = tools::python_with(project, "wheel", &PACKAGES)?;
    // The same interpreter each time, or the crate is built again.
    let interpreter = python.to_string_lossy();
    let build = [
        "build",
        "--release",
        "--locked",
        "--interpreter",
        &interpreter,
    ];
    package(project, &python, &build, "whl")
}

/// Installs it in place of an earlier one.
fn install(project: &Project, python: &Path, wheel: &Path) -> Result<(), Stop> {
    let words = [
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "--force-reinstall",
        "--no-deps",
    ];
    Ok(run(module(project, python, &words).arg(wheel))?)
}

/// Has maturin build one file that ends so, alone in its folder.
fn package(
    project: &Project,
    python: &Path,
    words: &[&str],
    ending: &str,
) -> Result<PathBuf, Stop> {
    let folder = project.target.join("tmp").join(format!("python-{ending}"));
    // Of an earlier version.
    let _ = std::fs::remove_dir_all(&folder);
    let mut build = project.command(python);
    build.args(["-m", "maturin"]).args(words);
    // Its warnings about metadata for a registry concern nobody here; errors are shown.
    output(build.arg("--out").arg(&folder))?;
    let mut files = std::fs::read_dir(&folder).map_err(|error| error.to_string())?;
    let file = files.find_map(|file| {
        let path = file.ok()?.path();
        path.extension()
            .is_some_and(|end| end == ending)
            .then_some(path)
    });
    file.ok_or_else(|| Stop::Failed(format!("maturin left no .{ending} in {}", folder.display())))
}

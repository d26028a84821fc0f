//! The Python package. The gate takes its Rust part as the tests are built, beside the sources; the full check builds the
//! wheel and the source archive, and installs the wheel in an environment made for it, with all that it is used with.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::project::{Project, output, run};
use crate::release;
use crate::tools::{self, Stop};

/// Packages of PyPI; what type checkers find depends on their versions. They need Python 3.11, the wheel itself 3.10.
const PACKAGES: [&str; 7] = [
    "numpy==2.4.6",
    "gymnasium==1.4.0",
    "pettingzoo==1.27.0",
    "pytest==9.2.0",
    "rosbags==0.11.9",
    "mypy==2.4.1",
    "ruff==0.17.6",
];

/// What the wheel is built and tested with besides.
const WHEEL_PACKAGES: [&str; 4] = [
    "maturin==1.16.0",
    "jax==0.10.2",
    "optax==0.2.8",
    "matplotlib==3.11.2",
];

/// For its tests and figures on Ray.
const RAY_PACKAGES: [&str; 3] = ["numpy==2.4.6", "pytest==9.2.0", "ray==2.60.0"];
/// For Stable-Baselines3, which needs PyTorch: 5 GB; SuperSuit is the way there from PettingZoo.
const SB3_PACKAGES: [&str; 6] = [
    "numpy==2.4.6",
    "pytest==9.2.0",
    "pettingzoo==1.27.0",
    "stable-baselines3==2.9.2",
    "supersuit==3.11.0",
    "torch==2.15.0",
];

/// Runs the package's tests, and checks its form and its types.
pub(super) fn check(project: &Project) -> Result<(), Stop> {
    let python = tools::python_with(project, "python-tests", &PACKAGES)?;
    let package = in_place(project)?;
    let module = |words: &[&str]| {
        let mut module = module(project, &python, words);
        module.env("PYTHONPATH", &package);
        module
    };
    let rumbo = project.rumbo()?;
    run(module(&["pytest", "--quiet", "-p", "no:cacheprovider"]).env("RUMBO_COMMAND", rumbo))?;
    for words in [
        &["ruff", "format", "--no-cache", "--check"][..],
        &["ruff", "check", "--no-cache", "--quiet"],
    ] {
        run(module(words).args(["python", "examples/python"]))?;
    }
    let cache = project.target.join("tmp/mypy");
    run(module(&["mypy", "--cache-dir"]).arg(cache))?;
    // Whether the stub of the Rust part is true.
    let mut stub = module(&["mypy.stubtest", "rumbo._rumbo"]);
    Ok(run(stub.current_dir(project.target.join("tmp")))?)
}

/// The package as it would be installed, with the Rust part of the tests' build; returns the folder that Python looks in.
fn in_place(project: &Project) -> Result<PathBuf, Stop> {
    run(project.build_all().arg("--quiet"))?;
    let folder = project.target.join("tmp/python");
    let package = folder.join("rumbo");
    // Of an earlier version.
    let _ = std::fs::remove_dir_all(&package);
    let wrong = |path: &Path, error: std::io::Error| format!("{}: {error}", path.display());
    for file in project.files()? {
        if let Ok(name) = file.strip_prefix("python/rumbo") {
            let to = package.join(name);
            let parent = to.parent().unwrap_or(&package);
            std::fs::create_dir_all(parent).map_err(|error| wrong(parent, error))?;
            let from = project.root.join(&file);
            std::fs::copy(&from, &to).map_err(|error| wrong(&from, error))?;
        }
    }
    let [prefix, suffix] = [std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX];
    let library = project.target.join(format!("debug/{prefix}_rumbo{suffix}"));
    let name = match cfg!(windows) {
        true => "_rumbo.pyd",
        false => "_rumbo.abi3.so",
    };
    std::fs::copy(&library, package.join(name)).map_err(|error| wrong(&library, error))?;
    Ok(folder)
}

/// Builds the package, installs it, and runs its tests with all that they take where it is there.
pub(super) fn check_whole(project: &Project) -> Result<(), Stop> {
    let python = installed(project, "wheel", &packages())?;
    let sources = package(project, &python, &["sdist"], "gz")?;
    let mut tests = module(
        project,
        &python,
        &["pytest", "--quiet", "-p", "no:cacheprovider"],
    );
    tests
        .env("RUMBO_COMMAND", project.release_binary()?)
        .env("RUMBO_SDIST", sources);
    Ok(run(&mut tests)?)
}

/// Those of the wheel.
fn packages() -> Vec<&'static str> {
    [&PACKAGES[..], &WHEEL_PACKAGES].concat()
}

/// Installs the package beside Ray, and runs its tests on clusters of two workers, then its figures.
pub(crate) fn on_ray(project: &Project) -> Result<(), Stop> {
    let python = installed(project, "ray", &RAY_PACKAGES)?;
    let rumbo = project.release_binary()?;
    tests(project, &python, "python/tests/test_ray.py")?;
    let mut bench = project.command(&python);
    bench
        .env("RUMBO_COMMAND", rumbo)
        .arg("python/benches/on_ray.py");
    Ok(run(&mut bench)?)
}

/// Learns as the examples do, whole, with JAX and with Stable-Baselines3, whose checker looks at the environments; fails
/// where too few robots arrive.
pub(crate) fn learning(project: &Project) -> Result<(), Stop> {
    let jax = installed(project, "wheel", &packages())?;
    example(project, &jax, "ppo.py")?;
    let sb3 = installed(project, "sb3", &SB3_PACKAGES)?;
    tests(project, &sb3, "python/tests/test_sb3.py")?;
    example(project, &sb3, "sb3.py")
}

/// Runs an example; what it writes is left in the target folder.
fn example(project: &Project, python: &Path, name: &str) -> Result<(), Stop> {
    let folder = project.target.join("tmp/learning");
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let mut learning = project.command(python);
    let example = project.root.join("examples/python").join(name);
    Ok(run(learning.current_dir(&folder).arg(example))?)
}

/// Runs the tests of one file.
fn tests(project: &Project, python: &Path, file: &str) -> Result<(), Stop> {
    let words = ["pytest", "--quiet", "-p", "no:cacheprovider", file];
    Ok(run(&mut module(project, python, &words))?)
}

/// A module of Python, as a program.
fn module(project: &Project, python: &Path, words: &[&str]) -> Command {
    let mut command = project.command(python);
    // Nothing of it beside the sources.
    command.env("PYTHONDONTWRITEBYTECODE", "1");
    command.arg("-m").args(words);
    command
}

/// A Python with these packages, and the wheel of the sources as they are.
fn installed(project: &Project, name: &str, packages: &[&str]) -> Result<PathBuf, Stop> {
    let python = tools::python_with(project, name, packages)?;
    install(project, &python, &wheel(project)?)?;
    Ok(python)
}

/// Builds the wheel.
fn wheel(project: &Project) -> Result<PathBuf, Stop> {
    let python = tools::python_with(project, "wheel", &packages())?;
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

/// Systems that the wheel is tried in, and their Python.
const SYSTEMS: [(&str, &str); 2] = [("bookworm", "3.11"), ("trixie", "3.13")];

/// Installs the wheel as a user would, in systems with nothing but Python and without a network, and drives robots there.
pub(crate) fn in_clean_systems(project: &Project) -> Result<(), Stop> {
    let python = tools::python_with(project, "wheel", &packages())?;
    let wheel = wheel(project)?;
    for (suite, version) in SYSTEMS {
        let root = release::clean_system(project, suite, &["python3-venv"])?;
        let wheels = root.join("wheels");
        let words = [
            "pip",
            "download",
            "--quiet",
            "--only-binary=:all:",
            "--python-version",
            version,
            "--dest",
        ];
        run(module(project, &python, &words).arg(&wheels).arg(&wheel))?;
        let there = "/venv/bin/python";
        let count = "import rumbo; assert len(rumbo.run('mode1', seeds=range(1, 21))) == 20";
        for words in [
            &["python3", "-m", "venv", "/venv"][..],
            &[
                there,
                "-m",
                "pip",
                "install",
                "--quiet",
                "--no-index",
                "--find-links",
                "/wheels",
                "rumbo",
            ],
            &[there, "-c", count],
        ] {
            release::inside(project, &root, words)?;
        }
    }
    Ok(())
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

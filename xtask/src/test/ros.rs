//! The node of ROS 2, a workspace of its own, and peers with the middlewares of genuine installations, in an environment
//! made for them.

use std::env::consts::EXE_SUFFIX;

use crate::project::{Project, run};
use crate::tools::{self, Stop};

/// Packages of PyPI: rclpy of Jazzy with Fast DDS, its messages, Cyclone DDS.
const PACKAGES: [&str; 7] = [
    "ros-jazzy-rclpy[fastrtps]==7.1.6",
    "ros-jazzy-geometry-msgs==5.3.6",
    "ros-jazzy-nav-msgs==5.3.6",
    "ros-jazzy-sensor-msgs==5.3.6",
    "ros-jazzy-std-srvs==5.3.6",
    "ros-jazzy-visualization-msgs==5.3.6",
    "cyclonedds==11.0.1",
];

/// The workspace of the node.
const MANIFEST: [&str; 2] = ["--manifest-path", "ros/Cargo.toml"];

/// Lints, tests and builds the node, then `rumbo` as the step `test` does, and has the peers meet both.
pub(super) fn check(project: &Project) -> Result<(), Stop> {
    tools::component(project, "fmt", "rustfmt")?;
    tools::component(project, "clippy", "clippy")?;
    let folder = project.target.join("rumbo-ros");
    let cargo = |command: &str, rest: &[&str]| {
        let mut cargo = project.cargo(&[command]);
        run(cargo
            .args(MANIFEST)
            .args(rest)
            .env("CARGO_TARGET_DIR", &folder))
    };
    cargo("fmt", &["--check"])?;
    cargo(
        "clippy",
        &["--all-targets", "--locked", "--", "-D", "warnings"],
    )?;
    cargo("test", &["--locked"])?;
    cargo("build", &["--locked"])?;
    let python = tools::python_with(project, "ros", &PACKAGES)?;
    // For the type of Nav2's action.
    tools::compiler(project)?;
    // Those of the Python that they were built for.
    let import = project
        .command(&python)
        .args(["-c", "import rclpy, cyclonedds"])
        .output();
    if !import.is_ok_and(|import| import.status.success()) {
        let remedy = "rclpy of PyPI does not run here; it is built for Linux, Python 3.11 to 3.13";
        return Err(Stop::Missing(remedy.to_owned()));
    }
    let rumbo = project.rumbo()?;
    let logs = project.target.join("tmp/ros");
    std::fs::create_dir_all(&logs).map_err(|error| format!("{}: {error}", logs.display()))?;
    let mut check = project.command(&python);
    check.env("RUMBO_COMMAND", &rumbo).env(
        "RUMBO_ROS_COMMAND",
        folder.join(format!("debug/rumbo-ros{EXE_SUFFIX}")),
    );
    Ok(run(check.arg("xtask/src/test/check_ros.py").arg(&logs))?)
}

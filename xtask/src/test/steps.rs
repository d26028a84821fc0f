//! The steps of the gate and of the full check, in order, and those that are a command or two.

use super::{lessons, logs, readme, ros, web, wheel};
use crate::project::{Project, output, run as run_command};
use crate::tidy::{
    self,
    ceilings::{Ceilings, Gate},
};
use crate::tools::{self, Stop};
use serde_json::Value;
use std::collections::BTreeSet;

/// Variable of the environment by which tests take all ticks, seeds and cases in place of a sample.
const FULL: &str = "RUMBO_FULL";

/// Which check a step belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Check {
    /// The one that CI runs, and the full one.
    Gate,
    /// The full one only.
    Full,
}

pub(super) struct Step {
    pub(super) name: &'static str,
    pub(super) what: &'static str,
    pub(super) part_of: Check,
    pub(super) check: StepCheck,
}

/// What a step does.
type StepCheck = fn(&Project) -> Result<(), Stop>;

/// A step of the gate.
const fn gate(name: &'static str, what: &'static str, check: StepCheck) -> Step {
    let part_of = Check::Gate;
    Step {
        name,
        what,
        part_of,
        check,
    }
}

/// A step of the full check only.
const fn full(name: &'static str, what: &'static str, check: StepCheck) -> Step {
    let part_of = Check::Full;
    Step {
        name,
        what,
        part_of,
        check,
    }
}

pub(super) const STEPS: [Step; 23] = [
    gate("fmt", "the code is formatted", fmt),
    gate(
        "tidy",
        "the rules of ARCHITECTURE.md hold, and the ceilings of xtask/ceilings.toml",
        rules,
    ),
    gate(
        "deny",
        "licences and sources of the dependencies are those of deny.toml",
        dependencies,
    ),
    gate(
        "build",
        "libraries, programs and tests of all crates compile",
        build,
    ),
    gate("clippy", "no warning from the compiler or clippy", clippy),
    full("doc", "the API documentation builds without a warning", doc),
    gate(
        "sketches",
        "the Arduino sketches build: images for the tests",
        crate::sketches::build,
    ),
    gate(
        "firmware",
        "the image for the Mega builds and keeps to its caps",
        crate::firmware::build,
    ),
    gate(
        "wasm",
        "simulator, experiments, report, session, logs and lab compile for a browser",
        wasm,
    ),
    gate(
        "test",
        "the tests of all crates, and the seeds of the fuzz targets",
        tests,
    ),
    gate(
        "figures",
        "the figures and tables of docs/theory are those of the sources",
        figures,
    ),
    gate("web", "the types of the dashboard", web::types),
    gate(
        "python",
        "the Python package: tests, environments, types",
        wheel::check,
    ),
    gate("browser", "the dashboard in a real browser", web::browser),
    gate("logs", "logs as other programs read them", logs::check),
    gate("readme", "the commands of the README", readme::check),
    gate(
        "lessons",
        "the figures of the lessons are those of the runs",
        lessons::check,
    ),
    full(
        "release",
        "the rumbo binary, as users build it, does what the README says",
        readme::check_release,
    ),
    full(
        "counts",
        "the instructions of pieces of work are those of xtask/counts.toml, within 2 %",
        crate::bench::counts::check,
    ),
    full(
        "wheel",
        "the wheel and the source archive, beside JAX, PettingZoo and matplotlib",
        wheel::check_whole,
    ),
    full(
        "ros",
        "the node of ROS 2: lints, tests, and as genuine peers see it",
        ros::check,
    ),
    full("site", "the site, and all browser tests", web::browser_full),
    full(
        "fuzz",
        "the fuzz targets find nothing in five seconds each",
        fuzz,
    ),
];

fn fmt(project: &Project) -> Result<(), Stop> {
    tools::component(project, "fmt", "rustfmt")?;
    Ok(run_command(
        &mut project.cargo(&["fmt", "--all", "--check"]),
    )?)
}

fn rules(project: &Project) -> Result<(), Stop> {
    found_nothing(tidy::run(project)?)
}

fn dependencies(project: &Project) -> Result<(), Stop> {
    found_nothing(crate::deny::check(project)?)
}

fn found_nothing(nothing: bool) -> Result<(), Stop> {
    match nothing {
        true => Ok(()),
        false => Err(Stop::Failed("see the findings above".to_owned())),
    }
}

/// What the compiler said while it built all, which cargo repeats. The robot's crates are checked a second time as the
/// firmware uses them, without their host-only features.
fn clippy(project: &Project) -> Result<(), Stop> {
    tools::component(project, "clippy", "clippy")?;
    const DENY: [&str; 3] = ["--", "-D", "warnings"];
    if project.builds_lint() {
        let messages = output(
            project
                .build_all()
                .args(["--quiet", "--message-format=json"]),
        )?;
        let warnings = warnings(&messages);
        warnings.iter().for_each(|warning| println!("{warning}"));
        found_nothing(warnings.is_empty())?;
    } else {
        let whole = ["clippy", "--workspace", "--all-targets", "--locked"];
        run_command(&mut project.cargo(&[&whole[..], &DENY].concat()))?;
    }
    let robot = [
        "clippy",
        "-p",
        "rumbo-control",
        "-p",
        "rumbo-wire",
        "-p",
        "rumbo-robot",
        "--locked",
    ];
    Ok(run_command(
        &mut project.cargo(&[&robot[..], &DENY].concat()),
    )?)
}

/// What is wrong by the messages of cargo, each once.
pub(super) fn warnings(messages: &str) -> Vec<String> {
    let of = |line: &str| {
        let message = serde_json::from_str::<Value>(line).ok()?;
        (message["reason"] == "compiler-message").then_some(())?;
        let rendered = message["message"]["rendered"].as_str()?;
        Some(rendered.to_owned())
    };
    let found: BTreeSet<_> = messages.lines().filter_map(of).collect();
    found.into_iter().collect()
}

/// Links to what is private are for those who read the source; in the documentation they are words.
fn doc(project: &Project) -> Result<(), Stop> {
    let words = "doc --workspace --no-deps --locked --keep-going";
    let mut doc = project.cargo(&words.split(' ').collect::<Vec<_>>());
    let flags = "-D warnings -A rustdoc::private-intra-doc-links";
    Ok(run_command(doc.env("RUSTDOCFLAGS", flags))?)
}

/// Compiles all that the steps after it run; what that takes is separate from what they take themselves.
fn build(project: &Project) -> Result<(), Stop> {
    // Without clippy it builds too, and that step says what is missing.
    let _ = tools::component(project, "clippy", "clippy");
    let messages = output(
        project
            .build_all()
            .arg("--message-format=json-render-diagnostics"),
    )?;
    let gate = Gate::of(&messages);
    println!(
        "{} units, {} programs with tests",
        gate.units, gate.executables
    );
    match gate.above(Ceilings::read(project)?.gate) {
        Some(problem) => Err(Stop::Failed(problem)),
        None => Ok(()),
    }
}

/// Where simavr or avr-gdb is missing, the tests that need it skip themselves, so this step is incomplete.
fn tests(project: &Project) -> Result<(), Stop> {
    let tools = [tools::simavr(project), tools::avr_gdb(project)];
    let mut test = project.linted(&["test", "--workspace", "--locked", "--no-fail-fast"]);
    if project.full {
        test.env(FULL, "1");
    }
    run_command(&mut test)?;
    tools.into_iter().try_for_each(|tool| tool.map(|_| ()))
}

fn fuzz(project: &Project) -> Result<(), Stop> {
    found_nothing(crate::fuzz::campaign(project, Some(5), &[])?)
}

fn wasm(project: &Project) -> Result<(), Stop> {
    crate::site::check(project)
}

/// The same sources give the same bytes, so a difference is a change of behaviour that the pages do not show yet.
fn figures(project: &Project) -> Result<(), Stop> {
    Ok(crate::figures::check(project)?)
}

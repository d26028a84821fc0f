//! `cargo xtask test`: the gate, every check that a change passes before it lands; with `--full` every check there is.
//! Each prints its result, its time and the processor's, and a summary closes the list.
//!
//! A step that lacks a tool installs it where it can (Debian packages as root, Node packages with `npm ci`), else it
//! is skipped with the remedy; with `CI=true` that is a failure. The gate builds everything once, with clippy as the
//! compiler: tests, browser, logs, README, lessons and the Python package share the development profile's artefacts.
//! What samples do not show, and what needs another build of the same sources, is in the full check. CI builds in two
//! lanes where the steps allow it ([`beside`]).

mod beside;
mod cost;
mod lessons;
mod logs;
mod readme;
mod ros;
pub(crate) mod tools;
mod web;
pub(crate) mod wheel;

use beside::Beside;
use cost::Clock;
pub(crate) use cost::Cost;
pub(crate) use tools::installed_chromium;

use std::collections::BTreeSet;

use serde_json::Value;

use crate::project::{Project, output, run as run_command};
use crate::tidy::{
    self,
    ceilings::{Ceilings, Gate},
};

/// How a step ended.
#[derive(Debug, PartialEq)]
enum Outcome {
    Passed,
    /// With what is wrong.
    Failed(String),
    /// With what is missing and the remedy.
    Skipped(String),
}

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

/// Variable of the environment by which tests take all ticks, seeds and cases in place of a sample.
const FULL: &str = "RUMBO_FULL";

/// Which check a step belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Check {
    /// The one that CI runs, and the full one.
    Gate,
    /// The full one only.
    Full,
}

struct Step {
    name: &'static str,
    what: &'static str,
    part_of: Check,
    check: fn(&Project) -> Result<(), Stop>,
}

const STEPS: [Step; 23] = [
    Step {
        name: "fmt",
        what: "the code is formatted",
        part_of: Check::Gate,
        check: fmt,
    },
    Step {
        name: "tidy",
        what: "the rules of ARCHITECTURE.md hold, and the ceilings of xtask/ceilings.toml",
        part_of: Check::Gate,
        check: rules,
    },
    Step {
        name: "deny",
        what: "licences and sources of the dependencies are those of deny.toml",
        part_of: Check::Gate,
        check: dependencies,
    },
    Step {
        name: "build",
        what: "libraries, programs and tests of all crates compile",
        part_of: Check::Gate,
        check: build,
    },
    Step {
        name: "clippy",
        what: "no warning from the compiler or clippy",
        part_of: Check::Gate,
        check: clippy,
    },
    Step {
        name: "doc",
        what: "the API documentation builds without a warning",
        part_of: Check::Full,
        check: doc,
    },
    Step {
        name: "sketches",
        what: "the Arduino sketches build: images for the tests",
        part_of: Check::Gate,
        check: crate::sketches::build,
    },
    Step {
        name: "firmware",
        what: "the image for the Mega builds and keeps to its caps",
        part_of: Check::Gate,
        check: crate::firmware::build,
    },
    Step {
        name: "wasm",
        what: "simulator, experiments, report, session, logs and lab compile for a browser",
        part_of: Check::Gate,
        check: wasm,
    },
    Step {
        name: "test",
        what: "the tests of all crates, and the seeds of the fuzz targets",
        part_of: Check::Gate,
        check: tests,
    },
    Step {
        name: "figures",
        what: "the figures and tables of docs/theory are those of the sources",
        part_of: Check::Gate,
        check: figures,
    },
    Step {
        name: "web",
        what: "the types of the dashboard",
        part_of: Check::Gate,
        check: web::types,
    },
    Step {
        name: "python",
        what: "the Python package: tests, environments, types",
        part_of: Check::Gate,
        check: wheel::check,
    },
    Step {
        name: "browser",
        what: "the dashboard in a real browser",
        part_of: Check::Gate,
        check: web::browser,
    },
    Step {
        name: "logs",
        what: "logs as other programs read them",
        part_of: Check::Gate,
        check: logs::check,
    },
    Step {
        name: "readme",
        what: "the commands of the README",
        part_of: Check::Gate,
        check: readme::check,
    },
    Step {
        name: "lessons",
        what: "the figures of the lessons are those of the runs",
        part_of: Check::Gate,
        check: lessons::check,
    },
    Step {
        name: "release",
        what: "the rumbo binary, as users build it, does what the README says",
        part_of: Check::Full,
        check: readme::check_release,
    },
    Step {
        name: "counts",
        what: "the instructions of pieces of work are those of xtask/counts.toml, within 2 %",
        part_of: Check::Full,
        check: crate::bench::counts::check,
    },
    Step {
        name: "wheel",
        what: "the wheel and the source archive, beside JAX, PettingZoo and matplotlib",
        part_of: Check::Full,
        check: wheel::check_whole,
    },
    Step {
        name: "ros",
        what: "the node of ROS 2: lints, tests, and as genuine peers see it",
        part_of: Check::Full,
        check: ros::check,
    },
    Step {
        name: "site",
        what: "the site, and all browser tests",
        part_of: Check::Full,
        check: web::browser_full,
    },
    Step {
        name: "fuzz",
        what: "the fuzz targets find nothing in five seconds each",
        part_of: Check::Full,
        check: fuzz,
    },
];

/// Steps that run beside another one with `CI=true`: they build into folders of their own, and have long phases of a
/// single thread, as the compiler has.
const BESIDE: (&str, [&str; 3]) = ("build", ["sketches", "firmware", "wasm"]);

/// Text of `cargo xtask test --help`.
pub(crate) fn help() -> String {
    let mut text = String::from("Usage: cargo xtask test [--full] [--only STEP]...\n");
    for (check, title) in [
        (Check::Gate, "Steps, in order"),
        (
            Check::Full,
            "Steps of --full besides, which also makes the tests longer",
        ),
    ] {
        text += &format!("\n{title}:\n");
        for step in STEPS.iter().filter(|step| step.part_of == check) {
            text += &format!("  {:<8} {}\n", step.name, step.what);
        }
    }
    text + "\nExamples:\n  cargo xtask test\n  cargo xtask test --only fmt --only clippy\n  cargo xtask test --full\n  CI=true cargo xtask test"
}

/// Runs the steps named in `only`, or all of the gate, or all; true if none failed.
pub(crate) fn run(project: &Project, only: &[String]) -> Result<bool, String> {
    if let Some(unknown) = only
        .iter()
        .find(|name| STEPS.iter().all(|step| step.name != *name))
    {
        let known: Vec<_> = STEPS.iter().map(|step| step.name).collect();
        return Err(format!("no step `{unknown}`; steps: {}", known.join(", ")));
    }
    let chosen = |step: &&Step| match only.is_empty() {
        true => project.full || step.part_of == Check::Gate,
        false => only.iter().any(|name| name == step.name),
    };
    let mut results = Vec::new();
    let mut beside = None;
    for step in STEPS.iter().filter(chosen) {
        if project.ci && only.is_empty() {
            if step.name == BESIDE.0 {
                beside = Some(Beside::start(project, &BESIDE.1)?);
            }
            if BESIDE.1.contains(&step.name) {
                if let Some(lane) = beside.take() {
                    results.extend(lane.end()?);
                }
                continue;
            }
        }
        println!("\n==> {}: {}", step.name, step.what);
        let clock = Clock::start();
        let outcome = judge((step.check)(project), project.ci);
        let cost = clock.stop();
        println!("<== {}", line(step.name, &outcome, cost));
        results.push((step.name, outcome, cost));
    }
    println!("\nSummary");
    for (name, outcome, cost) in &results {
        println!("  {}", line(name, outcome, *cost));
    }
    let whole: Cost = results.iter().map(|(_, _, cost)| *cost).sum();
    println!("  {:<16} {whole}", "all steps");
    let costs: Vec<_> = results
        .iter()
        .map(|(name, _, cost)| (*name, *cost))
        .collect();
    for warning in Ceilings::read(project)?.warnings(&costs) {
        println!("{warning}");
    }
    println!("{}", tally(results.iter().map(|(_, outcome, _)| outcome)));
    Ok(!results
        .iter()
        .any(|(_, outcome, _)| matches!(outcome, Outcome::Failed(_))))
}

fn judge(result: Result<(), Stop>, ci: bool) -> Outcome {
    match result {
        Ok(()) => Outcome::Passed,
        Err(Stop::Failed(error)) => Outcome::Failed(error),
        Err(Stop::Missing(remedy)) if ci => Outcome::Failed(format!("not checked: {remedy}")),
        Err(Stop::Missing(remedy)) => Outcome::Skipped(remedy),
    }
}

fn line(name: &str, outcome: &Outcome, cost: Cost) -> String {
    let (word, why) = match outcome {
        Outcome::Passed => ("passed", ""),
        Outcome::Failed(error) => ("FAILED", error.as_str()),
        Outcome::Skipped(remedy) => ("skipped", remedy.as_str()),
    };
    format!("{name:<8} {word:<7} {cost}  {why}")
        .trim_end()
        .to_owned()
}

fn tally<'a>(outcomes: impl Iterator<Item = &'a Outcome>) -> String {
    let (mut passed, mut failed, mut skipped) = (0, 0, 0);
    for outcome in outcomes {
        match outcome {
            Outcome::Passed => passed += 1,
            Outcome::Failed(_) => failed += 1,
            Outcome::Skipped(_) => skipped += 1,
        }
    }
    format!("{passed} passed, {failed} failed, {skipped} skipped")
}

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
fn warnings(messages: &str) -> Vec<String> {
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

#[cfg(test)]
mod tests;

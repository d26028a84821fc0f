//! `cargo xtask test`: every check, in order, each with its time and result, and a summary.
//!
//! A step that lacks a tool installs it where it can (Debian packages as root, Node packages with `npm ci`), else it
//! is skipped with the remedy; with `CI=true` that is a failure. Debug builds serve the tests, one release build the
//! browser and the README, so nothing is built twice in the same way. CI builds in two lanes where the steps allow it
//! ([`beside`]).

mod beside;
mod lessons;
mod logs;
mod readme;
mod ros;
pub(crate) mod tools;
mod web;
pub(crate) mod wheel;

use std::time::{Duration, Instant};

use beside::Beside;
pub(crate) use tools::installed_chromium;

use crate::project::{Project, run as run_command};
use crate::tidy;

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

impl From<String> for Stop {
    fn from(error: String) -> Self {
        Self::Failed(error)
    }
}

struct Step {
    name: &'static str,
    what: &'static str,
    check: fn(&Project) -> Result<(), Stop>,
}

const STEPS: [Step; 19] = [
    Step {
        name: "fmt",
        what: "the code is formatted",
        check: fmt,
    },
    Step {
        name: "tidy",
        what: "the rules of ARCHITECTURE.md hold",
        check: rules,
    },
    Step {
        name: "deny",
        what: "licences and sources of the dependencies are those of deny.toml",
        check: dependencies,
    },
    Step {
        name: "clippy",
        what: "no warning from the compiler or clippy",
        check: clippy,
    },
    Step {
        name: "doc",
        what: "the API documentation builds without a warning",
        check: doc,
    },
    Step {
        name: "build",
        what: "the rumbo binary, as users build it",
        check: build,
    },
    Step {
        name: "sketches",
        what: "the Arduino sketches build: images for the tests",
        check: crate::sketches::build,
    },
    Step {
        name: "firmware",
        what: "the image for the Mega builds and keeps to its caps",
        check: crate::firmware::build,
    },
    Step {
        name: "wasm",
        what: "simulator, experiments, report, session, logs and lab compile for a browser",
        check: wasm,
    },
    Step {
        name: "fuzz",
        what: "the fuzz targets find nothing in five seconds each",
        check: fuzz,
    },
    Step {
        name: "test",
        what: "the tests of all crates",
        check: tests,
    },
    Step {
        name: "ros",
        what: "the node of ROS 2: lints, tests, and as genuine peers see it",
        check: ros::check,
    },
    Step {
        name: "figures",
        what: "the figures and tables of docs/theory are those of the sources",
        check: figures,
    },
    Step {
        name: "web",
        what: "the types of the dashboard",
        check: web::types,
    },
    Step {
        name: "python",
        what: "the Python package: wheel, tests, environments, types",
        check: wheel::check,
    },
    Step {
        name: "browser",
        what: "the dashboard in a real browser",
        check: web::browser,
    },
    Step {
        name: "logs",
        what: "logs as other programs read them",
        check: logs::check,
    },
    Step {
        name: "readme",
        what: "the commands of the README",
        check: readme::check,
    },
    Step {
        name: "lessons",
        what: "the figures of the lessons are those of the runs",
        check: lessons::check,
    },
];

/// Steps that run beside others with `CI=true`.
struct Lane {
    /// They begin with this step, and end before the first of them has its turn.
    first: &'static str,
    steps: &'static [&'static str],
    /// They take what the others leave of the processor.
    nice: bool,
}

/// They build into folders of their own. Those beside the compiler have long phases of a single thread, as it has; the
/// nodes of ROS 2 mostly wait, but must not wait for long.
const LANES: [Lane; 2] = [
    Lane {
        first: "clippy",
        steps: &["sketches", "firmware", "wasm", "fuzz"],
        nice: false,
    },
    Lane {
        first: "ros",
        steps: &["python"],
        nice: true,
    },
];

/// Text of `cargo xtask test --help`.
pub(crate) fn help() -> String {
    let mut text = String::from("Usage: cargo xtask test [--only STEP]...\n\nSteps, in order:\n");
    for step in &STEPS {
        text += &format!("  {:<8} {}\n", step.name, step.what);
    }
    text + "\nExamples:\n  cargo xtask test\n  cargo xtask test --only fmt --only clippy\n  CI=true cargo xtask test"
}

/// Runs the steps named in `only` (all if empty); true if none failed.
pub(crate) fn run(project: &Project, only: &[String]) -> Result<bool, String> {
    if let Some(unknown) = only
        .iter()
        .find(|name| STEPS.iter().all(|step| step.name != *name))
    {
        let known: Vec<_> = STEPS.iter().map(|step| step.name).collect();
        return Err(format!("no step `{unknown}`; steps: {}", known.join(", ")));
    }
    let mut results = Vec::new();
    let mut beside = None;
    for step in STEPS
        .iter()
        .filter(|step| only.is_empty() || only.iter().any(|name| name == step.name))
    {
        if project.ci && only.is_empty() {
            if let Some(lane) = LANES.iter().find(|lane| lane.first == step.name) {
                beside = Some(Beside::start(project, lane)?);
            }
            if LANES.iter().any(|lane| lane.steps.contains(&step.name)) {
                if let Some(lane) = beside.take() {
                    results.extend(lane.end()?);
                }
                continue;
            }
        }
        println!("\n==> {}: {}", step.name, step.what);
        let start = Instant::now();
        let outcome = judge((step.check)(project), project.ci);
        let time = start.elapsed();
        println!("<== {}", line(step.name, &outcome, time));
        results.push((step.name, outcome, time));
    }
    println!("\nSummary");
    for (name, outcome, time) in &results {
        println!("  {}", line(name, outcome, *time));
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

fn line(name: &str, outcome: &Outcome, time: Duration) -> String {
    let (word, why) = match outcome {
        Outcome::Passed => ("passed", ""),
        Outcome::Failed(error) => ("FAILED", error.as_str()),
        Outcome::Skipped(remedy) => ("skipped", remedy.as_str()),
    };
    format!("{name:<8} {word:<7} {:>6.1} s  {why}", time.as_secs_f64())
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

/// The robot's crates are checked a second time as the firmware uses them, without their host-only features.
fn clippy(project: &Project) -> Result<(), Stop> {
    tools::component(project, "clippy", "clippy")?;
    const DENY: [&str; 3] = ["--", "-D", "warnings"];
    let whole = ["clippy", "--workspace", "--all-targets", "--locked"];
    run_command(&mut project.cargo(&[&whole[..], &DENY].concat()))?;
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

fn doc(project: &Project) -> Result<(), Stop> {
    let mut doc = project.cargo(&["doc", "--workspace", "--no-deps", "--locked"]);
    Ok(run_command(doc.env("RUSTDOCFLAGS", "-D warnings"))?)
}

/// Where simavr or avr-gdb is missing, the tests that need it skip themselves, so this step is incomplete.
fn tests(project: &Project) -> Result<(), Stop> {
    let tools = [tools::simavr(project), tools::avr_gdb(project)];
    run_command(project.whole("test").arg("--no-fail-fast"))?;
    tools.into_iter().try_for_each(|tool| tool.map(|_| ()))
}

fn fuzz(project: &Project) -> Result<(), Stop> {
    found_nothing(crate::fuzz::campaign(project, Some(5), &[])?)
}

/// The step *browser* takes what this one builds.
fn wasm(project: &Project) -> Result<(), Stop> {
    crate::site::compile(project)?;
    Ok(())
}

fn build(project: &Project) -> Result<(), Stop> {
    project.release_binary()?;
    Ok(())
}

/// The same sources give the same bytes, so a difference is a change of behaviour that the pages do not show yet.
fn figures(project: &Project) -> Result<(), Stop> {
    Ok(crate::figures::check(project)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closing_line_counts_every_step() {
        let outcomes = [
            Outcome::Passed,
            Outcome::Failed("x".to_owned()),
            Outcome::Passed,
            Outcome::Skipped("y".to_owned()),
        ];
        assert_eq!(tally(outcomes.iter()), "2 passed, 1 failed, 1 skipped");
    }

    #[test]
    fn a_missing_tool_is_a_skip_at_home_and_a_failure_in_ci() {
        let missing = || Err(Stop::Missing("install it".to_owned()));
        assert_eq!(
            judge(missing(), false),
            Outcome::Skipped("install it".to_owned())
        );
        assert_eq!(
            judge(missing(), true),
            Outcome::Failed("not checked: install it".to_owned())
        );
    }

    /// Else steps would be left out, or a lane ended by the next one.
    #[test]
    fn a_lane_begins_before_its_steps_and_after_those_of_the_lane_before() {
        let place = |name: &str| STEPS.iter().position(|step| step.name == name);
        let mut places = Vec::new();
        for lane in &LANES {
            places.push(place(lane.first).expect(lane.first));
            let steps = lane.steps.iter().map(|name| place(name).expect(name));
            places.push(steps.min().expect(lane.first));
        }
        assert!(places.is_sorted_by(|one, next| one < next), "{places:?}");
    }

    #[test]
    fn every_step_is_in_the_help() {
        assert!(STEPS.iter().all(|step| help().contains(step.what)));
    }
}

//! `cargo xtask test`: the gate, every check that a change passes before it lands; with `--full` every check there is.
//! Each prints its result, its time and the processor's, and a summary closes the list.
//!
//! A step that lacks a tool installs it where it can (Debian packages as root, Node packages with `npm ci`), else it
//! is skipped with the remedy; with `CI=true` that is a failure. The gate builds everything once, with clippy as the
//! compiler: tests, browser, logs, README, lessons and the Python package share the development profile's artefacts.
//! What samples do not show, and what needs another build of the same sources, is in the full check. CI builds in two
//! lanes where the steps allow it ([`beside`]).

mod beside;
mod lessons;
mod logs;
mod readme;
mod ros;
mod steps;
mod web;
pub(crate) mod wheel;

use beside::Beside;
use steps::{Check, STEPS, Step};

use crate::cost::{Clock, Cost};
use crate::project::Project;
use crate::tidy::ceilings::Ceilings;
use crate::tools::Stop;

/// How a step ended.
#[derive(Debug, PartialEq)]
enum Outcome {
    Passed,
    /// With what is wrong.
    Failed(String),
    /// With what is missing and the remedy.
    Skipped(String),
}

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

#[cfg(test)]
mod tests;

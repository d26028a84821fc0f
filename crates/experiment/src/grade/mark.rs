//! The marks of a hand-in, line by line.

use super::assignment::Assignment;
use super::program::{Seen, is_of_program};
use crate::files::FileError;
use crate::note::Note;
use crate::run::RunResult;
use serde::Serialize;
use std::fmt;

/// A hand-in's mark.
#[derive(Clone, Debug, Serialize)]
pub struct Mark {
    /// The hand-in's name.
    pub name: String,
    /// What it earned.
    pub points: f64,
    /// The full mark.
    pub of: f64,
    /// It passes.
    pub pass: bool,
    /// Why nothing of it was driven, a line each.
    pub refused: Vec<String>,
    /// The rubric's lines, for each test that they are about.
    pub lines: Vec<RubricLine>,
    /// Points lost for contact.
    pub penalty: f64,
    /// Runs that touched something.
    pub touching: usize,
    /// Runs in all.
    pub runs: usize,
    /// Why the program stopped early, each reason once.
    pub ended: Vec<Note>,
    /// Further notes for the reader.
    pub notes: Vec<Note>,
    /// For each test the run with its first public seed, for the plot.
    #[serde(skip)]
    pub drawn: Vec<Option<RunResult>>,
}

/// A line of the rubric in one test.
#[derive(Clone, Debug, Serialize)]
pub struct RubricLine {
    /// The criterion, by its place.
    pub criterion: usize,
    /// The test, by its place.
    pub test: usize,
    /// What was measured, for each seed in order; none where it never happened. Of what a program does inside, with one
    /// seed.
    pub values: Vec<Option<f64>>,
    /// Where in the program that was, if it is about one.
    pub place: Option<Note>,
    /// The points earned.
    pub points: f64,
    /// The possible points.
    pub of: f64,
}

impl RubricLine {
    /// The value in the middle, `None` where most seeds have none. What never happened is worse than any value.
    pub fn median(&self, assignment: &Assignment) -> Option<f64> {
        let criterion = &assignment.criteria[self.criterion];
        let mut values = self.values.clone();
        values.sort_by(|one, other| {
            let rank = |value: &Option<f64>| value.map_or(-1.0, |_| criterion.share(*value));
            rank(other)
                .total_cmp(&rank(one))
                .then(one.unwrap_or(0.0).total_cmp(&other.unwrap_or(0.0)))
        });
        values.get(values.len() / 2).copied().flatten()
    }

    /// All points.
    pub fn is_full(&self) -> bool {
        self.points >= self.of - 1e-9
    }
}

/// Why a run could not be made.
#[derive(Debug)]
pub(super) enum RunError {
    /// The program cannot be driven in this setup.
    Setup(FileError),
    /// The simulator panicked.
    Panicked,
}

impl fmt::Display for RunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Setup(error) => error.fmt(f),
            Self::Panicked => f.write_str("the simulator failed on this program; please report it"),
        }
    }
}

/// The result of one run.
#[derive(Debug)]
pub(super) struct GradedRun {
    pub(super) test: usize,
    /// `Err`: it could not be started.
    pub(super) result: Result<RunResult, RunError>,
    /// What was seen of the program, if it was watched.
    pub(super) seen: Option<Seen>,
}

impl Mark {
    /// Why nothing of it was driven, or why its program stopped early, if it did: the first reason.
    pub fn why_not(&self) -> Option<String> {
        let ended = self.ended.iter().map(ToString::to_string);
        self.refused.iter().cloned().chain(ended).next()
    }

    /// The mark of a hand-in that could not be driven.
    pub(super) fn refused(assignment: &Assignment, name: &str, why: Vec<String>) -> Self {
        Self {
            refused: why,
            ..Self::of(assignment, name, Vec::new())
        }
    }

    /// The mark from a hand-in's runs, in order of tests and seeds.
    pub(super) fn of(assignment: &Assignment, name: &str, runs: Vec<GradedRun>) -> Self {
        let lines = lines(assignment, &runs);
        let touching = runs.iter().filter(|run| touches(run)).count();
        let share = touching as f64 / runs.len().max(1) as f64;
        let penalty = cents(assignment.contact_penalty * share);
        let earned: f64 = lines.iter().map(|line| line.points).sum();
        let points = cents((earned - penalty).max(0.0));
        let mut mark = Self {
            name: name.to_owned(),
            points,
            of: assignment.points,
            pass: points >= assignment.pass,
            refused: Vec::new(),
            lines,
            penalty,
            touching,
            runs: runs.len(),
            ended: Vec::new(),
            notes: Vec::new(),
            drawn: assignment.tests.iter().map(|_| None).collect(),
        };
        for GradedRun { test, result, .. } in runs {
            match result {
                Ok(result) => {
                    once(&mut mark.ended, result.ended.iter());
                    // Notes about a program that drives are not reported.
                    if !result.trace.drove() {
                        once(&mut mark.notes, result.notes.iter());
                    }
                    let seed = assignment.tests[test].public.first();
                    if seed == Some(&result.seed) && mark.drawn[test].is_none() {
                        mark.drawn[test] = Some(result);
                    }
                }
                Err(why) => once(&mut mark.ended, [why.to_string().into()].iter()),
            }
        }
        mark
    }
}

/// The lines of the rubric, their points scaled to the full mark.
fn lines(assignment: &Assignment, runs: &[GradedRun]) -> Vec<RubricLine> {
    let worth = |test: usize| {
        let tests = assignment.tests.iter();
        let all: f64 = tests.map(|test| test.weight).sum();
        assignment.tests[test].weight / all
    };
    let mut lines = Vec::new();
    for (number, criterion) in assignment.criteria.iter().enumerate() {
        for (test, about) in assignment.tests.iter().enumerate() {
            if !criterion.is_of(test) {
                continue;
            }
            let of = match criterion.test {
                Some(_) => criterion.points,
                None => criterion.points * worth(test),
            };
            let own = runs.iter().filter(|run| run.test == test);
            let seen = own.clone().find_map(|run| run.seen.as_ref());
            let place = seen.and_then(|seen| seen.places.get(criterion.metric.as_str()));
            let mut values: Vec<Option<f64>> =
                own.map(|run| value(run, &criterion.metric)).collect();
            let watched = is_of_program(&criterion.metric);
            values.resize(if watched { 1 } else { about.seeds().count() }, None);
            let shares: f64 = values.iter().map(|value| criterion.share(*value)).sum();
            let points = of * shares / values.len().max(1) as f64;
            lines.push(RubricLine {
                criterion: number,
                test,
                values,
                place: place.cloned(),
                points,
                of,
            });
        }
    }
    let all: f64 = lines.iter().map(|line| line.of).sum();
    let scale = if all > 0.0 {
        assignment.points / all
    } else {
        0.0
    };
    for line in &mut lines {
        line.points *= scale;
        line.of *= scale;
    }
    lines
}

/// Notes kept of one kind.
const MOST_NOTES: usize = 5;

fn once<'a>(notes: &mut Vec<Note>, more: impl Iterator<Item = &'a Note>) {
    for note in more {
        if notes.len() < MOST_NOTES && !notes.contains(note) {
            notes.push(note.clone());
        }
    }
}

/// The metrics of a run; none if the program ended early or never drove.
fn value(run: &GradedRun, metric: &str) -> Option<f64> {
    let result = run.result.as_ref().ok()?;
    if result.ended.is_some() || !result.trace.drove() {
        return None;
    }
    let metrics = match &run.seen {
        Some(seen) if is_of_program(metric) => &seen.metrics,
        _ => &result.metrics,
    };
    metrics
        .get(metric)
        .copied()
        .filter(|value| value.is_finite())
}

fn touches(run: &GradedRun) -> bool {
    let touched = |result: &RunResult| {
        result
            .metrics
            .get("contacts")
            .is_some_and(|count| *count > 0.0)
    };
    run.result.as_ref().is_ok_and(touched)
}

/// Hundredths of a point.
fn cents(points: f64) -> f64 {
    (100.0 * points).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::run;

    const TEXT: &str = r#"
title = "T"
statement = "S"
points = 8
contact_penalty = 4
[[scenario]]
scenario = "mode1"
public_seeds = [1, 2]
weight = 3
[[scenario]]
scenario = "mode5"
public_seeds = [1, 2]
[[criterion]]
title = "C"
metric = "control_period_s"
points = 1
full = 0
none = 1
"#;

    #[test]
    fn weights_contacts_and_medians_count_as_the_file_says() {
        let assignment = Assignment::parse("a.toml", TEXT).unwrap();
        let of = |test: usize, value: f64, contacts: f64| {
            let mut result = run(&assignment.tests[test].setup, 1).unwrap();
            result.metrics.insert("control_period_s".into(), value);
            result.metrics.insert("contacts".into(), contacts);
            GradedRun {
                test,
                result: Ok(result),
                seen: None,
            }
        };
        let runs = vec![
            of(0, 0.0, 0.0),
            of(0, 0.5, 2.0),
            of(1, 1.0, 0.0),
            of(1, 1.0, 0.0),
        ];
        let mark = Mark::of(&assignment, "ana", runs);
        assert_eq!([mark.lines[0].of, mark.lines[1].of], [6.0, 2.0]);
        assert_eq!([mark.lines[0].points, mark.lines[1].points], [4.5, 0.0]);
        // One run of four touched something.
        assert_eq!((mark.penalty, mark.points), (1.0, 3.5));
        assert!(!mark.pass);
        // Of two, the worse one.
        assert_eq!(mark.lines[0].median(&assignment), Some(0.5));
    }
}

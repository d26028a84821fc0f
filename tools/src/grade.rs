//! Grades a class of a hundred, thirty of whom are hostile, and compares every mark with that of a class without them.
//!
//! `cargo xtask campaign --only grade` builds and starts it in the project's root. Arguments: hand-ins (100), scenarios
//! (5), seeds of each (10). Exit status 1 if a mark differs by a byte, a hostile program earns a point, or the model
//! solution does not have them all.

use crate::data;
use rayon::prelude::*;
use rumbo_experiment::grade::{Assignment, HandIn, Mark, grade};
use rumbo_sketch::limits::Limits;
use rumbo_sketch::sandbox::Sandbox;
use rumbo_sketch::{BOARDS, Compiler, Given, Source, Toolchain, given};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

const ASSIGNMENT: &str = "examples/assignments/speed";
/// Of ten hand-ins so many are hostile.
const HOSTILE_OF_TEN: usize = 3;

pub(crate) fn main() -> ExitCode {
    crate::ended("grade", run())
}

fn run() -> Result<bool, Box<dyn Error>> {
    let numbers: Result<Vec<usize>, _> = crate::arguments().map(|text| text.parse()).collect();
    let numbers = numbers?;
    let number = |index: usize, usual| numbers.get(index).copied().unwrap_or(usual);
    let (count, scenarios, seeds) = (number(0, 100), number(1, 5), number(2, 10));
    let assignment = assignment(scenarios, seeds)?;
    let compiler = compiler(&assignment)?;
    let Given::Sketch(model) = given(&Path::new(ASSIGNMENT).join("model"), true)? else {
        return Err("the model is no sketch".into());
    };

    let hostile: BTreeMap<String, String> = data(include_str!("../data/hostile.toml"))?;
    let hostile: Vec<(String, String)> = hostile.into_iter().collect();

    let begun = Instant::now();
    let sources: Vec<(bool, Source)> = (0..count)
        .map(|index| source(&model, &hostile, index))
        .collect();
    let all: Vec<(bool, HandIn)> = sources
        .par_iter()
        .map(|(hostile, source)| (*hostile, compiled(&compiler, source)))
        .collect();
    let compiled_s = begun.elapsed().as_secs_f64();
    let (hostile, honest): (Vec<_>, Vec<_>) = all.into_iter().partition(|(hostile, _)| *hostile);
    let honest: Vec<HandIn> = honest.into_iter().map(|(_, one)| one).collect();
    let all_of =
        |hand_ins: &[HandIn]| grade(&assignment, hand_ins, || true).ok_or("a run was left out");
    let alone = all_of(&honest)?;
    let alone_s = begun.elapsed().as_secs_f64() - compiled_s;
    let bad = hostile.len();
    let together: Vec<HandIn> = hostile
        .into_iter()
        .map(|(_, one)| one)
        .chain(honest)
        .collect();
    let begun = Instant::now();
    let marks = all_of(&together)?;
    let graded_s = begun.elapsed().as_secs_f64();

    println!(
        "{count} hand-ins, {bad} of them hostile; {scenarios} scenarios x {seeds} seeds of {} s",
        assignment.tests[0].setup.scenario.duration_s
    );
    println!(
        "compiled in {compiled_s:.0} s, driven in {graded_s:.0} s; without the hostile in {alone_s:.0} s"
    );
    let same = same(&alone, &marks[bad..])?;
    println!(
        "marks that the hostile changed: {}",
        if same { "none" } else { "SOME" }
    );
    let gained = marks[..bad].iter().filter(|mark| mark.points > 0.0);
    let gained: Vec<_> = gained.map(|mark| mark.name.as_str()).collect();
    println!("hostile programs with points: {gained:?}");
    Ok(same && gained.is_empty())
}

/// The compiler in its sandbox, with nothing kept: what is measured is a class that comes for the first time.
fn compiler(assignment: &Assignment) -> Result<Compiler, Box<dyn Error>> {
    let toolchain = Toolchain::find()?;
    let limits = Limits {
        time: Duration::from_secs_f64(assignment.compile_s),
        ..Limits::default()
    };
    let sandbox = Sandbox::walled(&toolchain, limits)?;
    let cache = Path::new("target/sketches/class");
    let _ = std::fs::remove_dir_all(cache);
    Ok(Compiler::new(
        BOARDS[0],
        toolchain,
        sandbox,
        cache.to_owned(),
    )?)
}

/// The assignment with so many scenarios and seeds.
fn assignment(scenarios: usize, seeds: usize) -> Result<Assignment, Box<dyn Error>> {
    let mut assignment = Assignment::read(&format!("{ASSIGNMENT}/assignment.toml"))?;
    let mut test = assignment.tests[0].clone();
    // The first are those whose marks the model has in full.
    let known: Vec<u64> = test.seeds().collect();
    test.public = known.iter().copied().chain(1000..).take(seeds).collect();
    test.hidden = Vec::new();
    assignment.tests = vec![test; scenarios.max(1)];
    Ok(assignment)
}

/// A hand-in: hostile ones between models that each have a comment of their own.
fn source(model: &Source, programs: &[(String, String)], index: usize) -> (bool, Source) {
    let hostile = index % 10 < HOSTILE_OF_TEN;
    let name = format!("hand-in-{index}");
    if !hostile {
        let mut own = model.clone();
        for bytes in own.files.values_mut() {
            bytes.extend(format!("// {index}\n").bytes());
        }
        return (false, Source { name, ..own });
    }
    let number = HOSTILE_OF_TEN * (index / 10) + index % 10;
    let (what, text) = &programs[number % programs.len()];
    let files = [(
        "bad.ino".to_owned(),
        format!("{text}// {index}\n").into_bytes(),
    )];
    let name = format!("{name}-{what}");
    (
        true,
        Source {
            name,
            files: files.into(),
        },
    )
}

fn compiled(compiler: &Compiler, source: &Source) -> HandIn {
    let image = compiler
        .compile(source, &[])
        .map_err(|error| error.to_string());
    let bytes =
        image.and_then(|image| std::fs::read(image.path).map_err(|error| error.to_string()));
    HandIn {
        name: source.name.clone(),
        program: bytes.map_err(|error| vec![error]),
        notes: Vec::new(),
    }
}

fn same(one: &[Mark], other: &[Mark]) -> Result<bool, serde_json::Error> {
    Ok(serde_json::to_string(one)? == serde_json::to_string(other)?)
}

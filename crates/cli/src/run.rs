//! `rumbo run`: scenarios without a window, as fast as the machine can, judged against their limits.

use crate::args::RunArgs;
use crate::failure::Failure;
use crate::fleet_table;
use crate::interrupt;
use crate::observe;
use crate::output::{self, in_words};
use crate::place::{self, Guard};
use crate::results::Results;
use crate::run_log::{Kept, RunSource};
use indicatif::{ProgressBar, ProgressStyle};
use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_experiment::compare::median;
use rumbo_experiment::files::{Library, Overrides, ScenarioFile, Setup, TimedText};
use rumbo_experiment::run::{self, RunResult};
use rumbo_log::LogKind;
use rumbo_sim::trace::Trace;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

/// Runs every scenario with every seed; one line or table per scenario, or one JSON object per run.
pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let overrides = overrides(args);
    let library = Library::new();
    let setup = |name: &String| library.setup(name, &overrides);
    let setups: Vec<Setup> = args.scenarios.iter().map(setup).collect::<Result<_, _>>()?;
    setups.iter().try_for_each(sends_all)?;
    setups
        .iter()
        .try_for_each(|setup| check_policy(setup, &overrides))?;
    check_places(args, &setups, &overrides)?;
    note_in_vain(args, &setups);
    if let Some(folder) = &args.out {
        place::try_folder(folder)?;
    }

    set_threads(args.threads)?;
    let runs = args.runs as usize;
    let jobs: Vec<_> = setups
        .iter()
        .flat_map(|setup| seeds(args).map(move |seed| (setup, seed)))
        .collect();
    let progress = progress_bar(jobs.len());
    let (mut passed, mut results) = (true, Vec::new());
    // A debugger holds the run, so that Ctrl-C ends it.
    let asked = (!observe::is_wanted(args)).then(interrupt::asked);
    let go_on = || match &asked {
        Some(asked) if asked.load(Ordering::Relaxed) => Err(Failure::Interrupted),
        _ => Ok(()),
    };
    let source = RunSource {
        kind: LogKind::Run,
        library: &library,
        overrides: &overrides,
    };
    let mut kept = Kept::of(jobs.len(), args.out.is_none() && !args.no_record);
    let handle = |setup: &Setup, mut result: RunResult| {
        progress.inc(1);
        passed &= result.pass;
        match &args.out {
            Some(folder) => {
                let results = Results::of(folder, &result.scenario, result.seed);
                results.write(&source, setup, &result)?;
            }
            None => progress.suspend(|| kept.take(&source, setup, &result)),
        }
        if args.json {
            progress.suspend(|| output::json(&result))?;
            return go_on();
        }
        // A thousand traces would fill the memory; what is printed needs none.
        result.trace = Trace::default();
        result.robots.clear();
        results.push(result);
        if results.len() == runs {
            let results = std::mem::take(&mut results);
            progress.suspend(|| report(setup, &results))?;
        }
        go_on()
    };
    let ended = run_jobs(args, &jobs, &overrides, go_on, handle);
    let done = progress.position();
    progress.finish_and_clear();
    // Of the scenario whose runs were interrupted, those that are over.
    if !results.is_empty()
        && let Some((setup, _)) = jobs[..done as usize].last()
    {
        report(setup, &results)?;
    }
    kept.report();
    let ended = match ended {
        // Too late: there is nothing left to interrupt.
        Err(Failure::Interrupted) if done == jobs.len() as u64 => Ok(()),
        ended => ended,
    };
    if matches!(ended, Err(Failure::Interrupted)) {
        let all = output::counted(jobs.len(), "run");
        let kept = match &args.out {
            _ if done == 0 => "; nothing is kept".into(),
            Some(folder) => format!("; the results of those are in {}", output::shown(folder)),
            None => String::new(),
        };
        output::note(&format!("interrupted after {done} of {all}{kept}"));
    }
    ended?;
    match passed {
        true => Ok(()),
        false => Err(Failure::LimitMissed),
    }
}

/// A program without our parameters would do the same with any.
pub(crate) fn check_control<'a>(
    mut names: impl Iterator<Item = &'a str>,
    setup: &Setup,
) -> Result<(), Failure> {
    match names.find(|name| ParamId::from_name(name).is_some()) {
        Some(name) if !setup.takes_parameters() => Err(Failure::Input(format!(
            "{name}: is a parameter of Rumbo's control core, which does not drive here; choose one of the plant's (`rumbo list plant`)"
        ))),
        _ => Ok(()),
    }
}

/// Refuses a policy for a scenario whose mode asks none.
pub(crate) fn check_policy(setup: &Setup, overrides: &Overrides) -> Result<(), Failure> {
    let mode = |robot: &Setup| robot.scenario.mode;
    match &overrides.policy {
        Some(policy)
            if !setup
                .robots()
                .iter()
                .any(|robot| mode(robot) == ModeId::Policy) =>
        {
            Err(Failure::Input(format!(
                "--policy {policy}: scenario {} drives in mode {} ({}), and only mode {} (policy) is driven by one; \
                 leave --policy out, or choose a scenario of that mode, as mode9-random",
                setup.scenario.name,
                mode(setup) as u8,
                mode(setup).name(),
                ModeId::Policy as u8,
            )))
        }
        _ => Ok(()),
    }
}

/// Says of a parameter of our program that another one drives, and of commands that nobody receives.
fn note_in_vain(args: &RunArgs, setups: &[Setup]) {
    let names = || args.parameters.params.iter().map(|(name, _)| name.as_str());
    let refused = |setup: &Setup| check_control(names(), setup).err();
    if let Some(why) = setups.iter().find_map(refused) {
        output::note(&format!("--param {why}"));
    }
    let deaf = |setup: &Setup| {
        let firmware = setup.firmware.as_ref();
        firmware.is_some_and(|firmware| firmware.link_usart().is_none())
    };
    if !args.commands.is_empty() && setups.iter().any(deaf) {
        output::note(
            "--command: the robot has no Bluetooth module; --usb types over the USB cable, and one on pins 0 and 1 of a Uno is \
             link_rx = 0 and link_tx = 1 in the wiring, --pins link_rx=0,link_tx=1 of `rumbo new robot`",
        );
    }
}

/// What is in place of the scenarios'.
fn overrides(args: &RunArgs) -> Overrides {
    let ending = args.line_ending;
    let lines = args.commands.iter().chain(&args.usb).cloned();
    let lines = lines.map(|text| TimedText { ending, ..text });
    let hands = args.press.iter().flatten().chain(&args.place).cloned();
    let of_scenario = args
        .setting
        .overrides(args.program, &args.image, &args.parameters);
    Overrides {
        texts: lines.chain(hands).collect(),
        duration_s: args.duration,
        ..of_scenario
    }
}

/// Sets the number of threads, if one is requested.
pub(crate) fn set_threads(threads: Option<u16>) -> Result<(), Failure> {
    let Some(threads) = threads else {
        return Ok(());
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
    pool.build_global().map_err(Failure::input)
}

fn seeds(args: &RunArgs) -> impl Iterator<Item = u64> {
    let first = args.seed.seed;
    (0..args.runs).map(move |index| first.wrapping_add(u64::from(index)))
}

/// Refuses, before anything runs, what would write over something else than an older result of the same run.
fn check_places(args: &RunArgs, setups: &[Setup], overrides: &Overrides) -> Result<(), Failure> {
    let named = [&args.setting.robot, &args.setting.world];
    let inputs = args.scenarios.iter().chain(named.into_iter().flatten());
    let inputs = inputs.map(PathBuf::from).chain(args.image.firmware.clone());
    let guard = Guard::new(inputs, args.overwrite.force);
    observe::check_places(args, &guard, setups, overrides)?;
    let Some(folder) = &args.out else {
        return Ok(());
    };
    // Seeds differ, so that names do if those of the scenarios do.
    let named = |(scenario, setup): (&String, &Setup)| {
        let results = Results::of(folder, &setup.scenario.name, args.seed.seed);
        (results.json(), scenario.clone())
    };
    let results: Vec<_> = args.scenarios.iter().zip(setups).map(named).collect();
    place::distinct(&results)?;
    for setup in setups {
        for seed in seeds(args) {
            let results = Results::of(folder, &setup.scenario.name, seed);
            results.check(&guard, setup, overrides, seed)?;
        }
    }
    Ok(())
}

/// All of them at once; the one whose program is looked at by itself.
fn run_jobs(
    args: &RunArgs,
    jobs: &[(&Setup, u64)],
    overrides: &Overrides,
    go_on: impl Fn() -> Result<(), Failure>,
    mut handle: impl FnMut(&Setup, RunResult) -> Result<(), Failure>,
) -> Result<(), Failure> {
    if !observe::is_wanted(args) {
        return run::run_all_on(rayon::current_num_threads(), jobs, go_on, handle);
    }
    let result = observe::run(args, jobs, overrides)?;
    jobs.iter()
        .take(1)
        .try_for_each(|(setup, _)| handle(setup, result.clone()))
}

/// On stderr, and only where that is a terminal and there is something to wait for.
pub(crate) fn progress_bar(runs: usize) -> ProgressBar {
    if runs < 4 {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len} runs, {eta} left");
    ProgressBar::new(runs as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// Refuses a line that is due when the run is over.
fn sends_all(setup: &Setup) -> Result<(), Failure> {
    let duration_s = setup.scenario.duration_s;
    match setup.texts.iter().find(|text| text.at_s >= duration_s) {
        None => Ok(()),
        Some(late) => Err(Failure::Input(format!(
            "scenario {}: lasts {duration_s} s, and `{}` is to be sent at {} s; send it earlier, or let it last longer, --duration",
            setup.scenario.name, late.text, late.at_s
        ))),
    }
}

/// All runs of one scenario: each metric's range over the seeds against its limits, and why runs did not pass.
fn report(setup: &Setup, results: &[RunResult]) -> Result<(), Failure> {
    let scenario = &setup.scenario;
    let passes = results.iter().filter(|result| result.pass).count();
    let seeds = match results {
        [first, .., last] => format!(
            "seeds {} to {}, {passes} of {} pass",
            first.seed,
            last.seed,
            results.len()
        ),
        _ => results
            .iter()
            .map(|only| format!("seed {}", only.seed))
            .collect(),
    };
    output::line(&format!("{}: {} ({seeds})", scenario.name, scenario.title))?;
    let mut values: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for (metric, value) in results.iter().flat_map(|result| &result.metrics) {
        values.entry(metric).or_default().push(*value);
    }
    let of_robots = fleet_table::take(setup, &mut values);
    let mut rows = Vec::new();
    if results.len() > 1 {
        rows.push(
            ["", "min", "median", "max", "limit"]
                .map(String::from)
                .to_vec(),
        );
    }
    // What is judged comes first.
    let (judged, others): (Vec<_>, Vec<_>) = values
        .into_iter()
        .partition(|(metric, _)| scenario.limits.contains_key(*metric));
    let both = judged.into_iter().chain(others);
    rows.extend(both.map(|(metric, values)| row(scenario, metric, values)));
    output::table(&rows)?;
    for table in of_robots {
        output::table(&table)?;
    }
    for result in results {
        for failure in &result.failures {
            output::line(&format!("  FAILED, seed {}: {failure}", result.seed))?;
        }
        for note in &result.notes {
            // What a display shows has lines of its own.
            let note = note.to_string();
            let mut lines = note.lines();
            let first = lines.next().unwrap_or_default();
            output::line(&format!("  note, seed {}: {first}", result.seed))?;
            lines.try_for_each(|line| output::line(&format!("    {line}")))?;
        }
    }
    Ok(())
}

/// One metric: its value, or min, median and max of many; its limit, and whether that is kept.
fn row(scenario: &ScenarioFile, metric: &str, mut values: Vec<f64>) -> Vec<String> {
    values.sort_by(f64::total_cmp);
    let mut row = vec![metric.to_owned()];
    match &values[..] {
        [first, .., last] => row.extend([*first, median(&values), *last].map(in_words)),
        _ => row.extend(values.iter().map(|only| in_words(*only))),
    }
    if let Some(bounds) = scenario.limits.get(metric) {
        let missed = values.iter().filter(|value| !bounds.admit(**value)).count();
        let verdict = match (missed, values.len()) {
            (0, _) => "ok".into(),
            (_, 1) => "MISSED".into(),
            (_, runs) => format!("MISSED by {missed} of {runs}"),
        };
        row.extend([bounds.to_string(), verdict]);
    }
    row
}

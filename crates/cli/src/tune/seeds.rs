//! A scenario's experiment with many seeds, for a page that draws those robots beside its own.

use crate::failure::Failure;
use crate::run_log::RunSource;
use rumbo_experiment::files::{Kind, Library, Overrides, unknown};
use rumbo_experiment::run::run_all_on;
use rumbo_log::{Log, Row};
use rumbo_session::headless::record_run;
use rumbo_station::NotTuned;
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::io::Cursor;

/// Most seeds of a request.
const MOST: u32 = 32;
/// Rows of a run are thinned out to about as many: what a plot shows of a range, and a map of a robot.
const MOST_ROWS: usize = 400;

/// What a page asks for.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Asked {
    /// One of those offered: a page names no path.
    scenario: String,
    /// The same; none: the scenario's.
    world: Option<String>,
    rig: Option<String>,
    /// The first.
    seed: u64,
    seeds: u32,
    /// Of the control core.
    params: BTreeMap<String, f64>,
}

/// The runs, each with its seed, whether it keeps all limits, and its signals.
pub(super) fn drive(
    asked: Asked,
    (robot, scenarios): (&Option<String>, &[String]),
    threads: usize,
    progress: &(dyn Fn(f64) + Sync),
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Result<Value, NotTuned> {
    let library = Library::new();
    let overrides = overrides(&asked, robot, scenarios, &library)?;
    let setup = library
        .setup(&asked.scenario, &overrides)
        .map_err(refused)?;
    if !setup.fleet.is_empty() {
        return Err(refused(
            "several robots are in this world: one seed at a time",
        ));
    }
    let source = RunSource {
        kind: rumbo_log::LogKind::Run,
        library: &library,
        overrides: &overrides,
    };
    let seeds = (0..asked.seeds).map(|more| asked.seed.wrapping_add(u64::from(more)));
    let jobs: Vec<_> = seeds.map(|seed| (&setup, seed)).collect();
    let mut runs = Vec::new();
    let go_on = || match goes_on() {
        true => Ok(()),
        false => Err(Failure::Interrupted),
    };
    let done = run_all_on(threads, &jobs, go_on, |setup, result| {
        source.each_robot(setup, &result, |manifest, run| {
            let bytes = record_run(Vec::new(), manifest, run).map_err(Failure::input)?;
            let log = Log::read_signals(Cursor::new(bytes)).map_err(Failure::input)?;
            let every = log.rows.len().div_ceil(MOST_ROWS).max(1);
            let rows = log.rows.iter().step_by(every).map(Row::cells);
            runs.push(json!({
                "seed": result.seed,
                "pass": result.pass,
                "columns": Row::names().collect::<Vec<_>>(),
                "rows": rows.collect::<Vec<_>>(),
            }));
            Ok::<_, Failure>(())
        })?;
        progress(runs.len() as f64 / f64::from(asked.seeds));
        Ok(())
    });
    match done {
        Ok(()) => Ok(json!({ "runs": runs })),
        Err(Failure::Input(why)) => Err(NotTuned(why)),
        Err(_) => Err(refused("ended before all seeds were driven")),
    }
}

/// What is in place of the scenario's, if all of it is offered.
fn overrides(
    asked: &Asked,
    robot: &Option<String>,
    scenarios: &[String],
    library: &Library,
) -> Result<Overrides, NotTuned> {
    let one_of = |what, name: &String, known: &[String]| match known.contains(name) {
        true => Ok(()),
        false => Err(refused(unknown(
            what,
            name,
            known.iter().map(String::as_str),
        ))),
    };
    one_of("scenario", &asked.scenario, scenarios)?;
    if let Some(world) = &asked.world {
        one_of("world", world, &library.list(Kind::World))?;
    }
    if !(1..=MOST).contains(&asked.seeds) {
        return Err(refused(format!(
            "from 1 to {MOST} seeds are driven for a page"
        )));
    }
    Ok(Overrides {
        robot: robot.clone(),
        world: asked.world.clone(),
        rig: asked.rig.clone(),
        parameters: asked.params.clone().into_iter().collect(),
        ..Overrides::default()
    })
}

fn refused(error: impl Display) -> NotTuned {
    NotTuned(error.to_string())
}

//! `rumbo tune`: values of control parameters for an aim, checked on robots that the search has not seen.

mod dashboard;
mod seeds;

pub(crate) use dashboard::in_dashboard;

use crate::args::TuneArgs;
use crate::calibrate::{check_robot, rewrite_robot};
use crate::compare::variants::{differences_as_json, print_differences};
use crate::failure::Failure;
use crate::interrupt;
use crate::output::{self, figure};
use crate::run::set_threads;
use indicatif::{ProgressBar, ProgressStyle};
use rumbo_experiment::compare::differences;
use rumbo_experiment::files::{Library, Overrides};
use rumbo_experiment::run;
use rumbo_experiment::tune::{Search, TuningOutcome, TuningPlan, TuningRequest, is_tuned};
use serde_json::{Value, json};
use std::sync::atomic::Ordering;

/// Runs on the image: each takes about two seconds.
const ON_IMAGE: usize = 20;

/// Searches, checks on other robots, writes, and says what it bought.
pub(crate) fn tune(args: &TuneArgs) -> Result<(), Failure> {
    let library = Library::new();
    let overrides = Overrides {
        robot: args.setting.robot.clone(),
        rig: args.setting.rig.clone(),
        world: args.setting.world.clone(),
        parameters: args.parameters.params.clone(),
        ..Overrides::default()
    };
    let setup = library.setup(&args.scenario, &overrides)?;
    if let Some(out) = &args.out {
        check_robot(out, &setup.robot.name, is_tuned, args.overwrite)?;
    }
    let request = TuningRequest {
        over: args.over.clone(),
        objective: args.aims.clone().unwrap_or_default(),
        seed: args.seed.seed,
        runs: args.runs,
        held_out: Search::held_out(args.seed.seed, args.held_out),
    };
    let plan = TuningPlan::new(setup, &library.scenario(&args.scenario)?, request)?;
    set_threads(args.threads)?;
    let asked = interrupt::asked();
    let is_asked = || asked.load(Ordering::Relaxed);
    let bar = progress_bar();
    let outcome = plan.run(&|share| bar.set_position((1_000.0 * share) as u64), &|| {
        !is_asked()
    });
    let percent = bar.position() / 10;
    bar.finish_and_clear();
    let checked = match is_asked() {
        true => Err(Failure::Interrupted),
        false => {
            let outcome = outcome?;
            on_image(args, &library, &overrides, &plan, &outcome, &is_asked).map(|on| (outcome, on))
        }
    };
    if matches!(checked, Err(Failure::Interrupted)) {
        output::note(&format!(
            "interrupted after {percent} % of the search; nothing is written"
        ));
    }
    let (outcome, on_image) = checked?;
    match args.json {
        true => output::json(&as_json(&plan, &outcome, on_image))?,
        false => report(&plan, &outcome, on_image)?,
    }
    write(args, &plan, &outcome)?;
    let all_pass = outcome.passes[1] == plan.seeds().len();
    match all_pass && on_image.is_none_or(|(pass, of)| pass == of) {
        true => Ok(()),
        false => Err(Failure::LimitMissed),
    }
}

/// How many of the first unseen robots pass with the image, and of how many.
fn on_image(
    args: &TuneArgs,
    library: &Library,
    overrides: &Overrides,
    plan: &TuningPlan,
    outcome: &TuningOutcome,
    is_asked: &dyn Fn() -> bool,
) -> Result<Option<(usize, usize)>, Failure> {
    let Some(image) = &args.image else {
        return Ok(None);
    };
    let mut overrides = overrides.clone();
    overrides.firmware = Some(image.clone());
    let setup = library.setup(&args.scenario, &overrides)?;
    if !setup.takes_parameters() {
        return Err(Failure::Input(format!(
            "{}: is no image of Rumbo's firmware: it takes no parameters",
            image.display()
        )));
    }
    let on_image = Search {
        setup: &setup,
        ..plan.search()
    };
    let setup = on_image.setup_of(&outcome.found.values)?;
    let seeds = plan.seeds();
    let seeds = &seeds[..ON_IMAGE.min(seeds.len())];
    let jobs: Vec<_> = seeds.iter().map(|seed| (&setup, *seed)).collect();
    let mut pass = 0;
    let go_on = || match is_asked() {
        true => Err(Failure::Interrupted),
        false => Ok(()),
    };
    run::run_all_on(rayon::current_num_threads(), &jobs, go_on, |_, result| {
        pass += usize::from(result.pass);
        Ok(())
    })?;
    Ok(Some((pass, seeds.len())))
}

/// In hundredths of all runs.
fn progress_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {percent} %, at most {eta} left");
    // By the permille: until it moves, the time left reads 0.
    ProgressBar::new(1_000).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// The outcome, for programs and for the dashboard.
fn as_json(plan: &TuningPlan, outcome: &TuningOutcome, on_image: Option<(usize, usize)>) -> Value {
    let values = plan
        .over()
        .iter()
        .zip(&outcome.found.values)
        .map(|(one, value)| json!({ "name": one.id.name(), "now": one.start, "tuned": value }));
    let [now, tuned] = outcome.passes;
    json!({
        "scenario": plan.setup().scenario.name,
        "runs": outcome.found.runs,
        "parameters": values.collect::<Vec<_>>(),
        "held_out": { "seeds": plan.seeds(), "passed_now": now, "passed_tuned": tuned },
        "image": on_image.map(|(pass, of)| json!({ "passed": pass, "of": of })),
        "differences": differences_as_json(&outcome.runs[0], &outcome.runs[1]),
    })
}

fn report(
    plan: &TuningPlan,
    outcome: &TuningOutcome,
    on_image: Option<(usize, usize)>,
) -> Result<(), Failure> {
    let scenario = &plan.setup().scenario;
    output::line(&format!(
        "{}: {} ({} runs of the search)",
        scenario.name, scenario.title, outcome.found.runs
    ))?;
    let mut rows = vec![["", "now", "tuned"].map(String::from).to_vec()];
    let values = plan.over().iter().zip(&outcome.found.values);
    rows.extend(values.map(|(one, value)| {
        let name = match one.id.unit() {
            "1" => one.id.name().to_owned(),
            unit => format!("{} ({unit})", one.id.name()),
        };
        vec![name, figure(one.start), figure(*value)]
    }));
    output::table(&rows)?;
    let (of, [now, then]) = (plan.seeds().len(), outcome.passes);
    output::line(&format!(
        "on {of} robots that the search has not seen: {now} passed, {then} pass"
    ))?;
    let [now, tuned] = &outcome.runs;
    print_differences(&differences(now, tuned), ["now", "tuned"])?;
    match on_image {
        Some((pass, of)) => output::line(&format!("on the image: {pass} of {of} pass")),
        None => Ok(()),
    }
}

/// Writes the robot file, unless that would be no gain.
fn write(args: &TuneArgs, plan: &TuningPlan, outcome: &TuningOutcome) -> Result<(), Failure> {
    let Some(out) = &args.out else {
        return Ok(());
    };
    if !outcome.is_kept() {
        output::note(&format!(
            "{}: not written, more of the unseen robots fail than before",
            out.display()
        ));
        return Ok(());
    }
    rewrite_robot(out, plan.setup(), |text, today| {
        plan.rewrite(&outcome.found, text, today)
    })?;
    output::aside(&format!("written: {}", out.display()));
    Ok(())
}

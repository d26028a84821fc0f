//! `rumbo tune`: values of control parameters for an aim, checked on robots that the search has not seen.

use crate::args::TuneArgs;
use crate::calibrate::{check_robot, rewrite_robot};
use crate::compare::variants::{differences_as_json, print_differences};
use crate::failure::Failure;
use crate::interrupt;
use crate::output::{self, figure};
use crate::run::set_threads;
use indicatif::{ProgressBar, ProgressStyle};
use rumbo_experiment::compare::{Variant, differences, run_variants};
use rumbo_experiment::files::{Library, Overrides, Setup};
use rumbo_experiment::run::{self, check_metrics};
use rumbo_experiment::tune::Tuned;
use rumbo_experiment::tune::{Found, Objective, Search, is_tuned, rewrite, tuned};
use serde_json::json;
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
    check(args, &library, &setup)?;
    let over = tuned(&setup, &args.over)?;
    let objective = args.aims.clone().unwrap_or_default();
    set_threads(args.threads)?;
    check_metrics(objective.names(), &setup, args.seed.seed)?;
    let search = Search {
        setup: &setup,
        over: &over,
        objective: &objective,
        seed: args.seed.seed,
        budget: args
            .runs
            .map_or_else(|| Search::default_budget(&setup), |runs| runs as usize),
    };
    let asked = interrupt::asked();
    let is_asked = || asked.load(Ordering::Relaxed);
    let bar = progress_bar();
    let found = search.run(|share| {
        bar.set_position((100.0 * share) as u64);
        !is_asked()
    });
    bar.finish_and_clear();
    let found = found?;
    if is_asked() {
        return Err(Failure::Interrupted);
    }
    let tuned = search.setup_of(&found.values)?;
    let variants = [("now", &setup), ("tuned", &tuned)];
    let variants = variants.map(|(name, setup)| (name.to_owned(), setup.clone()));
    let first = search.seed.wrapping_add(Search::SEEDS);
    let seeds: Vec<u64> = (0..args.held_out)
        .map(|index| first.wrapping_add(index.into()))
        .collect();
    let runs = run_variants(&variants, &seeds, || match is_asked() {
        true => Err(Failure::Interrupted),
        false => Ok(()),
    })?;
    let on_image = on_image(args, &library, &overrides, &search, &found, &seeds)?;
    let outcome = Outcome {
        args,
        objective: &objective,
        over: &over,
        found: &found,
        runs: &runs,
        seeds: &seeds,
        on_image,
    };
    outcome.report(&setup)?;
    outcome.write(&setup)?;
    match outcome.passes(1) == seeds.len() && outcome.on_image.is_none_or(|(pass, of)| pass == of) {
        true => Ok(()),
        false => Err(Failure::LimitMissed),
    }
}

/// Refuses what could not come to anything, before anything runs.
fn check(args: &TuneArgs, library: &Library, setup: &Setup) -> Result<(), Failure> {
    let own = library.scenario(&args.scenario)?;
    args.over.iter().try_for_each(|over| over.check(&own))?;
    match &args.out {
        Some(out) => check_robot(out, &setup.robot.name, is_tuned, args.overwrite),
        None => Ok(()),
    }
}

/// How many of the first unseen robots pass with the image, and of how many.
fn on_image(
    args: &TuneArgs,
    library: &Library,
    overrides: &Overrides,
    search: &Search<'_>,
    found: &Found,
    seeds: &[u64],
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
        ..*search
    };
    let setup = on_image.setup_of(&found.values)?;
    let seeds = &seeds[..ON_IMAGE.min(seeds.len())];
    let jobs: Vec<_> = seeds.iter().map(|seed| (&setup, *seed)).collect();
    let mut pass = 0;
    run::run_all(&jobs, |_, result| {
        pass += usize::from(result.pass);
        Ok::<(), Failure>(())
    })?;
    Ok(Some((pass, seeds.len())))
}

/// In hundredths of the budget.
fn progress_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {pos} %, at most {eta} left");
    ProgressBar::new(100).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

struct Outcome<'a> {
    args: &'a TuneArgs,
    objective: &'a Objective,
    over: &'a [Tuned],
    found: &'a Found,
    /// Now and tuned, on the unseen robots.
    runs: &'a [Variant],
    seeds: &'a [u64],
    on_image: Option<(usize, usize)>,
}

impl Outcome<'_> {
    /// Runs that pass and keep the objective's limits.
    fn passes(&self, variant: usize) -> usize {
        let variant = &self.runs[variant];
        let runs = variant.passes.iter().zip(&variant.metrics);
        runs.filter(|(pass, run)| **pass && self.objective.admits(run))
            .count()
    }

    fn report(&self, setup: &Setup) -> Result<(), Failure> {
        let [now, then] = [self.passes(0), self.passes(1)];
        if self.args.json {
            let values = self.over.iter().zip(&self.found.values).map(
                |(one, value)| json!({ "name": one.id.name(), "now": one.start, "tuned": value }),
            );
            return output::json(&json!({
                "scenario": setup.scenario.name,
                "runs": self.found.runs,
                "parameters": values.collect::<Vec<_>>(),
                "held_out": { "seeds": self.seeds, "pass_now": now, "pass_tuned": then },
                "image": self.on_image.map(|(pass, of)| json!({ "pass": pass, "of": of })),
                "differences": differences_as_json(&self.runs[0], &self.runs[1]),
            }));
        }
        output::line(&format!(
            "{}: {} ({} runs of the search)",
            setup.scenario.name, setup.scenario.title, self.found.runs
        ))?;
        let mut rows = vec![["", "now", "tuned"].map(String::from).to_vec()];
        rows.extend(
            self.over
                .iter()
                .zip(&self.found.values)
                .map(|(one, value)| {
                    let name = match one.id.unit() {
                        "1" => one.id.name().to_owned(),
                        unit => format!("{} ({unit})", one.id.name()),
                    };
                    vec![name, figure(one.start), figure(*value)]
                }),
        );
        output::table(&rows)?;
        let of = self.seeds.len();
        output::line(&format!(
            "on {of} robots that the search has not seen: {now} passed, {then} pass"
        ))?;
        print_differences(&differences(&self.runs[0], &self.runs[1]), ["now", "tuned"])?;
        match self.on_image {
            Some((pass, of)) => output::line(&format!("on the image: {pass} of {of} pass")),
            None => Ok(()),
        }
    }

    /// Writes the robot file, unless that would be no gain.
    fn write(&self, setup: &Setup) -> Result<(), Failure> {
        let Some(out) = &self.args.out else {
            return Ok(());
        };
        if self.passes(1) < self.passes(0) {
            output::note(&format!(
                "{}: not written, more of the unseen robots fail than before",
                out.display()
            ));
            return Ok(());
        }
        let values = self.over.iter().zip(&self.found.values);
        let values: Vec<_> = values.map(|(one, value)| (one.id, *value)).collect();
        rewrite_robot(out, setup, |text, today| {
            let about = format!("on {today} for {}.", setup.scenario.name);
            rewrite(text, &values, &about)
        })?;
        output::aside(&format!("written: {}", out.display()));
        Ok(())
    }
}

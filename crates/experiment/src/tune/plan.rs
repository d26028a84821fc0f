//! A whole tuning, from what is asked for to what it bought: the search, then robots that it has not seen, each with
//! the present values and with those found. Command line, dashboard and Python make theirs here.

use super::{Found, Objective, Over, Search, TuneError, Tuned, rewrite, tuned};
use crate::compare::{Variant, run_variants};
use crate::files::{FileError, ScenarioFile, Setup};
use crate::run::check_metrics;
use rumbo_plant::rewrite::RewriteError;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct TuningRequest {
    /// What to search over.
    pub over: Vec<Over>,
    /// What for.
    pub objective: Objective,
    /// First seed of the search.
    pub seed: u64,
    /// Most runs of the search; `None`: [`Search::default_budget`].
    pub runs: Option<u32>,
    /// Seeds of the robots, none of them of the search, on which the values found are checked: [`Search::held_out`].
    pub held_out: Vec<u64>,
}

/// A tuning that is ready to begin.
#[derive(Clone, Debug)]
pub struct TuningPlan {
    setup: Setup,
    over: Vec<Tuned>,
    objective: Objective,
    seed: u64,
    budget: usize,
    held_out: Vec<u64>,
}

/// What a tuning bought.
#[derive(Clone, Debug)]
pub struct TuningOutcome {
    /// What the search found.
    pub found: Found,
    /// The runs that the search has not seen: with the values now, and tuned.
    pub runs: [Variant; 2],
    /// How many of them pass and keep the limits of the request: now, and tuned.
    pub passes: [usize; 2],
}

impl TuningOutcome {
    /// Whether the values are worth keeping: no more of the unseen robots fail than before.
    #[must_use]
    pub fn is_kept(&self) -> bool {
        self.passes[1] >= self.passes[0]
    }
}

impl TuningPlan {
    /// Checks a request for a setup; `own` is its scenario as its file has it.
    ///
    /// # Errors
    /// A parameter that cannot be tuned there, or nothing to tune it for.
    pub fn new(
        setup: Setup,
        own: &ScenarioFile,
        request: TuningRequest,
    ) -> Result<Self, FileError> {
        let TuningRequest {
            over,
            objective,
            seed,
            runs,
            held_out,
        } = request;
        over.iter().try_for_each(|over| over.check(own))?;
        let is_seen = |held_out: &&u64| held_out.wrapping_sub(seed) < Search::SEEDS;
        if let Some(seen) = held_out.iter().find(is_seen) {
            return Err(TuneError::Seen(*seen).into());
        }
        let over = tuned(&setup, &over)?;
        if setup.scenario.limits.is_empty() && objective.names().next().is_none() {
            return Err(TuneError::NoAim(setup.scenario.name).into());
        }
        let budget = runs.map_or_else(|| Search::default_budget(&setup), |runs| runs as usize);
        Ok(Self {
            setup,
            over,
            objective,
            seed,
            budget,
            held_out,
        })
    }

    /// The setup as it is now.
    #[must_use]
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// What is tuned, in the order of [`Found::values`].
    #[must_use]
    pub fn over(&self) -> &[Tuned] {
        &self.over
    }

    /// The search.
    #[must_use]
    pub fn search(&self) -> Search<'_> {
        Search {
            setup: &self.setup,
            over: &self.over,
            objective: &self.objective,
            seed: self.seed,
            budget: self.budget,
        }
    }

    /// The seeds of robots that the search does not see.
    #[must_use]
    pub fn seeds(&self) -> &[u64] {
        &self.held_out
    }

    /// Searches and checks, on the threads of the current pool; `progress` gets the share of all runs that is done.
    /// `goes_on` is asked before each run.
    ///
    /// # Errors
    /// An aim that is no metric of the scenario, too few runs, the first error of a run, or [`TuneError::Ended`] once
    /// `goes_on` denies.
    pub fn run(
        &self,
        progress: &(dyn Fn(f64) + Sync),
        goes_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<TuningOutcome, FileError> {
        check_metrics(self.objective.names(), &self.setup, self.seed)?;
        let search = self.search();
        let (budget, check) = (self.budget as f64, 2.0 * self.held_out.len() as f64);
        let all = budget + check;
        let found = search.run(|share| progress(share * budget / all), goes_on)?;
        let (now, tuned) = (self.setup.clone(), search.setup_of(&found.values)?);
        let mut done = budget;
        let go_on = || match goes_on() {
            true => Ok(()),
            false => Err(FileError::from(TuneError::Ended)),
        };
        let runs = run_variants(
            &[("now".to_owned(), now), ("tuned".to_owned(), tuned)],
            &self.held_out,
            go_on,
            || {
                done += 1.0;
                progress(done / all);
                go_on()
            },
        )?;
        let runs = <[Variant; 2]>::try_from(runs).map_err(|_| TuneError::Ended)?;
        let passes = [self.passes(&runs[0]), self.passes(&runs[1])];
        Ok(TuningOutcome {
            found,
            runs,
            passes,
        })
    }

    /// Runs that pass and keep the limits of the request.
    fn passes(&self, variant: &Variant) -> usize {
        let runs = variant.passes.iter().zip(&variant.metrics);
        runs.filter(|(pass, run)| **pass && self.objective.admits(run))
            .count()
    }

    /// A robot file with the values found; `today` is a date.
    ///
    /// # Errors
    /// A text that is no robot file.
    pub fn rewrite(&self, found: &Found, text: &str, today: &str) -> Result<String, RewriteError> {
        let values = self.over.iter().zip(&found.values);
        let values: Vec<_> = values.map(|(one, value)| (one.id, *value)).collect();
        let about = format!("on {today} for {}.", self.setup.scenario.name);
        rewrite(text, &values, &about)
    }
}

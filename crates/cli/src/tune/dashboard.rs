//! Work for the dashboard of the lab, on some of the cores: the search of `rumbo tune`, and the experiment with many seeds.

use super::{as_json, seeds};
use crate::calibrate::rewritten;
use rayon::{ThreadPool, ThreadPoolBuilder};
use rumbo_experiment::files::{FileError, Kind, Library, Overrides, Setup, unknown};
use rumbo_experiment::tune::{Objective, Over, Search, TuningPlan, TuningRequest, tunable};
use rumbo_report::text::Language;
use rumbo_station::{NotTuned, Tuner};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::sync::{Mutex, PoisonError};

/// Most runs that a page may ask for: more than any scenario's default.
const MOST_RUNS: u32 = 200_000;
/// Most parameters that a page may ask for: more are hardly searched with so many runs.
const MOST_PARAMETERS: usize = 12;
/// Longest aims of a page \[bytes\].
const LONGEST_AIMS: usize = 500;
/// Unseen robots, as `rumbo tune` has by default.
const HELD_OUT: u32 = 100;
/// Most threads of a search.
const MOST_THREADS: usize = 4;

/// What a page asks for, in the words of the command line.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Asked {
    /// One of those offered: a page names no path.
    scenario: String,
    /// As `--over`: names, or `NAME=FROM:TO`.
    over: Vec<String>,
    /// As `--param`: the values of the robot in the lab, where they are not those of its file.
    #[serde(default)]
    params: BTreeMap<String, f64>,
    /// As `--for`; empty: all limits.
    #[serde(default)]
    aims: String,
    runs: Option<u32>,
    seed: u64,
}

/// The report of `rumbo experiments`, in a language: `en` or `es`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Report {
    report: String,
}

/// Makes searches for the robot of a lab.
#[derive(Debug)]
struct OfLab {
    /// As `--robot`.
    robot: Option<String>,
    /// The scenario that the lab began with, which may be a file.
    own: String,
}

/// The tuning of a lab's dashboard.
pub(crate) fn in_dashboard(robot: Option<&str>, scenario: &str) -> Box<dyn Tuner> {
    Box::new(OfLab {
        robot: robot.map(str::to_owned),
        own: scenario.to_owned(),
    })
}

fn refused(error: impl Display) -> NotTuned {
    NotTuned(error.to_string())
}

impl OfLab {
    fn names(&self, library: &Library) -> Vec<String> {
        let mut names = library.list(Kind::Scenario);
        if !names.contains(&self.own) {
            names.insert(0, self.own.clone());
        }
        names
    }

    fn setup(
        &self,
        library: &Library,
        name: &str,
        params: &BTreeMap<String, f64>,
    ) -> Result<Setup, FileError> {
        let overrides = Overrides {
            robot: self.robot.clone(),
            parameters: params.clone().into_iter().collect(),
            ..Overrides::default()
        };
        library.setup(name, &overrides)
    }

    /// What a page may choose of a scenario, if it can be tuned: one that is wrong, has no limits or several robots cannot.
    fn offer(&self, library: &Library, name: &str) -> Option<Value> {
        let own = library.scenario(name).ok()?;
        if own.limits.is_empty() || !own.fleet.is_empty() {
            return None;
        }
        let setup = self.setup(library, name, &BTreeMap::new()).ok()?;
        let groups = tunable(&setup, &own).ok()?;
        if groups.is_empty() || !setup.takes_parameters() {
            return None;
        }
        let groups = groups.iter().map(|group| {
            let parameters = group.parameters.iter();
            let parameters = parameters.map(|(id, now)| json!({ "name": id.name(), "now": now }));
            json!({ "title": group.title, "parameters": parameters.collect::<Vec<_>>() })
        });
        let limits = own.limits.iter();
        let limits: BTreeMap<_, _> = limits
            .map(|(name, bounds)| (name, json!({ "min": bounds.min, "max": bounds.max })))
            .collect();
        Some(json!({
            "name": name,
            "title": own.title,
            "limits": limits,
            "runs": Search::default_budget(&setup),
            "groups": groups.collect::<Vec<_>>(),
        }))
    }

    /// Runs every experiment, and writes them up.
    fn report(&self, language: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Value, NotTuned> {
        let language = match language {
            "es" => Language::Spanish,
            _ => Language::English,
        };
        let request = rumbo_report::Request {
            seed: 1,
            overrides: Overrides {
                robot: self.robot.clone(),
                ..Overrides::default()
            },
            ..rumbo_report::Request::default()
        };
        let plan = rumbo_report::Plan::new(&Library::new(), request).map_err(refused)?;
        let (all_s, done_s) = (plan.simulated_s(), Mutex::new(0.0));
        let stamp = plan.stamp(language);
        let done = |run_s: f64| {
            let mut done_s = done_s.lock().unwrap_or_else(PoisonError::into_inner);
            *done_s += run_s;
            progress(*done_s / all_s);
        };
        let data = pool()?.install(|| plan.run(done));
        let (page, _) = rumbo_report::html(&data.map_err(refused)?, language).map_err(refused)?;
        let page = stamp.put_on(page);
        Ok(json!({ "page": String::from_utf8_lossy(&page) }))
    }

    fn plan(&self, asked: Asked) -> Result<TuningPlan, NotTuned> {
        let library = Library::new();
        let names = self.names(&library);
        if !names.contains(&asked.scenario) {
            let known = names.iter().map(String::as_str);
            return Err(refused(unknown("scenario", &asked.scenario, known)));
        }
        if asked.over.is_empty() {
            return Err(refused("choose a parameter"));
        }
        if asked.over.len() > MOST_PARAMETERS {
            return Err(refused(format!(
                "at most {MOST_PARAMETERS} parameters are searched from a page"
            )));
        }
        if asked.runs.is_some_and(|runs| runs > MOST_RUNS) {
            return Err(refused(format!(
                "a search from a page has at most {MOST_RUNS} runs"
            )));
        }
        if asked.aims.len() > LONGEST_AIMS {
            return Err(refused(format!(
                "the aims are longer than {LONGEST_AIMS} characters"
            )));
        }
        let over = asked.over.iter().map(|one| one.parse::<Over>());
        let objective = match asked.aims.trim() {
            "" => Objective::default(),
            aims => aims.parse().map_err(refused)?,
        };
        let request = TuningRequest {
            over: over.collect::<Result<_, _>>().map_err(refused)?,
            objective,
            seed: asked.seed,
            runs: asked.runs,
            held_out: Search::held_out(asked.seed, HELD_OUT),
        };
        let setup = self.setup(&library, &asked.scenario, &asked.params);
        let own = library.scenario(&asked.scenario).map_err(refused)?;
        TuningPlan::new(setup.map_err(refused)?, &own, request).map_err(refused)
    }
}

impl Tuner for OfLab {
    fn offers(&self) -> Value {
        let library = Library::new();
        let names = self.names(&library);
        let offers = names.iter().filter_map(|name| self.offer(&library, name));
        json!({
            "least_runs": Search::LEAST,
            "most_runs": MOST_RUNS,
            "most_parameters": MOST_PARAMETERS,
            "scenarios": offers.collect::<Vec<_>>(),
        })
    }

    fn tune(
        &self,
        request: &str,
        progress: &(dyn Fn(f64) + Sync),
        goes_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Value, NotTuned> {
        if let Ok(asked) = serde_json::from_str(request) {
            let names = self.names(&Library::new());
            return seeds::drive(asked, (&self.robot, &names), threads(), progress, goes_on);
        }
        if let Ok(Report { report }) = serde_json::from_str(request) {
            return self.report(&report, progress);
        }
        let asked = serde_json::from_str(request).map_err(refused)?;
        let plan = self.plan(asked)?;
        let outcome = pool()?.install(|| plan.run(progress, goes_on));
        let outcome = outcome.map_err(refused)?;
        let file = match outcome.is_kept() {
            true => {
                let robot = &plan.setup().robot;
                let rewrite = |text: &str, today: &str| plan.rewrite(&outcome.found, text, today);
                Some(rewritten(&robot.name, &robot.text, rewrite).map_err(refused)?)
            }
            false => None,
        };
        let mut answer = as_json(&plan, &outcome, None);
        answer["robot_file"] = json!(file);
        Ok(answer)
    }
}

/// Threads of its own for one request.
fn pool() -> Result<ThreadPool, NotTuned> {
    let pool = ThreadPoolBuilder::new().num_threads(threads());
    pool.build().map_err(refused)
}

/// All cores but one, which the session has.
fn threads() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    (cores - 1).clamp(1, MOST_THREADS)
}

//! `rumbo sweep`: a scenario with many values of its parameters, as a table and a page.

mod journal;
mod tables;

use crate::args::SweepArgs;
use crate::experiments::language;
use crate::failure::Failure;
use crate::interrupt;
use crate::mark::Mark;
use crate::output::{self, figure};
use crate::place::{self, Guard};
use crate::run::{check_control, check_policy, progress_bar, set_threads};
use crate::run_log::{self, RunSource};
use journal::{Header, Journal};
use rumbo_experiment::MODEL;
use rumbo_experiment::files::{Library, Overrides, Setup};
use rumbo_experiment::metrics::{bare, more_is_better};
use rumbo_experiment::run::{self, check_metrics};
use rumbo_experiment::sweep::{Design, RunRow, SweepOutcome, SweepPlan};
use rumbo_lab::manifest::{self, crc32};
use rumbo_log::LogKind;
use rumbo_report::FileStamp;
use rumbo_report::sweep::{Page, SHOWN};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

/// The page, the tables, the runs as they are done, and the logs of the best and the worst.
const PAGE: &str = "index.html";
const CSV: &str = "runs.csv";
const JOURNAL: &str = "runs.jsonl";
const LOGS: &str = "logs";

/// Runs what is missing, and writes tables and page of what is there.
pub(crate) fn sweep(args: &SweepArgs) -> Result<(), Failure> {
    let library = Library::new();
    let overrides = args
        .setting
        .overrides(args.program, &args.image, &args.parameters);
    let setup = library.setup(&args.scenario, &overrides)?;
    check_policy(&setup, &overrides)?;
    let plan = plan(args, &setup)?;
    set_threads(args.threads)?;
    if let Some(by) = &args.by {
        check_metrics([by.as_str()].into_iter(), &setup, args.seed.seed)?;
    }
    // What no run can be made of is said before anything is written.
    for robot in setup.robots() {
        robot.config(args.seed.seed)?;
    }
    let header = header(args, &setup, &overrides, &plan);
    let about = serde_json::to_string(&header).map_err(Failure::input)?;
    let stamp = FileStamp::of("sweep", &[about]);
    let (mut journal, rows) = journal(args, &header, &plan)?;
    let first = rows.len();
    let mut sweep = SweepOutcome { plan, rows };
    let asked = interrupt::asked();
    let progress = progress_bar(sweep.plan.len());
    progress.set_position(first as u64);
    progress.reset_eta();
    let mut done = Vec::new();
    let go_on = || match asked.load(Ordering::Relaxed) {
        true => Err(Failure::Interrupted),
        false => Ok(()),
    };
    let threads = rayon::current_num_threads();
    let ended = sweep.plan.run(&setup, first, threads, go_on, |row| {
        journal.put(&row)?;
        done.push(row);
        progress.inc(1);
        go_on()
    });
    progress.finish_and_clear();
    sweep.rows.extend(done);
    let by = by(args, &setup);
    let writer = Writer {
        args,
        library: &library,
        overrides: &overrides,
        setup: &setup,
        by: &by,
    };
    writer.write(&sweep, &stamp)?;
    report(args, &sweep, &by)?;
    if sweep.rows.len() < sweep.plan.len() {
        output::note(&format!(
            "done: {} of {}; the same command with --resume goes on",
            sweep.rows.len(),
            output::counted(sweep.plan.len(), "run")
        ));
    }
    ended
}

/// The journal of this sweep and its runs so far: the one that is there, or else a new one.
fn journal(
    args: &SweepArgs,
    header: &Header,
    plan: &SweepPlan,
) -> Result<(Journal, Vec<RunRow>), Failure> {
    let path = args.out.join(JOURNAL);
    if !args.overwrite.force
        && let Some(before) = Journal::resume(&path, header, plan, args.resume)?
    {
        return Ok(before);
    }
    check_places(args)?;
    place::try_folder(&args.out)?;
    Ok((Journal::begin(&path, header)?, Vec::new()))
}

fn plan(args: &SweepArgs, setup: &Setup) -> Result<SweepPlan, Failure> {
    let fixed = args.parameters.params.iter().map(|(name, _)| name);
    for name in fixed {
        if args.axes.iter().any(|axis| axis.name == *name) {
            return Err(Failure::Input(format!(
                "{name} is an axis and has a --param; give it once"
            )));
        }
    }
    let design = match (args.random, args.sobol) {
        (Some(count), _) => Design::Random(count as usize),
        (None, Some(count)) => Design::Sobol(count as usize),
        (None, None) => Design::Grid,
    };
    let plan = SweepPlan::new(args.axes.clone(), design, args.seed.seed, args.runs);
    let plan = plan.map_err(Failure::input)?;
    plan.check(setup)?;
    check_control(args.axes.iter().map(|axis| axis.name.as_str()), setup)?;
    Ok(plan)
}

fn header(args: &SweepArgs, setup: &Setup, overrides: &Overrides, plan: &SweepPlan) -> Header {
    let about = manifest::of(LogKind::Run, setup, overrides, plan.seed);
    let files = format!("{:?}", (&about.files, &about.rig, &about.wiring));
    Header {
        rumbo_sweep: about.version,
        model: MODEL,
        scenario: args.scenario.clone(),
        axes: args.axes.iter().map(|axis| format!("{axis:?}")).collect(),
        design: format!("{:?}", plan.design),
        seed: plan.seed,
        runs: plan.runs,
        program: about.program,
        image: about.image,
        parameters: about.parameters,
        files: format!("{:08x}", crc32(files.as_bytes())),
    }
}

/// Refuses, before anything runs, a folder with files that are no sweep's: one of a sweep has a journal.
fn check_places(args: &SweepArgs) -> Result<(), Failure> {
    let named = [&args.setting.robot, &args.setting.world];
    let inputs = [&args.scenario]
        .into_iter()
        .chain(named.into_iter().flatten());
    let inputs = inputs.map(PathBuf::from).chain(args.image.firmware.clone());
    let guard = Guard::new(inputs, args.overwrite.force);
    let mark = Mark::Text("rumbo sweep ".into());
    [PAGE, CSV, JOURNAL]
        .into_iter()
        .try_for_each(|name| guard.check(&args.out.join(name), &mark))
}

/// The metric that ranks: the requested one, else a time or an error with a limit.
fn by(args: &SweepArgs, setup: &Setup) -> String {
    if let Some(asked) = &args.by {
        return asked.clone();
    }
    let limits = || setup.scenario.limits.keys().map(|name| bare(name));
    let is_time =
        |name: &&str| name.ends_with("_s") && !name.ends_with("m_s") && !name.ends_with("rad_s");
    let timed = limits().find(is_time);
    let error = limits().find(|name| *name != "contacts" && !more_is_better(name));
    timed.or(error).unwrap_or("contacts").to_owned()
}

struct Writer<'a> {
    args: &'a SweepArgs,
    library: &'a Library,
    overrides: &'a Overrides,
    setup: &'a Setup,
    by: &'a str,
}

impl Writer<'_> {
    fn write(&self, sweep: &SweepOutcome, stamp: &FileStamp) -> Result<(), Failure> {
        let out = |name: &str| self.args.out.join(name);
        let logs = self.logs(sweep)?;
        place::write(&out(CSV), tables::csv(sweep))?;
        let page = Page {
            sweep,
            scenario: &self.setup.scenario,
            by: self.by,
            logs: &logs,
        };
        let html = page.html(language(self.args.language));
        place::write(&out(PAGE), stamp.put_on(html))
    }

    /// Runs the best and the worst of the points in the page once more, for their logs; returns their addresses.
    fn logs(&self, sweep: &SweepOutcome) -> Result<BTreeMap<(usize, u64), String>, Failure> {
        let ranked = sweep.ranked(self.by);
        let folder = self.args.out.join(LOGS);
        place::folder(&folder)?;
        let ends = ranked
            .iter()
            .take(SHOWN)
            .chain(ranked.iter().rev().take(SHOWN));
        let mut logs = BTreeMap::new();
        for point in ends {
            for worst in [false, true] {
                let Some(row) = sweep.extreme(*point, self.by, worst) else {
                    continue;
                };
                let name = format!("point{}-{}", row.point, row.seed);
                let address = format!("{LOGS}/{name}.mcap");
                if logs.insert((row.point, row.seed), address).is_none() {
                    self.record(sweep, row, &folder.join(name + ".mcap"))?;
                }
            }
        }
        Ok(logs)
    }

    fn record(
        &self,
        sweep: &SweepOutcome,
        row: &RunRow,
        path: &std::path::Path,
    ) -> Result<(), Failure> {
        let mut overrides = self.overrides.clone();
        let names = sweep.plan.axes.iter().map(|axis| axis.name.clone());
        let values = sweep.plan.points[row.point].iter().copied();
        overrides.parameters.extend(names.zip(values));
        let source = RunSource {
            kind: LogKind::Run,
            library: self.library,
            overrides: &overrides,
        };
        let setup = sweep.plan.setup(self.setup, row.point)?;
        let result = run::run(&setup, row.seed)?;
        // The page leads to the first robot's.
        let first = result.robots.first().map(|robot| robot.scenario.as_str());
        let log = |robot: Option<&str>| match robot {
            Some(other) if robot != first => path.with_extension(format!("{other}.mcap")),
            _ => path.to_owned(),
        };
        run_log::write(&source, log, &setup, &result)
    }
}

/// The best points, and where the page is.
fn report(args: &SweepArgs, sweep: &SweepOutcome, by: &str) -> Result<(), Failure> {
    let axes = sweep.plan.axes.iter().map(|axis| axis.name.clone());
    let more = ["passed".to_owned(), format!("{by}, median")];
    let mut rows: Vec<Vec<String>> = vec![axes.chain(more).collect()];
    for point in sweep.ranked(by).into_iter().take(SHOWN) {
        let values = sweep.plan.axes.iter().zip(&sweep.plan.points[point]);
        let values = values.map(|(axis, value)| match axis.name_of(*value) {
            Some(name) => name.to_owned(),
            None => figure(*value),
        });
        let mut row: Vec<String> = values.collect();
        row.push(format!("{:.0} %", 100.0 * sweep.pass_share(point)));
        let median = sweep.spread(point, by).map(|spread| spread.median);
        row.push(match median {
            Some(median) if median.is_finite() => figure(median),
            _ => "never".into(),
        });
        rows.push(row);
    }
    let points = sweep.points_done();
    if points > SHOWN {
        output::line(&format!("the best {SHOWN} of {points} points, by {by}:"))?;
    }
    output::table(&rows)?;
    output::line(&output::shown(&args.out.join(PAGE)))
}

//! `rumbo experiments`: every experiment of the report, and the report itself as one page.

use crate::args::{ExperimentsArgs, LanguageName};
use crate::failure::Failure;
use crate::mark::Mark;
use crate::output;
use crate::place::{self, Guard};
use crate::recorded;
use crate::results::Results;
use crate::run_log::RunSource;
use indicatif::{ProgressBar, ProgressStyle};
use rumbo_experiment::files::{Library, Overrides};
use rumbo_lab::manifest;
use rumbo_log::LogKind;
use rumbo_report::FileStamp;
use rumbo_report::real::{self, Real};
use rumbo_report::text::Language;
use rumbo_report::{Data, Plan, Request, html};
use std::io::IsTerminal;
use std::path::Path;
use std::time::Instant;

/// File name of the report.
const REPORT: &str = "report.html";
/// Simulated seconds that a thread gets through in a second: natively, and with an image on the emulated chip. For the first estimate of
/// the time left; what is shown later is measured.
const NATIVE_SPEED: f64 = 1_500.0;
const EMULATED_SPEED: f64 = 50.0;

/// Runs, writes, and prints what came of each experiment.
pub(crate) fn experiments(args: &ExperimentsArgs) -> Result<(), Failure> {
    let begun = Instant::now();
    let real = match &args.real {
        Some(folder) => real::read(folder, recorded::from_log).map_err(Failure::input)?,
        None => Real::default(),
    };
    let (library, overrides) = (
        Library::new(),
        Overrides {
            robot: args.robot.clone(),
            ..args.image.overrides()
        },
    );
    let request = Request {
        only: args.only.clone(),
        seed: args.seed.seed,
        overrides: overrides.clone(),
        real,
    };
    let plan = Plan::new(&library, request)?;
    let stamp = check_places(args, &plan, &overrides)?;
    place::try_folder(&args.out)?;
    let progress = progress(args, &plan);
    let mut data = plan.run(|simulated_s| progress.inc((10.0 * simulated_s) as u64))?;
    progress.finish_and_clear();
    data.firmware = args.image.firmware.as_deref().map(named);
    let (page, _) = html(&data, language(args.language)).map_err(Failure::input)?;
    let place = args.out.join(REPORT);
    place::write(&place, stamp.put_on(page))?;
    if args.data {
        let source = RunSource {
            kind: LogKind::Run,
            library: &library,
            overrides: &overrides,
        };
        write_data(&args.out, &source, &data)?;
    }
    report(&data, &place, begun)
}

/// Refuses, before anything runs, what would write over something else than an older report of the same. Gives what the
/// report is known by.
fn check_places(
    args: &ExperimentsArgs,
    plan: &Plan,
    overrides: &Overrides,
) -> Result<FileStamp, Failure> {
    let stamp = plan.stamp(language(args.language));
    let inputs = args.robot.iter().map(Into::into);
    let guard = Guard::new(
        inputs.chain(args.image.firmware.clone()),
        args.overwrite.force,
    );
    guard.check(&args.out.join(REPORT), &Mark::of(&stamp))?;
    for setup in plan.setups().filter(|_| args.data) {
        let seed = args.seed.seed;
        let results = Results::of(&args.out, &setup.scenario.name, seed);
        results.check(&guard, setup, overrides, seed)?;
    }
    Ok(stamp)
}

/// The bar, which says from the start about how long it will take.
fn progress(args: &ExperimentsArgs, plan: &Plan) -> ProgressBar {
    let threads = std::thread::available_parallelism().map_or(1.0, |count| count.get() as f64);
    let speed = if args.image.firmware.is_some() {
        EMULATED_SPEED
    } else {
        NATIVE_SPEED
    };
    let expected_s = (plan.simulated_s() / speed / threads).ceil().max(1.0);
    let message = format!(
        "{}, {:.0} s of driving, about {expected_s:.0} s",
        output::counted(plan.runs(), "run"),
        plan.simulated_s()
    );
    // Without a progress bar, a single note if the wait is long.
    if !std::io::stderr().is_terminal() && expected_s > 3.0 {
        output::aside(&message);
    }
    let style = ProgressStyle::with_template("{msg} {bar:30} {percent} %, {eta} left");
    let bar = ProgressBar::new((10.0 * plan.simulated_s()) as u64).with_message(message);
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.tick();
    bar
}

/// The language that was asked for, else the locale's.
pub(crate) fn language(asked: Option<LanguageName>) -> Language {
    match asked {
        Some(LanguageName::En) => Language::English,
        Some(LanguageName::Es) => Language::Spanish,
        None => {
            let set = |name| std::env::var(name).ok().filter(|value| !value.is_empty());
            let locale = ["LC_ALL", "LC_MESSAGES", "LANG"].into_iter().find_map(set);
            Language::of_locale(&locale.unwrap_or_default())
        }
    }
}

/// An image by its name without folder, and what tells it from another of that name.
fn named(path: &Path) -> [String; 2] {
    let file = path.file_name().unwrap_or(path.as_os_str());
    [
        file.to_string_lossy().into_owned(),
        manifest::hash(path).unwrap_or_default(),
    ]
}

/// The log of each run, its true signals as CSV, and its metrics as JSON.
fn write_data(folder: &Path, source: &RunSource<'_>, data: &Data) -> Result<(), Failure> {
    data.outcomes.values().try_for_each(|outcome| {
        let results = Results::of(folder, &outcome.result.scenario, outcome.result.seed);
        results.write(source, &outcome.setup, &outcome.result)
    })
}

fn report(data: &Data, place: &Path, begun: Instant) -> Result<(), Failure> {
    let rows: Vec<Vec<String>> = data
        .experiments
        .iter()
        .map(|experiment| {
            let verdict = if data.passes(experiment) {
                "ok"
            } else {
                "MISSED"
            };
            vec![
                experiment.name.to_owned(),
                verdict.to_owned(),
                experiment.title(Language::English),
            ]
        })
        .collect();
    output::table(&rows)?;
    for outcome in data.outcomes.values() {
        for failure in &outcome.result.failures {
            output::line(&format!("  FAILED, {}: {failure}", outcome.result.scenario))?;
        }
    }
    for skipped in &data.real.skipped {
        output::line(&format!(
            "  note: {} is not shown: {}",
            skipped.file,
            skipped.why.text().of(Language::English)
        ))?;
    }
    output::line(&format!(
        "{} ({:.1} s)",
        place.display(),
        begun.elapsed().as_secs_f64()
    ))?;
    if data.pass() {
        Ok(())
    } else {
        Err(Failure::LimitMissed)
    }
}

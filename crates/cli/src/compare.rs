//! `rumbo compare`: several logs side by side, with their differences from the first, a gate for regressions; or variants
//! of a scenario with the same seeds.

pub(crate) mod variants;

use crate::args::CompareArgs;
use crate::export::warn_if_cut;
use crate::failure::Failure;
use crate::figures;
use crate::logs;
use crate::mark::Mark;
use crate::output::{self, figure};
use crate::place::{self, Guard};
use rumbo_log::{Log, Row};
use rumbo_report::FileStamp;
use rumbo_station::log_file;
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

type Metrics = BTreeMap<String, f64>;

/// Compares variants of a scenario if there are any, else logs.
pub(crate) fn compare(args: &CompareArgs) -> Result<(), Failure> {
    match (&args.variants[..], &args.logs[..]) {
        ([], [_]) => Err(Failure::input(
            "one log has nothing to be compared with: give another, or variants of a scenario with --with NAME=VALUE",
        )),
        ([], _) => compare_logs(args),
        (_, [scenario]) => variants::compare(args, &output::shown(scenario)),
        _ => Err(Failure::input(
            "--with is for variants of one scenario; give one",
        )),
    }
}

/// Refuses a name that says something else than what will be in the file.
fn check_ending(path: &Path, ending: &str, what: &str) -> Result<(), Failure> {
    match path.extension() {
        Some(other) if !other.eq_ignore_ascii_case(ending) => Err(Failure::Input(format!(
            "{}: {what}; name it .{ending}",
            path.display()
        ))),
        _ => Ok(()),
    }
}

/// Prints metrics and differences, draws all runs overlaid on request, and fails where a tolerance is exceeded.
fn compare_logs(args: &CompareArgs) -> Result<(), Failure> {
    let names: Vec<String> = args.logs.iter().map(|path| output::shown(path)).collect();
    let stamp = FileStamp::of("compare", &names);
    if let Some(path) = &args.out {
        Guard::new(&args.logs, args.overwrite.force).check(path, &Mark::of(&stamp))?;
        check_ending(path, "svg", "logs overlaid are a figure")?;
        place::try_file(path)?;
    }
    let logs = args.logs.iter().map(|path| {
        logs::mend(path);
        let log = log_file::read(path).map_err(Failure::input)?;
        warn_if_cut(path, &log)?;
        Ok(log)
    });
    let logs: Vec<Log> = logs.collect::<Result<_, Failure>>()?;
    let metrics: Vec<Metrics> = logs.iter().map(metrics).collect();
    let passes: Vec<Option<bool>> = logs
        .iter()
        .map(|log| log.outcome.as_ref().map(|outcome| outcome.pass))
        .collect();
    let complaints = complaints(&names, &metrics, &passes, args.tolerance);
    let parameters = differing(&logs);
    if let Some(path) = &args.out {
        let pairs: Vec<_> = names.iter().map(String::as_str).zip(&logs).collect();
        let figures = figures::of_many(&pairs);
        if figures.is_empty() {
            return Err(Failure::Input(format!(
                "{}: not drawn, the logs hold no signals; leave --out away",
                path.display()
            )));
        }
        let text = figures.svg();
        place::write(path, stamp.put_on(text))?;
    }
    if args.json {
        let runs = names.iter().zip(&metrics).zip(&passes);
        let runs: Vec<Value> = runs.map(|((name, metrics), pass)| json!({ "log": name, "passed": pass, "metrics": numbers(metrics) })).collect();
        output::json(&json!({ "runs": runs, "parameters": parameters, "exceeded": complaints }))?;
    } else {
        print(&names, &metrics, &passes)?;
        print_parameters(&parameters)?;
        for complaint in &complaints {
            output::line(&format!("  EXCEEDED: {complaint}"))?;
        }
    }
    if complaints.is_empty() {
        Ok(())
    } else {
        Err(Failure::LimitMissed)
    }
}

/// The parameters that are not the same in all logs that have them, with their values in each.
fn differing(logs: &[Log]) -> BTreeMap<String, Vec<Option<f32>>> {
    let known: Vec<BTreeMap<String, f32>> = logs.iter().map(Log::parameters).collect();
    let names: BTreeSet<&String> = known.iter().flat_map(BTreeMap::keys).collect();
    let values = names.into_iter().map(|name| {
        let values = known.iter().map(|values| values.get(name).copied());
        (name.clone(), values.collect::<Vec<_>>())
    });
    values
        .filter(|(_, values)| {
            let mut known = values.iter().flatten();
            let first = known.next();
            known.any(|value| Some(value) != first)
        })
        .collect()
}

fn print_parameters(parameters: &BTreeMap<String, Vec<Option<f32>>>) -> Result<(), Failure> {
    if parameters.is_empty() {
        return Ok(());
    }
    output::line("parameters that differ:")?;
    let shown = |value: &Option<f32>| value.map_or_else(|| "-".into(), |value| value.to_string());
    let row = |(name, values): (&String, &Vec<Option<f32>>)| {
        let values = values.iter().map(shown);
        [name.clone()].into_iter().chain(values).collect()
    };
    output::table(&parameters.iter().map(row).collect::<Vec<_>>())
}

/// JSON has no NaN.
fn numbers(metrics: &Metrics) -> Map<String, Value> {
    metrics
        .iter()
        .map(|(name, value)| (name.clone(), json!(value)))
        .collect()
}

/// The differences beyond the tolerance, a line each.
fn complaints(
    names: &[String],
    metrics: &[Metrics],
    passes: &[Option<bool>],
    tolerance_percent: Option<f64>,
) -> Vec<String> {
    let Some(tolerance_percent) = tolerance_percent else {
        return Vec::new();
    };
    let [first, others @ ..] = metrics else {
        return Vec::new();
    };
    let mut complaints = Vec::new();
    for (index, other) in others.iter().enumerate() {
        let name = &names[index + 1];
        if passes[0] == Some(true) && passes[index + 1] == Some(false) {
            complaints.push(format!("{name} misses a limit that {} keeps", names[0]));
        }
        for (metric, value) in first {
            let now = other.get(metric).copied().unwrap_or(f64::NAN);
            let allowed = value.abs() * tolerance_percent / 100.0;
            // Where the measured event never happened in either, they agree.
            let agree = (value.is_nan() && now.is_nan()) || (now - value).abs() <= allowed;
            if !agree {
                complaints.push(format!(
                    "{metric}: {} in {name}, {} in {}",
                    figure(now),
                    figure(*value),
                    names[0]
                ));
            }
        }
    }
    complaints
}

fn print(names: &[String], metrics: &[Metrics], passes: &[Option<bool>]) -> Result<(), Failure> {
    for (index, name) in names.iter().enumerate() {
        let verdict = match passes[index] {
            Some(true) => ", passes",
            Some(false) => ", does not pass",
            None => "",
        };
        output::line(&format!("{}: {name}{verdict}", index + 1))?;
    }
    let all: BTreeSet<&String> = metrics.iter().flat_map(BTreeMap::keys).collect();
    let mut table = vec![vec![String::new()]];
    for number in 1..=names.len() {
        table[0].push(number.to_string());
        if number > 1 {
            table[0].push(format!("{number} - 1"));
        }
    }
    for metric in all {
        let mut row = vec![metric.clone()];
        let value = |run: &Metrics| run.get(metric).copied();
        let first = metrics.first().and_then(value);
        for (index, run) in metrics.iter().enumerate() {
            let now = value(run);
            row.push(now.map_or_else(|| "-".into(), figure));
            if index > 0 {
                row.push(now.zip(first).map_or_else(
                    || "-".into(),
                    |(now, first)| Rounded(now - first).to_string(),
                ));
            }
        }
        table.push(row);
    }
    output::table(&table)
}

/// A difference with a sign, in four significant digits.
pub(crate) struct Rounded(pub(crate) f64);

impl std::fmt::Display for Rounded {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let sign = if self.0 > 0.0 { "+" } else { "" };
        write!(f, "{sign}{}", figure(self.0))
    }
}

/// The metrics of a log: those of its run, and those that any log has.
fn metrics(log: &Log) -> Metrics {
    let mut metrics: Metrics = log
        .outcome
        .as_ref()
        .map(|outcome| outcome.metrics.clone())
        .unwrap_or_default();
    let faults = log
        .events()
        .filter(|(_, level, _)| *level == "fault")
        .count();
    metrics.insert("log.duration_s".into(), log.duration_s());
    metrics.insert("log.faults".into(), faults as f64);
    if let Some(way_m) = way_m(log) {
        metrics.insert("log.way_m".into(), way_m);
    }
    for (name, measured, reference) in [
        ("log.left_error_rms_rad_s", "left_rad_s", "left_ref_rad_s"),
        (
            "log.right_error_rms_rad_s",
            "right_rad_s",
            "right_ref_rad_s",
        ),
    ] {
        if let Some(rms) = rms(log, measured, reference) {
            metrics.insert(name.into(), rms);
        }
    }
    metrics
}

/// Length of the path, the true one where it is known.
fn way_m(log: &Log) -> Option<f64> {
    let way = |names: [&str; 2]| -> Vec<[f64; 2]> {
        log.rows
            .iter()
            .filter_map(|row| Some([row.signal(names[0])?, row.signal(names[1])?]))
            .collect()
    };
    let truth = way(["true_x_m", "true_y_m"]);
    let places = if truth.is_empty() {
        way(["x_m", "y_m"])
    } else {
        truth
    };
    let step = |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
    (places.len() > 1).then(|| places.windows(2).map(step).sum())
}

/// How far a wheel's speed was from its reference while the robot was armed.
fn rms(log: &Log, measured: &str, reference: &str) -> Option<f64> {
    let armed = |row: &&Row| row.signal("armed") != Some(0.0);
    let errors: Vec<f64> = log
        .rows
        .iter()
        .filter(armed)
        .filter_map(|row| Some(row.signal(measured)? - row.signal(reference)?))
        .collect();
    (!errors.is_empty()).then(|| {
        (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tolerance_is_of_the_first_run_s_value_and_a_lost_pass_always_counts() {
        let names = ["a".to_owned(), "b".to_owned()];
        let run = |value: f64| {
            Metrics::from([("x_m".to_owned(), value), ("never_s".to_owned(), f64::NAN)])
        };
        let exceeded = |now, pass, percent| {
            complaints(
                &names,
                &[run(2.0), run(now)],
                &[Some(true), Some(pass)],
                percent,
            )
            .len()
        };
        assert_eq!(exceeded(2.09, true, Some(5.0)), 0);
        assert_eq!(exceeded(2.11, true, Some(5.0)), 1);
        assert_eq!(exceeded(1.89, false, Some(5.0)), 2);
        assert_eq!(exceeded(f64::NAN, true, Some(5.0)), 1);
        assert_eq!(exceeded(9.0, false, None), 0);
    }
}

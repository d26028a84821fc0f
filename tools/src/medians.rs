//! The metrics with limits of every scenario, natively and on the emulated Mega: medians of 20 seeds side by side.
//!
//! `cargo xtask campaign --only medians` builds the image and starts it. Arguments: the number of seeds, then names of scenarios (none:
//! all). With 20 seeds of all, the table between the markers of docs/firmware.md is rewritten. Exit status 1 if a
//! median differs by more than 2 % and more than a quantum.

#![allow(missing_docs)]

use crate::{pages, runs};
use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_experiment::files::{Kind, Library, Overrides, Setup};
use rumbo_experiment::run::RunResult;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write as _;
use std::process::ExitCode;

const SEEDS: u64 = 20;
/// Negligible difference of the medians.
const ALIKE: f64 = 0.02;
/// The page, relative to the root, and the marker of its table.
const PAGE: &str = "docs/firmware.md";
const TABLE: &str = "medians";

/// The tick in which a command is taken and the sample in which a signal is judged: 10 ms each.
const TIME_S: f64 = 0.02;
/// Distance of a wheel between two edges: 384 a turn, 65 mm of wheel.
const EDGE_M: f64 = TAU * 0.0325 / 384.0;
/// Turn of a base of 0.12 m with an edge of one wheel.
const EDGE_RAD: f64 = EDGE_M / 0.12;
/// A count of the timer that makes the servo's pulse: 232 for a quarter turn.
const SERVO_RAD: f64 = FRAC_PI_2 / 232.0;
/// Counts of full PWM.
const PWM_COUNTS: f64 = 255.0;
/// Radius of a wheel.
const WHEEL_M: f64 = 0.0325;

pub(crate) fn main() -> ExitCode {
    let mut args = crate::arguments();
    let seeds = args.next().and_then(|seeds| seeds.parse().ok());
    let only: Vec<String> = args.collect();
    crate::ended("medians", compare(seeds.unwrap_or(SEEDS), &only))
}

/// Prints the table, and writes it if it is complete; returns whether all medians agree.
fn compare(seeds: u64, only: &[String]) -> Result<bool, String> {
    let library = Library::new();
    let names = match only {
        [] => library.list(Kind::Scenario),
        only => only.to_vec(),
    };
    let mut table = Table::default();
    for name in &names {
        let setup = |firmware| {
            let overrides = Overrides {
                firmware,
                ..Overrides::default()
            };
            library.setup(name, &overrides)
        };
        let natively = setup(None).and_then(|setup| Ok((runs(&setup, seeds)?, setup)));
        let (natively, setup_of) = natively.map_err(|error| error.to_string())?;
        let on_chip =
            setup(Some(pages::built("firmware/rumbo.elf"))).and_then(|setup| runs(&setup, seeds));
        let on_chip = on_chip.map_err(|error| error.to_string())?;
        table.add(&setup_of, &natively, &on_chip);
        eprintln!("{name}: {} of {} alike so far", table.alike, table.compared);
    }
    let text = table.text(seeds);
    println!("{text}");
    if only.is_empty() && seeds == SEEDS {
        pages::write(PAGE, TABLE, &text).map_err(|error| error.to_string())?;
    }
    Ok(table.alike == table.compared)
}

#[derive(Default)]
struct Table {
    rows: String,
    alike: usize,
    compared: usize,
    /// Figures that are the same number in both.
    equal: usize,
    passes: String,
}

impl Table {
    fn add(&mut self, setup: &Setup, natively: &[RunResult], on_chip: &[RunResult]) {
        let name = &setup.scenario.name;
        for metric in setup.scenario.limits.keys() {
            let [native, chip] = [natively, on_chip].map(|runs| median(runs, metric));
            let quantum = quantum(setup, metric);
            let differs = if native == chip {
                0.0
            } else {
                (chip - native).abs()
            };
            let by_share = native.is_finite() && differs <= ALIKE * native.abs();
            let is_alike = by_share || differs <= quantum.unwrap_or(0.0);
            self.compared += 1;
            self.alike += usize::from(is_alike);
            self.equal += usize::from(native == chip);
            if is_alike {
                continue;
            }
            let share = match native {
                0.0 => "-".to_owned(),
                _ => format!("{:+.1} %", 100.0 * (chip - native) / native.abs()),
            };
            let [native, chip, quantum] =
                [Some(native), Some(chip), quantum].map(|value| value.map_or("-".into(), shown));
            let _ = writeln!(
                self.rows,
                "| {name} | `{metric}` | {native} | {chip} | {share} | {quantum} |"
            );
        }
        let [native, chip] =
            [natively, on_chip].map(|runs| runs.iter().filter(|run| run.pass).count());
        if native < natively.len() || chip < on_chip.len() {
            let _ = writeln!(
                self.passes,
                "- {name}: {native} natively, {chip} on the Mega"
            );
        }
    }

    fn text(&self, seeds: u64) -> String {
        let passes = match self.passes.as_str() {
            "" => " in every scenario, of both.".to_owned(),
            others => format!(
                " in every scenario, of both, but for these:\n\n{}",
                others.trim_end()
            ),
        };
        format!(
            "Medians of {seeds} seeds: {} of {} figures are alike, {} of them the same number. Those that are not:\n\n\
             | scenario | figure | natively | on the Mega | difference | quantum |\n|---|---|---|---|---|---|\n{}\n\
             Within their limits are all {seeds} seeds{passes}\n",
            self.alike, self.compared, self.equal, self.rows
        )
    }
}

/// The middle value; of an even number, half way between the two. A missing metric counts as infinite.
fn median(runs: &[RunResult], metric: &str) -> f64 {
    let value = |run: &RunResult| run.metrics.get(metric).copied().unwrap_or(f64::INFINITY);
    let mut values: Vec<f64> = runs.iter().map(value).collect();
    values.sort_by(f64::total_cmp);
    let upper = values.get(values.len() / 2).copied().unwrap_or(f64::NAN);
    let lower = values.get(values.len().saturating_sub(1) / 2).copied();
    let lower = lower.unwrap_or(f64::NAN);
    if lower == upper {
        upper
    } else {
        f64::midpoint(lower, upper)
    }
}

/// The resolution of a figure; `None` for counts and ratios.
fn quantum(setup: &Setup, metric: &str) -> Option<f64> {
    // A wheel's speed by a count of PWM, as the feedforward has it.
    let count_rad_s = 1.0 / PWM_COUNTS / f64::from(ParamId::Velocity.limits().default);
    let by_servo = setup.scenario.mode == ModeId::FrontAlign && setup.scenario.rig == "final";
    let quanta = [
        ("_rad_s", count_rad_s),
        ("_m_s", count_rad_s * WHEEL_M),
        ("_rad", if by_servo { SERVO_RAD } else { EDGE_RAD }),
        ("_m", EDGE_M),
        ("_s", TIME_S),
    ];
    let fitting = quanta.into_iter().find(|(end, _)| metric.ends_with(end));
    fitting.map(|(_, quantum)| quantum)
}

fn shown(value: f64) -> String {
    if !value.is_finite() {
        "never".into()
    } else if value.abs() >= 10.0 {
        format!("{value:.2}")
    } else {
        format!("{value:.4}")
    }
}

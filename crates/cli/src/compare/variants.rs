//! Variants of a scenario with the same seeds, pair by pair.

use super::Rounded;
use crate::args::CompareArgs;
use crate::experiments::language;
use crate::failure::Failure;
use crate::interrupt;
use crate::mark::Mark;
use crate::output::{self, figure};
use crate::place::{self, Guard};
use crate::run::{check_control, progress_bar, set_threads};
use crate::sketch;
use rumbo_control::params::ParamId;
use rumbo_experiment::compare::{Difference, Variant, differences, run_variants};
use rumbo_experiment::files::{
    Library, NativeProgram, Overrides, ScenarioFile, Setup, parameters, unknown,
};
use rumbo_plant::params::Params;
use rumbo_report::FileStamp;
use rumbo_report::compare::page;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::atomic::Ordering;

/// Name of the scenario without a change.
const AS_IT_IS: &str = "as it is";
/// What a variant can change besides parameters.
const SETTINGS: [&str; 7] = [
    "robot", "world", "rig", "program", "firmware", "sketch", "wiring",
];

pub(super) fn compare(args: &CompareArgs, scenario: &str) -> Result<(), Failure> {
    let texts = different(&args.variants)?;
    let library = Library::new();
    let variants = texts.iter().map(|text| {
        let overrides = overrides(scenario, text)?;
        let setup = library.setup(scenario, &overrides)?;
        has_its_parameters(&overrides, &setup)?;
        let name = if text.is_empty() { AS_IT_IS } else { text };
        Ok((name.to_owned(), setup))
    });
    let variants: Vec<(String, Setup)> = variants.collect::<Result<_, Failure>>()?;
    let first = args.seed.seed;
    let seeds: Vec<u64> = (0..args.runs)
        .map(|index| first.wrapping_add(index.into()))
        .collect();
    let about = [
        scenario.to_owned(),
        texts.join(" "),
        format!("{:?}", [first, args.runs.into()]),
    ];
    let stamp = FileStamp::of("compare", &about);
    if let Some(path) = &args.out {
        Guard::new([PathBuf::from(scenario)], args.overwrite.force)
            .check(path, &Mark::of(&stamp))?;
        super::check_ending(path, "html", "variants are compared on a page")?;
        place::try_file(path)?;
    }
    set_threads(args.threads)?;
    let progress = progress_bar(variants.len() * seeds.len());
    let asked = interrupt::asked();
    let go_on = || match asked.load(Ordering::Relaxed) {
        true => Err(Failure::Interrupted),
        false => Ok(()),
    };
    let runs = run_variants(&variants, &seeds, go_on, || {
        progress.inc(1);
        go_on()
    });
    let done = progress.position();
    progress.finish_and_clear();
    if matches!(runs, Err(Failure::Interrupted)) {
        let all = output::counted(variants.len() * seeds.len(), "run");
        output::note(&format!(
            "interrupted after {done} of {all}; nothing is compared or written"
        ));
    }
    let runs = runs?;
    let scenario = &variants[0].1.scenario;
    if let Some(path) = &args.out {
        let html = page(scenario, &runs, &seeds, language(args.language));
        place::write(path, stamp.put_on(html))?;
    }
    match args.json {
        true => output::json(&as_json(scenario, &runs, &seeds)),
        false => print(scenario, &runs, &seeds),
    }
}

/// The texts of the variants, none of them twice; one alone is compared with the scenario as it is.
fn different(variants: &[String]) -> Result<Vec<&str>, Failure> {
    let alone = (variants.len() == 1).then_some("");
    let texts = variants.iter().map(String::as_str);
    let texts: Vec<&str> = alone.into_iter().chain(texts).collect();
    for (index, text) in texts.iter().enumerate() {
        if texts[..index].contains(text) {
            return Err(Failure::Input(format!(
                "--with {text}: is there twice; a variant differs in nothing from itself"
            )));
        }
    }
    Ok(texts)
}

/// The overrides of a variant: `front_kp=5,robot=mine.toml`.
fn overrides(scenario: &str, text: &str) -> Result<Overrides, Failure> {
    let mut overrides = Overrides::default();
    let mut sketch = None;
    for part in text
        .split(',')
        .map(str::trim)
        .filter(|part| !part.is_empty())
    {
        let wrong = |what: &str| Failure::Input(format!("--with {text}: {what}"));
        let Some((name, value)) = part.split_once('=') else {
            return Err(wrong(&format!(
                "`{part}` is none; write NAME=VALUE, e.g. front_kp=5"
            )));
        };
        let (name, value) = (name.trim(), value.trim());
        let some = || Some(value.to_owned());
        match name {
            "robot" => overrides.robot = some(),
            "world" => overrides.world = some(),
            "rig" => overrides.rig = some(),
            "wiring" => overrides.wiring = some(),
            "firmware" => overrides.firmware = Some(PathBuf::from(value)),
            "sketch" => sketch = Some(value),
            "program" => {
                overrides.program = match value {
                    "rumbo" => NativeProgram::Rumbo,
                    "baseline" => NativeProgram::Baseline,
                    _ => return Err(wrong("program is rumbo or baseline")),
                }
            }
            _ => {
                let limits = Params::limits();
                let plant = limits.iter().map(|limit| limit.key.as_str());
                let known = ParamId::ALL.map(ParamId::name);
                let known = plant.chain(known).chain(SETTINGS);
                if !known.clone().any(|known| known == name) {
                    return Err(unknown("parameter or setting", name, known).into());
                }
                let number = parameters::parse(name, value);
                let number = number.map_err(|error| wrong(&format!("{name}: {error}")))?;
                overrides.parameters.push((name.to_owned(), number));
            }
        }
    }
    let programs = [
        sketch.is_some(),
        overrides.firmware.is_some(),
        overrides.program != NativeProgram::Rumbo,
    ];
    if programs.into_iter().filter(|is_one| *is_one).count() > 1 {
        return Err(Failure::Input(format!(
            "--with {text}: one program drives; give program, firmware or sketch"
        )));
    }
    if let Some(sketch) = sketch {
        let board = crate::args::board(overrides.robot.as_deref(), Some(scenario))?;
        overrides.firmware = Some(sketch::image(sketch, board)?);
    }
    Ok(overrides)
}

fn has_its_parameters(overrides: &Overrides, setup: &Setup) -> Result<(), Failure> {
    let names = overrides.parameters.iter().map(|(name, _)| name.as_str());
    check_control(names, setup)
}

/// What differs in some run.
fn shown(all: &[Difference]) -> impl Iterator<Item = &Difference> {
    all.iter().filter(|difference| !difference.is_none())
}

fn print(scenario: &ScenarioFile, runs: &[Variant], seeds: &[u64]) -> Result<(), Failure> {
    let [first, others @ ..] = runs else {
        return Ok(());
    };
    let last = seeds.last().copied().unwrap_or_default();
    output::line(&format!(
        "{}: {} (seeds {} to {last})",
        scenario.name, scenario.title, seeds[0]
    ))?;
    for (index, variant) in runs.iter().enumerate() {
        let pass = variant.passes.iter().filter(|pass| **pass).count();
        output::line(&format!(
            "  {}: {}, {pass} of {} pass",
            index + 1,
            variant.name,
            seeds.len()
        ))?;
    }
    for (index, other) in others.iter().enumerate() {
        let number = index + 2;
        let all = differences(first, other);
        output::line("")?;
        print_differences(&all, ["1", &number.to_string()])?;
    }
    Ok(())
}

/// A table of what differs between two variants.
pub(crate) fn print_differences(all: &[Difference], names: [&str; 2]) -> Result<(), Failure> {
    let [first, second] = names.map(str::to_owned);
    let difference = format!("{second} - {first}");
    let rest = ["95 % interval", "effect", "better", ""].map(str::to_owned);
    let header = [
        [String::new(), first, second, difference].to_vec(),
        rest.to_vec(),
    ]
    .concat();
    let mut rows = vec![header];
    rows.extend(shown(all).map(row));
    match rows.len() {
        1 => output::line("  no run differs"),
        _ => output::table(&rows),
    }
}

fn row(difference: &Difference) -> Vec<String> {
    let Difference {
        metric,
        never,
        medians,
        mean,
        interval,
        effect,
        better,
        ..
    } = difference;
    let number = |value: f64| {
        if value.is_finite() {
            figure(value)
        } else {
            "-".into()
        }
    };
    let [low, high] = interval.map(|end| Rounded(end).to_string());
    vec![
        metric.clone(),
        number(medians[0]),
        number(medians[1]),
        if mean.is_finite() {
            Rounded(*mean).to_string()
        } else {
            "-".into()
        },
        if interval[0].is_finite() {
            format!("{low} to {high}")
        } else {
            "-".into()
        },
        if effect.is_finite() {
            format!("{effect:+.2}")
        } else {
            "-".into()
        },
        format!("{:.0} %", 100.0 * better),
        match never {
            [0, 0] => String::new(),
            [one, other] => format!("never in {one} and {other} runs"),
        },
    ]
}

fn as_json(scenario: &ScenarioFile, runs: &[Variant], seeds: &[u64]) -> Value {
    let variants: Vec<Value> = runs
        .iter()
        .map(|variant| {
            let runs = variant.metrics.iter().zip(&variant.passes).zip(seeds);
            let runs: Vec<Value> = runs
                .map(|((metrics, pass), seed)| json!({ "seed": seed, "passed": pass, "metrics": metrics }))
                .collect();
            json!({ "variant": variant.name, "runs": runs })
        })
        .collect();
    let differences: Vec<Value> = runs[1..]
        .iter()
        .flat_map(|other| differences_as_json(&runs[0], other))
        .collect();
    json!({ "scenario": scenario.name, "variants": variants, "differences": differences })
}

pub(crate) fn differences_as_json(first: &Variant, other: &Variant) -> Vec<Value> {
    let one = |one: Difference| {
        json!({
            "first": first.name,
            "second": other.name,
            "metric": one.metric,
            "pairs": one.pairs,
            "never": one.never,
            "medians": one.medians,
            "mean": one.mean,
            "interval": one.interval,
            "effect": one.effect,
            "better": one.better,
            "worse": one.worse,
        })
    };
    differences(first, other).into_iter().map(one).collect()
}

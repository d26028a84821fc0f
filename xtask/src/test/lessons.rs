//! The figures that students compare theirs with: those in the tables of `docs/lessons/` are what the runs give.
//!
//! A row whose first cell links to a run of the lab is checked in each column whose head links to a metric, named by the
//! link's title: `[overshoot (cm)](../../scenarios.md#metrics "step1.overshoot_m")`. `rumbo run` drives that scenario
//! with the link's seed and parameters. A figure is right to its last digit; a metric without a value is `never`, one
//! that the run does not have `–`. Both languages have the same runs and figures. Scenarios in `toml` blocks run.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};
use serde_json::Value;

use crate::markdown::Markdown;
use crate::project::Project;
use crate::tools::Stop;

const FOLDER: &str = "docs/lessons";
/// The program of a scenario for a sketch.
const SKETCH: &str = "example:line";
/// A metric without a value, in either language.
const NEVER: [&str; 2] = ["never", "nunca"];
/// A metric that the run does not have.
const NONE: &str = "–";

/// A figure of a lesson.
#[derive(Clone, Debug, PartialEq)]
struct Figure {
    line: usize,
    /// The link's part after the `#`.
    run: String,
    metric: String,
    /// In the brackets of the column's head.
    unit: String,
    /// As it stands there, with a point.
    text: String,
}

/// Checks the lessons in both languages.
pub(crate) fn check(project: &Project) -> Result<(), Stop> {
    let rumbo = project.rumbo()?;
    let lessons = languages(&project.files()?);
    let mut wrong = Vec::new();
    let mut known = BTreeMap::new();
    let mut count = 0;
    for (name, languages) in &lessons {
        if languages != &["en", "es"] {
            wrong.push(format!(
                "{FOLDER}: {name} is only in {}",
                languages.join(", ")
            ));
            continue;
        }
        let path = |language: &str| format!("{FOLDER}/{language}/{name}");
        let read = |language: &str| {
            let text = std::fs::read_to_string(project.root.join(path(language)));
            text.map_err(|error| format!("{}: {error}", path(language)))
        };
        for language in ["en", "es"] {
            for block in Markdown::parse(&read(language)?).blocks {
                if block.language == "toml" {
                    let tried = try_scenario(project, &rumbo, &block.text);
                    let place = format!("{}:{}", path(language), block.line);
                    wrong.extend(tried.err().map(|what| format!("{place}: {what}")));
                }
            }
        }
        let (english, spanish) = (figures(&read("en")?), figures(&read("es")?));
        wrong.extend(difference(&english, &spanish).map(|what| format!("{name}: {what}")));
        count += english.len();
        for figure in &english {
            if !known.contains_key(&figure.run) {
                let metrics = metrics(project, &rumbo, &figure.run)?;
                known.insert(figure.run.clone(), metrics);
            }
            let metrics = known.get(&figure.run).unwrap_or(&Value::Null);
            if let Err(what) = judge(figure, metrics) {
                wrong.push(format!("{}:{}: {what}", path("en"), figure.line));
            }
        }
    }
    println!("{count} figures of {} runs", known.len());
    match wrong.is_empty() && count > 0 {
        true => Ok(()),
        false => Err(Stop::Failed(format!("the lessons:\n{}", wrong.join("\n")))),
    }
}

/// The languages of each lesson, by its name.
fn languages(files: &[PathBuf]) -> BTreeMap<String, Vec<String>> {
    let mut lessons: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for file in files {
        let path = file.to_string_lossy().replace('\\', "/");
        let inside = path
            .strip_prefix(FOLDER)
            .map(|rest| rest.trim_start_matches('/'));
        if let Some((language, name)) = inside.and_then(|rest| rest.split_once('/')) {
            let of_it = lessons.entry(name.to_owned()).or_default();
            of_it.push(language.to_owned());
        }
    }
    lessons
}

/// The figures of a lesson's tables.
fn figures(text: &str) -> Vec<Figure> {
    let mut figures = Vec::new();
    // Of the table: metric and unit of each column; of the row: its run, and the number of the cell.
    let (mut columns, mut run, mut column) = (Vec::new(), None, 0);
    let (mut in_head, mut cell, mut metric) = (false, String::new(), None);
    for (event, range) in Parser::new_ext(text, Options::ENABLE_TABLES).into_offset_iter() {
        match event {
            Event::Start(Tag::TableHead) => {
                columns.clear();
                in_head = true;
            }
            Event::End(TagEnd::TableHead) => in_head = false,
            Event::Start(Tag::TableRow) => (run, column) = (None, 0),
            Event::Start(Tag::TableCell) => (cell, metric) = (String::new(), None),
            Event::Start(Tag::Link {
                title, dest_url, ..
            }) => {
                if in_head && !title.is_empty() {
                    metric = Some(title.into_string());
                } else if let (0, Some((_, fragment))) =
                    (column, dest_url.split_once("index.html#"))
                {
                    run = Some(fragment.to_owned());
                }
            }
            Event::Text(words) | Event::Code(words) => cell.push_str(&words),
            Event::End(TagEnd::TableCell) if in_head => {
                let unit = cell.rsplit_once('(').map_or("", |(_, unit)| unit);
                let unit = unit.trim_end_matches(')').to_owned();
                columns.push(metric.take().map(|metric| (metric, unit)));
            }
            Event::End(TagEnd::TableCell) => {
                if let (Some(run), Some(Some((metric, unit)))) = (&run, columns.get(column)) {
                    figures.push(Figure {
                        line: 1 + text[..range.start].matches('\n').count(),
                        run: run.clone(),
                        metric: metric.clone(),
                        unit: unit.clone(),
                        text: cell.trim().replace(',', ".").replace('−', "-"),
                    });
                }
                column += 1;
            }
            _ => {}
        }
    }
    figures
}

/// The first figure that differs between the languages.
fn difference(english: &[Figure], spanish: &[Figure]) -> Option<String> {
    let meaning = |figure: &Figure| {
        let never = NEVER.contains(&figure.text.as_str());
        let text = if never { NEVER[0] } else { &figure.text };
        (figure.run.clone(), figure.metric.clone(), text.to_owned())
    };
    let count = english.len().max(spanish.len());
    let index = (0..count)
        .find(|&index| english.get(index).map(meaning) != spanish.get(index).map(meaning))?;
    let shown = |figures: &[Figure]| match figures.get(index) {
        Some(Figure {
            line, metric, text, ..
        }) => format!("line {line}: {metric} {text}"),
        None => "no further figure".to_owned(),
    };
    let (english, spanish) = (shown(english), shown(spanish));
    Some(format!(
        "the languages differ: en {english}, es {spanish}; same runs, metrics and figures in both"
    ))
}

/// The metrics of the run that a link opens.
fn metrics(project: &Project, rumbo: &Path, run: &str) -> Result<Value, String> {
    let mut arguments = Vec::new();
    for field in run.split('&') {
        let (name, value) = field.split_once('=').unwrap_or((field, ""));
        match name {
            "scenario" => arguments.push(value.to_owned()),
            "seed" | "world" | "rig" | "robot" => {
                arguments.extend([format!("--{name}"), value.to_owned()])
            }
            _ => arguments.extend(["--param".to_owned(), field.to_owned()]),
        }
    }
    result_of(project, rumbo, &arguments).map_err(|error| format!("{run}: {error}"))
}

/// Runs a scenario that a lesson lets its reader write; one without a mode with the sketch that the lesson is about.
fn try_scenario(project: &Project, rumbo: &Path, text: &str) -> Result<(), String> {
    let path = project.target.join("lesson.toml");
    let wrong = |error: std::io::Error| format!("{}: {error}", path.display());
    std::fs::write(&path, text).map_err(wrong)?;
    let mut arguments = vec![path.to_string_lossy().into_owned()];
    if !text.contains("mode =") {
        arguments.extend(["--sketch", SKETCH].map(str::to_owned));
    }
    result_of(project, rumbo, &arguments).map(|_| ())
}

/// The metrics of one run; one that misses a limit has them too.
fn result_of(project: &Project, rumbo: &Path, arguments: &[String]) -> Result<Value, String> {
    let mut command = project.command(rumbo);
    command
        .args(["run", "--json", "--no-record"])
        .args(arguments);
    let output = command.output().map_err(|error| error.to_string())?;
    let mut result: Value = serde_json::from_slice(&output.stdout)
        .map_err(|_| String::from_utf8_lossy(&output.stderr).into_owned())?;
    Ok(result["metrics"].take())
}

/// Whether a figure is that of the run, to its last digit.
fn judge(figure: &Figure, metrics: &Value) -> Result<(), String> {
    let Figure {
        metric, unit, text, ..
    } = figure;
    let Some(found) = metrics.get(metric) else {
        let none = text == NONE;
        return none
            .then_some(())
            .ok_or_else(|| format!("the run has no metric `{metric}`: write {NONE}"));
    };
    let scale = scale(metric, unit).ok_or_else(|| {
        format!(
            "`{metric}` in `{unit}`: the column's head ends with (s), (m), (cm), (rpm), (°) or (1)"
        )
    })?;
    let digits = text.split_once('.').map_or(0, |(_, digits)| digits.len());
    let right = match found.as_f64() {
        // No negative zero.
        Some(value) => format!("{:.digits$}", value * scale + 0.0),
        None => NEVER[0].to_owned(),
    };
    let same = *text == right || found.is_null() && NEVER.contains(&text.as_str());
    same.then_some(())
        .ok_or_else(|| format!("`{metric}` is {right} {unit}, not {text} ({})", figure.run))
}

/// From the unit of a metric, which ends its name, to that of a column.
fn scale(metric: &str, unit: &str) -> Option<f64> {
    Some(match unit {
        "rpm" if metric.ends_with("_rad_s") => 30.0 / std::f64::consts::PI,
        "°" if metric.ends_with("_rad") => 180.0 / std::f64::consts::PI,
        "cm" if metric.ends_with("_m") => 100.0,
        "m" if metric.ends_with("_m") => 1.0,
        "s" if metric.ends_with("_s")
            && !metric.ends_with("_rad_s")
            && !metric.ends_with("_m_s") =>
        {
            1.0
        }
        "1" => 1.0,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const LESSON: &str = "# L\n\n| run | mine (cm) | [overshoot (cm)](s.md \"step1.overshoot_m\") |\n|---|---|---|\n| [late](../index.html#scenario=mode1&seed=1&front_kp=9) | | 8,3 |\n| no run | | 7 |\n";

    fn figure(text: &str) -> Figure {
        let mut figure = figures(LESSON).remove(0);
        text.clone_into(&mut figure.text);
        figure
    }

    #[test]
    fn figures_are_those_of_runs_and_metrics_with_their_line() {
        let found = figures(LESSON);
        assert_eq!(found.len(), 1);
        let Figure {
            line,
            run,
            metric,
            unit,
            text,
        } = &found[0];
        assert_eq!(
            (*line, metric.as_str(), unit.as_str(), text.as_str()),
            (5, "step1.overshoot_m", "cm", "8.3")
        );
        assert_eq!(run, "scenario=mode1&seed=1&front_kp=9");
    }

    #[test]
    fn a_figure_is_right_to_its_last_digit() {
        let metrics = json!({"step1.overshoot_m": 0.08267});
        for right in ["8", "8.3", "8.27"] {
            assert_eq!(judge(&figure(right), &metrics), Ok(()));
        }
        for wrong in ["8.2", "8.30", "never", ""] {
            assert!(
                judge(&figure(wrong), &metrics).is_err_and(|what| what.contains("8")),
                "{wrong}"
            );
        }
        let never = json!({"step1.overshoot_m": null});
        assert_eq!(judge(&figure("nunca"), &never), Ok(()));
        assert!(judge(&figure("8.3"), &never).is_err());
        assert_eq!(judge(&figure("–"), &json!({})), Ok(()));
        assert!(judge(&figure("–"), &never).is_err());
        assert!(judge(&figure("8.3"), &json!({})).is_err_and(|what| what.contains("no metric")));
    }

    #[test]
    fn languages_differ_in_words_only() {
        let english = figures(LESSON);
        assert_eq!(
            difference(&english, &figures(&LESSON.replace("late", "tarde"))),
            None
        );
        for (now, then) in [("8,3", "8,4"), ("kp=9", "kp=8")] {
            let what = difference(&english, &figures(&LESSON.replace(now, then)));
            assert!(what.is_some_and(|what| what.contains("line 5")), "{then}");
        }
        assert!(difference(&english, &[]).is_some());
    }
}

//! The page around the chapters: what was run, whether it passed, the table of contents, what was left out.

use crate::content::ContentError;
use crate::data::Data;
use crate::data::{Experiment, Highlight};
use crate::judge::{self, KEPT, MISSED, name_of};
use crate::markdown;
use crate::metric_names::shown;
use crate::page::Page;
use crate::places::Places;
use crate::real::Skipped;
use crate::signals::ReportedRun;
use crate::table::{Cell, Tone, table};
use crate::text::{Language, Text, capital, escape, word};
use rumbo_plot::STYLE as PLOTS;

const STYLE: &str = include_str!("style.css");

const TITLE: Text = word("title");
const SUBTITLE: Text = word("subtitle");
const VERSION: Text = word("version");
const SEED: Text = word("seed");
const ROBOT: Text = word("robot-fact");
const PROGRAM: Text = word("program");
const NATIVE: Text = word("native-program");
const IMAGE: Text = word("emulated-program");
const RECORDED: Text = word("recorded-runs");
const NONE: Text = word("none-given");
const ALL_PASS: Text = word("all-pass");
const ONE_PASSES: Text = word("one-passes");
const SOME_MISS: Text = word("some-miss");
const HEADER: [Text; 5] = [
    word("experiment"),
    word("result"),
    word("quantity"),
    word("here"),
    word("robot-of-the-original-report"),
];
const HOW_FOREIGN: Text = word("foreign-note");
const HOW_SILENT: Text = word("no-telemetry-note");

/// The report as one HTML page, and each figure's identifier, in order.
///
/// # Errors
/// A mistake in a text or a drawing of the content.
pub fn html(data: &Data, language: Language) -> Result<(String, Vec<String>), ContentError> {
    let mut page = Page::new(language);
    let mut chapters = String::new();
    for experiment in &data.experiments {
        let mut places = Places::new(language);
        places.section("own", !data.is_foreign());
        (experiment.fill)(&mut places, data);
        chapters += &markdown::chapter(&mut page, experiment.number, experiment.name, &places)?;
    }
    let front = front(data, language, page.contents());
    let front = markdown::front(&mut page, &front)?;
    let body = front + &chapters;
    let html = shell(language, TITLE.of(language), SUBTITLE.of(language), &body);
    Ok((html, page.figure_ids().to_vec()))
}

/// A whole page around a body in HTML.
pub(crate) fn shell(language: Language, title: &str, subtitle: &str, body: &str) -> String {
    let title = escape(title);
    format!(
        "<!doctype html>\n<html lang=\"{}\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, \
         initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n<style>\n{PLOTS}{STYLE}</style>\n</head>\n<body>\n\
         <header><h1>{title}</h1><p class=\"subtitle\">{}</p></header>\n<main>\n{body}</main>\n</body>\n</html>\n",
        language.tag(),
        escape(subtitle),
    )
}

/// A heading of a page without numbers.
#[cfg(feature = "host")]
pub(crate) fn heading(text: &str) -> String {
    format!("<h2 class=\"on\">{}</h2>\n", escape(text))
}

/// A figure without a number; `label` is for screen readers.
#[cfg(feature = "host")]
pub(crate) fn figure(svg: &str, label: &str) -> String {
    let label = format!("<svg role=\"img\" aria-label=\"{}\"", escape(label));
    let svg = svg.replacen("<svg", &label, 1);
    format!("<figure><div class=\"wide\" tabindex=\"0\">{svg}</div></figure>\n")
}

/// What stands before the chapters.
fn front(data: &Data, language: Language, contents: String) -> Places {
    let mut places = Places::new(language);
    places.block("verdict", verdict(data, language));
    places.block("facts", facts(data, language));
    places.block("summary", summary(data, language));
    places.section("skipped", !data.real.skipped.is_empty());
    places.block("skipped", skipped(data, language));
    places.block("contents", contents);
    if data.is_foreign() {
        places.value("foreign", HOW_FOREIGN.of(language));
    } else {
        places.nothing("foreign");
    }
    if data.outcomes.values().all(ReportedRun::has_telemetry) {
        places.nothing("no-telemetry");
    } else {
        places.value("no-telemetry", HOW_SILENT.of(language));
    }
    places
}

/// Recorded files that are shown nowhere, and why.
fn skipped(data: &Data, language: Language) -> String {
    let row = |skipped: &Skipped| {
        vec![
            Cell::html(name_of(&skipped.file)),
            Cell::text(skipped.why.text().of(language)),
        ]
    };
    let rows: Vec<_> = data.real.skipped.iter().map(row).collect();
    table(&[], &rows)
}

fn verdict(data: &Data, language: Language) -> String {
    let all = data.experiments.len();
    let missed = data
        .experiments
        .iter()
        .filter(|experiment| !data.passes(experiment))
        .count();
    let (class, text) = match (missed, all) {
        (0, 1) => ("good", ONE_PASSES.of(language).to_owned()),
        (0, _) => (
            "good",
            ALL_PASS.with(language, &[("count", &all.to_string())]),
        ),
        _ => (
            "bad",
            SOME_MISS.with(
                language,
                &[("missed", &missed.to_string()), ("count", &all.to_string())],
            ),
        ),
    };
    format!("<p class=\"verdict {class}\">{}</p>\n", escape(&text))
}

fn facts(data: &Data, language: Language) -> String {
    let program = match &data.firmware {
        None => NATIVE.of(language).to_owned(),
        Some([file, crc]) => IMAGE.with(language, &[("file", file), ("crc", crc)]),
    };
    let files: Vec<&str> = data
        .real
        .runs
        .values()
        .map(|run| run.file.as_str())
        .collect();
    let recorded = if files.is_empty() {
        NONE.of(language).to_owned()
    } else {
        files.join(", ")
    };
    let rows = [
        (VERSION, format!("Rumbo {}", env!("CARGO_PKG_VERSION"))),
        (SEED, data.seed.to_string()),
        (ROBOT, data.robot[0].clone()),
        (PROGRAM, program),
        (RECORDED, recorded),
    ];
    let rows: String = rows
        .iter()
        .map(|(name, value)| {
            format!(
                "<dt>{}</dt><dd>{}</dd>\n",
                escape(name.of(language)),
                escape(value)
            )
        })
        .collect();
    format!("<dl class=\"facts\">\n{rows}</dl>\n")
}

/// Each experiment's verdict and most important values.
fn summary(data: &Data, language: Language) -> String {
    let mut rows = Vec::new();
    for experiment in &data.experiments {
        let (verdict, tone) = if data.passes(experiment) {
            (KEPT, Tone::Good)
        } else {
            (MISSED, Tone::Bad)
        };
        let link = format!(
            "<a href=\"#{}\">{}</a>",
            experiment.name,
            escape(&experiment.title(language))
        );
        let mut first = vec![
            Cell::html(link),
            Cell::text(verdict.of(language)).tone(tone),
        ];
        for cells in highlights(language, data, experiment) {
            let mut row = std::mem::replace(&mut first, vec![Cell::text(""), Cell::text("")]);
            row.extend(cells);
            rows.push(row);
        }
    }
    let header = HEADER.map(|text| text.of(language));
    table(&header, &rows)
}

fn highlights(language: Language, data: &Data, experiment: &Experiment) -> Vec<[Cell; 3]> {
    let row = |highlight: &Highlight| {
        let outcome = data.outcome(highlight.scenario)?;
        let shown = shown(language, &outcome.setup.scenario, highlight.metric)?;
        let ours = judge::value(language, &shown, outcome.metric(highlight.metric)?);
        let real = highlight
            .real
            .map(|real| judge::value(language, &shown, real))
            .unwrap_or_default();
        let name = highlight.of.map_or_else(
            || shown.name.clone(),
            |of| format!("{}: {}", capital(of.of(language)), shown.bare),
        );
        Some([Cell::text(&name), Cell::text(&ours), Cell::text(&real)])
    };
    let rows: Vec<_> = experiment.highlights.iter().filter_map(row).collect();
    if rows.is_empty() {
        vec![[Cell::text(""), Cell::text(""), Cell::text("")]]
    } else {
        rows
    }
}

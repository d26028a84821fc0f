//! Pages of a graded class: one for each hand-in, and one for the teacher.
//!
//! A student's page shows the task, the measurements, the points and the advice, and plots a run with a public seed. It
//! shows no other controller's results.

mod class;
mod figures;

pub use class::class;

use crate::complaints::complaint;
use crate::judge;
use crate::metric_names::{Shown, shown};
use crate::signals::ReportedRun;
use crate::summary::{heading, shell};
use crate::table::{Cell, Tone, table};
use crate::text::{Language, Text, capital, escape, put, word};
use pulldown_cmark::{Event, Options, Parser, html};
use rumbo_experiment::grade::{Assignment, Bilingual, GradedTest, Mark, RubricLine};
use rumbo_experiment::note::Note;
use std::borrow::Cow;
use std::ffi::OsStr;
use std::path::Path;

const POINTS_OF: Text = word("points-of");
const SEEDS: Text = word("seeds-driven");
const EARNED: Text = word("earned-by-line");
const NOT_DRIVEN: Text = word("could-not-be-driven");
const ENDED: Text = word("program-ended");
const NOTES: Text = word("notes");
const POINTS: Text = word("points");
const ASKED: Text = word("asked");
const MEASURED_HERE: Text = word("measured-median");
const RUNS: Text = word("runs-with-all-points");
const CONTACT: Text = word("contact-in-runs");
const LOOK_AT: Text = word("what-to-look-at");
const YOUR_ROBOT: Text = word("your-robot");
const SEED_SHOWN: Text = word("seed-shown");
const STATEMENT: Text = word("assignment-statement");
const FULL: Text = word("full-marks");
const NONE: Text = word("no-points");
const AT_MOST: Text = word("at-most-value");
const AT_LEAST: Text = word("at-least-value");

/// A text of an assignment in a language, if it has it.
#[must_use]
pub fn of(language: Language, words: &Bilingual) -> &str {
    match (language, &words.spanish) {
        (Language::Spanish, Some(spanish)) => spanish,
        _ => &words.text,
    }
}

/// What is noted of a hand-in or of how its program ended, in a language.
#[must_use]
pub fn noted(language: Language, note: &Note) -> String {
    complaint(language, note).text()
}

/// With how many seeds a hand-in is driven, and how many of them nobody knows, in a language.
#[must_use]
pub fn seeds_in_words(assignment: &Assignment, language: Language) -> String {
    let count = |seeds: fn(&GradedTest) -> usize| -> String {
        let all: usize = assignment.tests.iter().map(seeds).sum();
        all.to_string()
    };
    let public = count(|test| test.public.len());
    let hidden = count(|test| test.hidden.len());
    SEEDS.with(language, &[("public", &public), ("hidden", &hidden)])
}

/// Points and measurement of a line of the rubric, in a language.
#[must_use]
pub fn earned_in_words(assignment: &Assignment, line: &RubricLine, language: Language) -> String {
    let criterion = &assignment.criteria[line.criterion];
    let shown = metric(assignment, line, language);
    let in_words = |value| judge::value(language, &shown, value);
    let values = [
        ("points", language.number(line.points, 2)),
        ("of", language.short(line.of, 2)),
        ("metric", shown.name.clone()),
        (
            "value",
            in_words(line.median(assignment).unwrap_or(f64::NAN)),
        ),
        ("full", full(language, assignment, line)),
        ("none", in_words(criterion.none)),
    ];
    EARNED.with(language, &values)
}

/// What was seen in the program where a line of the rubric lost points, in a language; empty where it lost none.
#[must_use]
pub fn place_in_words(line: &RubricLine, language: Language) -> String {
    match &line.place {
        Some(place) if !line.is_full() => noted(language, place),
        _ => String::new(),
    }
}

/// From where on a line has all points.
fn full(language: Language, assignment: &Assignment, line: &RubricLine) -> String {
    let criterion = &assignment.criteria[line.criterion];
    let bound = match criterion.full < criterion.none {
        true => AT_MOST,
        false => AT_LEAST,
    };
    let shown = metric(assignment, line, language);
    bound.with(
        language,
        &[("value", &judge::value(language, &shown, criterion.full))],
    )
}

/// The way back to the class, shown to who came from there: a student has no such page.
pub(crate) fn back(language: Language) -> String {
    let class = escape(class::CLASS.of(language));
    format!("<p id=\"class\"><a href=\"../index.html\">← {class}</a></p>\n")
}

/// The page of one hand-in.
#[must_use]
pub fn student(assignment: &Assignment, mark: &Mark, notes: &[Note], language: Language) -> String {
    let mut body = back(language) + &verdict(mark, language);
    let seeds = escape(&seeds_in_words(assignment, language));
    put(&mut body, format_args!("<p>{seeds}</p>\n"));
    let notes = [notes, &mark.notes].concat();
    body += &list(language, NOTES, &notes);
    if mark.refused.is_empty() {
        body += &list(language, ENDED, &mark.ended);
        body += &points(assignment, mark, language);
        body += &advice(assignment, mark, language);
        body += &curves(assignment, mark, language);
    } else {
        body += &heading(NOT_DRIVEN.of(language));
        let lines = mark.refused.iter();
        let lines: String = lines.map(|line| escape(line) + "\n").collect();
        put(
            &mut body,
            format_args!("<div class=\"wide\" tabindex=\"0\"><pre>{lines}</pre></div>\n"),
        );
    }
    body += &heading(STATEMENT.of(language));
    body += &markdown(of(language, &assignment.statement));
    shell(language, of(language, &assignment.title), &mark.name, &body)
}

fn list(language: Language, title: Text, notes: &[Note]) -> String {
    if notes.is_empty() {
        return String::new();
    }
    let items = notes
        .iter()
        .map(|note| format!("<li>{}</li>\n", complaint(language, note).html()));
    let items: String = items.collect();
    format!(
        "<div class=\"note\"><p>{}</p><ul>\n{items}</ul></div>\n",
        escape(title.of(language))
    )
}

fn verdict(mark: &Mark, language: Language) -> String {
    let class = if mark.pass { "good" } else { "bad" };
    let text = POINTS_OF.with(
        language,
        &[
            ("points", &language.short(mark.points, 2)),
            ("of", &language.short(mark.of, 2)),
        ],
    );
    format!("<p class=\"verdict {class}\">{}</p>\n", escape(&text))
}

/// A metric as displayed, for the plotted run or any other.
fn metric(assignment: &Assignment, line: &RubricLine, language: Language) -> Shown {
    let criterion = &assignment.criteria[line.criterion];
    let scenario = &assignment.tests[line.test].setup.scenario;
    shown(language, scenario, &criterion.metric).unwrap_or(Shown {
        name: criterion.metric.clone(),
        ..judge::plain("")
    })
}

/// Criterion, measurement and points, a row for each line of the rubric.
fn points(assignment: &Assignment, mark: &Mark, language: Language) -> String {
    let header = [
        ASKED.of(language),
        POINTS.of(language),
        MEASURED_HERE.of(language),
        FULL.of(language),
        NONE.of(language),
        RUNS.of(language),
    ];
    let several = assignment.tests.len() > 1;
    let mut rows = Vec::new();
    for line in &mark.lines {
        let criterion = &assignment.criteria[line.criterion];
        let shown = metric(assignment, line, language);
        let mut asked = escape(of(language, &criterion.title));
        let mut below = escape(&shown.name);
        if several {
            let test = &assignment.tests[line.test];
            below = format!("{}. {below}", escape(of(language, &test.title)));
        }
        put(&mut asked, format_args!("<br><small>{below}</small>"));
        let in_words = |value| judge::value(language, &shown, value);
        let median = line.median(assignment).unwrap_or(f64::NAN);
        let all = line
            .values
            .iter()
            .filter(|value| criterion.share(**value) >= 1.0);
        rows.push(vec![
            Cell::html(asked),
            earned(language, line.points, line.of),
            Cell::text(&in_words(median)),
            Cell::text(&full(language, assignment, line)),
            Cell::text(&in_words(criterion.none)),
            Cell::text(&format!("{} / {}", all.count(), line.values.len())),
        ]);
    }
    if mark.penalty > 0.0 {
        let runs = [
            ("count", mark.touching.to_string()),
            ("of", mark.runs.to_string()),
        ];
        let lost = language.number(-mark.penalty, 2);
        let mut row = vec![
            Cell::text(&CONTACT.with(language, &runs)),
            Cell::text(&lost).tone(Tone::Bad),
        ];
        row.extend((0..4).map(|_| Cell::text("")));
        rows.push(row);
    }
    heading(POINTS.of(language)) + &table(&header, &rows)
}

fn earned(language: Language, points: f64, of: f64) -> Cell {
    let tone = if points >= of - 1e-9 {
        Tone::Good
    } else {
        Tone::Bad
    };
    let text = format!("{} / {}", language.number(points, 2), language.short(of, 2));
    Cell::text(&text).tone(tone)
}

/// Advice for each criterion that lost points. Of what never happened in a test the first is the reason for the rest.
fn advice(assignment: &Assignment, mark: &Mark, language: Language) -> String {
    let mut never = Vec::new();
    let criteria = assignment.criteria.iter().enumerate();
    let lost = criteria.filter(|(number, one)| {
        let own = || mark.lines.iter().filter(|line| line.criterion == *number);
        if of(language, &one.advice).is_empty() || own().all(RubricLine::is_full) {
            return false;
        }
        let tests: Vec<_> = own().map(|line| line.test).collect();
        let is_first = !never.contains(&tests);
        match own().any(|line| line.median(assignment).is_some()) {
            true => return true,
            false => never.push(tests),
        }
        is_first
    });
    let items: String = lost
        .map(|(number, one)| {
            let (title, advice) = (of(language, &one.title), of(language, &one.advice));
            let own = mark.lines.iter().filter(|line| line.criterion == number);
            let places = own.map(|line| place_in_words(line, language));
            let place = places
                .filter(|place| !place.is_empty())
                .map(|place| place + ". ");
            let place: String = place.take(1).collect();
            format!(
                "<li><b>{}.</b> {}{}</li>\n",
                escape(title),
                escape(&capital(&place)),
                escape(advice)
            )
        })
        .collect();
    match items.is_empty() {
        true => items,
        false => format!("{}<ul>\n{items}</ul>\n", heading(LOOK_AT.of(language))),
    }
}

/// A figure for each test.
fn curves(assignment: &Assignment, mark: &Mark, language: Language) -> String {
    let mut html = String::new();
    for (test, result) in assignment.tests.iter().zip(&mark.drawn) {
        let Some(result) = result else {
            continue;
        };
        let outcome = ReportedRun {
            setup: test.setup.clone(),
            result: result.clone(),
        };
        let (seed, command) = (result.seed.to_string(), escape(&in_lab(test, result.seed)));
        let shown = [
            ("seed", &*seed),
            ("command", &format!("<code>{command}</code>")),
        ];
        let seed = SEED_SHOWN.with(language, &shown);
        let title = of(language, &test.title);
        for svg in figures::figures(language, test, &outcome) {
            let label = format!("<svg role=\"img\" aria-label=\"{}\"", escape(title));
            let svg = svg.replacen("<svg", &label, 1);
            put(
                &mut html,
                format_args!(
                    "<figure><div class=\"wide\" tabindex=\"0\">{svg}</div><figcaption>{}. {}</figcaption></figure>\n",
                    escape(title),
                    seed
                ),
            );
        }
    }
    match html.is_empty() {
        true => html,
        false => heading(YOUR_ROBOT.of(language)) + &html,
    }
}

/// What shows a sketch's run in the lab, where the assignment's files are.
fn in_lab(test: &GradedTest, seed: u64) -> String {
    let scenario = &test.setup.scenario;
    let file = scenario.path.as_ref().map(Path::new);
    let file = file.and_then(Path::file_name).map(OsStr::to_string_lossy);
    let name = file.unwrap_or(Cow::Borrowed(&scenario.name));
    let wiring = test
        .wiring
        .as_ref()
        .map(|wiring| format!(" --wiring {wiring}"));
    format!(
        "rumbo lab --scenario {name} --sketch my_sketch{} --seed {seed}",
        wiring.unwrap_or_default()
    )
}

/// A teacher's text as HTML; HTML in it is escaped.
fn markdown(text: &str) -> String {
    let events = Parser::new_ext(text, Options::ENABLE_TABLES).map(|event| match event {
        Event::Html(html) | Event::InlineHtml(html) => Event::Text(html),
        other => other,
    });
    let mut written = String::new();
    html::push_html(&mut written, events);
    // A heading without words is none.
    written.replace("<th></th>", "<td></td>")
}
